//! The changes of volume that a nearly incompressible body resists, for linear solvers.

use crate::body_energy::BodyEnergy;
use crate::body_energy::driving::Driving;
use crate::controls::Controls;
use crate::error::Inadmissible;
use crate::kernels::cell_scratch::Scratch;
use crate::kernels::cells::Cells;
use crate::kernels::displaced::Displaced;
use crate::kernels::patch::Patch;
use nastic_energy::{EnergyTerm, Response, Want};
use nastic_linear::VolumeModes;
use nastic_tensor::{Kinematics, Mat3, Tangent};

/// Ratio of bulk to shear modulus from which on a cell's changes of volume stand out, and the one that is left beside them.
pub const STANDS_OUT: f64 = 30.0;
/// The ratio that is left beside them.
pub const LEFT: f64 = 8.0;

impl BodyEnergy {
    /// Those of the cells whose formulation gives them few and whose passive laws, with the designs and the growth among the controls, resist them much, at a displacement: for a mode of the projection
    /// of J the rows of its change, and with the passive energy W of `Fbar`
    ///
    /// ```text
    /// c = min over the points of d^2 W / d(Jbar)^2 = (Fbar : A : Fbar / d^2 + P : Fbar (1 - d) / d^2) / Jbar^2,   A = dP/dF at Fbar
    /// ```
    ///
    /// less the share that leaves the rest of the tangent a bulk modulus of eight times the shear modulus. `None` where there are none. Changes of volume
    /// that a solution is expected to have, by quadrature point, become those of the modes.
    ///
    /// # Errors
    /// [`Inadmissible`] where the displacement is.
    pub fn volume_modes(
        &self,
        to: Displaced,
        controls: &Controls,
        fixed: &[bool],
        expected: Option<&[f64]>,
        parallel: bool,
    ) -> Result<Option<VolumeModes>, Inadmissible> {
        let (mut modes, mut changes) = (VolumeModes::none(self.disc.dim()), Vec::new());
        if !self.groups().any(|(cells, _)| self.projects(cells)) {
            return Ok(None);
        }
        let work = Modes { body: self, to, controls, expected };
        self.sweep(
            parallel,
            Cells::row_length,
            |cells, patch, scratch, found: &mut Found| work.compute(cells, patch, scratch, found),
            |_, _, found| {
                if !found.modes.is_empty() {
                    modes.push(&found.nodes, &found.modes, found.stiffness);
                    changes.extend_from_slice(&found.expected);
                }
            },
        )?;
        if expected.is_some() {
            modes = modes.expecting(changes);
        }
        Ok((!modes.is_empty()).then(|| modes.supported(fixed)))
    }

    /// `sum_i phi_i v_i` at every quadrature point, of numbers by volume mode; zero where there are none.
    ///
    /// # Errors
    /// [`Inadmissible`] where the displacement is.
    pub fn volume_modes_at_points(
        &self,
        to: Displaced,
        controls: &Controls,
        by_mode: &[f64],
        parallel: bool,
    ) -> Result<Vec<f64>, Inadmissible> {
        let none = vec![0.0; self.disc.points().len()];
        let (mut all, mut left) = (none.clone(), by_mode);
        let work = Modes { body: self, to, controls, expected: Some(&none) };
        self.sweep(
            parallel,
            Cells::row_length,
            |cells, patch, scratch, found: &mut Found| work.compute(cells, patch, scratch, found),
            |cells, patch, found| {
                let (own, rest) = left.split_at(found.modes.len().min(left.len()));
                left = rest;
                let points = found.shapes.first().map_or(0, Vec::len);
                let at = |q: usize| found.shapes.iter().zip(own).map(|(phi, v)| phi[q] * v).sum::<f64>();
                if points > 0 {
                    cells.put(patch, &(0..points).map(at).collect::<Vec<_>>(), &mut all);
                }
            },
        )?;
        Ok(all)
    }
}

/// The modes of every patch.
struct Modes<'a> {
    body: &'a BodyEnergy,
    to: Displaced<'a>,
    controls: &'a Controls,
    /// Changes of volume by quadrature point.
    expected: Option<&'a [f64]>,
}

