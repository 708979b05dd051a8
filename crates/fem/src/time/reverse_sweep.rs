//! The discrete adjoint of a trajectory, from its end to its beginning.

use crate::contributions::body_energy::history::History;
use crate::contributions::controls::Controls;
use crate::contributions::instant::Instant;
use crate::error::{InvertedAt, StateError};
use crate::model::Model;
use crate::solution::options::SolveOptions;
use crate::solution::state::{SolveReport, State};
use crate::solution::tangent_systems::TangentSystems;
use crate::solution::workspace::Workspace;
use crate::time::initial_acceleration::without_acceleration;
use crate::time::points::Points;
use crate::time::scheme::{Point, Quantity, Term};
use crate::time::trajectory::{Begin, Trajectory};
use nastic_numeric::vector::axpy;
use std::mem::take;

/// Partial derivatives of a functional at one instant.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct StatePartials {
    /// `dj/du`, flat; empty for zero.
    pub u: Vec<f64>,
    /// `dj/dv`, flat; empty for zero.
    pub velocity: Vec<f64>,
}

impl StatePartials {
    /// Of a functional that depends on the displacement alone.
    pub fn by_displacement(u: Vec<f64>) -> Self {
        StatePartials { u, velocity: Vec::new() }
    }
}

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

/// What later instants owe to one: derivatives by u, v and a; empty for zero.
#[derive(Debug, Clone, Default)]
struct Owed {
    u: Vec<f64>,
    velocity: Vec<f64>,
    acceleration: Vec<f64>,
}

impl Owed {
    fn of(&mut self, of: Quantity) -> &mut Vec<f64> {
        match of {
            Quantity::Displacement => &mut self.u,
            Quantity::Velocity => &mut self.velocity,
            Quantity::Acceleration => &mut self.acceleration,
        }
    }

    fn is_zero(&self) -> bool {
        [&self.u, &self.velocity, &self.acceleration].into_iter().all(|d| d.iter().all(|&d| d == 0.0))
    }
}

/// `into += factor d`, where either may be empty for zero.
fn add(factor: f64, d: &[f64], into: &mut Vec<f64>) {
    if !d.is_empty() {
        into.resize(d.len(), 0.0);
        axpy(factor, d, into);
    }
}

/// The sweep under way.
struct Sweep<'a, 'w> {
    model: &'a Model,
    trajectory: &'a Trajectory,
    how: &'a SolveOptions<'a>,
    workspace: &'w mut Workspace,
    /// By state.
    owed: Vec<Owed>,
    /// By the internal variables of the step that is swept, and of the one behind it through them.
    history: History,
    swept: Swept,
}

impl Model {
    /// The derivative of `j(y_0, .., y_N)` by the controls of every instant, given its partial derivatives: every
    /// step is a chain of linear combinations and of solves `r(w, v, a; m) = 0` (see [`Scheme`](crate::Scheme)),
    /// which the sweep passes backwards. With `v = c_v w + b_v`, `a = c_a w + b_a` and K the tangent of the stage,
    ///
    /// ```text
    /// K^T l = -(dj/dw + c_v dj/dv + c_a dj/da)
    /// dj/db_v = dj/dv + l . dr/dv,    dj/db_a = dj/da + l . dr/da,    dj/dm = l . dr/dm
    /// ```
    ///
    /// one transposed solve per stage; then the combinations transposed. An acceleration `M a = -r(u, v, 0; m)` at
    /// the beginning and an equilibrium there take a solve each. A static problem is a trajectory of one instant, and
    /// this its adjoint. Source: docs/model.md section 12.
    ///
    /// # Errors
    /// A tangent that is singular, partial derivatives of the wrong length, states of another body or with internal
    /// variables.
    pub fn reverse_sweep(
        &self,
        trajectory: &Trajectory,
        partials: &[StatePartials],
        how: &SolveOptions,
        workspace: &mut Workspace,
    ) -> Result<Swept, StateError> {
        let states = trajectory.states();
        self.check_partials(partials, states.len())?;
        if states.iter().any(|state| !state.internal.is_empty()) {
            let what = "the adjoint of laws with internal variables is not there yet".to_owned();
            return Err(crate::FemError::Meaningless { what }.into());
        }
        states.iter().try_for_each(|state| self.check_state(state))?;
        let owed = partials
            .iter()
            .map(|p| Owed { u: p.u.clone(), velocity: p.velocity.clone(), acceleration: Vec::new() })
            .collect();
        let swept = Swept {
            lambda: vec![Vec::new(); states.len()],
            controls: vec![self.controls(); states.len()],
            report: SolveReport::default(),
        };
        let mut sweep = Sweep { model: self, trajectory, how, workspace, owed, history: History::new(), swept };
        for n in (0..trajectory.steps().len()).rev() {
            sweep.step(n)?;
        }
        if trajectory.begin() == Begin::Equilibrium {
            sweep.equilibrium()?;
        }
        Ok(sweep.swept)
    }

