//! How far an optimisation is, for the line that shows a solve under way.

use crate::number::duration;
use std::fmt;
use std::time::Instant;

/// Trials and iterations done, and the time they took.
#[derive(Clone, Copy, Debug)]
pub struct Pace {
    began: Instant,
    /// Iterations that were done when the first trial was reported.
    before: Option<usize>,
    iteration: usize,
    trial: usize,
    /// That of the last accepted trial.
    cost: Option<f64>,
    /// The limit of iterations.
    most: usize,
}

impl Pace {
    /// Of an optimisation that begins now, with a limit of iterations.
    pub fn new(most: usize) -> Self {
        Self { began: Instant::now(), before: None, iteration: 0, trial: 0, cost: None, most }
    }

    /// Iterations that are done, their limit, the trial under way, and the cost of the last accepted one.
    pub(crate) fn counts(&self) -> (usize, usize, usize, Option<f64>) {
        (self.iteration, self.most, self.trial, self.cost)
    }

    /// A trial ended; with its cost, where it was accepted.
    pub fn done(&mut self, trial: usize, iteration: usize, cost: Option<f64>) {
        self.before.get_or_insert(iteration);
        (self.trial, self.iteration, self.cost) = (trial, iteration, cost.or(self.cost));
    }
}

/// `iteration 9 of 60, trial 12, cost 1.2340e-3, 34.1 s so far, 3.2 min to the limit`.
impl fmt::Display for Pace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let seconds = self.began.elapsed().as_secs_f64();
        write!(f, "iteration {} of {}, trial {}", self.iteration + 1, self.most, self.trial + 1)?;
        if let Some(cost) = self.cost {
            write!(f, ", cost {cost:.4e}")?;
        }
        write!(f, ", {} so far", duration(seconds))?;
        let done = self.before.map_or(0, |before| self.iteration.saturating_sub(before));
        if done > 0 && self.iteration < self.most {
            let each = seconds / done as f64;
            write!(f, ", {} to the limit", duration(each * (self.most - self.iteration) as f64))?;
        }
        Ok(())
    }
}