#[derive(Debug, Clone, Default)]
struct Found {
    nodes: Vec<u32>,
    modes: Vec<Vec<f64>>,
    stiffness: [f64; 2],
    /// By mode, where changes are expected: of the solution, and its values at the points.
    expected: Vec<f64>,
    shapes: Vec<Vec<f64>>,
}

impl Modes<'_> {
    fn compute(
        &self,
        cells: Cells,
        patch: Patch,
        scratch: &mut Scratch,
        found: &mut Found,
    ) -> Result<(), Inadmissible> {
        found.modes.clear();
        found.shapes.clear();
        let (body, controls) = (self.body, self.controls);
        let formulation = body.arithmetic_of(cells.first(patch));
        if formulation.is_affine() {
            return Ok(());
        }
        let Some(share) = body.stiff_share(cells, patch, controls) else { return Ok(()) };
        body.kinematics(cells, patch, self.to, Some(Driving::relaxed(controls)), scratch)?;
        let derivatives = body.derivatives_by_volume(cells, patch, controls, scratch);
        let stiffness = derivatives.iter().fold(f64::INFINITY, |least, [_, second]| least.min(*second));
        if !stiffness.is_finite() || stiffness <= 0.0 {
            return Ok(());
        }
        found.stiffness = [stiffness * share, stiffness * (1.0 - share)];
        found.expected.clear();
        if let Some(expected) = self.expected {
            let changes = cells.taken(patch, expected);
            let of_mode = |mode: &[f64]| {
                let points = mode.iter().zip(&scratch.weights).zip(&changes);
                points.map(|((phi, w), change)| w * phi * change).sum::<f64>()
            };
            found.expected.extend(scratch.dilatation.modes().map(of_mode));
            found.shapes = scratch.dilatation.modes().map(<[f64]>::to_vec).collect();
        }
        (found.nodes, found.modes) = cells.summed_at_nodes(patch, &formulation.changes_of_modes(cells, patch, scratch));
        Ok(())
    }
}

impl BodyEnergy {
    /// Whether the formulation of a cell of this kind projects J.
    fn projects(&self, cells: Cells) -> bool {
        cells.part.cells.iter().any(|&cell| !self.arithmetic_of(cell as usize).is_affine())
    }

    /// The share of its bulk modulus that makes the changes of volume of a patch stand out; `None` where they do not.
    pub(super) fn stiff_share(&self, cells: Cells, patch: Patch, controls: &Controls) -> Option<f64> {
        let ratio = self.ratio_of(cells.first(patch), cells.part.first_point(cells.number(patch)), controls);
        (ratio >= STANDS_OUT).then(|| 1.0 - LEFT / ratio)
    }

    /// First and second derivative of the passive energy by the determinant that laws see, at the points of a patch that was moved to.
    pub(super) fn derivatives_by_volume(
        &self,
        cells: Cells,
        patch: Patch,
        controls: &Controls,
        scratch: &mut Scratch,
    ) -> Vec<[f64; 2]> {
        let want = Want { energy: false, stress: true, tangent: true };
        scratch.clear(want);
        for (range, at) in cells.batches(patch, &scratch.kinematics) {
            let stress = &mut scratch.stress[range.clone()];
            let mut out = Response { energy: &mut [], stress, tangent: &mut scratch.tangent[range] };
            for (law, m) in self.materials(&at, Driving::relaxed(controls)) {
                law.respond(&at, m.get(), want, &mut out);
            }
        }
        let d = cells.dim;
        let of_point = |((kinematics, tangent), stress): ((&Kinematics, &Tangent), &Mat3)| {
            let f = Mat3::from_fn(|i, k| if i < d && k < d { kinematics.f()[(i, k)] } else { 0.0 });
            let dim = d as f64;
            let (by_f, d_j) = (stress.dot(&f), dim * kinematics.j());
            [by_f / d_j, (f.dot(&tangent.apply(&f)) + (1.0 - dim) * by_f) / d_j.powi(2)]
        };
        let points = scratch.kinematics.iter().zip(&scratch.tangent).zip(&scratch.stress);
        points.map(of_point).collect()
    }
}
