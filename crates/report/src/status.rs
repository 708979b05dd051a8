//! [`Status`]: what a command does at the moment, as a line that passes on a terminal or goes to a log.

use crate::number::duration;
use crate::pace::Pace;
use crate::standing::Standing;
use std::time::{Duration, Instant};

/// Characters of a bar.
const BAR: usize = 12;

/// `[####........]`: how many of all are done.
#[must_use]
pub fn bar(done: usize, of: usize) -> String {
    let filled = (BAR * done.min(of)).checked_div(of).unwrap_or(0);
    format!("[{}{}]", "#".repeat(filled), ".".repeat(BAR - filled))
}

/// Parts of a whole that are done one after the other, for the time that is left.
#[derive(Debug)]
struct Parts {
    began: Instant,
    /// The first that is not done before.
    from: usize,
    done: usize,
    of: usize,
    what: String,
}

impl Parts {
    fn left(&self) -> Option<Duration> {
        let made = self.done.checked_sub(self.from).filter(|made| *made > 0)?;
        let each = self.began.elapsed().as_secs_f64() / made as f64;
        Some(Duration::from_secs_f64(each * self.of.saturating_sub(self.done) as f64))
    }
}

/// What a command does at the moment.
#[derive(Debug)]
pub(crate) struct Status {
    began: Instant,
    phase: String,
    /// Runs of a sweep.
    runs: Option<Parts>,
    /// How far an optimisation is.
    pub pace: Option<Pace>,
    /// Steps of a motion.
    steps: Option<Parts>,
    /// The instant that the step under way leads to, and the end of the motion.
    instant: Option<[f64; 2]>,
    /// About the solve under way.
    pub line: String,
    /// How many lines are being said.
    pub speaking: usize,
    /// Nothing is shown any more.
    pub ended: bool,
}

impl Default for Status {
    fn default() -> Self {
        let (phase, line) = (String::new(), String::new());
        let began = Instant::now();
        Self { began, phase, runs: None, pace: None, steps: None, instant: None, line, speaking: 0, ended: false }
    }
}

impl Status {
    /// Another phase begins.
    pub fn enter(&mut self, phase: &str) {
        (self.phase, self.steps, self.instant, self.line) = (phase.to_owned(), None, None, String::new());
    }

    /// So many runs of a sweep are done, and the next has this name.
    pub fn run(&mut self, done: usize, of: usize, what: String) {
        let (began, from) = self.runs.as_ref().map_or((Instant::now(), done), |runs| (runs.began, runs.from));
        self.runs = Some(Parts { began, from, done, of, what });
    }

    /// So many steps of a motion are done, and the next leads to this instant.
    pub fn step(&mut self, done: usize, of: usize, what: String) {
        let before = self.steps.as_ref().filter(|steps| steps.of == of && steps.done <= done);
        let (began, from) = before.map_or((Instant::now(), done), |steps| (steps.began, steps.from));
        self.steps = Some(Parts { began, from, done, of, what });
    }

    /// The step under way leads to this instant of a motion with this end.
    pub fn at(&mut self, time: f64, end: f64) {
        self.instant = Some([time, end]);
    }

    /// The same as values.
    pub fn standing(&self) -> Standing {
        let pace = self.pace.as_ref().map(Pace::counts);
        Standing {
            phase: self.phase.clone(),
            seconds: self.began.elapsed().as_secs_f64(),
            step: self.steps.as_ref().map(|steps| steps.done),
            steps: self.steps.as_ref().map(|steps| steps.of),
            time: self.instant.map(|[time, _]| time),
            end: self.instant.map(|[_, end]| end),
            iteration: pace.map(|(iteration, ..)| iteration),
            iterations: pace.map(|(_, most, ..)| most),
            trial: pace.map(|(_, _, trial, _)| trial),
            cost: pace.and_then(|(.., cost)| cost),
            line: self.line.clone(),
        }
    }

    /// Since when it is shown.
    pub fn elapsed(&self) -> Duration {
        self.began.elapsed()
    }
}

impl std::fmt::Display for Status {
    /// `motion: step 7 of 45, t = 0.07 of 0.45 s, 34.1 s so far, about 3.2 min left; solving: load 1.0000, Newton iteration 17, ..`
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mut parts = Vec::new();
        if let Some(Parts { done, of, what, .. }) = &self.runs {
            parts.push(format!("{} run {} of {of}: {what}", bar(*done, *of), done + 1));
        }
        let mut now = match &self.pace {
            Some(pace) => pace.to_string(),
            None => self.phase.clone(),
        };
        if let Some(Parts { done, of, what, .. }) = &self.steps {
            let before = if now.is_empty() { String::new() } else { now + ": " };
            now = format!("{before}step {} of {of}, {what}", done + 1);
        }
        if self.pace.is_none() || self.runs.is_some() {
            let before = if now.is_empty() { String::new() } else { now + ", " };
            now = format!("{before}{} so far", duration(self.began.elapsed().as_secs_f64()));
            let whole = self.runs.as_ref().or(self.steps.as_ref());
            if let Some(left) = whole.and_then(Parts::left) {
                now += &format!(", about {} left", duration(left.as_secs_f64()));
            }
        }
        parts.push(now);
        parts.extend((!self.line.is_empty()).then(|| self.line.clone()));
        f.write_str(&parts.join("; "))
    }
}
