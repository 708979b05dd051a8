//! The discrete adjoint of a trajectory, from its end to its beginning.

use crate::initial_acceleration::at_instant;
use crate::initial_acceleration::beginning;
use crate::initial_acceleration::divide_by_mass;
use crate::initial_acceleration::without_acceleration;
use crate::instant_adjoint::{InstantAdjoint, StatePartials, add};
use crate::points::Points;
use crate::scheme::{Quantity, Stage, Term, TermInstant};
use crate::supported::supports_motion_adjoint;
use crate::trajectory::{Begin, Trajectory};
use nastic_body::contribution::sensitivities::{Increment, Sensitivities};
use nastic_body::controls::Controls;
use nastic_body::error::{FemError, StateError};
use nastic_body::history::{BeforeStep, History};
use nastic_body::instant::{Instant, TimeStep};
use nastic_body::state::{SolveReport, State};
use nastic_equilibrium::adjoint::inverted;
use nastic_equilibrium::linear_systems::tangent_systems::TangentSystems;
use nastic_equilibrium::linear_systems::workspace::Workspace;
use nastic_equilibrium::model::Model;
use nastic_equilibrium::search::options::SolveOptions;
use nastic_numeric::vector::axpy;
use std::mem::{replace, take};
use std::sync::Arc;

/// Instants of the step that is swept.
const END: usize = 0;
const BEGIN: usize = 1;
const BEFORE: usize = 2;

/// What a reverse sweep finds.
#[derive(Debug, Clone)]
pub struct Swept {
    /// Adjoint displacement of every instant (of the last stage of the step that leads there), flat, zero on the
    /// supports; empty where the state was given.
    pub lambda: Vec<Vec<f64>>,
    /// Derivative of the functional by the controls of every instant, through the states.
    pub controls: Vec<Controls>,
    /// Work done.
    pub report: SolveReport,
}

/// What a reverse sweep finds at one instant.
#[derive(Debug, Clone)]
pub struct SweptInstant {
    /// Adjoint displacement (of the last stage of the step that leads there), flat, zero on the supports; empty where the state was
    /// given.
    pub lambda: Vec<f64>,
    /// Derivative of the functional by the controls of the instant, through the states.
    pub controls: Controls,
}

/// A reverse sweep that is given the steps of a motion one by one, from the last to the first, and then its beginning: see
/// [`TimeStepping::reverse_sweep`](crate::TimeStepping::reverse_sweep). It holds the sensitivities by three instants, and no states.
#[derive(Debug)]
pub struct ReverseSweep<'a> {
    model: &'a Model,
    how: &'a SolveOptions<'a>,
    workspace: &'a mut Workspace,
    /// By the states at the end and at the beginning of the step that is swept, and before it.
    adjoints: [InstantAdjoint; 3],
    /// By the controls at its end and at its beginning.
    controls: [Controls; 2],
    /// By the internal variables of the step that is swept, and of the one behind it through them.
    history: History,
    report: SolveReport,
}

/// [`TimeStepping::reverse_sweep`](crate::TimeStepping::reverse_sweep).
pub(crate) fn reverse_sweep(
    model: &Model,
    trajectory: &Trajectory,
    partials: &[StatePartials],
    how: &SolveOptions,
    workspace: &mut Workspace,
) -> Result<Swept, StateError> {
    let states = trajectory.states().len();
    if partials.len() != states {
        let what = "partial derivatives by instant".to_owned();
        return Err(FemError::Length { what, found: partials.len(), expected: states }.into());
    }
    let mut sweep = ReverseSweep::new(model, how, workspace);
    let (mut lambda, mut controls) = (Vec::new(), Vec::new());
    let mut found = |at: SweptInstant| {
        lambda.push(at.lambda);
        controls.push(at.controls);
    };
    for k in (0..trajectory.steps().len()).rev() {
        found(sweep.step(trajectory, k, partials[k + 1].clone())?);
    }
    let (first, report) = sweep.begin(trajectory, partials[0].clone())?;
    found(first);
    lambda.reverse();
    controls.reverse();
    Ok(Swept { lambda, controls, report })
}

