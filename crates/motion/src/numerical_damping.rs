//! [`AmplificationFactor`], [`ModalDamping`]: what a time scheme makes of one mode of vibration.

use crate::points::Points;
use crate::scheme::{Scheme, TermInstant};
use nalgebra::DMatrix;
use nastic_body::controls::Controls;
use nastic_body::error::FemError;
use nastic_body::state::{SolveReport, State};
use std::sync::Arc;

/// The principal amplification factor R of a scheme: over a step a free vibration is multiplied by R. The exact one by
/// `exp(-d h/2) exp(i w_d h)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AmplificationFactor {
    /// `|R|`: the amplitude after a step, as a share of that before.
    pub modulus: f64,
    /// `arg R` in `[0, pi]`: the phase of a step in rad; an exact one beyond pi is not seen.
    pub argument: f64,
}

/// Damping and frequency of a mode, exact and as a scheme moves it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ModalDamping {
    /// `d/w` of `q'' + d q' + w^2 q = 0`, twice the damping ratio.
    pub physical: f64,
    /// `-(2/(h w)) ln |R|`: the `d/w` with which the exact motion would decay as that of the scheme does.
    pub effective: f64,
    /// Numerical over exact frequency, `arg R/(h w_d)`, `w_d^2 = w^2 - d^2/4`; `None` where the mode does not oscillate.
    pub frequency: Option<f64>,
}

impl Scheme {
    /// R on `q'' + d q' + w^2 q = 0`, from `h w` and `d/w`: of the eigenvalues of the matrix by which a step multiplies
    /// (u, h v), with `h^2 a` where the scheme carries an acceleration that is not in equilibrium and the state before
    /// where it needs that, the largest of a conjugate pair; of real ones, of an overdamped mode, the one with the
    /// largest value, its slower part. (The other ones of an acceleration may be as large as -1.)
    ///
    /// Of a scheme with [`exact_modes`](Self::exact_modes) it is that of the others.
    ///
    /// For `d = 0` and `t = h w`: backward Euler `|R|^2 = 1/(1 + t^2)`, TR-BDF2 `1/(1 + t^4/(144 + 25 t^2))`, the
    /// trapezoidal rule 1.
    ///
    /// # Errors
    /// An `h w` that is not positive and finite, a `d/w` that is negative or not finite; a scheme without inertia.
    pub fn amplification(&self, hw: f64, damping: f64) -> Result<AmplificationFactor, FemError> {
        if !(hw.is_finite() && hw > 0.0 && damping.is_finite() && damping >= 0.0) {
            let what = format!(
                "a mode with h w = {hw} and d/w = {damping}: take an h w above zero and a d/w of at least zero, both finite"
            );
            return Err(FemError::Meaningless { what });
        }
        if self.is_quasi_static() {
            let what = format!("the amplification factor of {}: without inertia nothing vibrates", self.name());
            return Err(FemError::Meaningless { what });
        }
        let eigenvalues = self.amplification_matrix(hw, damping).complex_eigenvalues();
        let paired = eigenvalues.iter().filter(|e| e.im != 0.0).max_by(|a, b| a.norm().total_cmp(&b.norm()));
        let slowest = || eigenvalues.iter().max_by(|a, b| a.re.total_cmp(&b.re));
        let principal = paired.or_else(slowest).copied().unwrap_or_default();
        Ok(AmplificationFactor { modulus: principal.norm(), argument: principal.im.abs().atan2(principal.re) })
    }

    /// What steps of length h make of a mode with the angular frequency w under Rayleigh damping, `d = a0 + a1 w^2`.
    ///
    /// ```
    /// # use nastic_fem::Scheme;
    /// let seen = Scheme::backward_euler().modal_damping(0.1, 10.0, 0.0, 0.0)?;
    /// assert_eq!(seen.physical, 0.0);
    /// assert!((seen.effective - 2f64.ln()).abs() < 1e-14); // a damping ratio of 0.35
    /// # Ok::<(), nastic_fem::FemError>(())
    /// ```
    ///
    /// # Errors
    /// As [`amplification`](Self::amplification).
    pub fn modal_damping(&self, h: f64, w: f64, a0: f64, a1: f64) -> Result<ModalDamping, FemError> {
        let (hw, physical) = (h * w, a0 / w + a1 * w);
        let factor = self.amplification(hw, physical)?;
        let oscillates = physical < 2.0;
        let frequency = oscillates.then(|| factor.argument / (hw * (1.0 - 0.25 * physical * physical).sqrt()));
        Ok(ModalDamping { physical, effective: -2.0 / hw * factor.modulus.ln() + 0.0, frequency })
    }

    /// As many oscillators side by side as a state has numbers, each beginning with one of them: the steps themselves
    /// give the matrix, column by column.
    fn amplification_matrix(&self, hw: f64, damping: f64) -> DMatrix<f64> {
        let two_states = self.terms().any(|term| term.at == TermInstant::Before);
        let carries = self.needs_acceleration() && self.extrapolates();
        let n = 2 + usize::from(carries) + 2 * usize::from(two_states);
        let (stiffness, c) = (hw * hw, damping * hw);
        let unit = |k: usize| -> Vec<f64> { (0..n).map(|i| f64::from(u8::from(i == k))).collect() };
        let state = |u: Vec<f64>, v: Vec<f64>, a: Option<Vec<f64>>| {
            let a = a.unwrap_or_else(|| u.iter().zip(&v).map(|(u, v)| -stiffness * u - c * v).collect());
            let still = State::equilibrium(u, Controls::zeros([]), 1.0, SolveReport::default());
            State { velocity: Some(Arc::new(v)), acceleration: Some(Arc::new(a)), ..still }
        };
        let begin = state(unit(0), unit(1), carries.then(|| unit(2)));
        let before = two_states.then(|| state(unit(n - 2), unit(n - 1), None));
        let mut points = Points::new(self, 1.0, &begin, before.as_ref(), None, n);
        for _ in 0..self.stages() {
            let step = points.next(&begin.controls);
            let ((c_v, b_v), (c_a, b_a)) = (&step.velocity, &step.acceleration);
            let w = b_a.iter().zip(b_v).map(|(a, v)| -(a + c * v) / (c_a + c * c_v + stiffness)).collect();
            points.found(Arc::new(w), &step);
        }
        let end = points.end();
        let mut rows: Vec<Vec<f64>> = [end.u, end.velocity].into_iter().flatten().map(|row| row.to_vec()).collect();
        rows.extend(end.acceleration.filter(|_| carries).map(|row| row.to_vec()));
        rows.extend(two_states.then(|| [unit(0), unit(1)]).into_iter().flatten());
        DMatrix::from_fn(n, n, |i, k| rows.get(i).map_or(0.0, |row| row[k]))
    }
}
