use nastic_tensor::{Kinematics, Mat3, Vec3};

use super::error::FormulaProblem;
use crate::{EnergyTerm, MaterialPoint, check};

/// Points of a path, and halvings of the way between two of them: a jump is found to 1e-9 of the strain.
const POINTS: usize = 40;
const HALVINGS: usize = 26;
/// Jumps up to this share of the stiffness are rounding.
const ALLOWED: f64 = 1e-6;

/// Looks for jumps of the energy and the stress along stretches, shears and changes of volume to both sides of rest, which formulas with branches may have.
///
/// # Errors
/// [`FormulaProblem::Jump`] where it found one.
pub fn check_smooth(
    law: &dyn EnergyTerm,
    invariants: impl Fn(&Kinematics) -> [f64; 4],
    fiber: Option<Vec3>,
) -> Result<(), FormulaProblem> {
    let f = fiber.unwrap_or_else(Vec3::x);
    let across = if f.x.abs() < 0.7 { Vec3::x().cross(&f) } else { Vec3::y().cross(&f) }.normalize();
    let (along, side) = (f * f.transpose(), across * across.transpose());
    let paths = [Mat3::identity(), along, side, along - side, f * across.transpose()];
    let state = |path: &Mat3, t: f64| {
        let k = Kinematics::new(Mat3::identity() + path * t).ok()?;
        law.check_domain(&crate::PointBatch { kinematics: &[k], cell: 0, first: 0 }, crate::Slots::none()).ok()?;
        Some((k, check::evaluate(law, MaterialPoint { cell: 0, point: 0 }, &k, &[])))
    };
    for path in &paths {
        for n in 0..POINTS {
            let at = |n: usize| -0.7 + 2.2 * n as f64 / POINTS as f64;
            let (mut low, mut high) = (at(n), at(n + 1));
            for _ in 0..HALVINGS {
                let middle = 0.5 * (low + high);
                let (Some((_, a)), Some((_, b)), Some((_, c))) =
                    (state(path, low), state(path, middle), state(path, high))
                else {
                    break;
                };
                let change = |a: &check::Evaluation, b: &check::Evaluation| {
                    (a.stress - b.stress).norm() + (a.energy - b.energy).abs()
                };
                if change(&a, &b) > change(&b, &c) { high = middle } else { low = middle }
            }
            let (Some((k, a)), Some((_, b))) = (state(path, low), state(path, high)) else { continue };
            let stiffness = norm(&a) + norm(&b);
            let stress = (a.stress - b.stress).norm() / stiffness;
            let energy = (a.energy - b.energy).abs() / stiffness;
            let at = invariants(&k);
            if energy > ALLOWED {
                return Err(FormulaProblem::Jump { of: "the energy", size: energy, at });
            }
            if stress > ALLOWED {
                return Err(FormulaProblem::Jump { of: "the stress", size: stress, at });
            }
        }
    }
    Ok(())
}

fn norm(at: &check::Evaluation) -> f64 {
    at.tangent.0.iter().map(|x| x * x).sum::<f64>().sqrt()
}
