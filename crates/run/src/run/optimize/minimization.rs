//! One run of the optimiser, from a start or a checkpoint to its end or a limit.

use crate::run::error::RunError;
use crate::run::optimize::recorder::Recorder;
use crate::run::optimize::starts::start_run::Begun;
use crate::run::optimize::starts::start_run::FinishedRun;
use crate::run::optimize::starts::start_run::RunTrials;
use crate::run::session::Session;
use nastic_ensemble::{Ensemble, EnsemblePoint, EnsembleWorkspace};
use nastic_opt::{
    AugmentedBest, AugmentedLagrangian, AugmentedRun, AugmentedState, DEFAULT_ACCURACY, Domain, EvaluatedStart, Failed,
    Optimizer, Outcome, Problem as _, Stop,
};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

pub(crate) fn evaluate(
    session: &Session<'_>,
    m: &[f64],
    workspace: &mut EnsembleWorkspace,
) -> Result<EnsemblePoint, Failed> {
    session.evaluate(m, DEFAULT_ACCURACY, workspace)
}

/// A run from an evaluated start.
pub(crate) fn begin_run<'s>(
    session: &'s Session<'_>,
    optimizer: &dyn Optimizer,
    begun: Begun,
) -> Result<AugmentedRun<&'s Ensemble>, RunError> {
    let Begun { point, derivative, workspace, .. } = begun;
    let start = EvaluatedStart { m: point.m.clone(), point, derivative: Some(derivative) };
    let ensemble = &session.input.problem.ensemble;
    let run = AugmentedLagrangian::default().start(optimizer, ensemble, domain(session)?, start)?;
    Ok(run.with_workspace(workspace))
}

/// Where controls may be, how they are measured, and the flag that stops the run.
pub(crate) fn domain(session: &Session<'_>) -> Result<Domain, RunError> {
    let problem = &session.input.problem;
    let metric = problem.ensemble.inner_product().map_err(nastic_opt::RunError::InnerProduct)?;
    Ok(Domain { set: Arc::new(problem.set.clone()), metric, cancel: Some(session.input.cancel.clone()) })
}

/// A run from a checkpoint.
pub(crate) fn resume_run<'s>(
    session: &'s Session<'_>,
    optimizer: &dyn Optimizer,
    state: &AugmentedState,
) -> Result<AugmentedRun<&'s Ensemble>, RunError> {
    let ensemble = &session.input.problem.ensemble;
    Ok(AugmentedLagrangian::default().load(optimizer, ensemble, domain(session)?, state)?)
}

/// Where [`minimize`] left a run.
pub(crate) enum Minimized {
    /// At the limit of its round.
    Paused(Box<AugmentedState>, RunTrials),
    Ended(Box<FinishedRun>, RunTrials),
}

/// Runs the optimiser to its end, to a number of iterations, or until `halt` is raised. `saved` is the iteration of the checkpoint that
/// the run comes from.
pub(crate) fn minimize<'s>(
    session: &'s Session<'s>,
    optimizer: &dyn Optimizer,
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
        if done >= limit && !session.is_cancelled() {
            let state = Box::new(run.checkpoint());
            return Minimized::Paused(state, recorder.finish());
        }
        if recorder.is_checkpoint_due(done) && saved != Some(done) {
            // The workspace goes whether the file can be written or not: bits do not depend on disks.
            let state = run.checkpoint();
            recorder.save(&state);
            saved = Some(done);
            let kept: Vec<&EnsemblePoint> = [&start, run.point()].into_iter().chain(run.best_point()).collect();
            if let Some(moved) = recorder.moved_members(session, &kept) {
                match moved.and_then(|start| Ok((resume_run(session, optimizer, &state)?, start))) {
                    Ok(moved) => (run, start) = moved,
                    Err(error) => break Stop::Aborted(Failed::because(error.to_string()).fatal()),
                }
                session.input.problem.ensemble.forget();
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
