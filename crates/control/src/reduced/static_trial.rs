//! The equilibrium of a trial: within its budget, around limit points.

use super::Reduced;
use crate::evaluated::{Evaluated, SolvedStates};
use crate::workspace::ReducedWorkspace;
use nastic_fem::{
    Ahead, Cause, Connection, Controls, Feature, Instant, LimitAhead, SolveOptions, SolveReport, State, StateError,
    Workspace,
};
use nastic_fields::ControlError;
use nastic_numeric::vector::{axpy, sub};
use nastic_opt::{Budget, Request};

/// Newton iterations that any trial may take, whatever the last accepted ones took: of a body whose path of equilibria can be followed where they do
/// not suffice, and of others.
const LEAST: [usize; 2] = [25, 100];
/// Newton iterations that may go into following the path where a trial has found no state: some ten points of a branch without limit points, each with its
/// inertia, and a few more.
const FOLLOWED: usize = 80;
/// Relative residual of the states on a path that is looked along.
const ROUGH: f64 = 1e-7;

/// What is known of a trial before its state is looked for.
struct Trial<'a> {
    m: &'a [f64],
    stage: usize,
    controls: Controls,
    /// The point that it starts near.
    near: Option<&'a Evaluated>,
    /// The same, where the path from there can be followed.
    follows: Option<&'a Evaluated>,
    /// Newton iterations that it may take.
    budget: Option<usize>,
    /// Newton iterations that may go into following the path.
    followed: usize,
}

impl Reduced {
    /// An equilibrium and its values. A trial with a budget whose step leads beyond a limit point that is known, or that finds no state, is looked at along the path
    /// of equilibria, which shows the limit point, or leads to the state.
    pub(super) fn evaluate_static(
        &self,
        m: &[f64],
        how: &Request<'_, Evaluated>,
        workspace: &mut ReducedWorkspace,
    ) -> Result<Evaluated, ControlError> {
        let guess = match how.near {
            Some(near) => {
                workspace.predictor.record(&near.m, &near.state().u, near.work.newton);
                workspace.predictor.guess(m)
            }
            None => {
                workspace.clear();
                None
            }
        };
        let follows = self.follows_paths();
        let budget = how.budget.work(workspace.predictor.usual_work(), LEAST[usize::from(!follows)]);
        let near = how.near.filter(|_| follows && budget.is_some());
        let followed = if let Budget::Of(most) = how.budget { most.min(FOLLOWED) } else { FOLLOWED };
        let (stage, controls) = (how.stage, self.layout_in_stage(how.stage).to_points(m)?);
        let trial = Trial { m, stage, controls, near: how.near, follows: near, budget, followed };
        let solved = self.state_of(&trial, guess.as_deref(), how.accuracy, workspace);
        self.forget(workspace);
        let state = solved?;
        self.check_stable(&state)?;
        let work = state.report;
        self.valued(SolvedStates::one(state, how.accuracy), m, how.stage, work)
    }

    /// Whether the paths of its equilibria can be followed.
    fn follows_paths(&self) -> bool {
        self.projected.is_none() && self.solid().model().properties().supports(Feature::Path).is_ok()
    }

    fn state_of(
        &self,
        trial: &Trial<'_>,
        guess: Option<&[f64]>,
        accuracy: f64,
        workspace: &mut ReducedWorkspace,
    ) -> Result<State, ControlError> {
        let how = SolveOptions { budget: trial.budget, ..self.solve_options(accuracy) };
        let near = trial.follows;
        let (mut spent, mut looked) = (SolveReport::default(), false);
        if let Some(near) = near
            && workspace.limits.are_crossed(&near.m, trial.m)
        {
            if let Some(state) = self.along_path(near, trial, &how, &mut spent, workspace)? {
                return Ok(state);
            }
            looked = true;
        }
        // a step that was cut at a limit point goes on from the states before it
        let passed = near.and_then(|near| workspace.limits.before(&near.m, trial.m)).cloned();
        let start = passed.as_ref().or(trial.near.map(Evaluated::state));
        let options = SolveOptions { guess: guess.filter(|_| passed.is_none()), near: start, ..how.clone() };
        match (self.solved(&trial.controls, &options, &mut workspace.solve), near) {
            (Err(error), Some(near)) if !looked && may_be_limit(&error) => {
                spent.newton += iterations(&error);
                let found = self.along_path(near, trial, &how, &mut spent, workspace)?;
                found.ok_or(ControlError::State(error))
            }
            (solved, _) => Ok(after(solved?, &spent)),
        }
    }

