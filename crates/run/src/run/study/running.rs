//! A [`Study`] is made a problem of the command line's kind, and run.

use crate::console::Console;
use crate::run::commands::thread_pool;
use crate::run::conclusion::conclude;
use crate::run::error::{Exit, RunError};
use crate::run::options::Options;
use crate::run::outcome::Outcome;
use crate::run::session::Opened;
use crate::run::states::States;
use crate::run::study::control_set::ControlSet;
use crate::run::study::{Optimum, Study, StudyError, record};
use crate::run::{optimize, resumption};
use crate::saved::CheckpointError;
use crate::signals::cancelled_by_signals;
use nastic_case::lower::{Assembled, CaseProblem, ControlProblem};
use nastic_ensemble::EnsembleBlock;
use nastic_language::schema::{Case, Command, Method};
use nastic_language::syntax::Document;
use nastic_opt::Optimizer;
use serde_json::json;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

impl Study {
    /// Optimises from the start. Its derivative is checked first.
    ///
    /// # Errors
    /// [`StudyError`]. A stop before convergence is none: see [`Outcome::exit`].
    pub fn optimize(self, optimizer: &impl Optimizer) -> Result<Optimum, StudyError> {
        self.run(optimizer, false)
    }

    /// Goes on with an optimisation of the same problem from the last checkpoint in the directory: the result is that of a run without
    /// interruption, to the bit but for times and the entry `resumed`. Begins where there is no checkpoint yet, so that a program that is
    /// simply run again goes on.
    ///
    /// # Errors
    /// As [`optimize`](Self::optimize); a checkpoint of another problem: other meshes, supports, controls, inner products, sets, starts, names of costs,
    /// another optimiser, or a law or a cost that gives the control of the checkpoint another value.
    pub fn resume(self, optimizer: &impl Optimizer) -> Result<Optimum, StudyError> {
        self.run(optimizer, true)
    }

    fn run(self, optimizer: &impl Optimizer, goes_on: bool) -> Result<Optimum, StudyError> {
        let pool = thread_pool(self.threads)?;
        let began = Instant::now();
        let console = self.console.clone();
        let own = if self.interruptible { Some(stop_by_signals(&console)) } else { self.cancel.clone() };
        let (directory, restart) = (self.directory.clone(), self.restart);
        let (no_report, on_trial, spectrum) = (!self.report, self.on_trial.clone(), self.spectrum);
        let mut problem = self.assemble(optimizer)?;
        if let Some(flag) = &own {
            problem.ensemble.cancel_by(flag);
        }
        let cancel = own.unwrap_or_default();
        let run = || -> Result<(Outcome, Option<States>), RunError> {
            let options = Options { no_report, on_trial, spectrum, cancel, ..Options::default() };
            let mut opened = Opened::on(Command::Optimize, problem, options, &console, began);
            let exit = match directory {
                Some(directory) if goes_on && !restart => resume_in(&mut opened, optimizer, directory),
                Some(directory) => {
                    opened.destination.enter(&opened.input, directory)?;
                    optimize::begin(&mut opened, optimizer, restart)
                }
                None => optimize::begin(&mut opened, optimizer, restart),
            };
            conclude(opened, exit, true)
        };
        let (outcome, states) = pool.install(run).map_err(StudyError::of)?;
        match states {
            Some(states) => Ok(Optimum { outcome, states }),
            None => Err(StudyError::Derivative { mismatch: *outcome.record.gradient_check.mismatch }),
        }
    }

    fn assemble(self, optimizer: &dyn Optimizer) -> Result<CaseProblem, StudyError> {
        let controls = self.controls()?;
        let name = self.name();
        let case = self.case(&name, optimizer)?;
        let identity = record::identity(&self.ensemble, &controls, optimizer, &case);
        let document = Document::from_json(&name, &identity);
        let Self { ensemble, probes, .. } = self;
        let controls = controls.into_iter().map(|(_, control)| control).collect();
        Ok(CaseProblem::assemble(Assembled { ensemble, controls, probes, case, document })?)
    }

