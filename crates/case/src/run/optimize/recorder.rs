//! Trial by trial: the table, `history.jsonl`, snapshots of iterations.

use super::super::error::RunError;
use super::super::number::short;
use super::super::session::Session;
use super::super::table::Table;
use super::super::watched::Watched;
use crate::console::Console;
use crate::history::{self, History};
use crate::lower::Problem;
use crate::result::files::Directory;
use crate::result::snapshot::{self, View};
use crate::result::summary;
use nastic_control::Evaluated;
use nastic_fem::SolveReport;
use nastic_opt::{Reason, Trial};
use serde_json::json;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

/// Told of every trial.
pub(super) struct Recorder<'s> {
    problem: &'s Problem,
    console: &'s Console,
    watched: &'s Watched<'s>,
    cancel: Arc<AtomicBool>,
    out: Option<Directory>,
    history: Option<History>,
    table: Table,
    work: SolveReport,
    last: Instant,
    /// Snapshots written: iteration and file.
    steps: Vec<(f64, String)>,
    failed: Option<RunError>,
}

impl<'s> Recorder<'s> {
    pub fn new(session: &'s Session<'s>, watched: &'s Watched<'s>) -> Result<Self, RunError> {
        let problem = &session.problem;
        let history = session.out.as_ref().map(|out| History::create(&out.file("history.jsonl"))).transpose()?;
        Ok(Self {
            problem,
            console: session.console,
            watched,
            cancel: session.cancel.clone(),
            out: session.out.clone(),
            history,
            table: Table { distance: has_distance(problem), stages: problem.stages() > 1 },
            work: SolveReport::default(),
            last: Instant::now(),
            steps: vec![],
            failed: None,
        })
    }

    pub fn begin(&self, method: &str) {
        let block = &self.problem.case.optimizer;
        self.console.say(format!(
            "optimizer   {method}, at most {} iterations, until the projected gradient is {} of the first",
            block.max_iterations,
            short(block.tolerance)
        ));
        self.console.say("");
        self.console.say(self.table.header());
    }

    pub fn record(&mut self, trial: &Trial<'_, Evaluated>) {
        if trial.cost.is_none() && self.cancel.load(Ordering::Relaxed) {
            // Broken off, not failed: a run that goes on makes this trial again.
            return;
        }
        let distance = self.distance(trial);
        let seconds = self.last.elapsed().as_secs_f64();
        self.last = Instant::now();
        let failed_newton = self.watched.failed_newton().filter(|_| trial.cost.is_none());
        if let Some(point) = trial.point.filter(|_| trial.reason != Reason::Stage) {
            self.work.add_work(&point.total_work());
        } else if let Some(newton) = failed_newton {
            self.work.newton += newton;
        }
        if trial.reason == Reason::Stage {
            self.console.say(format!("stage {} of {}", trial.stage + 1, self.problem.stages()));
        }
        self.console.say(self.table.row(trial, failed_newton, distance, seconds));
        let mut line = history::line(trial, failed_newton, seconds);
        if let (Some(distance), Some(line)) = (distance, line.as_object_mut()) {
            line.insert("hausdorff_true".into(), json!(distance));
        }
        if let Some(history) = &mut self.history {
            history.add(&line);
        }
        self.snapshot(trial);
    }

    /// The true distance of an accepted state.
    fn distance(&self, trial: &Trial<'_, Evaluated>) -> Option<f64> {
        let point = trial.point.filter(|_| trial.accepted && self.table.distance)?;
        let figures = summary::hausdorff(self.problem, &point.state, &point.m, point.stage).ok()?;
        figures["true"].as_f64()
    }

    /// Every so many iterations, the start among them.
    fn snapshot(&mut self, trial: &Trial<'_, Evaluated>) {
        let every = self.problem.case.output.every;
        let due = trial.accepted && every > 0 && trial.iteration.is_multiple_of(every) && trial.reason != Reason::Stage;
        let (Some(point), true) = (trial.point, due) else { return };
        if let Err(error) = self.write(trial.iteration, point, trial.derivative) {
            // An optimisation does not end for a snapshot; the end tells.
            self.failed.get_or_insert(error);
        }
    }

    fn write(&mut self, iteration: usize, point: &Evaluated, derivative: Option<&[f64]>) -> Result<(), RunError> {
        let Some(out) = &self.out else { return Ok(()) };
        let view = View { state: &point.state, m: &point.m, adjoint: point.adjoint(), derivative };
        let name = format!("iteration_{iteration:04}.vtu");
        out.write_vtu(&name, &snapshot::snapshot(self.problem, &view)?)?;
        self.steps.push((iteration as f64, name));
        nastic_io::write_pvd(out.file("iterations.pvd"), &self.steps)?;
        Ok(())
    }

    /// Closes the history; the work of all trials.
    pub fn finish(self) -> Result<SolveReport, RunError> {
        if let Some(history) = self.history {
            history.finish()?;
        }
        match self.failed {
            Some(error) => Err(error),
            None => Ok(self.work),
        }
    }
}

fn has_distance(problem: &Problem) -> bool {
    problem.case.costs.iter().any(|cost| matches!(cost, crate::schema::Cost::SmoothedHausdorff(_)))
}
