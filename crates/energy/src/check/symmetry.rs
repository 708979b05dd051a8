use super::{Finding, Violation, Worst, evaluate, kinematics, norm, rotations, states};
use crate::{EnergyTerm, MaterialPoint};

/// `dP/dF` is symmetric: `A_iJkL = A_kLiJ`.
///
/// # Errors
/// A [`Violation`] at the first state where it is not.
pub fn major_symmetry(term: &dyn EnergyTerm, at: MaterialPoint, m: &[f64]) -> Result<Finding, Violation> {
    let mut worst = Worst::new("dP/dF is symmetric", 1e-13);
    for k in states() {
        let tangent = evaluate(term, at, &k, m).tangent;
        let flipped = tangent.transposed();
        let error = tangent.0.iter().zip(&flipped.0).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        worst.see(error, norm(&tangent), k.f())?;
    }
    Ok(worst.finding())
}

/// Turning space changes no energy and turns the stress: `W(Q F) = W(F)`, `P(Q F) = Q P(F)`.
///
/// `turn` turns those controls that are vectors of space along with it; see [`EnergyTerm::turn`](crate::EnergyTerm::turn).
///
/// # Errors
/// A [`Violation`] at the first state where it does not hold.
pub fn objectivity(
    term: &dyn EnergyTerm,
    at: MaterialPoint,
    m: &[f64],
    turn: &dyn Fn(&nastic_tensor::Mat3, &mut [f64]),
) -> Result<Finding, Violation> {
    let check = "turning space turns P and keeps the energy";
    let mut worst = Worst::new(check, 1e-11);
    for k in states() {
        let here = evaluate(term, at, &k, m);
        let scale = norm(&here.tangent) + here.stress.norm();
        for q in rotations() {
            let mut turned_controls = m.to_vec();
            turn(&q, &mut turned_controls);
            let turned = evaluate(term, at, &kinematics(check, q * k.f())?, &turned_controls);
            worst.see((turned.energy - here.energy).abs(), scale, k.f())?;
            worst.see((turned.stress - q * here.stress).norm(), scale, k.f())?;
        }
    }
    Ok(worst.finding())
}
