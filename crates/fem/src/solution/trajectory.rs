//! [`Trajectory`]: the states of a problem in time, one after the other; of a static problem, one.

use crate::contributions::controls::Controls;
use crate::contributions::instant::TimeStep;
use crate::error::{FemError, StateError};
use crate::model::Model;
use crate::solution::options::SolveOptions;
use crate::solution::state::State;
use crate::solution::workspace::Workspace;
use std::sync::Arc;

/// States one after the other, at least one.
#[derive(Debug, Clone)]
pub struct Trajectory {
    begin: Begin,
    states: Vec<State>,
    /// Lengths of the steps between them.
    steps: Vec<f64>,
}

/// What the first state is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Begin {
    /// The equilibrium under its controls: it depends on them.
    Equilibrium,
    /// Given: it depends on nothing.
    Given,
}

/// A step to another instant.
#[derive(Debug, Clone)]
pub struct StepTo {
    /// Length of the step.
    pub dt: f64,
    /// Controls at its end.
    pub controls: Controls,
}

impl From<State> for Trajectory {
    /// A static problem: its equilibrium.
    fn from(state: State) -> Self {
        Trajectory { begin: Begin::Equilibrium, states: vec![state], steps: Vec::new() }
    }
}

impl Trajectory {
    /// One that begins at a state that is given.
    pub fn from_given(state: State) -> Self {
        Trajectory { begin: Begin::Given, states: vec![state], steps: Vec::new() }
    }

    /// What the first state is.
    pub fn begin(&self) -> Begin {
        self.begin
    }

    /// The states, the first one included.
    pub fn states(&self) -> &[State] {
        &self.states
    }

    /// The last state: the answer of a static problem.
    pub fn end(&self) -> &State {
        &self.states[self.states.len() - 1]
    }

    /// The step that led to the n-th state; `None` for the first, and where there is no such state.
    pub fn step(&self, n: usize) -> Option<TimeStep> {
        let before = n.checked_sub(1)?;
        Some(TimeStep::backward_euler(&self.states[before], *self.steps.get(before)?))
    }
}

impl Model {
    /// Goes on from the end of a trajectory by steps of backward Euler, each an equilibrium with the velocities and
    /// accelerations that the scheme gives; at full dead loads. Each begins at the state before: `near` and `guess` of the
    /// options are not used.
    ///
    /// # Errors
    /// A step that is not positive; a [`StateError`] at the first step that has no solution.
    pub fn advance(
        &self,
        trajectory: &mut Trajectory,
        steps: &[StepTo],
        how: &SolveOptions,
        workspace: &mut Workspace,
    ) -> Result<(), StateError> {
        self.check()?;
        self.refuse_constraints("a step in time", "drive it by a force or a pressure")?;
        for to in steps {
            if !(to.dt.is_finite() && to.dt > 0.0) {
                let what = format!("a time step of {} is not positive", to.dt);
                return Err(FemError::Meaningless { what }.into());
            }
            self.check_controls(&to.controls)?;
            let before = trajectory.end();
            let step = TimeStep::backward_euler(before, to.dt);
            let options = SolveOptions { near: Some(before), guess: None, ..how.clone() };
            let mut state = self.find(&to.controls, &options, Some(&step), workspace)?;
            state.time = before.time + to.dt;
            state.velocity = Some(Arc::new(step.velocity_at(&state.u)));
            let at = self.instant(&state, Some(&step), how.parallel);
            let last = Box::new(before.clone());
            let internal = self.commit(&at).map_err(|at| StateError::Inverted { at, load: 1.0, cuts: 0, last })?;
            state.internal = Arc::new(internal);
            trajectory.states.push(state);
            trajectory.steps.push(to.dt);
        }
        Ok(())
    }
}