impl<'a> ReverseSweep<'a> {
    /// One that stands at the end of a motion.
    pub fn new(model: &'a Model, how: &'a SolveOptions<'a>, workspace: &'a mut Workspace) -> Self {
        let controls = [model.zero_controls(), model.zero_controls()];
        let report = SolveReport::default();
        ReverseSweep {
            model,
            how,
            workspace,
            adjoints: Default::default(),
            controls,
            history: History::default(),
            report,
        }
    }

    /// The k-th step of a part of the motion, the one before the step that was swept last, with the partial derivatives at its end.
    ///
    /// # Errors
    /// As [`TimeStepping::reverse_sweep`](crate::TimeStepping::reverse_sweep); a step that is not there.
    pub fn step(&mut self, part: &Trajectory, k: usize, by_end: StatePartials) -> Result<SweptInstant, StateError> {
        let (states, Some(step)) = (part.states(), part.steps().get(k)) else {
            let what = format!("the adjoint of step {k} of a trajectory of {}", part.steps().len());
            return Err(FemError::Meaningless { what }.into());
        };
        let (begin, end, h) = (&states[k], &states[k + 1], step.dt);
        supports_motion_adjoint(self.model, &step.scheme)?;
        self.check(end)?;
        self.check(begin)?;
        self.add_partials(&by_end)?;
        if !by_end.held.is_empty() && !step.scheme.ends_at_its_last_stage() {
            let what = format!(
                "the derivative of a reaction under the scheme {}, whose steps end at no stage",
                step.scheme.name()
            );
            return Err(FemError::Meaningless { what }.into());
        }
        let before = k.checked_sub(1).map(|k| &states[k]);
        let history = self.model.memory().next_history(begin, self.how.parallel).map_err(|at| inverted(at, begin))?;
        let mut points =
            Points::new(&step.scheme, h, begin, before, step.started.as_ref(), self.model.discretization().dofs());
        let mut time_steps = Vec::new();
        for (u, stage) in step.stages.iter().zip(&step.scheme.stages) {
            let of_stage = Arc::new(self.model.memory().history_of_step(&history, stage.time * h));
            let time_step = TimeStep { history: of_stage, ..points.next(&end.controls) };
            points.found(u.clone(), &time_step);
            time_steps.push(time_step);
        }
        let mut stages = vec![InstantAdjoint::default(); step.stages.len()];
        let mut of_end = take(&mut self.adjoints[0]);
        for (of, terms) in step.scheme.end.combinations() {
            let adjoints = take(of_end.of(of));
            terms.iter().for_each(|term| self.pass(term.scaled(of, h), term, &adjoints, &mut stages));
        }
        let mut of_last = Vec::new();
        for (k, stage) in step.scheme.stages.iter().enumerate().rev() {
            let mut adjoints = take(&mut stages[k]);
            // forces at held unknowns are those of the last stage
            let held: &[f64] = if k + 1 == step.stages.len() { &by_end.held } else { &[] };
            if adjoints.is_zero() && held.is_empty() {
                continue;
            }
            let time_step = &time_steps[k];
            let InstantAdjoint { u: mut by_u, velocity, acceleration } = adjoints.clone();
            add(time_step.velocity.0, &velocity, &mut by_u);
            add(time_step.acceleration.0, &acceleration, &mut by_u);
            let controls = begin.controls.blend(&end.controls, stage.time);
            let u = if step.scheme.is_linearised() { &begin.u } else { &step.stages[k] };
            let at = Instant { parallel: self.how.parallel, ..Instant::new(u, &controls, 1.0) };
            let at = at.in_step(time_step);
            self.add_held(&at, held, &mut by_u, end)?;
            let lambda = self.solve(&at, &by_u, end)?;
            let mut by = self.model.vjp(&at, &sum(&lambda, held)).map_err(|at| inverted(at, end))?;
            if step.scheme.is_linearised() {
                self.linearisation(&at, &lambda, &step.stages[k], &mut by.controls)?;
            }
            if let Some(force) = self
                .model
                .prescribed_unknowns()
                .prescribed_force(&at, &by_u, &lambda)
                .map_err(|at| inverted(at, end))?
            {
                match step.scheme.extrapolation(k) {
                    None => self.model.prescribed_unknowns().add_prescribed_vjp(&at, &force, &mut by),
                    Some((alpha, rest)) => {
                        let force: Vec<f64> = force.iter().map(|f| f / alpha).collect();
                        self.end_holds(&force, end);
                        rest.iter().for_each(|term| {
                            self.pass(-term.scaled(Quantity::Displacement, h), term, &force, &mut stages)
                        });
                    }
                }
            }
            self.take_before(by.before);
            self.add_controls(END, stage.time, &by.controls);
            self.add_controls(BEGIN, 1.0 - stage.time, &by.controls);
            add(1.0, &by.velocity, &mut adjoints.velocity);
            add(1.0, &by.acceleration, &mut adjoints.acceleration);
            self.pass_rates(stage, k, h, adjoints, &mut stages);
            if k + 1 == step.stages.len() {
                of_last = lambda;
            }
        }
        of_last.resize(self.model.unknowns().len(), 0.0);
        if let Some(acceleration) = &step.started {
            self.start(begin, acceleration, &history)?;
        }
        self.pass_history(begin)?;
        self.adjoints.rotate_left(1);
        Ok(self.swept(of_last))
    }

