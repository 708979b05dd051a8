//! The members of an ensemble as they finish.

use crate::console::Console;
use nastic_case::lower::CaseProblem;
use nastic_ensemble::Finished;
use nastic_numeric::format::scientific;
use nastic_report::bar;
use std::sync::{Arc, Mutex};

/// Who has finished in the present round, and where that is shown.
pub(super) struct EnsembleProgress {
    done: Mutex<Vec<bool>>,
    what: &'static str,
    console: Console,
}

impl EnsembleProgress {
    pub fn new(problem: &CaseProblem, console: &Console) -> Self {
        let what = if problem.has_scenarios() { "scenarios" } else { "load cases" };
        Self { done: Mutex::new(vec![]), what, console: console.clone() }
    }

    /// What an ensemble reports.
    pub fn watcher(self) -> impl Fn(&Finished) + Send + Sync + 'static {
        let progress = Arc::new(self);
        move |finished| progress.tick(finished)
    }

    fn tick(&self, finished: &Finished) {
        let Ok(mut done) = self.done.lock() else { return };
        // Whoever comes a second time begins another round.
        if done.len() != finished.of || done[finished.index] || done.iter().all(|done| *done) {
            *done = vec![false; finished.of];
        }
        done[finished.index] = true;
        let count = done.iter().filter(|done| **done).count();
        let cost = match finished.cost {
            Ok(cost) => format!("cost {}", scientific(cost, 4)),
            Err(_) => "no equilibrium".to_owned(),
        };
        let (bar, what, of) = (bar(count, finished.of), self.what, finished.of);
        self.console.pass(format!("{bar} {what}: {count} of {of}, {} has {cost}", finished.name));
    }
}
