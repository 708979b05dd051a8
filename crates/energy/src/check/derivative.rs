use nastic_tensor::{Kinematics, Mat3};

use super::{Evaluation, Finding, Violation, Worst, evaluate, kinematics, norm, states};
use crate::{EnergyTerm, MaterialPoint, PointBatch, Slots};

/// `P` is the derivative of the energy by `F`.
///
/// # Errors
/// A [`Violation`] at the first state where it is not.
pub fn stress(term: &dyn EnergyTerm, at: MaterialPoint, m: &[f64]) -> Result<Finding, Violation> {
    let check = "P is the derivative of the energy";
    let mut worst = Worst::new(check, 1e-9);
    for k in states() {
        let here = evaluate(term, at, &k, m);
        let scale = norm(&here.tangent) + here.stress.norm();
        for (unit, i, j) in units() {
            let energies = along(check, &k, &unit, |k| evaluate(term, at, k, m).energy)?;
            worst.see((energies - here.stress[(i, j)]).abs(), scale, k.f())?;
        }
    }
    Ok(worst.finding())
}

/// `dP/dF` is the derivative of `P` by `F`.
///
/// # Errors
/// A [`Violation`] at the first state where it is not.
pub fn tangent(term: &dyn EnergyTerm, at: MaterialPoint, m: &[f64]) -> Result<Finding, Violation> {
    let check = "dP/dF is the derivative of P";
    let mut worst = Worst::new(check, 1e-9);
    for k in states() {
        let here: Evaluation = evaluate(term, at, &k, m);
        let scale = norm(&here.tangent) + here.stress.norm();
        for (unit, _, _) in units() {
            let slope = along(check, &k, &unit, |k| evaluate(term, at, k, m).stress)?;
            worst.see((slope - here.tangent.apply(&unit)).norm(), scale, k.f())?;
        }
    }
    Ok(worst.finding())
}

/// [`EnergyTerm::stress_change`] adds `dP/dF : G`.
///
/// # Errors
/// A [`Violation`] at the first state where it does not.
pub fn stress_change(term: &dyn EnergyTerm, at: MaterialPoint, m: &[f64]) -> Result<Finding, Violation> {
    let mut worst = Worst::new("the change of P is dP/dF applied to that of F", 1e-13);
    for k in states() {
        let tangent = evaluate(term, at, &k, m).tangent;
        let scale = norm(&tangent);
        let points = PointBatch { kinematics: &[k], cell: at.cell, first: at.point };
        for (unit, _, _) in units() {
            // a start value of the size of the answer, so that an overwritten start shows and no digits are lost
            let mut change = [k.f() * scale];
            term.stress_change(&points, Slots::by_point(m, m.len()), &[unit], &mut change);
            let expected = k.f() * scale + tangent.apply(&unit);
            worst.see((change[0] - expected).norm(), scale * (1.0 + k.f().norm()), k.f())?;
        }
    }
    Ok(worst.finding())
}

/// The nine unit directions with their row and column.
pub(super) fn units() -> impl Iterator<Item = (Mat3, usize, usize)> {
    (0..9).map(|n| {
        let (i, j) = (n / 3, n % 3);
        let mut unit = Mat3::zeros();
        unit[(i, j)] = 1.0;
        (unit, i, j)
    })
}

/// Sixth-order central difference of `value` at `k` along `unit`.
pub(super) fn along<T>(
    check: &'static str,
    k: &Kinematics,
    unit: &Mat3,
    value: impl Fn(&Kinematics) -> T,
) -> Result<T, Violation>
where
    T: std::ops::Sub<Output = T> + std::ops::Add<Output = T> + std::ops::Mul<f64, Output = T>,
{
    // Small beside the smallest stretch, which is what higher derivatives scale with.
    let step = 5e-3 * k.f().singular_values().min();
    let state = |n: f64| Ok(value(&kinematics(check, k.f() + unit * (n * step))?));
    sixth_order(step, state)
}

/// Sixth-order central difference from six values at multiples of `step`.
pub(super) fn sixth_order<T, E>(step: f64, value: impl Fn(f64) -> Result<T, E>) -> Result<T, E>
where
    T: std::ops::Sub<Output = T> + std::ops::Add<Output = T> + std::ops::Mul<f64, Output = T>,
{
    let one = value(1.0)? - value(-1.0)?;
    let two = value(2.0)? - value(-2.0)?;
    let three = value(3.0)? - value(-3.0)?;
    Ok((one * 45.0 - two * 9.0 + three) * (1.0 / (60.0 * step)))
}
