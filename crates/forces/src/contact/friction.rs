//! [`Slip`]: the direction and share of Coulomb friction by the slip velocity.

use nastic_body::controls::Controls;
use nastic_body::error::FemError;
use nastic_body::instant::Instant;
use nastic_energy::Slot;
use nastic_tensor::Scalar;
use nastic_tensor::{Mat3, Vec3};

/// Coulomb's friction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Friction {
    pub coefficient: f64,
    pub slip_speed: f64,
}

impl Friction {
    /// Its coefficient, a design.
    ///
    /// # Errors
    /// A slip speed or coefficient that is none.
    pub fn slot(&self, contact: &str) -> Result<Slot, FemError> {
        let refuse = |what: String| FemError::Meaningless { what: format!("contact \"{contact}\": {what}") };
        let Friction { coefficient, slip_speed } = *self;
        if !(slip_speed > 0.0 && slip_speed.is_finite()) {
            return Err(refuse(format!("its slip speed is {slip_speed}; it must be positive and finite")));
        }
        if !(coefficient >= 0.0 && coefficient.is_finite()) {
            let what = format!("its friction coefficient is {coefficient}; it must be finite and at least zero");
            return Err(refuse(what));
        }
        Ok(Slot::design("friction", "1", coefficient))
    }
}

/// Why an equilibrium with friction is refused outside of steps.
pub(super) const PATH: &str = "friction depends on the path: take steps in time, quasi_static for slow loads";

/// Checks the values of a stiffness and, with friction, a coefficient.
pub(super) fn check_controls(contact: &str, stiffness: f64, coefficient: Option<f64>) -> Result<(), FemError> {
    let refuse = |what: String| Err(FemError::Meaningless { what: format!("contact \"{contact}\": {what}") });
    if stiffness.is_nan() || stiffness <= 0.0 {
        return refuse(format!("its stiffness is {stiffness}; it must be positive"));
    }
    match coefficient {
        Some(friction) if friction.is_nan() || friction < 0.0 => {
            refuse(format!("its friction coefficient is {friction}; it must not be negative"))
        }
        _ => Ok(()),
    }
}

/// Where normal forces, normals and places of friction are taken, instead of those of the instant.
#[derive(Debug, Clone, Copy)]
pub(super) struct Elsewhere<'a> {
    pub u: &'a [f64],
    pub controls: &'a Controls,
    /// What the slip speed is multiplied by.
    pub smoothing: f64,
}

impl<'a> Elsewhere<'a> {
    /// Where a step begins, if friction is `lagged`; else where a step that is not found at once says.
    pub fn of(at: &Instant<'a>, lagged: bool) -> Option<Self> {
        let step = at.step?;
        let (lag, before) = (step.lag.as_ref(), &step.before);
        let smoothing = lag.map_or(1.0, |lag| lag.smoothing);
        match lagged {
            true => Some(Elsewhere { u: &before.u, controls: &before.controls, smoothing }),
            false => lag.map(|lag| Elsewhere { u: &lag.u, controls: &lag.controls, smoothing }),
        }
    }
}

/// Friction that acts in a step.
#[derive(Debug, Clone, Copy)]
pub(super) struct Coulomb {
    /// mu
    pub coefficient: f64,
    /// e
    pub slip_speed: f64,
    /// `dv/du` of the scheme.
    pub rate: f64,
}

/// `f(v) = g(|v|) v` and its derivative, with `g(s) = 2/e - s/e^2` below the slip speed e and `1/s` above: Coulomb's friction over its largest
/// value, smoothed with a continuous derivative. Source: Li et al., Incremental Potential Contact, ACM Trans. Graph. 39 (2020), eq. 11.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Slip {
    /// f
    pub share: Vec3,
    /// `D = df/dv = g 1 + g' s m m^T`, `m = v/s`
    pub slope: Mat3,
}

/// `F(s)` with `F' = g(s) s`: what friction takes of power per normal force, smoothed like f.
pub(super) fn dissipation(s: f64, e: f64) -> f64 {
    if s < e { s * s / e - s * s * s / (3.0 * e * e) } else { s - e / 3.0 }
}

/// The same f of numbers with derivatives, of which the first ones are right at zero too.
pub(super) fn share<T: Scalar>(v: [T; 3], e: f64) -> [T; 3] {
    let square = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    let g = if square.value() > 0.0 {
        let s = square.root(2);
        if s.value() < e { T::of(2.0 / e) - s / T::of(e * e) } else { T::of(1.0) / s }
    } else {
        T::of(2.0 / e)
    };
    v.map(|v| g * v)
}

impl Slip {
    pub fn at(v: &Vec3, e: f64) -> Self {
        let s = v.norm();
        let (g, bend) = if s < e { (2.0 / e - s / (e * e), -s / (e * e)) } else { (1.0 / s, -1.0 / s) };
        let m = if s > 0.0 { v / s } else { Vec3::zeros() };
        Slip { share: g * v, slope: g * Mat3::identity() + bend * m * m.transpose() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn is_smooth_and_reaches_one() {
        let e = 1e-3;
        for s in [0.0, 0.4e-3, 0.999e-3, 1.001e-3, 0.3] {
            let (v, h) = (s * Vec3::new(0.6, -0.64, 0.48), 1e-8);
            let at = Slip::at(&v, e);
            for k in 0..3 {
                let to = |sign: f64| Slip::at(&(v + sign * h * Vec3::ith(k, 1.0)), e).share;
                let column = (to(1.0) - to(-1.0)) / (2.0 * h);
                assert!((column - at.slope.column(k)).norm() < 1e-4 * at.slope.norm(), "{s}");
            }
            assert!((Vec3::from(share(v.into(), e)) - at.share).norm() < 1e-15);
            assert!(at.share.norm() <= 1.0 + 1e-15 && (s < e || (at.share.norm() - 1.0).abs() < 1e-15));
        }
    }
}
