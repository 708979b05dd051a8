//! [`Merit`]: what falls along a step.

pub(super) mod augmented;
pub(super) mod energy;
pub(super) mod residual;
pub(super) mod sliding;
pub(super) mod volume_errors;

use crate::nonlinear::equations::{Equations, Evaluated};
use nastic_body::error::Inadmissible;

/// A function of the unknowns along a step.
#[derive(Debug, Clone, Copy)]
pub(super) struct Line {
    /// Its value where the step begins.
    pub start: f64,
    /// Its derivative along the step there.
    pub slope: f64,
    /// What rounding may change it by.
    pub noise: f64,
}

/// A function that has a minimum, along steps, where the equations are solved.
pub(super) trait Merit {
    /// What is known of it where the step begins.
    fn line(&self) -> Line;

    /// Its value at a trial, which is a share of the step, and the evaluated model.
    ///
    /// # Errors
    /// [`Inadmissible`] outside of the admissible set.
    fn value<'e>(
        &self,
        equations: &Equations<'e>,
        trial: &[f64],
        length: f64,
    ) -> Result<(f64, Evaluated<'e>), Inadmissible>;

    /// Whether it is made of energies, whose minima along a line parabolas show, and which collapsed cells may lower.
    fn is_energy(&self) -> bool {
        true
    }

    /// Energy and residual at an accepted trial.
    ///
    /// # Errors
    /// As [`value`](Self::value).
    fn accepted<'e>(
        &self,
        _equations: &Equations<'e>,
        _trial: &[f64],
        _length: f64,
        found: Evaluated<'e>,
    ) -> Result<Evaluated<'e>, Inadmissible> {
        Ok(found)
    }
}
