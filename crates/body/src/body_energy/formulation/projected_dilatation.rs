//! [`ProjectedDilatation`]: the determinant of F projected onto functions of the cell, or of a patch of cells.

use super::{CellFormulation, StressJet};
use crate::discretization::Discretization;
use crate::error::Inadmissible;
use crate::kernels::cell_scratch::Scratch;
use crate::kernels::cells::{Cells, PatchMatrix};
use crate::kernels::dilatation::{Dilatation, jets, matrix as matrix_of, part, rows as rows_of};
use crate::kernels::displaced::Displaced;
use crate::kernels::patch::Patch;
use nastic_tensor::{Kinematics, Mat3};

/// `Fbar = (Jbar / J)^(1/d) F` with Jbar the L2 projection of J onto constants, or onto `1, X, Y, Z`; see
/// [`Dilatation`].
///
/// Linear functions are those of the position, not of the reference element, which loses an order of accuracy on distorted cells: Boffi,
/// Gastaldi, "On the quadrilateral Q2-P1 element for the Stokes problem", IJNMF 39 (2002).
#[derive(Debug, Clone, Copy)]
pub(super) struct ProjectedDilatation {
    pub linear: bool,
}

impl CellFormulation for ProjectedDilatation {
    fn is_affine(&self) -> bool {
        false
    }

    fn kinematics(
        &self,
        disc: &Discretization,
        cells: Cells,
        patch: Patch,
        to: Displaced,
        scratch: &mut Scratch,
    ) -> Result<(), Inadmissible> {
        scratch.move_to(cells, patch, to)?;
        let positions = if self.linear { positions(disc, cells, patch) } else { Vec::new() };
        let dilatation = &mut scratch.dilatation;
        dilatation.set_modes(cells.dim, &scratch.weights, &positions, self.linear);
        dilatation.own.clone_from(&scratch.kinematics);
        let own: Vec<_> = dilatation.own.iter().map(|k| rows_of(k.f())).collect();
        let jacobians = dilatation.jacobians();
        if let Some(point) = jacobians.iter().position(|j| j.is_nan() || *j <= 0.0) {
            return Err(cells.inverted_at(patch, point, jacobians[point]));
        }
        scratch.kinematics.clear();
        for (point, f) in dilatation.modified(&own).iter().enumerate() {
            let kinematics = Kinematics::new(matrix_of(f));
            scratch.kinematics.push(kinematics.map_err(|found| cells.inverted_at(patch, point, found.jacobian))?);
        }
        Ok(())
    }

    fn own<'a>(&self, scratch: &'a Scratch) -> &'a [Kinematics] {
        &scratch.dilatation.own
    }

    fn projected(&self, scratch: &Scratch, values: &[f64]) -> Option<Vec<f64>> {
        Some(scratch.dilatation.project(values))
    }

    fn changes_of_modes(&self, cells: Cells, patch: Patch, scratch: &Scratch) -> Vec<Vec<f64>> {
        let dilatation = &scratch.dilatation;
        let at = |q: usize| dilatation.own[q].h() * dilatation.weights()[q];
        dilatation.modes().map(|mode| at_points(cells, patch, &scratch.g, mode, &at)).collect()
    }

    fn change(&self, cells: Cells, patch: Patch, v: &[f64], scratch: &mut Scratch) {
        scratch.change_by(cells, patch, v);
        let dilatation = &mut scratch.dilatation;
        dilatation.along.clone_from(&scratch.change);
        let changed = dilatation.modified(&dilatation.along([&dilatation.along, &[]]));
        scratch.change = part(&changed, 1);
    }

    fn second_change(&self, scratch: &Scratch, along: [&[Mat3]; 2]) -> Vec<Mat3> {
        let dilatation = &scratch.dilatation;
        part(&dilatation.modified(&dilatation.along(along)), 3)
    }

    fn add_force(&self, cells: Cells, scratch: &Scratch, stress: &[Mat3], rows: &mut [f64]) {
        let dilatation = &scratch.dilatation;
        let own: Vec<_> = dilatation.own.iter().map(|k| rows_of(k.f())).collect();
        let stress: Vec<_> = stress.iter().map(rows_of).collect();
        let stress: Vec<Mat3> = dilatation.stress(&own, &stress).iter().map(matrix_of).collect();
        cells.force(&scratch.g, &stress, rows);
    }

    fn add_force_derivative(&self, cells: Cells, scratch: &Scratch, jet: StressJet, which: usize, rows: &mut [f64]) {
        let dilatation = &scratch.dilatation;
        let stress = dilatation.stress(&dilatation.along(jet.along), &jets(jet.parts));
        cells.force(&scratch.g, &part(&stress, which), rows);
    }

    fn tangent(&self, cells: Cells, patch: Patch, scratch: &mut Scratch, matrix: &mut PatchMatrix) {
        let factors = Factors::of(scratch);
        local_tangents(scratch, &factors);
        cells.tangent(patch, &scratch.g, &scratch.tangent, matrix, &mut scratch.work);
        let changes = self.changes_of_modes(cells, patch, scratch);
        for [changes, forces] in coupled(cells, patch, scratch, changes, &factors) {
            cells.add_symmetric_product(patch, &changes, &forces, matrix);
        }
    }
}

/// Positions of the points of a patch.
fn positions(disc: &Discretization, cells: Cells, patch: Patch) -> Vec<[f64; 3]> {
    let (part, points) = (cells.part, disc.mesh().points());
    let at = |(c, q): (u32, usize)| {
        let mut x = [0.0; 3];
        for (&node, shape) in part.nodes_of(c as usize).iter().zip(part.table.shapes_at(q)) {
            x.iter_mut().zip(&points[node as usize]).for_each(|(x, p)| *x += shape * p);
        }
        x
    };
    patch.cells.iter().flat_map(|&c| (0..part.table.points).map(move |q| (c, q))).map(at).collect()
}

