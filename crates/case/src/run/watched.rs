//! The problem as the optimiser sees it: the start is solved once, failures leave a trace.

use crate::lower::CaseProblem;
use nastic_control::{ControlError, EnsembleError, EnsemblePoint};
use nastic_fem::StateError;
use nastic_opt::{Failed, Objective, Report, Request};
use std::sync::Mutex;

/// A problem with its start already evaluated.
pub(super) struct Watched<'a> {
    problem: &'a CaseProblem,
    /// The start and the derivative there, each until it was asked for: it would keep its factors from being let go.
    start: Mutex<Option<EnsemblePoint>>,
    derivative: Mutex<Option<(Vec<f64>, Vec<f64>)>>,
    /// Newton iterations of the last evaluation that failed, if it told.
    failed: Mutex<Option<usize>>,
}

impl<'a> Watched<'a> {
    pub fn new(problem: &'a CaseProblem, start: EnsemblePoint, derivative: Vec<f64>) -> Self {
        let derivative = Mutex::new(Some((start.m.clone(), derivative)));
        Self { problem, start: Mutex::new(Some(start)), derivative, failed: Mutex::new(None) }
    }

    /// Newton iterations of the evaluation that failed last; asked for once.
    pub fn failed_newton(&self) -> Option<usize> {
        self.failed.lock().ok().and_then(|mut failed| failed.take())
    }

    /// A failure in words; the next question about Newton iterations is about it.
    fn note(&self, error: &EnsembleError) -> Failed {
        if let (EnsembleError::Member { source, .. }, Ok(mut failed)) = (error, self.failed.lock()) {
            *failed = newton_of(source);
        }
        Failed::new(self.problem.explain(error))
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
    type Point = EnsemblePoint;

    fn evaluate(&self, m: &[f64], how: &Request<'_, EnsemblePoint>) -> Result<EnsemblePoint, Failed> {
        let first = how.near.is_none() && how.stage == 0;
        let known = self.start.lock().ok().and_then(|mut start| start.take_if(|start| first && start.m == m));
        match known {
            Some(start) => Ok(start),
            None => self.problem.ensemble.try_evaluate(m, how).map_err(|error| self.note(&error)),
        }
    }

    fn value(&self, point: &EnsemblePoint) -> f64 {
        self.problem.ensemble.value(point)
    }

    fn derivative(&self, point: &EnsemblePoint) -> Result<Vec<f64>, Failed> {
        let known = self.derivative.lock().ok().and_then(|mut known| known.take());
        match known {
            // The first question is about the start.
            Some((m, derivative)) if m == point.m => Ok(derivative),
            _ => {
                let derivative = self.problem.ensemble.try_derivative(point);
                derivative.map_err(|error| Failed::new(self.problem.explain(&error)))
            }
        }
    }

    fn stages(&self) -> usize {
        self.problem.stages()
    }

    fn restage(&self, stage: usize, point: &EnsemblePoint) -> Result<EnsemblePoint, Failed> {
        let restaged = self.problem.ensemble.try_restage(stage, point);
        restaged.map_err(|error| Failed::new(self.problem.explain(&error)))
    }

    fn report(&self, point: &EnsemblePoint) -> Report {
        self.problem.ensemble.report(point)
    }
}
