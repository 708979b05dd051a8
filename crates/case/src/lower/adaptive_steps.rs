//! Time steps of a case with a tolerance: found once, at its start controls.

use crate::lower::problem::CaseProblem;
use nastic_control::{AdaptiveSteps, ControlError};
use nastic_fem::Tolerance;
use nastic_language::syntax::Diagnostics;
use rayon::prelude::*;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use thiserror::Error;

/// Why there are no time steps.
#[derive(Debug, Error)]
pub enum StepsError {
    /// The motion of a member fails, or the tolerance is out of reach.
    #[error("{error}")]
    Motion {
        /// Index of the member.
        member: usize,
        /// What failed.
        error: ControlError,
    },
    /// With these steps the case is wrong.
    #[error(transparent)]
    Input(#[from] Diagnostics),
}

impl CaseProblem {
    /// Whether its time steps are still to be found: until then it leads through what is written, knots and instants of costs alone, and
    /// is for looking at.
    #[must_use]
    pub fn lacks_steps(&self) -> bool {
        let has =
            |label: &crate::lower::member::Label| label.case.time.as_ref().is_none_or(|time| time.tolerance.is_none());
        !self.has_steps && !self.labels.iter().all(has)
    }

    /// Runs the motion of every member at the start controls, to states of this relative accuracy, by steps as long as the tolerance
    /// allows. They are those of every control vector from then on. The answer is the problem with these steps, and for every member what
    /// was found.
    ///
    /// # Errors
    /// The first member, in order, whose motion fails.
    pub fn with_adaptive_steps(
        &self,
        accuracy: f64,
        cancel: Arc<AtomicBool>,
    ) -> Result<(Self, Vec<AdaptiveSteps>), StepsError> {
        let find = |index: usize| {
            let member = self.member(index);
            let time = member.case().time.as_ref();
            let equal = || member.reduced().timeline().map_or_else(Vec::new, |timeline| timeline.instants().to_vec());
            let Some((time, error)) = time.and_then(|time| Some((time, time.tolerance?))) else {
                return Ok(AdaptiveSteps { instants: equal(), report: nastic_fem::AdaptiveReport::default() });
            };
            let tolerance = Tolerance { error, first: None, longest: Some(time.longest()) };
            let steps = member.reduced().adaptive_steps(&member.local(&self.start), accuracy, tolerance);
            let missing = || ControlError::Cost { what: "steps of a case that does not move".to_owned() };
            steps.and_then(|steps| steps.ok_or_else(missing))
        };
        let found: Vec<_> = (0..self.labels.len()).into_par_iter().map(find).collect();
        let named = |(member, steps): (usize, Result<AdaptiveSteps, ControlError>)| {
            steps.map_err(|error| StepsError::Motion { member, error })
        };
        let steps: Vec<AdaptiveSteps> = found.into_iter().enumerate().map(named).collect::<Result<_, _>>()?;
        let instants: Vec<Vec<f64>> = steps.iter().map(|steps| steps.instants.clone()).collect();
        Ok((self.through(&instants, cancel)?, steps))
    }

    /// The problem with steps through given instants, of every member.
    ///
    /// # Errors
    /// What is wrong with the case by these steps.
    pub fn through(&self, instants: &[Vec<f64>], cancel: Arc<AtomicBool>) -> Result<Self, Diagnostics> {
        let problem = Self::lower_through(self.document.clone(), cancel, instants, false)?;
        Ok(Self { has_steps: true, ..problem })
    }
}