/// What second derivatives are made of at a point. With `x, y` the gradients of two fields, `G = F^-T`, `b = (ln Jbar)'` along a field,
/// `F` the entries in the plane, `A = dP/dF` and `M = A : F`, the potential's second derivative is a sum over the points of
///
/// ```text
/// x : C : y + (V : x) b_y + (V : y) b_x + k b_x b_y
/// C = s^2 A + G (x) U + U (x) G + (w pbar - t/J) F x      U = -(s^2/d) M - (s/d) P + (s^2/d^2 F:M + t/d + t) G / 2
/// V = (s^2/d) M + (s/d) P - (s^2/d^2 F:M + t/d) G          k = s^2/d^2 F:M + t/d - t
/// ```
struct Factors {
    u: Vec<Mat3>,
    v: Vec<Mat3>,
    k: Vec<f64>,
    scale: Vec<f64>,
    /// `w pbar - t / J`
    cross: Vec<f64>,
    jbar: Vec<f64>,
}

impl Factors {
    fn of(scratch: &Scratch) -> Self {
        let Scratch { dilatation, tangent, stress, .. } = scratch;
        let d = dilatation.dim() as f64;
        let points = stress.len();
        let jbar = dilatation.jacobians();
        let roots = dilatation.own.iter().zip(&jbar).map(|(k, jbar)| root(jbar / k.j(), dilatation));
        let scale: Vec<f64> = roots.collect();
        let planar: Vec<Mat3> = dilatation.own.iter().map(|k| in_plane(k.f(), dilatation)).collect();
        let t: Vec<f64> = (0..points).map(|q| scale[q] / d * stress[q].dot(&planar[q])).collect();
        let pressures: Vec<f64> = t.iter().zip(&jbar).map(|(t, jbar)| t / jbar).collect();
        let pbar = dilatation.spread(&pressures);
        let (mut u, mut v, mut k, mut cross) = (vec![], vec![], vec![], vec![]);
        for q in 0..points {
            let own = &dilatation.own[q];
            let (s, g) = (scale[q], own.h() / own.j());
            let m = tangent[q].apply(&planar[q]) * (s * s / d) + stress[q] * (s / d);
            let curvature = s * s / (d * d) * planar[q].dot(&tangent[q].apply(&planar[q])) + t[q] / d;
            u.push(g * (0.5 * (curvature + t[q])) - m);
            v.push(m - g * curvature);
            k.push(curvature - t[q]);
            cross.push(dilatation.weights()[q] * pbar[q] - t[q] / own.j());
        }
        Factors { u, v, k, scale, cross, jbar }
    }
}

/// C at every point, in place of A.
fn local_tangents(scratch: &mut Scratch, factors: &Factors) {
    let Scratch { dilatation, tangent, .. } = scratch;
    for (q, tangent) in tangent.iter_mut().enumerate() {
        let own = &dilatation.own[q];
        let square = factors.scale[q] * factors.scale[q];
        tangent.0.iter_mut().for_each(|c| *c *= square);
        tangent.add_outer_symmetric(&(own.h() / own.j()), &factors.u[q], 1.0);
        tangent.add_cross(own.f(), factors.cross[q]);
    }
}

/// What couples the points: for every mode the nodal rows `B_i = sum_q w phi_i H : grad` of `(sum_q w phi_i J)'`, `changes`, and `Y_i` such that
/// the matrix has `B_i Y_i^T + Y_i B_i^T`.
fn coupled(
    cells: Cells,
    patch: Patch,
    scratch: &Scratch,
    changes: Vec<Vec<f64>>,
    factors: &Factors,
) -> Vec<[Vec<f64>; 2]> {
    let Scratch { dilatation, g, .. } = scratch;
    let modes: Vec<&[f64]> = dilatation.modes().collect();
    let weights = dilatation.weights();
    let pair = |(i, mode): (usize, &&[f64])| {
        let mut force = at_points(cells, patch, g, mode, &|q| factors.v[q] / factors.jbar[q]);
        for (other, change) in modes.iter().zip(&changes) {
            let of_point = |q: usize| factors.k[q] * mode[q] * other[q] / (factors.jbar[q] * factors.jbar[q]);
            let k: f64 = (0..weights.len()).map(of_point).sum();
            force.iter_mut().zip(change).for_each(|(f, c)| *f += 0.5 * k * c);
        }
        [changes[i].clone(), force]
    };
    modes.iter().enumerate().map(pair).collect()
}

/// The nodal rows of a stress times a mode.
fn at_points(cells: Cells, patch: Patch, g: &[f64], mode: &[f64], of: &dyn Fn(usize) -> Mat3) -> Vec<f64> {
    let stress: Vec<Mat3> = mode.iter().enumerate().map(|(q, mode)| of(q) * *mode).collect();
    let mut rows = Vec::new();
    cells.clear_rows(patch, &mut rows);
    cells.force(g, &stress, &mut rows);
    rows
}

fn root(x: f64, dilatation: &Dilatation) -> f64 {
    nastic_tensor::Scalar::root(x, dilatation.dim())
}

fn in_plane(f: &Mat3, dilatation: &Dilatation) -> Mat3 {
    let mut f = *f;
    if dilatation.dim() == 2 {
        f[(2, 2)] = 0.0;
    }
    f
}
