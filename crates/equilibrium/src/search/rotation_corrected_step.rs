//! Rotation-corrected Newton steps (rotation-strain extrapolation).
//!
//! A straight step `u + s du` stretches whatever it rotates: a bar that wants to bend by an angle `w` is made longer by
//! `w^2 / 2`, and most of the way to a bent equilibrium is spent undoing that. The curved step takes the rotation in `du`
//! for a rotation:
//!
//! ```text
//! G = grad du F^-1,   w = skew G,   e = sym G            at every quadrature point
//! F(s) = exp(s w) (1 + s e) F
//! u(s) = argmin over v of  1/2 int |grad v - (F(s) - 1)|^2 dX,   v = u + s du where supported
//! ```
//!
//! `u'(0) = du`, so that descent and quadratic convergence are those of the straight step. The fit is a scalar Laplace
//! problem per component, a twenty-seventh of the work of one tangent, factorised once per solve, in large bodies solved by
//! multigrid; single precision is enough for it, since what it fits vanishes with s^2, and the states between two others need not be exact.
//!
//! Source: Huang, Tong, Zhou, Bao, Desbrun, "Interactive shape interpolation through controllable dynamic deformation",
//! IEEE TVCG 17 (2011), section 3.2, where rotation-strain coordinates serve animation.

use crate::model::Model;
use nastic_body::body_energy::max_step::volume_step;
use nastic_body::discretization::Discretization;
use nastic_body::kernels::cell_scratch::Scratch;
use nastic_body::kernels::cells::Cells;
use nastic_body::kernels::displaced::Displaced;
use nastic_body::kernels::patch::Patch;
use nastic_tensor::{Kinematics, Mat3, Vec3, polar_rotation};

/// Largest rotation of a step (radians) above which the step is corrected.
const MIN_ANGLE: f64 = 0.05;
/// Cells of one task.
const CELLS_PER_TASK: usize = 64;

/// The longest admissible step, straight and rotation-corrected.
pub(crate) struct StepLimits {
    /// The longest `s <= 1` for which `det(1 + t G) >= 1/10` on `[0, s]` at every point; see [`Model::max_step`].
    pub straight: f64,
    /// The same along the curve, with e in the place of G; nothing for a step that turns the body too little for a curve to
    /// be worth it.
    pub curved: Option<f64>,
}

impl StepLimits {
    pub fn of(disc: &Discretization, at: Displaced, du: &[f64], parallel: bool) -> Self {
        let of = |group: Cells, cells: &[u32]| {
            let mut found = Extremes::default();
            each_point(group, cells, at, du, |_, _, _, (_, g)| {
                let longest = |g: &Mat3| volume_step(&Kinematics::rest(), g);
                found.add(&Extremes {
                    angle: axial(&g).norm(),
                    straight: longest(&g),
                    curved: longest(&symmetric(&g)),
                });
            });
            found
        };
        let mut worst = Extremes::default();
        for group in Cells::all(disc) {
            let cells: Vec<u32> = (0..group.part.cells.len() as u32).collect();
            let found = group.map(&cells, CELLS_PER_TASK, parallel, |cells| of(group, cells));
            found.iter().for_each(|found| worst.add(found));
        }
        Self { straight: worst.straight, curved: (worst.angle > MIN_ANGLE).then_some(worst.curved) }
    }

    /// The same of a model: of a body over ranks the least of all, and straight, since its gradients are fitted on one rank alone.
    pub fn of_model(model: &Model, at: Displaced, du: &[f64], parallel: bool) -> Self {
        let own = Self::of(model.discretization(), at, du, parallel);
        match model.ranks().is_over_ranks() {
            false => own,
            true => StepLimits { straight: model.unknowns().least(own.straight), curved: None },
        }
    }
}

/// The largest angle and the shortest steps so far.
struct Extremes {
    angle: f64,
    straight: f64,
    curved: f64,
}

impl Default for Extremes {
    fn default() -> Self {
        Extremes { angle: 0.0, straight: 1.0, curved: 1.0 }
    }
}

impl Extremes {
    fn add(&mut self, other: &Extremes) {
        self.angle = self.angle.max(other.angle);
        self.straight = self.straight.min(other.straight);
        self.curved = self.curved.min(other.curved);
    }
}

/// `int (F(s) - F - s grad du) : grad N_a dX`, flat, with `F(s) = turned(G, s) F`.
pub(crate) fn misfit(
    disc: &Discretization,
    at: Displaced,
    du: &[f64],
    s: f64,
    turned: impl Fn(&Mat3, f64) -> Mat3 + Sync,
    parallel: bool,
) -> Vec<f64> {
    let mut out = vec![0.0; disc.dofs()];
    for group in Cells::all(disc) {
        let length = group.row_length();
        let rows_of = |cells: &[u32]| {
            let mut rows = vec![0.0; length * cells.len()];
            let mut targets = vec![Mat3::zeros(); group.part.table.points];
            let mut cell = 0;
            each_point(group, cells, at, du, |q, weight, shapes, (f, g)| {
                targets[q] = (turned(&g, s) * f - f - s * g * f) * weight;
                if q + 1 == targets.len() {
                    group.force(shapes, &targets, &mut rows[length * cell..length * (cell + 1)]);
                    cell += 1;
                }
            });
            rows
        };
        let cells: Vec<u32> = (0..group.part.cells.len() as u32).collect();
        let rows = group.map(&cells, CELLS_PER_TASK, parallel, rows_of);
        for (c, rows) in cells.iter().zip(rows.iter().flat_map(|rows| rows.chunks_exact(length))) {
            group.scatter(Patch::single(c), rows, &mut out);
        }
    }
    out
}

