//! [`Trajectory`]: the states of a problem in time, one after the other; of a static problem, one.

use crate::scheme::Scheme;
use crate::step::MAX_PARTS;
use nastic_body::controls::Controls;
use nastic_body::error::FemError;
use nastic_body::state::State;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// States one after the other, at least one, and what led from each to the next.
#[derive(Debug, Clone)]
pub struct Trajectory {
    begin: Begin,
    /// The number of its first state in the motion that it is a part of.
    first: usize,
    states: Vec<State>,
    steps: Vec<Step>,
}

/// What the first state is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Begin {
    /// The equilibrium under its controls: it depends on them.
    Equilibrium,
    /// Given: it depends on nothing.
    Given,
}

/// A step that was made: what its adjoint needs beside the states at its ends.
#[derive(Debug, Clone)]
pub(crate) struct Step {
    pub dt: f64,
    pub scheme: Arc<Scheme>,
    /// The displacements of its stages.
    pub stages: Vec<Arc<Vec<f64>>>,
    /// The acceleration at its beginning, where the state there did not carry the one that was needed.
    pub started: Option<Arc<Vec<f64>>>,
}

/// A step to another instant.
#[derive(Debug, Clone)]
pub struct StepTo {
    /// Length of the step.
    pub dt: f64,
    /// Controls at its end; in the step they are interpolated linearly.
    pub controls: Controls,
}

/// A step that was made, written down beside the states at its ends.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct StepRecord {
    /// Length of the step.
    pub dt: f64,
    /// Whether it was made by the scheme of first steps, of a scheme that has one.
    pub starts: bool,
    /// How many steps of the scheme it was made as: more than one where it had no solution at once.
    pub parts: usize,
    /// The displacements of its stages.
    pub stages: Vec<Arc<Vec<f64>>>,
    /// The acceleration at its beginning, where the state there did not carry the one that was needed.
    pub started: Option<Arc<Vec<f64>>>,
}

impl From<State> for Trajectory {
    /// A static problem: its equilibrium.
    fn from(state: State) -> Self {
        Trajectory { begin: Begin::Equilibrium, first: 0, states: vec![state], steps: Vec::new() }
    }
}

impl Trajectory {
    /// One that begins at a state that is given: its displacement and velocity, and its acceleration, where it has
    /// one, depend on nothing.
    pub fn from_given(state: State) -> Self {
        Trajectory { begin: Begin::Given, first: 0, states: vec![state], steps: Vec::new() }
    }

    /// What the first state of the motion is.
    pub fn begin(&self) -> Begin {
        self.begin
    }

    /// The number of its first state in the motion: 0 unless it is a part of one that keeps few states (see
    /// [`Recording`](crate::recording::Recording)).
    pub fn first(&self) -> usize {
        self.first
    }

    /// The states, the first one included.
    pub fn states(&self) -> &[State] {
        &self.states
    }

    /// The last state: the answer of a static problem.
    pub fn end(&self) -> &State {
        &self.states[self.states.len() - 1]
    }

    /// The scheme that led to the n-th state; `None` for the first, and where there is no such state.
    pub fn scheme(&self, n: usize) -> Option<&Scheme> {
        Some(&self.steps.get(n.checked_sub(1)?)?.scheme)
    }

    /// Its first state alone.
    #[must_use]
    pub fn beginning(&self) -> Trajectory {
        Trajectory { begin: self.begin, first: self.first, states: self.states[..1].to_vec(), steps: Vec::new() }
    }

    /// The last step, of a motion by this scheme; none where no step was made.
    pub fn last_step(&self, scheme: &Scheme) -> Option<StepRecord> {
        let step = self.steps.last()?;
        let (Step { dt, stages, started, .. }, parts) = (step.clone(), step.scheme.parts);
        let starts = scheme.start().is_some_and(|start| start.name == step.scheme.name);
        Some(StepRecord { dt, starts, parts, stages, started })
    }

    /// The [end](Self::tail) of a saved motion by a scheme, from which it continues with the same bits: its last states,
    /// the first of which has this number, and the step between them where there are two.
    ///
    /// # Errors
    /// No state, more than two, a step without two of them; vectors of different lengths, or a number of stages that is not the scheme's.
    pub fn from_end(
        begin: Begin,
        first: usize,
        states: Vec<State>,
        step: Option<StepRecord>,
        scheme: &Scheme,
    ) -> Result<Self, FemError> {
        let whole = match &step {
            Some(StepRecord { starts: true, .. }) => scheme.start().unwrap_or(scheme),
            _ => scheme,
        };
        let made_by = match &step {
            Some(StepRecord { parts, .. }) if *parts != 1 => {
                Some(*parts).filter(|n| n.is_power_of_two() && *n <= MAX_PARTS).and_then(|n| whole.in_parts(n))
            }
            _ => Some(whole.clone()),
        };
        let Some(made_by) = made_by else {
            let what = format!("a step of {} in several parts", whole.name());
            return Err(FemError::Meaningless { what });
        };
        let len = states.first().map_or(0, |state| state.u.len());
        let rates = |state: &State| state.velocity.iter().chain(&state.acceleration).all(|rate| rate.len() == len);
        let of_step = step.iter().flat_map(|step| step.stages.iter().chain(&step.started));
        let fits = states.len() == 1 + usize::from(step.is_some())
            && states.iter().all(|state| state.u.len() == len && rates(state))
            && of_step.clone().all(|vector| vector.len() == len)
            && step.as_ref().is_none_or(|step| step.stages.len() == made_by.stages() && step.dt > 0.0);
        if !fits {
            let what = "the end of a motion whose states and last step do not fit each other".to_owned();
            return Err(FemError::Meaningless { what });
        }
        let scheme = Arc::new(made_by);
        let made = |StepRecord { dt, stages, started, .. }| Step { dt, scheme, stages, started };
        Ok(Trajectory { begin, first, states, steps: step.map(made).into_iter().collect() })
    }

    /// The end of it, with as much before as a step from there takes: of a scheme over two steps the last step too.
    #[must_use]
    pub fn tail(&self, scheme: &Scheme) -> Trajectory {
        let steps = self.steps.len().min(usize::from(scheme.start().is_some()));
        let from = self.steps.len() - steps;
        let (states, steps) = (self.states[from..].to_vec(), self.steps[from..].to_vec());
        Trajectory { begin: self.begin, first: self.first + from, states, steps }
    }

    pub(crate) fn steps(&self) -> &[Step] {
        &self.steps
    }

    pub(crate) fn push(&mut self, step: Step, state: State) {
        self.steps.push(step);
        self.states.push(state);
    }
}
