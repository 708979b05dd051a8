//! [`Clock`]: the seconds of a command, phase by phase.

use nastic_report::record::Number;
use std::time::Instant;

/// The seconds of a command, phase by phase.
#[derive(Debug)]
pub(crate) struct Clock {
    phases: Vec<(&'static str, f64)>,
    began: Instant,
}

impl Clock {
    /// Of a command that began then.
    pub fn new(began: Instant) -> Self {
        Self { phases: vec![], began }
    }

    /// Adds to the time of a phase.
    pub fn note(&mut self, phase: &'static str, seconds: f64) {
        match self.phases.iter_mut().find(|(known, _)| *known == phase) {
            Some((_, total)) => *total += seconds,
            None => self.phases.push((phase, seconds)),
        }
    }

    /// All of them, and how long it took in all.
    pub fn seconds(&self) -> impl Iterator<Item = (String, Number)> {
        let total = ("total", self.began.elapsed().as_secs_f64());
        self.phases.iter().copied().chain([total]).map(|(phase, seconds)| (phase.to_owned(), seconds.into()))
    }
}