    fn check_partials(&self, partials: &[StatePartials], expected: usize) -> Result<(), StateError> {
        let refuse = |what: &str, found, expected| {
            Err(crate::FemError::Length { what: what.to_owned(), found, expected }.into())
        };
        if partials.len() != expected {
            return refuse("partial derivatives by instant", partials.len(), expected);
        }
        let dofs = self.unknowns().len();
        let lengths = partials.iter().flat_map(|p| [p.u.len(), p.velocity.len()]);
        match lengths.filter(|&found| found != 0).find(|&found| found != dofs) {
            Some(found) => refuse("partial derivatives of a state", found, dofs),
            None => Ok(()),
        }
    }
}

impl Sweep<'_, '_> {
    /// The step from the n-th state.
    fn step(&mut self, n: usize) -> Result<(), StateError> {
        let (states, step) = (self.trajectory.states(), &self.trajectory.steps()[n]);
        let (begin, end, h) = (&states[n], &states[n + 1], step.dt);
        let before = n.checked_sub(1).map(|n| &states[n]);
        let history = self.model.next_history(begin, self.how.parallel)?;
        let mut points = Points::new(&step.scheme, h, (begin, before), step.started.as_ref());
        let mut time_steps = Vec::new();
        for u in &step.stages {
            let time_step = points.next();
            points.found(u.clone(), &time_step);
            time_steps.push(time_step);
        }
        let mut stages = vec![Owed::default(); step.stages.len()];
        let mut of_end = take(&mut self.owed[n + 1]);
        for (of, terms) in step.scheme.end.combinations() {
            let owed = take(of_end.of(of));
            terms.iter().for_each(|term| self.pass(term.scaled(of, h), term, &owed, n, &mut stages));
        }
        for (k, stage) in step.scheme.stages.iter().enumerate().rev() {
            let mut owed = take(&mut stages[k]);
            if owed.is_zero() {
                continue;
            }
            let time_step = &time_steps[k];
            let Owed { u: mut by_u, velocity, acceleration } = owed.clone();
            add(time_step.velocity.0, &velocity, &mut by_u);
            add(time_step.acceleration.0, &acceleration, &mut by_u);
            let mut controls = begin.controls.blend(&end.controls, stage.time);
            self.model.body.put_history(&history, stage.time * h, &mut controls);
            let at = Instant { parallel: self.how.parallel, ..Instant::new(&step.stages[k], &controls, 1.0) };
            let at = at.in_step(time_step);
            let lambda = self.solve(&at, &by_u, end)?;
            let mut by = self.model.vjp(&at, &lambda).map_err(|at| inverted(at, end))?;
            self.take_history(&history, &mut by.controls);
            self.add_controls(n + 1, stage.time, &by.controls);
            self.add_controls(n, 1.0 - stage.time, &by.controls);
            add(1.0, &by.velocity, &mut owed.velocity);
            add(1.0, &by.acceleration, &mut owed.acceleration);
            // what its own displacement owes is in the solve
            for term in stage.acceleration.iter().filter(|term| !term.is(Quantity::Displacement, k)) {
                let factor = term.scaled(Quantity::Acceleration, h);
                match term.is(Quantity::Velocity, k) {
                    true => add(factor, &owed.acceleration, &mut owed.velocity),
                    false => self.pass(factor, term, &owed.acceleration, n, &mut stages),
                }
            }
            for term in stage.velocity.iter().filter(|term| !term.is(Quantity::Displacement, k)) {
                self.pass(term.scaled(Quantity::Velocity, h), term, &owed.velocity, n, &mut stages);
            }
            self.swept.lambda[n + 1] = lambda;
        }
        if self.swept.lambda[n + 1].is_empty() {
            self.swept.lambda[n + 1] = vec![0.0; self.model.unknowns().len()];
        }
        if step.started.is_some() {
            self.start(n, &history)?;
        }
        self.pass_history(n)
    }

    /// Moves what is owed by internal variables out of the controls.
    fn take_history(&mut self, history: &History, by: &mut Controls) {
        for (k, _) in history {
            let found = by.values_mut(*k);
            match self.history.iter_mut().find(|(known, _)| known == k) {
                Some((_, sum)) => axpy(1.0, found, sum),
                None => self.history.push((*k, found.to_vec())),
            }
            found.fill(0.0);
        }
    }

