//! The acceleration of a state that does not carry one, and its adjoint.

use nastic_body::contribution::Demand;
use nastic_body::controls::Controls;
use nastic_body::error::{FemError, Inadmissible, StateError};
use nastic_body::history::History;
use nastic_body::instant::{Instant, TimeStep};
use nastic_body::state::State;
use nastic_equilibrium::model::Model;
use nastic_linear::{CgEnd, Preconditioner, conjugate_gradient};
use std::sync::Arc;

/// Relative residual of conjugate gradients: with the diagonal as preconditioner the condition number of a mass matrix
/// depends on the kind of cells alone (Wathen, IMA J. Numer. Anal. 7, 1987).
const RESIDUAL_TOLERANCE: f64 = 1e-15;
/// Iterations of conjugate gradients.
const MAX_ITERATIONS: usize = 1000;

struct Diagonal(Vec<f64>);

impl Preconditioner for Diagonal {
    fn apply(&self, vector: &mut [f64]) {
        vector.iter_mut().zip(&self.0).for_each(|(v, d)| *v /= d);
    }
}

/// `M a = -r(u, v, 0)` at full dead loads, a = 0 on the supports, on those that move too: whatever their acceleration is, its force
/// `M_FD a_D` on the free unknowns F is in balance with `M_FF a_F`.
pub(crate) fn initial_acceleration(
    model: &Model,
    state: &State,
    history: &History,
    parallel: bool,
) -> Result<Vec<f64>, StateError> {
    let moves = state.velocity.iter().flat_map(|v| v.iter()).any(|v| *v != 0.0);
    if moves && !model.body.is_known_at_instants() {
        let what = "this time scheme begins with an acceleration, which Kelvin-Voigt damping does not give for a body that moves \
                    already; begin at rest, or take backward Euler";
        return Err(FemError::Meaningless { what: what.to_owned() }.into());
    }
    let state = &at_instant(model, state, history);
    let step = without_acceleration(state);
    let at = beginning(model, state, &step, parallel);
    let last = |at: Inadmissible| StateError::inadmissible(at, 1.0, 0, Box::new(state.clone()));
    let sums = model.evaluate(&at, Demand { energy: false, force: true }).map_err(last)?;
    divide_by_mass(model, &state.controls, sums.force.iter().map(|f| -f).collect(), parallel)
}

/// A state with the internal variables behind it, in a step without length.
pub(crate) fn at_instant(model: &Model, state: &State, history: &History) -> State {
    State { history: Arc::new(model.memory().history_of_step(history, 0.0)), ..state.clone() }
}

/// `M^-1 b` on the free unknowns, M under these controls; multipliers, whose forces b holds as they are, have none.
pub(crate) fn divide_by_mass(
    model: &Model,
    controls: &Controls,
    mut b: Vec<f64>,
    parallel: bool,
) -> Result<Vec<f64>, StateError> {
    let mut mass = model.energies().mass_under(controls)?;
    mass.tie(model.supports.ties(), 1.0);
    let unknowns = b.len();
    b.truncate(model.discretization().dofs());
    let mut diagonal = mass.diagonal();
    model.supports.fixed().iter().zip(&mut diagonal).filter(|(fixed, _)| **fixed).for_each(|(_, m)| *m = 1.0);
    if let Some(dof) = diagonal.iter().position(|m| !(m.is_finite() && *m > 0.0)) {
        let node = dof / model.discretization().dim();
        let what = format!(
            "this time scheme begins with an acceleration, but node {node} has no mass; add an inertia, or begin \
             with backward Euler"
        );
        return Err(FemError::Meaningless { what }.into());
    }
    model.supports.restrict(&mut b);
    let product = |v: &[f64], out: &mut [f64]| {
        mass.multiply_on(v, out, parallel);
        model.supports.clear(out);
    };
    let mut x = vec![0.0; b.len()];
    let report = conjugate_gradient(&product, &Diagonal(diagonal), &b, &mut x, RESIDUAL_TOLERANCE, MAX_ITERATIONS);
    match report.end {
        CgEnd::Converged | CgEnd::Stagnated => {
            model.supports.extend(&mut x);
            x.resize(unknowns, 0.0);
            Ok(x)
        }
        end => {
            let what = format!("the mass matrix is not positive definite (conjugate gradients: {end:?})");
            Err(FemError::Meaningless { what }.into())
        }
    }
}

/// Where a motion begins: at full dead loads.
pub(crate) fn beginning<'a>(model: &Model, state: &'a State, step: &'a TimeStep, parallel: bool) -> Instant<'a> {
    Instant { load: 1.0, ..model.instant(state, Some(step), parallel) }
}

/// The velocity of a state, which does not depend on its displacement, and no acceleration.
pub(crate) fn without_acceleration(state: &State) -> TimeStep {
    let zero = vec![0.0; state.u.len()];
    let velocity = state.velocity.as_deref().unwrap_or(&zero).clone();
    let (before, history) = (state.clone(), state.history.clone());
    TimeStep {
        dt: 0.0,
        velocity: (0.0, velocity),
        acceleration: (0.0, zero),
        elapsed: 0.0,
        lag: None,
        before,
        history,
        end: None,
    }
}
