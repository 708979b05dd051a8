//! The derivative of a problem in time, by one reverse sweep over the motion.

use super::in_time::Motion;
use super::instant::AtInstant;
use super::motion_progress::counting;
use super::{Lagrangian, Reduced};
use crate::cost::{MotionPartials, Partials};
use crate::evaluated::{AdjointState, SolvedStates};
use crate::time::TrajectoryPartials;
use crate::workspace::ReducedWorkspace;
use nastic_fem::{ReverseSweep, SolveOptions, State, StatePartials, SweptInstant};
use nastic_fields::ControlError;
use nastic_numeric::vector::axpy;
use std::mem::take;

/// A sum of costs and constraints of a motion.
#[derive(Clone, Copy)]
pub(super) enum Functional<'a> {
    /// One of the cost terms.
    Term(usize),
    /// All of them, with constraints.
    Lagrangian(Lagrangian<'a>),
}

impl<'a> Functional<'a> {
    /// Of all costs.
    pub fn costs() -> Self {
        Functional::Lagrangian(Lagrangian { costs: true, y: &[] })
    }

    fn has_term(&self, k: usize) -> bool {
        match self {
            Functional::Term(term) => *term == k,
            Functional::Lagrangian(of) => of.costs,
        }
    }

    fn multipliers(self) -> &'a [f64] {
        match self {
            Functional::Lagrangian(of) if of.y.iter().any(|y| *y != 0.0) => of.y,
            _ => &[],
        }
    }
}

/// Partial derivatives of a functional, instant by instant.
struct InstantPartials<'a> {
    problem: &'a Reduced,
    motion: &'a Motion,
    /// The control vector and the stage.
    at: (&'a [f64], usize),
    of: Functional<'a>,
    counting: Vec<Vec<(usize, usize)>>,
    /// By the states, as far as costs of the whole motion give them at once; by the control vector, all so far.
    out: TrajectoryPartials,
    /// Whether one by a state was not zero.
    by_states: bool,
    /// The control vector of the instant at hand.
    of_instant: Vec<f64>,
}