    /// From the internal variables of the step behind the n-th state to that state and to those of the step that led to it.
    fn pass_history(&mut self, n: usize) -> Result<(), StateError> {
        let state = &self.trajectory.states()[n];
        let by_next = take(&mut self.history);
        if by_next.iter().all(|(_, by)| by.iter().all(|&d| d == 0.0)) {
            return Ok(());
        }
        let by_u = &mut self.owed[n].u;
        by_u.resize(self.model.unknowns().len(), 0.0);
        let before = self.model.body.history_vjp(&state.u, &state.controls, &by_next, by_u);
        self.history = before.map_err(|at| inverted(at, state))?;
        Ok(())
    }

    /// Adds what is owed through a term to what it is taken from.
    fn pass(&mut self, factor: f64, term: &Term, owed: &[f64], n: usize, stages: &mut [Owed]) {
        let to = match term.at {
            Point::Now => Some(&mut self.owed[n]),
            Point::Before => n.checked_sub(1).map(|before| &mut self.owed[before]),
            Point::Stage(k) => Some(&mut stages[k]),
        };
        if let Some(to) = to {
            add(factor, owed, to.of(term.of));
        }
    }

    /// The acceleration that the n-th state was given: `M a = -r(u, v, 0; m)`.
    fn start(&mut self, n: usize, history: &History) -> Result<(), StateError> {
        let owed = take(&mut self.owed[n].acceleration);
        if owed.iter().all(|&d| d == 0.0) {
            return Ok(());
        }
        let (model, parallel) = (self.model, self.how.parallel);
        let state = &model.at_instant(&self.trajectory.states()[n], history);
        let mu = model.divide_by_mass(owed.iter().map(|d| -d).collect(), parallel)?;
        let step = without_acceleration(state);
        let at = model.beginning(state, &step, parallel);
        let tangent = model.tangent_at(&at, state)?;
        let mut by_u = vec![0.0; mu.len()];
        tangent.multiply_transposed(&mu, &mut by_u, parallel);
        let mut by = model.vjp(&at, &mu).map_err(|at| inverted(at, state))?;
        self.take_history(history, &mut by.controls);
        add(1.0, &by_u, &mut self.owed[n].u);
        add(1.0, &by.velocity, &mut self.owed[n].velocity);
        self.add_controls(n, 1.0, &by.controls);
        Ok(())
    }

    /// The first state, where it is the equilibrium under its controls.
    fn equilibrium(&mut self) -> Result<(), StateError> {
        let state = &self.trajectory.states()[0];
        let mut by_u = take(&mut self.owed[0].u);
        by_u.resize(self.model.unknowns().len(), 0.0);
        if by_u.iter().all(|&d| d == 0.0) {
            self.swept.lambda[0] = by_u;
            return Ok(());
        }
        by_u.iter_mut().for_each(|d| *d = -*d);
        let adjoint = self.model.adjoint_with(state, &[&by_u], self.how, self.workspace)?;
        self.swept.report.add_work(&adjoint.report);
        self.swept.report.solver = adjoint.report.solver;
        let lambda = adjoint.lambda.into_iter().next().unwrap_or_default();
        let at = self.model.instant(state, None, self.how.parallel);
        by_u.iter_mut().for_each(|d| *d = -*d);
        let by = self.model.sensitivities(&at, &by_u, &lambda).map_err(|at| inverted(at, state))?;
        self.add_controls(0, 1.0, &by.controls);
        self.swept.lambda[0] = lambda;
        Ok(())
    }

    /// `K^T lambda = -by_u` with the tangent of a stage.
    fn solve(&mut self, at: &Instant, by_u: &[f64], end: &State) -> Result<Vec<f64>, StateError> {
        let mut rhs: Vec<f64> = by_u.iter().map(|d| -d).collect();
        self.model.supports.clear(&mut rhs);
        if rhs.iter().all(|&b| b == 0.0) {
            return Ok(vec![0.0; self.model.unknowns().len()]);
        }
        let matrix = self.model.tangent_at(at, end)?;
        let solver = self.model.linear_solver(self.how, self.workspace);
        let mut systems = TangentSystems::new(self.model, self.how.parallel, solver);
        let mut solved = systems.solve_transposed(matrix, at.u, &[&rhs], &mut self.swept.report)?;
        Ok(solved.swap_remove(0))
    }

    fn add_controls(&mut self, n: usize, factor: f64, by: &Controls) {
        if factor != 0.0 {
            let into = &mut self.swept.controls[n];
            (0..by.len()).for_each(|block| axpy(factor, by.values(block), into.values_mut(block)));
        }
    }
}

fn inverted(at: InvertedAt, state: &State) -> StateError {
    StateError::Inverted { at, load: state.load, cuts: 0, last: Box::new(state.clone()) }
}