    /// The first state of the motion, with the partial derivatives there, and the work of the whole sweep.
    ///
    /// # Errors
    /// As [`TimeStepping::reverse_sweep`](crate::TimeStepping::reverse_sweep).
    pub fn begin(
        mut self,
        part: &Trajectory,
        by_begin: StatePartials,
    ) -> Result<(SweptInstant, SolveReport), StateError> {
        let state = &part.states()[0];
        self.check(state)?;
        self.add_partials(&by_begin)?;
        let lambda = match part.begin() {
            Begin::Equilibrium => self.equilibrium(state, &by_begin.held)?,
            Begin::Given => {
                self.given(state, &by_begin.held)?;
                Vec::new()
            }
        };
        Ok((self.swept(lambda), self.report))
    }

    /// What was found at the instant at the end, which is left behind.
    fn swept(&mut self, lambda: Vec<f64>) -> SweptInstant {
        let before = replace(&mut self.controls[BEGIN], self.model.zero_controls());
        SweptInstant { lambda, controls: replace(&mut self.controls[END], before) }
    }

    fn check(&self, state: &State) -> Result<(), StateError> {
        self.model.checks().check_state(state)
    }

    fn add_partials(&mut self, partials: &StatePartials) -> Result<(), StateError> {
        let expected = self.model.unknowns().len();
        let lengths = [partials.u.len(), partials.velocity.len(), partials.held.len()];
        if let Some(found) = lengths.into_iter().find(|found| ![0, expected].contains(found)) {
            let what = "partial derivatives of a state".to_owned();
            return Err(FemError::Length { what, found, expected }.into());
        }
        self.adjoints[END].add_partials(partials);
        Ok(())
    }

    /// Of `r(u_n) + K(u_n) (w - u_n) = 0`: the derivative through the dependence of K on `u_n` and on the controls.
    fn linearisation(&mut self, at: &Instant, lambda: &[f64], w: &[f64], by: &mut Controls) -> Result<(), StateError> {
        let change: Vec<f64> = w.iter().zip(at.u).map(|(w, u)| w - u).collect();
        let along = Increment { u: &change, controls: &self.model.zero_controls() };
        let second = self.model.second_vjp(at, lambda, &along)?;
        (0..by.len()).for_each(|block| axpy(1.0, second.controls.values(block), by.values_mut(block)));
        add(1.0, &second.u, &mut self.adjoints[BEGIN].u);
        Ok(())
    }

