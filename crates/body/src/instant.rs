//! [`Instant`]: where contributions are evaluated.

use crate::controls::Controls;
use crate::history::History;
use crate::state::State;
use nastic_linear::Space;
use std::sync::Arc;

/// The unknowns and everything prescribed, at one instant.
#[derive(Clone, Copy)]
pub struct Instant<'a> {
    /// Displacement, flat; behind it the multipliers of all constraints.
    pub u: &'a [f64],
    /// The controls of all contributions.
    pub controls: &'a Controls,
    /// Multiple of the dead loads and prescribed displacements, 1 for an answer.
    pub load: f64,
    /// The time step that ends here; `None` of a static problem.
    pub step: Option<&'a TimeStep>,
    /// Whether to use all threads; the bits are the same.
    pub parallel: bool,
    /// Whether tangents leave out the curvature of contacts, `p d^2 d/du^2` with the gap d, which is indefinite.
    pub flat_contacts: bool,
    /// Internal variables outside of a time step: those of a state.
    pub remembered: &'a History,
    /// What sums over vectors of unknowns.
    pub space: &'a Space,
    /// Index of the contribution's own block of controls.
    pub block: usize,
    /// Index in u of the contribution's own first multiplier.
    pub scalar: usize,
    /// Index of the contribution's own block of internal variables.
    pub memory: usize,
}

impl<'a> Instant<'a> {
    /// A static instant.
    pub fn new(u: &'a [f64], controls: &'a Controls, load: f64) -> Self {
        let (remembered, scalar) = (History::relaxed(), u.len());
        Instant {
            u,
            controls,
            load,
            step: None,
            parallel: false,
            flat_contacts: false,
            remembered,
            space: Space::LOCAL,
            block: 0,
            scalar,
            memory: 0,
        }
    }

    /// That of a state, the internal variables with it.
    pub fn of(state: &'a State) -> Self {
        Instant { remembered: &state.history, ..Instant::new(&state.u, &state.controls, state.load) }
    }

    /// The same in a time step, with the internal variables that it begins with.
    #[must_use]
    #[inline]
    pub fn in_step(self, step: &'a TimeStep) -> Self {
        Instant { step: Some(step), ..self }
    }

    /// The same under other controls.
    #[must_use]
    #[inline]
    pub fn under(self, controls: &'a Controls) -> Self {
        Instant { controls, ..self }
    }

    /// The internal variables that the time step which ends here began with, or those of a state.
    #[inline]
    pub fn history(&self) -> &'a History {
        self.step.map_or(self.remembered, |step| &step.history)
    }

    /// The internal variables of the contribution that is asked; none where nothing was remembered yet.
    #[inline]
    pub fn internal(&self) -> &'a [f64] {
        self.history().values(self.memory)
    }

    /// The state that the time step begins at; `None` in a static problem.
    #[inline]
    pub fn before(&self) -> Option<&'a State> {
        self.step.map(|step| &step.before)
    }

    /// The value of a slot of the contribution that is asked.
    #[inline]
    pub fn control(&self, slot: usize) -> f64 {
        self.controls.values(self.block)[slot]
    }

    /// The value of a slot at a [point](crate::contribution::Contribution::control_points) of the contribution that is asked.
    #[inline]
    pub fn control_at(&self, point: usize, slot: usize) -> f64 {
        self.slot_at(self.controls, point, slot)
    }

    /// The same in other controls of the same model.
    #[inline]
    pub fn slot_at(&self, controls: &Controls, point: usize, slot: usize) -> f64 {
        controls.values(self.block)[point * controls.slots(self.block) + slot]
    }

    /// MaterialPoint of a multiplier of the contribution that is asked, in u and in all vectors of its length.
    #[inline]
    pub fn place(&self, multiplier: usize) -> usize {
        self.scalar + multiplier
    }

    /// A multiplier of the contribution that is asked; not a number where u is that of a model without it.
    #[inline]
    pub fn multiplier(&self, multiplier: usize) -> f64 {
        self.u.get(self.place(multiplier)).copied().unwrap_or(f64::NAN)
    }

    /// The value of a slot of the contribution that is asked, in other controls of the same model.
    #[inline]
    pub fn slot_of(&self, controls: &Controls, slot: usize) -> f64 {
        controls.values(self.block)[slot]
    }

    /// Velocity: zero in a static problem.
    #[inline]
    pub fn velocity(&self, dof: usize) -> f64 {
        self.step.map_or(0.0, |step| step.velocity.0 * self.u[dof] + step.velocity.1[dof])
    }

    /// Acceleration: zero in a static problem.
    #[inline]
    pub fn acceleration(&self, dof: usize) -> f64 {
        self.step.map_or(0.0, |step| step.acceleration.0 * self.u[dof] + step.acceleration.1[dof])
    }
}