    /// The state by the path of equilibria from the point that the trial starts near; `None` where it cannot be followed within the budget.
    ///
    /// # Errors
    /// [`ControlError::LimitPoint`] where it turns back.
    fn along_path(
        &self,
        near: &Evaluated,
        trial: &Trial<'_>,
        how: &SolveOptions<'_>,
        spent: &mut SolveReport,
        workspace: &mut ReducedWorkspace,
    ) -> Result<Option<State>, ControlError> {
        let coarse = SolveOptions { accuracy: how.accuracy.max(ROUGH), budget: Some(trial.followed), ..how.clone() };
        let (model, to) = (self.solid().model(), (&trial.controls, 1.0));
        match model.moves().ahead(near.state(), to, &coarse, &mut Workspace::default(), spent) {
            Err(error) if error.is_lack_of_memory() || matches!(error, StateError::Cancelled) => Err(error.into()),
            Err(_) | Ok(Ahead::Unknown(_)) => Ok(None),
            Ok(Ahead::LimitPoint(at)) => {
                let limit = self.layout_in_stage(trial.stage).limit_point([&near.m, trial.m], at.share);
                self.note(&at, near, trial, workspace);
                Err(ControlError::LimitPoint { limit, newton: spent.newton })
            }
            Ok(Ahead::Clear(state)) => {
                workspace.limits.leave(&near.m, trial.m);
                let options = SolveOptions { near: Some(&state), ..how.clone() };
                let solved = self.solved(&trial.controls, &options, &mut workspace.solve)?;
                Ok(Some(after(solved, spent)))
            }
        }
    }

    /// Why the state of a trial lies on another branch than that of the point it started near, if it does: by the test of
    /// [`Stability::connection`](nastic_fem::views::Stability::connection), which follows the path where the solve met a tangent that is not positive definite.
    pub fn other_branch(&self, from: &Evaluated, to: &Evaluated) -> Option<ControlError> {
        let model = self.solid().model();
        if self.timeline().is_some() || !self.follows_paths() {
            return None;
        }
        let how = SolveOptions { budget: Some(FOLLOWED), ..self.solve_options(to.solved.accuracy) };
        match model.stability().connection(from.state(), to.state(), &how) {
            Err(error) if error.is_lack_of_memory() || matches!(error, StateError::Cancelled) => Some(error.into()),
            Err(_) => None,
            Ok(Connection::LimitPoint(share)) => {
                let limit = self.layout_in_stage(to.stage).limit_point([&from.m, &to.m], share);
                Some(ControlError::LimitPoint { limit, newton: to.work.newton })
            }
            Ok(Connection::Elsewhere(apart)) => Some(ControlError::OtherBranch { apart }),
            Ok(Connection::Connected | Connection::Unknown(_)) => None,
        }
    }

    /// Remembers a limit point, with the normal of the surface of limit points there.
    fn note(&self, at: &LimitAhead, near: &Evaluated, trial: &Trial<'_>, workspace: &mut ReducedWorkspace) {
        let mut instant = Instant::of(&at.state);
        instant.parallel = self.parallel;
        // a state that was found is admissible
        let Ok(by) = self.solid().model().vjp(&instant, &at.direction) else { return };
        let step = sub(trial.m, &near.m);
        let mut m = near.m.clone();
        axpy(at.share, &step, &mut m);
        let normal = self.layout_in_stage(trial.stage).control_vjp(&m, &by.controls);
        workspace.limits.add(at, &near.m, step, normal);
    }
}

/// Whether a solve may have failed for a limit point.
fn may_be_limit(error: &StateError) -> bool {
    matches!(error, StateError::NoConvergence { cause: Cause::LimitPoint { .. } | Cause::Unknown, .. })
}

/// Newton iterations of a solve that failed, where that is known.
fn iterations(error: &StateError) -> usize {
    if let StateError::NoConvergence { newton, .. } = error { *newton } else { 0 }
}

/// A state with work that was done before it was looked for.
fn after(mut state: State, spent: &SolveReport) -> State {
    state.report.add_work(spent);
    state
}
