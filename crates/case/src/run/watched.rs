//! The problem as the optimiser sees it: the start is solved once, failures leave a trace.

use nastic_control::{ControlError, Evaluated, Reduced};
use nastic_fem::StateError;
use nastic_opt::{Failed, Objective, Report, Request};
use std::sync::Mutex;

/// A reduced problem with its start already evaluated.
pub(super) struct Watched<'a> {
    reduced: &'a Reduced,
    start: Evaluated,
    /// Newton iterations of the last evaluation that failed, if it told.
    failed: Mutex<Option<usize>>,
}

impl<'a> Watched<'a> {
    pub fn new(reduced: &'a Reduced, start: Evaluated) -> Self {
        Self { reduced, start, failed: Mutex::new(None) }
    }

    /// Newton iterations of the evaluation that failed last; asked for once.
    pub fn failed_newton(&self) -> Option<usize> {
        self.failed.lock().ok().and_then(|mut failed| failed.take())
    }
}

fn newton_of(error: &ControlError) -> Option<usize> {
    match error {
        ControlError::State(StateError::NoConvergence { newton, .. }) => Some(*newton),
        ControlError::State(StateError::Inverted { last, .. }) => Some(last.report.newton),
        _ => None,
    }
}

impl Objective for Watched<'_> {
    type Point = Evaluated;

    fn evaluate(&self, m: &[f64], how: &Request<'_, Evaluated>) -> Result<Evaluated, Failed> {
        if how.near.is_none() && m == self.start.m.as_slice() && how.stage == self.start.stage {
            return Ok(self.start.clone());
        }
        self.reduced.try_evaluate(m, how).map_err(|error| {
            if let Ok(mut failed) = self.failed.lock() {
                *failed = newton_of(&error);
            }
            Failed::new(error.to_string())
        })
    }

    fn value(&self, point: &Evaluated) -> f64 {
        self.reduced.value(point)
    }

    fn derivative(&self, point: &Evaluated) -> Result<Vec<f64>, Failed> {
        self.reduced.derivative(point)
    }

    fn stages(&self) -> usize {
        self.reduced.stages()
    }

    fn restage(&self, stage: usize, point: &Evaluated) -> Result<Evaluated, Failed> {
        self.reduced.restage(stage, point)
    }

    fn report(&self, point: &Evaluated) -> Report {
        self.reduced.report(point)
    }
}
