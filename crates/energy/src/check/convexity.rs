use nalgebra::SymmetricEigen;
use nastic_tensor::{Mat3, Tangent, Vec3};

use super::states::directions;
use super::{Finding, Violation, Worst, evaluate, kinematics, norm, rotations, states};
use crate::{EnergyTerm, MaterialPoint, PointBatch, Slots};

/// Legendre-Hadamard: waves in every direction keep real speeds, `A_iJkL v_i n_J v_k n_L >= 0` at every state.
///
/// # Errors
/// A [`Violation`] with the most negative eigenvalue of the acoustic tensor over the norm of the tangent.
pub fn ellipticity(law: &dyn EnergyTerm, at: MaterialPoint) -> Result<Finding, Violation> {
    let mut worst = Worst::new("the acoustic tensor is positive", 1e-13);
    for k in states() {
        let tangent = evaluate(law, at, &k, &[]).tangent;
        for n in directions() {
            let least = SymmetricEigen::new(acoustic(&tangent, &n)).eigenvalues.min();
            worst.see((-least).max(0.0), norm(&tangent), k.f())?;
        }
    }
    Ok(worst.finding())
}

fn acoustic(tangent: &Tangent, n: &Vec3) -> Mat3 {
    Mat3::from_fn(|i, k| (0..9).map(|c| tangent.get(i, c / 3, k, c % 3) * n[c / 3] * n[c % 3]).sum())
}

/// The energy grows without bound as `J -> 0`, when one, two or three stretches vanish: eight more decades of `J` cost
/// as much again (a logarithm), or more. Where a path leaves the domain of the law, its energy is infinite.
///
/// # Errors
/// A [`Violation`] with the share of the growth that is lost.
pub fn growth(law: &dyn EnergyTerm, at: MaterialPoint) -> Result<Finding, Violation> {
    let check = "the energy grows without bound as J -> 0";
    let mut worst = Worst::new(check, 1e-2);
    let paths: [fn(f64) -> Vec3; 3] =
        [|j| Vec3::new(j, 1.0, 1.0), |j| Vec3::new(j.sqrt(), j.sqrt(), 1.0), |j| Vec3::repeat(j.cbrt())];
    for turn in rotations() {
        for path in paths {
            let state = |j: f64| kinematics(check, Mat3::from_diagonal(&path(j)) * turn);
            let inside = |j: f64| {
                let points = [state(j)?];
                let points = PointBatch { kinematics: &points, cell: at.cell, first: at.point };
                Ok(law.check_domain(&points, Slots::none()).is_ok())
            };
            if !inside(1e-24)? {
                continue;
            }
            let energy = |j: f64| Ok(evaluate(law, at, &state(j)?, &[]).energy);
            let [flat, flatter, flattest] = [energy(1e-8)?, energy(1e-16)?, energy(1e-24)?];
            let (before, after) = (flatter - flat, flattest - flatter);
            let lost = if before > 0.0 { (1.0 - after / before).max(0.0) } else { f64::NAN };
            worst.see(lost, 1.0, state(1e-8)?.f())?;
        }
    }
    Ok(worst.finding())
}