    /// The derivative by the controls of the end of a step by the unknowns that they hold there.
    fn end_holds(&mut self, force: &[f64], end: &State) {
        let at = Instant { load: 1.0, ..Instant::of(end) };
        let mut by = Sensitivities::zero(self.model.controls(), &at);
        self.model.prescribed_unknowns().add_prescribed_vjp(&at, force, &mut by);
        self.add_controls(END, 1.0, &by.controls);
    }

    /// Takes the derivative by the state that the step begins at, and to the internal variables that it begins with.
    fn take_before(&mut self, before: BeforeStep) {
        if before.u.iter().any(|d| *d != 0.0) {
            add(1.0, &before.u, &mut self.adjoints[BEGIN].u);
        }
        if (0..before.controls.len()).any(|block| before.controls.values(block).iter().any(|d| *d != 0.0)) {
            self.add_controls(BEGIN, 1.0, &before.controls);
        }
        self.history.add(&before.history);
    }

    /// From the internal variables of the step behind a state to that state and to those of the step that led to it.
    fn pass_history(&mut self, state: &State) -> Result<(), StateError> {
        let by_next = take(&mut self.history);
        if !by_next.is_zero() {
            let before = self.model.memory().history_vjp(state, &by_next).map_err(|at| inverted(at, state))?;
            self.take_before(before);
        }
        Ok(())
    }

    /// Adds the derivative through a term to that by what it is taken from.
    fn pass(&mut self, factor: f64, term: &Term, adjoints: &[f64], stages: &mut [InstantAdjoint]) {
        let to = match term.at {
            TermInstant::Now => &mut self.adjoints[BEGIN],
            TermInstant::Before => &mut self.adjoints[BEFORE],
            TermInstant::Stage(k) => &mut stages[k],
        };
        add(factor, adjoints, to.of(term.of));
    }

    /// Adds the derivative through the velocity and acceleration of the k-th stage of a step to those by what they are taken from; the part of its own
    /// displacement is in the solve.
    fn pass_rates(
        &mut self,
        stage: &Stage,
        k: usize,
        h: f64,
        mut adjoints: InstantAdjoint,
        stages: &mut [InstantAdjoint],
    ) {
        for term in stage.acceleration.iter().filter(|term| !term.is(Quantity::Displacement, k)) {
            let factor = term.scaled(Quantity::Acceleration, h);
            match term.is(Quantity::Velocity, k) {
                true => add(factor, &adjoints.acceleration, &mut adjoints.velocity),
                false => self.pass(factor, term, &adjoints.acceleration, stages),
            }
        }
        for term in stage.velocity.iter().filter(|term| !term.is(Quantity::Displacement, k)) {
            self.pass(term.scaled(Quantity::Velocity, h), term, &adjoints.velocity, stages);
        }
    }

    /// The acceleration that a state was given: `M a = -r(u, v, 0; m)`.
    fn start(&mut self, state: &State, acceleration: &[f64], history: &History) -> Result<(), StateError> {
        let adjoints = take(&mut self.adjoints[BEGIN].acceleration);
        if adjoints.iter().all(|&d| d == 0.0) {
            return Ok(());
        }
        let (model, parallel) = (self.model, self.how.parallel);
        let state = &at_instant(model, state, history);
        let mu = divide_by_mass(model, &state.controls, adjoints.iter().map(|d| -d).collect(), parallel)?;
        // with it, since a mass may follow a design: mu . dM/dm a
        let step = TimeStep { acceleration: (0.0, acceleration.to_vec()), ..without_acceleration(state) };
        let at = beginning(model, state, &step, parallel);
        let tangent = model.tangents().bordered_tangent(&at).map_err(|at| inverted(at, state))?;
        let by_u = tangent.multiply_transposed(&mu, parallel);
        let by = model.vjp(&at, &mu).map_err(|at| inverted(at, state))?;
        self.take_before(by.before);
        add(1.0, &by_u, &mut self.adjoints[BEGIN].u);
        add(1.0, &by.velocity, &mut self.adjoints[BEGIN].velocity);
        self.add_controls(BEGIN, 1.0, &by.controls);
        Ok(())
    }