/// A step from one instant to the next. The scheme gives `v = c_v u + b_v` and `a = c_a u + b_a`; inertia and damping use
/// only these.
#[derive(Debug, Clone)]
pub struct TimeStep {
    /// Length.
    pub dt: f64,
    /// `c_v` and `b_v`.
    pub velocity: (f64, Vec<f64>),
    /// `c_a` and `b_a`.
    pub acceleration: (f64, Vec<f64>),
    /// Time from its beginning to the stage that this belongs to.
    pub elapsed: f64,
    /// Where the normal forces and tangent planes of friction are taken, instead of the displacement: on the way to a step that is not found at
    /// once.
    pub lag: Option<FrictionLag>,
    /// The state before.
    pub before: State,
    /// The internal variables that it begins with.
    pub history: Arc<History>,
    /// Where the end is extrapolated from the stage that this belongs to: what the prescribed unknowns follow from.
    pub end: Option<ExtrapolatedEnd>,
}

/// A displacement and controls at which the normal forces of friction are taken, so that what is left of it has a potential.
#[derive(Debug, Clone)]
pub struct FrictionLag {
    /// Displacement.
    pub u: Arc<Vec<f64>>,
    /// Controls.
    pub controls: Arc<Controls>,
    /// What slip speeds are multiplied by.
    pub smoothing: f64,
}

/// The end of a step whose displacement is `u = alpha w + b`, w that of its stage: prescribed unknowns are in their place at the end, so
/// that `w_D = (u_D(m) - b)/alpha` with the controls m of the end.
#[derive(Debug, Clone)]
pub struct ExtrapolatedEnd {
    /// Factor of the displacement of the stage.
    pub alpha: f64,
    /// b
    pub rest: Vec<f64>,
    /// m
    pub controls: Controls,
}

impl TimeStep {
    /// Backward Euler: `v = (u - u_n) / dt`, `a = (v - v_n) / dt`.
    pub fn backward_euler(before: &State, dt: f64) -> Self {
        let velocity: Vec<f64> = before.u.iter().map(|u| -u / dt).collect();
        let v = before.velocity.as_deref();
        let acceleration = velocity.iter().enumerate().map(|(i, b)| (b - v.map_or(0.0, |v| v[i])) / dt).collect();
        let (c_v, c_a) = (1.0 / dt, 1.0 / (dt * dt));
        let (velocity, acceleration, history) = ((c_v, velocity), (c_a, acceleration), Arc::default());
        TimeStep { dt, velocity, acceleration, elapsed: dt, lag: None, before: before.clone(), history, end: None }
    }

    /// The step that led from one state to the next one, whose velocity and acceleration are what that carries: to ask for forces and
    /// quantities there, not for derivatives.
    pub fn between(before: &State, after: &State) -> Self {
        let rate = |values: &Option<Arc<Vec<f64>>>| match values {
            Some(values) => (0.0, values.to_vec()),
            None => (0.0, vec![0.0; after.u.len()]),
        };
        let (dt, history) = (after.time - before.time, after.history.clone());
        let (velocity, acceleration) = (rate(&after.velocity), rate(&after.acceleration));
        let before = before.clone();
        TimeStep { dt, velocity, acceleration, elapsed: dt, lag: None, before, history, end: None }
    }

    /// The velocity at a displacement.
    pub fn velocity_at(&self, u: &[f64]) -> Vec<f64> {
        u.iter().zip(&self.velocity.1).map(|(u, b)| self.velocity.0 * u + b).collect()
    }

    /// The acceleration at a displacement.
    pub fn acceleration_at(&self, u: &[f64]) -> Vec<f64> {
        u.iter().zip(&self.acceleration.1).map(|(u, b)| self.acceleration.0 * u + b).collect()
    }
}
