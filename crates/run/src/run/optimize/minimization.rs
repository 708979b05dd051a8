//! One run of the optimiser, from a start or a checkpoint to its end or a limit.

use crate::console::Console;
use crate::run::error::RunError;
use crate::run::optimize::recorder::Recorder;
use crate::run::optimize::starts::journal::SharedJournal;
use crate::run::optimize::starts::start_run::{Begun, FinishedRun, RunTrials, StartRecord};
use crate::run::session::{CommandContext, CommandInput, Destination};
use nastic_ensemble::{Ensemble, EnsemblePoint};
use nastic_opt::{
    AugmentedBest, AugmentedLagrangian, AugmentedRun, AugmentedState, Domain, EvaluatedStart, Failed, Objective,
    Optimizer, Outcome, Problem as _, Request, Stop,
};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// What the runs from all starts share; none of it changes while they run.
#[derive(Clone, Copy)]
pub(crate) struct Minimization<'s> {
    pub input: &'s CommandInput,
    pub destination: &'s Destination,
    pub console: &'s Console,
    pub optimizer: &'s dyn Optimizer,
    pub journal: &'s SharedJournal,
}

/// Where [`Minimization::run`] left a run.
pub(crate) enum Minimized {
    /// At the limit of its round.
    Paused(Box<AugmentedState>, RunTrials),
    Ended(Box<FinishedRun>, RunTrials),
}

/// Where controls may be, how they are measured, and the flag that stops the run.
pub(crate) fn domain(input: &CommandInput) -> Result<Domain, RunError> {
    let problem = &input.problem;
    let metric = problem.ensemble.inner_product().map_err(nastic_opt::RunError::InnerProduct)?;
    Ok(Domain { set: Arc::new(problem.set.clone()), metric, cancel: Some(input.cancel.clone()) })
}

impl<'s> Minimization<'s> {
    pub fn new(context: CommandContext<'s>, optimizer: &'s dyn Optimizer, journal: &'s SharedJournal) -> Self {
        let CommandContext { input, destination, console } = context;
        Self { input, destination, console, optimizer, journal }
    }

    /// A run from an evaluated start.
    pub fn begin(&self, begun: Begun) -> Result<AugmentedRun<&'s Ensemble>, RunError> {
        let Begun { point, derivative, workspace, .. } = begun;
        let start = EvaluatedStart { m: point.m.clone(), point, derivative: Some(derivative) };
        let (ensemble, domain) = (&self.input.problem.ensemble, domain(self.input)?);
        let run = AugmentedLagrangian::default().start(self.optimizer, ensemble, domain, start)?;
        Ok(run.with_workspace(workspace))
    }

    /// A run from a checkpoint.
    pub fn resume(&self, state: &AugmentedState) -> Result<AugmentedRun<&'s Ensemble>, RunError> {
        let (ensemble, domain) = (&self.input.problem.ensemble, domain(self.input)?);
        Ok(AugmentedLagrangian::default().load(self.optimizer, ensemble, domain, state)?)
    }

    /// The start of a run under way.
    pub fn read_record(&self, record: &StartRecord) -> Result<EnsemblePoint, RunError> {
        let start = self.input.problem.ensemble.load(&record.m, &record.start, &Request::default());
        start.map_err(|failed| self.destination.unfit_checkpoint(self.input, &failed.to_string()))
    }

    /// Runs the optimiser to its end, to a number of iterations, or until `halt` is raised. `saved` is the iteration of the checkpoint that
    /// the run comes from.
    pub fn run(
        &self,
        mut run: AugmentedRun<&'s Ensemble>,
        mut start: EnsemblePoint,
        mut recorder: Recorder<'_>,
        mut saved: Option<usize>,
        (limit, halt): (usize, &AtomicBool),
    ) -> Minimized {
        let stop = loop {
            let done = run.progress().counts.iterations;
            if halt.load(Ordering::Relaxed) {
                break Stop::Cancelled;
            }
            if done >= limit && !self.input.is_cancelled() {
                let state = Box::new(run.checkpoint());
                return Minimized::Paused(state, recorder.finish());
            }
            if recorder.is_checkpoint_due(done) && saved != Some(done) {
                // The workspace goes whether the file can be written or not: bits do not depend on disks.
                let state = run.checkpoint();
                recorder.save(&state);
                saved = Some(done);
                let kept: Vec<&EnsemblePoint> = [&start, run.point()].into_iter().chain(run.best_point()).collect();
                if let Some(moved) = recorder.moved_members(self, &kept) {
                    match moved.and_then(|start| Ok((self.resume(&state)?, start))) {
                        Ok(moved) => (run, start) = moved,
                        Err(error) => break Stop::Aborted(Failed::because(error.to_string()).fatal()),
                    }
                    self.input.problem.ensemble.forget();
                    recorder.goes_on_from(run.point());
                }
            }
            match run.step(&mut |trial: &nastic_opt::Trial<'_, EnsemblePoint>| recorder.record(trial)) {
                Outcome::Stopped(stop) => break stop,
                Outcome::Iterated | Outcome::Staged(_) => {}
            }
        };
        let trials = recorder.finish();
        let AugmentedBest { best, constraints } = run.finish(stop);
        let run = FinishedRun { start, best, constraints, work: trials.work.clone(), limits: trials.limits.clone() };
        Minimized::Ended(Box::new(run), trials)
    }
}
