use nastic_tensor::{Kinematics, Mat3};

use super::control::{by_control, steps};
use super::derivative::{along, sixth_order};
use super::{Finding, Violation, Worst, evaluate, norm, states};
use crate::{EnergyError, EnergyTerm, MaterialPoint, PointBatch, Slots};

/// [`EnergyTerm::second_stress_change`] adds the derivative of [`EnergyTerm::stress_change`] by `F` and is symmetric in its two
/// changes; `None` where the term gives none.
///
/// # Errors
/// A [`Violation`] at the first state where it is not.
pub fn second_stress_change(term: &dyn EnergyTerm, at: MaterialPoint, m: &[f64]) -> Result<Option<Finding>, Violation> {
    let check = "the second change of P is the derivative of the first";
    let (mut worst, mut symmetric) =
        (Worst::new(check, 1e-8), Worst::new("the second change of P is symmetric", 1e-12));
    for k in states() {
        // third derivatives scale with the smallest stretch
        let scale = (norm(&evaluate(term, at, &k, m).tangent) + evaluate(term, at, &k, m).stress.norm())
            / k.f().singular_values().min();
        let first = |k: &Kinematics, a: &Mat3| {
            let mut out = [Mat3::zeros()];
            term.stress_change(&one(k, at), Slots::by_point(m, m.len()), &[*a], &mut out);
            out[0]
        };
        let second = |a: &Mat3, b: &Mat3| -> Result<Mat3, EnergyError> {
            // a start value of the size of the answer, so that an overwritten start shows
            let mut out = [k.f() * scale];
            let changes: [&[Mat3]; 2] = [&[*a], &[*b]];
            term.second_stress_change(&one(&k, at), Slots::by_point(m, m.len()), changes, &mut out)?;
            Ok(out[0] - k.f() * scale)
        };
        for a in directions() {
            for b in directions() {
                let Ok(found) = second(&a, &b) else { return Ok(None) };
                let expected = along(check, &k, &b, |k| first(k, &a))?;
                worst.see((found - expected).norm(), scale, k.f())?;
                let Ok(swapped) = second(&b, &a) else { return Ok(None) };
                symmetric.see((found - swapped).norm(), scale * (1.0 + k.f().norm()), k.f())?;
            }
        }
    }
    Ok(Some(worst.finding()))
}

/// [`EnergyTerm::control_stress_change`] sets the derivative of `dP/dm` along changes of `F` and of the controls; `None` where the
/// actuation gives none.
///
/// # Errors
/// A [`Violation`] at the first state where it is not.
pub fn control_stress_change(
    term: &dyn EnergyTerm,
    at: MaterialPoint,
    m: &[f64],
) -> Result<Option<Finding>, Violation> {
    let check = "the change of dP/dm is its derivative";
    let (mut worst, mut linear) = (Worst::new(check, 1e-8), Worst::new("the change of dP/dm is linear", 1e-12));
    let v: Vec<f64> = steps(term, m).iter().enumerate().map(|(n, step)| 1e2 * step * (0.7 + n as f64).sin()).collect();
    let still = vec![0.0; m.len()];
    for k in states() {
        let stated = |change: &Mat3, v: &[f64]| -> Result<Vec<Mat3>, EnergyError> {
            // Not-a-number to begin with: entries left out or added to would show.
            let mut out = vec![Mat3::repeat(f64::NAN); m.len()];
            let (controls, v) = (Slots::by_point(m, m.len()), Slots::by_point(v, m.len()));
            term.control_stress_change(&one(&k, at), controls, &[*change], v, &mut out)?;
            Ok(out)
        };
        let here = by_control(term, at, &k, m);
        let scale = |n: usize| here[n].norm() / k.f().singular_values().min() + f64::MIN_POSITIVE;
        let same_unit = |n: usize| (0..m.len()).filter(move |l| term.slots()[*l].unit == term.slots()[n].unit);
        let room = |n: usize| same_unit(n).map(scale).fold(0.0, f64::max);
        let Ok(by_v) = stated(&Mat3::zeros(), &v) else { return Ok(None) };
        for (n, found) in by_v.iter().enumerate() {
            let slope = sixth_order(1e-2, |t| {
                let moved: Vec<f64> = m.iter().zip(&v).map(|(m, v)| m + 1e-2 * t * v).collect();
                Ok::<Mat3, Violation>(by_control(term, at, &k, &moved)[n])
            })?;
            worst.see((found - slope).norm(), room(n) + slope.norm(), k.f())?;
        }
        for a in directions() {
            let Ok(by_f) = stated(&a, &still) else { return Ok(None) };
            let Ok(by_both) = stated(&a, &v) else { return Ok(None) };
            for n in 0..m.len() {
                let slope = along(check, &k, &a, |k| by_control(term, at, k, m)[n])?;
                worst.see((by_f[n] - slope).norm(), room(n) + slope.norm(), k.f())?;
                let sum = by_f[n] + by_v[n];
                linear.see((by_both[n] - sum).norm(), room(n) + sum.norm(), k.f())?;
            }
        }
    }
    Ok(Some(worst.finding()))
}

fn one(k: &Kinematics, at: MaterialPoint) -> PointBatch<'_> {
    PointBatch { kinematics: std::slice::from_ref(k), cell: at.cell, first: at.point }
}

/// Changes of `F` in no particular direction, of norm one.
fn directions() -> [Mat3; 3] {
    [0.3, 1.9, 4.1].map(|phase| {
        let m = Mat3::from_fn(|i, j| (phase + 1.7 * i as f64 + 2.9 * j as f64 + (i * j) as f64).sin());
        m / m.norm()
    })
}