impl<'a> InstantPartials<'a> {
    fn new(
        problem: &'a Reduced,
        motion: &'a Motion,
        at: (&'a [f64], usize),
        solved: &SolvedStates,
        of: Functional<'a>,
    ) -> Result<Self, ControlError> {
        let mut out = TrajectoryPartials::zero(motion.timeline.instants().len(), at.0.len());
        let context = problem.motion_context(motion, solved, at.0, at.1);
        for (k, cost) in motion.costs.iter().enumerate() {
            if of.has_term(motion.schedules.len() + k) {
                cost.add_partials(&context, &mut out)?;
            }
        }
        let (counting, by_states, of_instant) = (counting(motion), false, Vec::new());
        let mut partials = InstantPartials { problem, motion, at, of, counting, out, by_states, of_instant };
        partials.add_rates()?;
        Ok(partials)
    }

    /// Those of limited rates, whose values stand behind those of the constraints.
    fn add_rates(&mut self) -> Result<(), ControlError> {
        let y = self.of.multipliers();
        let (layout, rates) = (&self.problem.layout, &self.motion.rates);
        let lens = rates.iter().map(|rate| Ok(rate.group(layout)?.len)).collect::<Result<Vec<_>, ControlError>>()?;
        let mut first = y.len().saturating_sub(lens.iter().sum());
        for (rate, len) in rates.iter().zip(lens) {
            let y = y.get(first..first + len).unwrap_or_default();
            rate.add_partials(layout, self.at.0, y, &mut self.out.m)?;
            first += len;
        }
        Ok(())
    }

    /// Those of the constraints that hold in the n-th state.
    fn add_constraints(&mut self, at: &AtInstant, by: &mut StatePartials) -> Result<(), ControlError> {
        let n = at.n;
        let (problem, motion, mut y) = (self.problem, self.motion, self.of.multipliers());
        let (mut own, mut more) = (None, MotionPartials::default());
        if y.is_empty() {
            return Ok(());
        }
        for (k, instants) in motion.constrained_at.iter().enumerate() {
            let len = problem.constraints[k].group().len;
            let (of_instants, behind) = y.split_at(y.len().min(len * instants.len()));
            y = behind;
            let Ok(place) = instants.binary_search(&n) else { continue };
            let y = of_instants.get(place * len..(place + 1) * len).unwrap_or_default();
            if y.iter().all(|y| *y == 0.0) {
                continue;
            }
            let zero = || Partials::zero(at.state.u.len(), motion.layout.len());
            at.constraint(k)?.add_partials_in_motion(y, own.get_or_insert_with(zero), &mut more)?;
        }
        own.iter().for_each(|own| self.add(motion.timeline.instants()[n], 1.0, own, &mut by.u));
        self.add_more(n, 1.0, more, by);
        Ok(())
    }

    /// Those by the n-th state; those by the control vector are added to the others.
    fn at(&mut self, n: usize, state: &State) -> Result<StatePartials, ControlError> {
        let (problem, motion) = (self.problem, self.motion);
        let mut by_state = take(&mut self.out.states[n]);
        let at = problem.at_state(n, state, self.at)?;
        for (k, place) in self.counting[n].clone() {
            if !self.of.has_term(k) {
                continue;
            }
            let schedule = &motion.schedules[k];
            let mut own = Partials::zero(state.u.len(), motion.layout.len());
            let mut more = MotionPartials::default();
            let cost = at.cost(problem.scheduled(motion, k, place))?;
            let factor = schedule.weights[place].1 * schedule.shape(cost.value()).1;
            cost.add_partials_in_motion(&mut own, &mut more)?;
            self.add(motion.timeline.instants()[n], factor, &own, &mut by_state.u);
            self.add_more(n, factor, more, &mut by_state);
        }
        self.add_constraints(&at, &mut by_state)?;
        self.of_instant = at.m.into_owned();
        let all = by_state.u.iter().chain(&by_state.velocity).chain(&by_state.held);
        self.by_states |= all.into_iter().any(|d| *d != 0.0);
        Ok(by_state)
    }

    /// Adds those of a functional of one instant, times a factor.
    fn add(&mut self, t: f64, factor: f64, own: &Partials, by_u: &mut Vec<f64>) {
        by_u.resize(own.u.len(), 0.0);
        axpy(factor, &own.u, by_u);
        let by_m: Vec<f64> = own.m.iter().map(|d| factor * d).collect();
        self.problem.layout.add_at(t, &by_m, &mut self.out.m);
    }

    /// Adds those by the forces that supports exert, the velocity, and the controls where the step to the n-th instant began, times a factor.
    fn add_more(&mut self, n: usize, factor: f64, more: MotionPartials, by: &mut StatePartials) {
        let mut sum = MotionPartials { held: take(&mut by.held), velocity: take(&mut by.velocity), before: Vec::new() };
        sum.add(factor, &more);
        if let (Some(before), false) = (n.checked_sub(1), sum.before.is_empty()) {
            self.problem.layout.add_at(self.motion.timeline.instants()[before], &sum.before, &mut self.out.m);
        }
        (by.held, by.velocity) = (sum.held, sum.velocity);
    }

    /// What the sweep found at the n-th instant, the last at which partial derivatives were taken.
    fn add_swept(&mut self, n: usize, swept: &SweptInstant) {
        let by_instant = self.motion.layout.control_vjp(&self.of_instant, &swept.controls);
        self.problem.layout.add_at(self.motion.timeline.instants()[n], &by_instant, &mut self.out.m);
    }
}

impl Reduced {
    /// `d/dm` of a functional of the motion under a control vector in a stage, and the adjoint state at the end; none where nothing depends on the states. Of a
    /// motion that keeps few states the recording has only its beginning left afterwards.
    pub(super) fn derivative_of_motion(
        &self,
        motion: &Motion,
        at: (&[f64], usize),
        solved: &mut SolvedStates,
        of: Functional<'_>,
        workspace: &mut ReducedWorkspace,
    ) -> Result<(Vec<f64>, Option<AdjointState>), ControlError> {
        if solved.resumed {
            let what = "the states of a motion that was resumed are not all there: evaluate it anew for its derivative";
            return Err(ControlError::Cost { what: what.to_owned() });
        }
        let swept = self.sweep_motion(motion, at, solved, of, workspace);
        self.forget(workspace);
        swept
    }

    fn sweep_motion(
        &self,
        motion: &Motion,
        at: (&[f64], usize),
        solved: &mut SolvedStates,
        of: Functional<'_>,
        workspace: &mut ReducedWorkspace,
    ) -> Result<(Vec<f64>, Option<AdjointState>), ControlError> {
        let (model, last) = (self.solid.model(), motion.timeline.steps());
        let how = SolveOptions { parallel: self.parallel, ..SolveOptions::default() };
        let mut partials = InstantPartials::new(self, motion, at, solved, of)?;
        let mut sweep = ReverseSweep::new(model, &how, &mut workspace.solve);
        let (mut lambda, mut first) = (Vec::new(), None);
        let recomputed = solved.recording.backwards(
            model,
            &mut |n| self.step_to(motion, at.0, n),
            &self.solve_options(solved.accuracy),
            &mut |part, k| {
                let n = part.first() + k + 1;
                let by_end = partials.at(n, &part.states()[k + 1])?;
                let swept = sweep.step(part, k, by_end)?;
                partials.add_swept(n, &swept);
                if n == last {
                    lambda = swept.lambda;
                }
                if n == 1 {
                    first = Some(part.beginning());
                }
                Ok::<(), ControlError>(())
            },
        )?;
        let first = first.unwrap_or_else(|| solved.recording.part().beginning());
        let by_first = partials.at(0, first.end())?;
        let (swept, mut work) = sweep.begin(&first, by_first)?;
        partials.add_swept(0, &swept);
        work.add_work(&recomputed);
        let adjoint = partials.by_states.then(|| AdjointState { lambda, work, multipliers: vec![] });
        Ok((partials.out.m, adjoint))
    }
}