    /// The last part of the directory's name.
    fn name(&self) -> String {
        let last = self.directory.as_ref().and_then(|directory| directory.file_name());
        last.map_or_else(|| "study".to_owned(), |name| name.to_string_lossy().into_owned())
    }

    /// Set and start of every control field.
    fn controls(&self) -> Result<Vec<(ControlSet, ControlProblem)>, StudyError> {
        let blocks = self.ensemble.blocks();
        let named = self.sets.iter().map(|(name, _)| name).chain(self.starts.iter().map(|(name, _)| name));
        for name in named {
            if !blocks.iter().any(|block| block.name == *name) {
                let known = blocks.iter().map(|block| block.name.clone()).collect::<Vec<_>>().join(", ");
                return Err(StudyError::UnknownControl { name: name.clone(), known });
            }
        }
        let len = blocks.iter().map(|block| block.len).sum();
        if let Some(found) = self.whole_start.as_ref().map(Vec::len).filter(|found| *found != len) {
            return Err(StudyError::Length { found, expected: len });
        }
        Ok(blocks.iter().map(|block| self.control(block)).collect())
    }

    fn control(&self, block: &EnsembleBlock) -> (ControlSet, ControlProblem) {
        let last = self.sets.iter().rev().find(|(name, _)| *name == block.name);
        let set = last.map_or_else(ControlSet::none, |(_, set)| set.clone());
        let own = self.starts.iter().rev().find(|(name, _)| *name == block.name);
        let start = match (own, &self.whole_start) {
            (Some((_, values)), _) if values.len() == 1 => vec![values[0]; block.len],
            (Some((_, values)), _) => values.clone(),
            (None, Some(m)) => block.of(m).to_vec(),
            (None, None) => vec![0.0; block.len],
        };
        let control = ControlProblem { admitted: set.admission(), set: set.set(), start };
        (set, control)
    }

    /// What of a case file a program says otherwise.
    fn case(&self, name: &str, optimizer: &dyn Optimizer) -> Result<Case, StudyError> {
        let empty = json!({ "nastic": 1, "mesh": name, "materials": [] });
        let mut case = Case::read_variant(&Document::from_json(name, &empty), self.units).map_err(RunError::from)?;
        let options = optimizer.options();
        (case.units, case.title) = (self.units, self.title.clone());
        (case.output.every, case.output.checkpoint) = (self.every, self.checkpoint);
        (case.optimizer.starts, case.optimizer.seed) = (1 + self.random_starts, self.seed);
        case.optimizer.early_stopping = self.early_stopping;
        (case.optimizer.max_iterations, case.optimizer.tolerance) = (options.max_iterations, options.tolerance);
        case.optimizer.absolute_tolerance = options.absolute_tolerance;
        case.optimizer.stage_tolerance = options.stage_tolerance;
        case.optimizer.method = Method::named(optimizer.name()).unwrap_or_default();
        Ok(case)
    }
}

fn stop_by_signals(console: &Console) -> Arc<AtomicBool> {
    let console = console.clone();
    cancelled_by_signals(move |shown| console.say(shown))
}

/// Goes on where the directory holds a checkpoint of the same problem beyond its start; begins elsewhere.
fn resume_in(opened: &mut Opened<'_>, optimizer: &dyn Optimizer, directory: PathBuf) -> Result<Exit, RunError> {
    match resumption::read(&directory, None) {
        Err(RunError::Checkpoint(CheckpointError::Missing { .. })) => {
            opened.destination.enter(&opened.input, directory)?;
            optimize::begin(opened, optimizer, true)
        }
        Err(error) => Err(error),
        Ok((out, checkpoint)) => {
            checkpoint.case.check(&opened.input.problem, &directory)?;
            opened.destination.go_on_in(&opened.input, out, &directory)?;
            optimize::resume(opened, optimizer, checkpoint.position.filter(|position| !position.is_start()))
        }
    }
}