    /// The derivative by u through the forces at held unknowns, `K^T dj/dR`.
    fn add_held(&self, at: &Instant, held: &[f64], by_u: &mut Vec<f64>, state: &State) -> Result<(), StateError> {
        if !held.is_empty() {
            let tangent = self.model.tangents().bordered_tangent(at).map_err(|at| inverted(at, state))?;
            add(1.0, &tangent.multiply_transposed(held, self.how.parallel), by_u);
        }
        Ok(())
    }

    /// The forces at held unknowns of a state that was given.
    fn given(&mut self, state: &State, held: &[f64]) -> Result<(), StateError> {
        if !held.is_empty() {
            let at = self.model.instant(state, None, self.how.parallel);
            let by = self.model.vjp(&at, held).map_err(|at| inverted(at, state))?;
            self.add_controls(END, 1.0, &by.controls);
        }
        Ok(())
    }

    /// The adjoint of a state that is the equilibrium under its controls.
    fn equilibrium(&mut self, state: &State, held: &[f64]) -> Result<Vec<f64>, StateError> {
        let mut by_u = take(&mut self.adjoints[END].u);
        by_u.resize(self.model.unknowns().len(), 0.0);
        self.add_held(&self.model.instant(state, None, self.how.parallel), held, &mut by_u, state)?;
        self.given(state, held)?;
        if !self.model.unknowns().any(by_u.iter().any(|&d| d != 0.0)) {
            return Ok(by_u);
        }
        by_u.iter_mut().for_each(|d| *d = -*d);
        let adjoint = self.model.adjoint_with(state, &[&by_u], self.how, self.workspace)?;
        self.report.add_work(&adjoint.report);
        self.report.solver = adjoint.report.solver;
        let lambda = adjoint.lambda.into_iter().next().unwrap_or_default();
        let at = self.model.instant(state, None, self.how.parallel);
        by_u.iter_mut().for_each(|d| *d = -*d);
        let by =
            self.model.prescribed_unknowns().sensitivities(&at, &by_u, &lambda).map_err(|at| inverted(at, state))?;
        self.add_controls(END, 1.0, &by.controls);
        Ok(lambda)
    }

    /// `K^T lambda = -by_u` with the tangent of a stage.
    fn solve(&mut self, at: &Instant, by_u: &[f64], end: &State) -> Result<Vec<f64>, StateError> {
        let mut rhs: Vec<f64> = by_u.iter().map(|d| -d).collect();
        self.model.supports.restrict(&mut rhs);
        if rhs.iter().all(|&b| b == 0.0) {
            return Ok(vec![0.0; self.model.unknowns().len()]);
        }
        let solver = self.model.linear_solver(self.how, self.workspace);
        let mut systems = TangentSystems::new(self.model, at.controls, self.how.parallel, solver);
        let mut solved = self.model.solve_transposed_at(at, &[&rhs], end, &mut systems, &mut self.report)?;
        Ok(solved.swap_remove(0))
    }

    fn add_controls(&mut self, at: usize, factor: f64, by: &Controls) {
        if factor != 0.0 {
            let into = &mut self.controls[at];
            (0..by.len()).for_each(|block| axpy(factor, by.values(block), into.values_mut(block)));
        }
    }
}

/// The adjoint of the free unknowns and that of the held ones as one vector.
fn sum(lambda: &[f64], held: &[f64]) -> Vec<f64> {
    let mut sum = lambda.to_vec();
    if !held.is_empty() {
        axpy(1.0, held, &mut sum);
    }
    sum
}
