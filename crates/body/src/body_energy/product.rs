//! The change of the internal forces along a displacement and along controls, for which no matrix is assembled.

use crate::body_energy::BodyEnergy;
use crate::body_energy::driving::Driving;
use crate::body_energy::formulation::StressJet;
use crate::controls::Controls;
use crate::error::Inadmissible;
use crate::kernels::cell_scratch::Scratch;
use crate::kernels::cells::Cells;
use crate::kernels::displaced::Displaced;
use crate::kernels::patch::Patch;
use nastic_energy::{EnergyTerm, PointBatch, Response, Slots, Want};
use nastic_tensor::Mat3;

/// What forces change along.
#[derive(Clone, Copy)]
pub(super) enum Along<'a> {
    /// A displacement.
    Displacement(&'a [f64]),
    /// Controls.
    Controls(&'a Controls),
}

/// `out += K(u, m) v` or `out += dr/dm v`: at every point the change of stress, `dP/dF : F'(u) v` or `sum_k v_k dP/dm_k`, spread like a stress,
/// and along a displacement what the stress has by `F''(u)`.
pub(super) fn add(
    body: &BodyEnergy,
    at: (Displaced, Driving),
    along: Along,
    out: &mut [f64],
    parallel: bool,
) -> Result<(), Inadmissible> {
    let product = Product { body, to: at.0, driving: at.1, along };
    body.sweep(
        parallel,
        Cells::row_length,
        |cells, patch, scratch, rows: &mut Vec<f64>| product.compute(cells, patch, scratch, rows),
        |cells, patch, rows| cells.scatter(patch, rows, out),
    )
}

struct Product<'a> {
    body: &'a BodyEnergy,
    to: Displaced<'a>,
    driving: Driving<'a>,
    along: Along<'a>,
}

impl Product<'_> {
    fn compute(
        &self,
        cells: Cells,
        patch: Patch,
        scratch: &mut Scratch,
        rows: &mut Vec<f64>,
    ) -> Result<(), Inadmissible> {
        cells.clear_rows(patch, rows);
        if matches!(self.along, Along::Controls(_)) && !self.body.is_actuated(cells, patch) {
            return Ok(());
        }
        self.body.kinematics(cells, patch, self.to, Some(self.driving), scratch)?;
        let formulation = self.body.arithmetic_of(cells.first(patch));
        if let Along::Displacement(v) = self.along {
            formulation.change(cells, patch, v, scratch);
        }
        scratch.clear_stress();
        for (range, at) in cells.batches(patch, &scratch.kinematics) {
            let stress = &mut scratch.stress[range.clone()];
            match self.along {
                Along::Displacement(_) => {
                    for (law, m) in self.body.laws(&at, self.driving) {
                        law.stress_change(&at, m.get(), &scratch.change[range.clone()], stress);
                    }
                }
                Along::Controls(v) => self.add_by_controls(v, &at, &mut scratch.by_control, stress),
            }
        }
        weigh(&mut scratch.stress, &scratch.weights);
        if formulation.is_affine() || matches!(self.along, Along::Controls(_)) {
            formulation.add_force(cells, scratch, &scratch.stress, rows);
            return Ok(());
        }
        let mut stress = self.body.stresses(cells, patch, scratch, self.driving);
        weigh(&mut stress, &scratch.weights);
        let jet = StressJet { along: [&scratch.dilatation.along, &[]], parts: [&stress, &scratch.stress, &[], &[]] };
        formulation.add_force_derivative(cells, scratch, jet, 1, rows);
        Ok(())
    }

    fn add_by_controls(&self, v: &Controls, at: &PointBatch, by_control: &mut Vec<Mat3>, stress: &mut [Mat3]) {
        for own in self.body.laws_of(at.cell) {
            let (m, v) = (self.driving.of_law(own, at), self.driving.changes(own, v, at));
            let (m, v) = (m.get(), v.get());
            if v.width == 0 {
                continue; // without slots, or a viscous law
            }
            by_control.resize(at.len() * m.width, Mat3::zeros());
            own.law.stress_by_control(at, m, by_control);
            add_weighted(by_control, v, stress);
        }
    }
}

/// Adds `sum_k v_k by_control_k` at every point.
pub(super) fn add_weighted(by_control: &[Mat3], v: Slots, stress: &mut [Mat3]) {
    for (q, (stress, by_control)) in stress.iter_mut().zip(by_control.chunks_exact(v.width)).enumerate() {
        by_control.iter().zip(v.only(q).values).for_each(|(change, v)| *stress += change * *v);
    }
}

/// Multiplies stresses by the weights of their points.
pub(super) fn weigh(stress: &mut [Mat3], weights: &[f64]) {
    stress.iter_mut().zip(weights).for_each(|(stress, &w)| *stress *= w);
}

impl BodyEnergy {
    /// P of all terms and actuations at the points of a patch that was moved to.
    pub(super) fn stresses(&self, cells: Cells, patch: Patch, scratch: &Scratch, driving: Driving) -> Vec<Mat3> {
        let mut stress = vec![Mat3::zeros(); scratch.kinematics.len()];
        for (range, at) in cells.batches(patch, &scratch.kinematics) {
            let mut out = Response { energy: &mut [], stress: &mut stress[range], tangent: &mut [] };
            for (law, m) in self.laws(&at, driving) {
                law.respond(&at, m.get(), Want::STRESS, &mut out);
            }
        }
        stress
    }
}
