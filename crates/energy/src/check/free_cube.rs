use nalgebra::{SMatrix, SVector};
use nastic_tensor::{Kinematics, Mat3};

use super::{Evaluation, Violation, evaluate, norm};
use crate::{EnergyTerm, MaterialPoint};

/// What an actuation does to a free cube of a passive law: the symmetric deformation gradient of its homogeneous
/// equilibrium, found by Newton's method on the energy, from rest.
///
/// # Errors
/// [`Violation::NoEquilibrium`] when there is none, as above the law's fiber limit.
pub fn free_cube(
    law: &dyn EnergyTerm,
    actuation: &dyn EnergyTerm,
    at: MaterialPoint,
    m: &[f64],
) -> Result<Mat3, Violation> {
    const ITERATIONS: usize = 200;
    let total = |k: &Kinematics| {
        let (mut sum, added) = (evaluate(law, at, k, &[]), evaluate(actuation, at, k, m));
        sum.energy += added.energy;
        sum.stress += added.stress;
        sum.tangent.add(&added.tangent);
        sum
    };
    let (mut k, mut iterations) = (Kinematics::rest(), 0);
    let mut here = total(&k);
    while slope(&here).norm() > 1e-13 * norm(&here.tangent) && iterations < ITERATIONS {
        let Some((next, there)) = descend(&total, &k, &here) else { break };
        (k, here, iterations) = (next, there, iterations + 1);
    }
    let stress = slope(&here).norm() / norm(&here.tangent);
    if stress <= 1e-10 { Ok(*k.f()) } else { Err(Violation::NoEquilibrium { iterations, stress, jacobian: k.j() }) }
}

/// One Newton step, halved until the energy falls; `None` where it no longer does.
fn descend(
    total: &dyn Fn(&Kinematics) -> Evaluation,
    k: &Kinematics,
    here: &Evaluation,
) -> Option<(Kinematics, Evaluation)> {
    let step = newton_step(here);
    let predicted = slope(here).dot(&components(&step));
    (0..40).map(|halvings| 0.5f64.powi(halvings)).find_map(|length| {
        let trial = Kinematics::new(k.f() + step * length).ok()?;
        let there = total(&trial);
        let falls = there.energy <= here.energy + 1e-4 * length * predicted;
        // Below the rounding of energies only the slope can show.
        (falls || slope(&there).norm() < 0.5 * slope(here).norm()).then_some((trial, there))
    })
}

type Vec6 = SVector<f64, 6>;

/// Orthonormal basis of the symmetric matrices.
fn basis() -> [Mat3; 6] {
    let pairs = [(0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1)];
    pairs.map(|(i, j)| {
        let mut m = Mat3::zeros();
        let entry = if i == j { 1.0 } else { std::f64::consts::FRAC_1_SQRT_2 };
        m[(i, j)] = entry;
        m[(j, i)] = entry;
        m
    })
}

fn components(m: &Mat3) -> Vec6 {
    Vec6::from(basis().map(|b| b.dot(m)))
}

fn slope(here: &Evaluation) -> Vec6 {
    components(&here.stress)
}

fn newton_step(here: &Evaluation) -> Mat3 {
    let basis = basis();
    let curvature = SMatrix::<f64, 6, 6>::from_fn(|a, b| basis[a].dot(&here.tangent.apply(&basis[b])));
    // Descent even where the energy is not convex: reflect negative curvature, lift what is nearly flat.
    let eigen = ((curvature + curvature.transpose()) / 2.0).symmetric_eigen();
    let floor = 1e-6 * norm(&here.tangent);
    let mut in_eigenbasis = eigen.eigenvectors.transpose() * slope(here);
    for (entry, value) in in_eigenbasis.iter_mut().zip(eigen.eigenvalues.iter()) {
        *entry /= -value.abs().max(floor);
    }
    let step = eigen.eigenvectors * in_eigenbasis;
    basis.iter().zip(step.iter()).map(|(b, s)| b * *s).sum()
}
