use nastic_tensor::{Kinematics, Mat3};

use super::derivative::sixth_order;
use super::{Finding, Violation, Worst, evaluate, states};
use crate::{EnergyTerm, MaterialPoint, PointBatch, Slot, Slots};

/// `stress_by_control` is the derivative of `P` by every control component, and is set rather than added; `slots_vjp` adds its products.
///
/// # Errors
/// A [`Violation`] at the first state where it is not.
pub fn control_derivative(term: &dyn EnergyTerm, at: MaterialPoint, m: &[f64]) -> Result<Finding, Violation> {
    let mut worst = Worst::new("dP/dm is the derivative of P", 1e-9);
    let steps = steps(term, m);
    for k in states() {
        let stated = by_control(term, at, &k, m);
        for (n, (stated, &step)) in stated.iter().zip(&steps).enumerate() {
            let slope = sixth_order(step, |t| {
                let mut moved = m.to_vec();
                moved[n] += t * step;
                Ok::<Mat3, Violation>(evaluate(term, at, &k, &moved).stress)
            })?;
            let noise = evaluate(term, at, &k, m).stress.norm() / step;
            worst.see((slope - stated).norm(), slope.norm() + stated.norm() + noise, k.f())?;
        }
        let with = Mat3::new(0.3, -1.0, 0.6, 0.2, 0.8, -0.5, 1.1, 0.4, -0.7);
        let mut products = vec![1.0; m.len()];
        let points = PointBatch { kinematics: std::slice::from_ref(&k), cell: at.cell, first: at.point };
        term.slots_vjp(&points, slots_of(term, m), &[with], &mut products);
        for (product, stated) in products.iter().zip(&stated) {
            worst.see((product - 1.0 - stated.dot(&with)).abs(), 1.0 + stated.norm() * with.norm(), k.f())?;
        }
    }
    Ok(worst.finding())
}

/// A positive control `m` drives the displacement gradient `towards` at rest: the work `-(dP/dm m) : towards`, per unit
/// volume and relative to `|dP/dm m| |towards|`. One when the control drives just that, negative when it resists.
///
/// # Errors
/// [`Violation::Controls`] when there are not as many values as slots.
pub fn drives(term: &dyn EnergyTerm, at: MaterialPoint, m: &[f64], towards: &Mat3) -> Result<f64, Violation> {
    let expected = term.slots().len();
    if m.len() != expected {
        return Err(Violation::Controls { check: "drives", expected, found: m.len() });
    }
    let stated = by_control(term, at, &Kinematics::rest(), m);
    let stress: Mat3 = stated.iter().zip(m).map(|(dp, m)| dp * *m).sum();
    Ok(-stress.dot(towards) / (stress.norm() * towards.norm()))
}

pub(super) fn by_control(term: &dyn EnergyTerm, at: MaterialPoint, k: &Kinematics, m: &[f64]) -> Vec<Mat3> {
    // Not-a-number to begin with: entries left out or added to would show.
    let mut out = vec![Mat3::repeat(f64::NAN); m.len()];
    let points = PointBatch { kinematics: std::slice::from_ref(k), cell: at.cell, first: at.point };
    term.stress_by_control(&points, slots_of(term, m), &mut out);
    out
}

/// Steps of the slots for differences: of a control a hundredth of the largest one of its unit (1 where all are zero), of a pure number a
/// thousandth; of a number of a law, which may stand near a pole such as Poisson's ratio 1/2, a thousandth of its own value.
pub(super) fn steps(term: &dyn EnergyTerm, m: &[f64]) -> Vec<f64> {
    let slots = term.slots();
    let own = |(slot, value): (&Slot, &f64)| {
        if slot.is_design() && *value != 0.0 {
            return 1e-3 * value.abs();
        }
        if slot.unit == "1" {
            return 1e-3;
        }
        let alike = slots.iter().zip(m).filter(|(other, _)| other.unit == slot.unit);
        let largest = alike.fold(0.0_f64, |largest, (_, value)| largest.max(value.abs()));
        if largest > 0.0 { 1e-2 * largest } else { 1.0 }
    };
    slots.iter().zip(m).map(own).collect()
}

/// The values of the slots of a law at one point.
pub(super) fn slots_of<'m>(term: &dyn EnergyTerm, m: &'m [f64]) -> Slots<'m> {
    if term.slots().iter().any(Slot::is_global) { Slots::shared(m) } else { Slots::by_point(m, m.len()) }
}
