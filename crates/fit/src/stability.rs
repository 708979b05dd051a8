use nastic_energy::EnergyTerm;
use nastic_tensor::{Mat3, Vec3};

use crate::specimen::Specimen;
use crate::{Fibers, Mode};

/// Stretches around rest in which a law is stable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// Down to here.
    pub from: f64,
    /// Up to here.
    pub to: f64,
    /// Why it ends below and above.
    pub ends: [End; 2],
}

/// Why a range of stability ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// No more was looked at.
    Examined,
    /// Drucker's condition fails beyond.
    Unstable,
    /// The law is not defined beyond, as Gent's at its `jm`.
    Undefined,
}

/// The range of stretches l in a mode (`Uniaxial`, `Equibiaxial`, `Planar`), within `1/reach` to `reach`, on which Drucker's condition holds:
/// the stress power `dtau : d(ln l)` of every change at constant volume is positive. With `t_i = tau_i - tau_3` and `e_i = ln l_i`, the
/// symmetric part of the 2 x 2 matrix `dt_i/de_j`, i, j = 1, 2, must be positive definite (differences in e; 400 stretches, the
/// border bisected). Of a law with fibres these are the changes along its axes.
pub fn stable_range(law: &dyn EnergyTerm, mode: Mode, fibers: Fibers, reach: f64) -> Range {
    let specimen = Specimen { law, fibers };
    const STEPS: i32 = 200;
    let at = |share: f64| reach.powf(share);
    let end = |direction: f64| {
        let mut inside = 0.0;
        for k in 1..=STEPS {
            let share = direction * f64::from(k) / f64::from(STEPS);
            if let Some(why) = fails(specimen, mode, at(share)) {
                let (share, why) = border(specimen, mode, reach, [inside, share], why);
                return (at(share), why);
            }
            inside = share;
        }
        (at(direction), End::Examined)
    };
    if let Some(why) = fails(specimen, mode, 1.0) {
        return Range { from: 1.0, to: 1.0, ends: [why, why] };
    }
    let ((from, below), (to, above)) = (end(-1.0), end(1.0));
    Range { from, to, ends: [below, above] }
}

/// Where stability ends between two shares, the first of which is stable, and why there.
fn border(specimen: Specimen<'_>, mode: Mode, reach: f64, shares: [f64; 2], why: End) -> (f64, End) {
    let ([mut inside, mut outside], mut why) = (shares, why);
    for _ in 0..40 {
        let middle = 0.5 * (inside + outside);
        match fails(specimen, mode, reach.powf(middle)) {
            None => inside = middle,
            Some(end) => (outside, why) = (middle, end),
        }
    }
    (inside, why)
}

/// Why a law is not stable at a stretch; `None` where it is.
fn fails(specimen: Specimen<'_>, mode: Mode, l: f64) -> Option<End> {
    match is_stable(specimen, mode, l) {
        Some(true) => None,
        Some(false) => Some(End::Unstable),
        None => Some(End::Undefined),
    }
}

/// `None` where the law is not defined.
fn is_stable(specimen: Specimen<'_>, mode: Mode, l: f64) -> Option<bool> {
    const STEP: f64 = 1e-4;
    const NEAR: f64 = 20.0;
    let f = specimen.gradient(mode, l)?;
    let e = [f[(0, 0)].ln(), f[(1, 1)].ln()];
    let stresses = |i: usize, steps: f64| {
        let mut e = e;
        e[i] += steps * STEP;
        kirchhoff_differences(specimen, e)
    };
    let slope = |i: usize| {
        let (one, back) = (stresses(i, 1.0)?, stresses(i, -1.0)?);
        Some([0, 1].map(|k| (one[k] - back[k]) / (2.0 * STEP)))
    };
    let (a, b) = (slope(0)?, slope(1)?);
    let mixed = 0.5 * (a[1] + b[0]);
    let stable = a[0] > 0.0 && a[0] * b[1] - mixed * mixed > 0.0;
    if !stable {
        // close to a limit of the law, where stresses grow without bound, differences are no derivatives: it is the limit that ends the range
        for i in [0, 1] {
            stresses(i, NEAR)?;
            stresses(i, -NEAR)?;
        }
    }
    Some(stable)
}

/// `tau_1 - tau_3`, `tau_2 - tau_3` in the axes of the law at logarithmic stretches `e_1`, `e_2`, `-(e_1 + e_2)`.
fn kirchhoff_differences(specimen: Specimen<'_>, e: [f64; 2]) -> Option<[f64; 2]> {
    let l = [e[0].exp(), e[1].exp(), (-e[0] - e[1]).exp()];
    let stress = specimen.stress(Mat3::from_diagonal(&Vec3::from(l)))?;
    let tau = [0, 1, 2].map(|i| stress[(i, i)] * l[i]);
    Some([tau[0] - tau[2], tau[1] - tau[2]])
}
