//! [`Evaluated`]: one control with its equilibrium and cost, as a value and as bytes.

use crate::constraint::ConstraintPoint;
use crate::cost::CostPoint;
use nastic_fem::{Controls, Recording, SolveReport, State};
use nastic_opt::{Saved, SavedError};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// An evaluated control: its state and the values of the cost terms. A value; it holds no factor.
#[derive(Debug, Clone)]
pub struct Evaluated {
    /// The control vector.
    pub m: Vec<f64>,
    /// Its equilibrium, or its motion.
    pub solved: SolvedStates,
    /// Value of every cost term, weights included, in the order they were added.
    pub terms: Vec<f64>,
    /// Value of every constraint, in the order they were added.
    pub constraints: Vec<f64>,
    /// Continuation stage of the values.
    pub stage: usize,
    /// Work of the state solve.
    pub work: SolveReport,
    /// The adjoint state of the whole cost (under constraints of the augmented Lagrangian), once its derivative was taken.
    pub adjoint: Option<AdjointState>,
    /// The evaluated terms, for their partials and figures; empty where they are not kept, or the point was loaded.
    pub(crate) costs: Vec<Arc<dyn CostPoint>>,
    /// The evaluated constraints, likewise.
    pub(crate) constraint_points: Vec<Arc<dyn ConstraintPoint>>,
}

/// The states under one control, as they were solved: of a problem in time one for each instant, else one.
#[derive(Debug, Clone)]
pub struct SolvedStates {
    /// The states that are kept: by default all.
    pub recording: Recording,
    /// The relative accuracy that was asked of them.
    pub accuracy: f64,
    /// The smallest J at a quadrature point, over all states.
    pub min_j: f64,
    /// The step with the largest estimated error, of a scheme that estimates it.
    pub error: Option<StepError>,
    /// Whether it is a motion that went on from a place that an earlier program left: the states before are not there.
    pub resumed: bool,
}

impl SolvedStates {
    /// An equilibrium, solved to this relative accuracy.
    pub fn one(state: State, accuracy: f64) -> Self {
        let min_j = state.report.min_j;
        SolvedStates { recording: Recording::from(state), accuracy, min_j, error: None, resumed: false }
    }
}

/// The estimated error of a time step.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct StepError {
    /// What the step adds to the error of the displacement, the largest at any node, in the unit of length.
    pub error: f64,
    /// The end of the step.
    pub time: f64,
}

/// The adjoint displacement `K(u*) lambda = -d(j + y . c)/du` and the work of its solve.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct AdjointState {
    /// lambda, flat like the displacement.
    pub lambda: Vec<f64>,
    /// Work of the solve.
    pub work: SolveReport,
    /// The weights y of the constraints in what it is the adjoint of; empty where all are zero.
    pub multipliers: Vec<f64>,
}

impl Evaluated {
    /// The equilibrium; of a problem in time the state at the end.
    pub fn state(&self) -> &State {
        self.solved.recording.part().end()
    }

    /// Sum of the terms.
    pub fn cost(&self) -> f64 {
        self.terms.iter().sum()
    }

    /// The states: of a problem in time one for each instant, else the equilibrium alone. Of a motion that keeps few states
    /// ([`MotionMemory`](crate::MotionMemory)) those of the segment that was computed last; [`Reduced::for_each_state`](crate::Reduced::for_each_state)
    /// passes all.
    pub fn states(&self) -> &[State] {
        self.solved.recording.part().states()
    }

    /// The smallest J at a quadrature point, over all states.
    pub fn min_j(&self) -> f64 {
        self.solved.min_j
    }

    /// The adjoint displacement, once the derivative was taken.
    pub fn adjoint(&self) -> Option<&[f64]> {
        self.adjoint.as_ref().map(|adjoint| adjoint.lambda.as_slice())
    }

    /// Work of the state solve and, if there is one, of the adjoint.
    pub fn total_work(&self) -> SolveReport {
        let mut work = self.work;
        if let Some(adjoint) = &self.adjoint {
            work.add_work(&adjoint.work);
        }
        work
    }

    /// All but the control vector, as bytes.
    pub(crate) fn to_bytes(&self) -> Vec<u8> {
        let Evaluated { stage, work, .. } = *self;
        // they follow from the control vector
        let state = State { controls: Arc::default(), ..self.state().clone() };
        let (terms, constraints, adjoint) = (self.terms.clone(), self.constraints.clone(), self.adjoint.clone());
        SavedEvaluation { stage, terms, constraints, accuracy: self.solved.accuracy, state, work, adjoint }.to_bytes()
    }

    /// The point that [`to_bytes`](Self::to_bytes) wrote, of a motion with its last state alone; `controls` are those that `m` has at the points.
    pub(crate) fn from_bytes(
        bytes: &[u8],
        m: &[f64],
        controls: Controls,
        expected: Expected,
    ) -> Result<Self, SavedError> {
        let SavedEvaluation { stage, terms, constraints, accuracy, state, work, adjoint } = Saved::from_bytes(bytes)?;
        if (stage, terms.len(), state.u.len()) != (expected.stage, expected.terms, expected.dofs) {
            return Err(SavedError::Unfit("a point of another stage, with other cost terms or on another mesh"));
        }
        if constraints.len() != expected.constraints {
            return Err(SavedError::Unfit("a point with other constraints"));
        }
        if adjoint.as_ref().is_some_and(|adjoint| adjoint.lambda.len() != expected.dofs) {
            return Err(SavedError::Unfit("an adjoint state on another mesh"));
        }
        let solved = SolvedStates::one(State { controls: Arc::new(controls), ..state }, accuracy);
        let (m, costs, constraint_points) = (m.to_vec(), vec![], vec![]);
        Ok(Evaluated { m, solved, terms, constraints, stage, work, adjoint, costs, constraint_points })
    }
}

/// What is saved of it.
#[derive(Serialize, Deserialize)]
struct SavedEvaluation {
    stage: usize,
    terms: Vec<f64>,
    constraints: Vec<f64>,
    accuracy: f64,
    state: State,
    work: SolveReport,
    adjoint: Option<AdjointState>,
}

impl Saved for SavedEvaluation {
    const KIND: &'static str = "nastic-point-8";
}

/// What a saved point must agree with.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Expected {
    pub stage: usize,
    pub terms: usize,
    pub constraints: usize,
    pub dofs: usize,
}