/// Calls with the number of every quadrature point in its cell, its weight, the cell's shape gradients, F, and
/// `G = grad du F^-1`. Cells that are inverted (there are none at a state that was evaluated) count as unturned.
fn each_point(
    group: Cells,
    cells: &[u32],
    displaced: Displaced,
    du: &[f64],
    mut call: impl FnMut(usize, f64, &[f64], (Mat3, Mat3)),
) {
    let mut scratch = Scratch::new(group);
    for c in cells {
        let patch = Patch::single(c);
        let sound = scratch.move_to(group, patch, displaced).is_ok();
        scratch.change_by(group, patch, du);
        for (q, (step, &weight)) in scratch.change.iter().zip(&scratch.weights).enumerate() {
            let pair = match scratch.kinematics.get(q).filter(|_| sound) {
                // F^-1 = H^T / J
                Some(at) => (*at.f(), step * at.h().transpose() / at.j()),
                None => (Mat3::zeros(), Mat3::zeros()),
            };
            call(q, weight, &scratch.g, pair);
        }
    }
}

/// `exp(s skew G) (1 + s sym G)`.
pub(crate) fn turned(g: &Mat3, s: f64) -> Mat3 {
    rotation(&(s * axial(g))) * (Mat3::identity() + s * symmetric(g))
}

/// `R^s (1 + s (U - 1))` with `R U = 1 + G`; the straight way where that has no polar decomposition.
pub(crate) fn turned_between(g: &Mat3, s: f64) -> Mat3 {
    let whole = Mat3::identity() + g;
    let Some(r) = polar_rotation(&whole) else { return Mat3::identity() + s * g };
    let stretch = r.transpose() * whole;
    rotation(&(s * rotation_vector(&r))) * (Mat3::identity() + s * (stretch - Mat3::identity()))
}

/// The axis of a rotation times its angle, which is at most pi; of a half turn either of the two.
fn rotation_vector(r: &Mat3) -> Vec3 {
    let (sine, cosine) = (axial(r), 0.5 * (r.trace() - 1.0));
    let angle = sine.norm().atan2(cosine);
    if cosine > 0.0 {
        let size = sine.norm();
        return if size > f64::EPSILON { sine * (angle / size) } else { sine };
    }
    // 2 (1 - cos) a a^T, which does not vanish where the sine does.
    let square = r + r.transpose() + Mat3::identity() * (1.0 - r.trace());
    let longest = (0..3).max_by(|a, b| square[(*a, *a)].total_cmp(&square[(*b, *b)])).unwrap_or(0);
    let axis = Vec3::new(square[(0, longest)], square[(1, longest)], square[(2, longest)]);
    let sign = if axis.dot(&sine) < 0.0 { -1.0 } else { 1.0 };
    axis * (sign * angle / axis.norm())
}

fn symmetric(g: &Mat3) -> Mat3 {
    0.5 * (g + g.transpose())
}

/// The axial vector of the skew part.
fn axial(g: &Mat3) -> Vec3 {
    0.5 * Vec3::new(g[(2, 1)] - g[(1, 2)], g[(0, 2)] - g[(2, 0)], g[(1, 0)] - g[(0, 1)])
}

/// The rotation by `|w|` about `w` (Rodrigues).
fn rotation(w: &Vec3) -> Mat3 {
    let angle = w.norm();
    let skew = w.cross_matrix();
    // (1 - cos a) / a^2 without cancellation
    let (first, second) = match angle {
        0.0 => (1.0, 0.5),
        a => (a.sin() / a, 0.5 * ((0.5 * a).sin() / (0.5 * a)).powi(2)),
    };
    Mat3::identity() + first * skew + second * skew * skew
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn between_two_states_every_part_turns_evenly() {
        let axis = Vec3::new(1.0, -2.0, 0.5).normalize();
        let stretch = Mat3::new(1.2, 0.1, 0.0, 0.1, 0.9, 0.05, 0.0, 0.05, 1.1);
        for angle in [0.0, 1e-9, 1.0, 2.0, 3.1, std::f64::consts::PI] {
            let g = rotation(&(axis * angle)) * stretch - Mat3::identity();
            for s in [0.0, 0.3, 1.0] {
                let even = Mat3::identity() + (stretch - Mat3::identity()) * s;
                let expected = [1.0, -1.0].map(|sign| rotation(&(axis * (sign * s * angle))) * even);
                let found = turned_between(&g, s);
                let error = |expected: &Mat3| (found - expected).norm();
                // A half turn may be taken either way round.
                let either = error(&expected[0]).min(if angle == std::f64::consts::PI {
                    error(&expected[1])
                } else {
                    f64::INFINITY
                });
                assert!(either < 1e-9, "angle {angle}, s {s}: {either:e}");
            }
        }
    }
}
