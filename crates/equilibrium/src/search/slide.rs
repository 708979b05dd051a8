//! Steps in time with friction for which Newton's method fails.

use crate::linear_systems::workspace::Workspace;
use crate::model::Model;
use crate::model::views::Moves;
use crate::nonlinear::iterate::Stop;
use crate::nonlinear::iteration::{Limits, ShortSteps};
use crate::search::options::SolveOptions;
use nastic_body::controls::Controls;
use nastic_body::error::StateError;
use nastic_body::instant::{FrictionLag, Instant, TimeStep};
use nastic_body::state::{SolveReport, State};
use nastic_body::strategy::Strategy;
use std::sync::Arc;

/// Newton iterations with implicit friction behind a round.
const MAX_IMPLICIT_ITERATIONS: usize = 20;
/// Rounds of lagged friction.
const MAX_ROUNDS: usize = 30;
/// Largest factor of the slip speed.
const MAX_SMOOTHING: f64 = 1e4;

/// When iterations with short steps are given up, and how the slip speed changes.
struct RoundLimits {
    /// Short steps with implicit friction.
    at_once: ShortSteps,
    /// Short steps in a round.
    round: ShortSteps,
    /// Factor of the slip speed behind a round that failed.
    smoothing_growth: f64,
    /// Divisor of the slip speed behind a round that converged.
    smoothing_decrease: f64,
}

/// The first attempt, by long steps.
const LONG_STEPS_ONLY: RoundLimits = RoundLimits {
    at_once: ShortSteps { most: 3, length: 0.1 },
    round: ShortSteps { most: 4, length: 0.03 },
    smoothing_growth: 100.0,
    smoothing_decrease: 10.0,
};
/// The second attempt, without a limit on short steps.
const STEPS_OF_ANY_LENGTH: RoundLimits = RoundLimits {
    at_once: ShortSteps::ALLOWED,
    round: ShortSteps::ALLOWED,
    smoothing_growth: 10.0,
    smoothing_decrease: 3.0,
};
/// Relative residual to which a round is solved.
const ROUND_TOLERANCE: f64 = 1e-6;
/// Relative residual of the equations with implicit friction below which these are tried behind a round.
const MAX_IMPLICIT_RESIDUAL: f64 = 0.1;

impl Model {
    /// The end of a step with friction: by Newton's method from its beginning, else by rounds with lagged friction. In a round the normal forces of
    /// friction are those of the round before (at first those at the beginning of the step), so that its solution is the minimum of a potential; where a
    /// round fails, the slip speed is increased. `None` where neither converges.
    ///
    /// Source: Li et al., Incremental Potential Contact, ACM Trans. Graph. 39 (2020), section 5.5, there with a fixed number of rounds; here
    /// Newton's method with implicit friction follows them.
    pub(crate) fn slide(
        &self,
        near: &State,
        controls: &Controls,
        how: &SolveOptions,
        step: &TimeStep,
        workspace: &mut Workspace,
        report: &mut SolveReport,
    ) -> Result<Option<State>, StateError> {
        let starts = [how.guess.map(<[f64]>::to_vec), Some(near.u.to_vec())];
        let borne = |u: &Vec<f64>| self.bears(near, controls, u, how, Some(step));
        let Some(start) = starts.into_iter().flatten().find(borne) else { return Ok(None) };
        let found = |u: Vec<f64>, rounds: usize, report: &mut SolveReport| {
            report.load_steps += 1 + rounds;
            Ok(Some(State::equilibrium(u, controls.clone(), 1.0, *report)))
        };
        let at_once = self.equations(controls, 1.0, Some(step), 1.0, how);
        if how.guess.is_none() {
            let mut u = start.clone();
            let short_steps = if at_once.has_potential() { ShortSteps::ALLOWED } else { LONG_STEPS_ONLY.at_once };
            let within = Limits { short_steps, ..Limits::new(how.max_newton, how.accuracy) };
            match at_once.solve_either_way(within, &mut u, self.linear_solver(how, workspace), report) {
                Ok(_) => return found(u, 0, report),
                Err(stop) => go_on(stop)?,
            }
            workspace.forget();
        }
        if self.residual_creeps() {
            let mut u = start.clone();
            report.strategies.count(Strategy::PointStrains);
            match at_once.solve_with_point_strains(&mut u, self.linear_solver(how, workspace), report) {
                Ok(()) => return found(u, 0, report),
                Err(stop) => go_on(stop)?,
            }
            workspace.forget();
        }
        for limits in [LONG_STEPS_ONLY, STEPS_OF_ANY_LENGTH] {
            if let Some((u, rounds)) = self.rounds(near, (&start, controls), (how, step), &limits, workspace, report)? {
                return found(u, rounds, report);
            }
        }
        Ok(None)
    }

    /// Rounds of lagged friction: the resulting displacement, and their number.
    fn rounds(
        &self,
        near: &State,
        (start, controls): (&[f64], &Controls),
        (how, step): (&SolveOptions, &TimeStep),
        limits: &RoundLimits,
        workspace: &mut Workspace,
        report: &mut SolveReport,
    ) -> Result<Option<(Vec<f64>, usize)>, StateError> {
        let once = SolveOptions { max_newton: how.max_newton.min(MAX_IMPLICIT_ITERATIONS), ..how.clone() };
        let at_once = self.equations(controls, 1.0, Some(step), 1.0, &once);
        let at_once_within = Limits { short_steps: limits.at_once, ..Limits::new(once.max_newton, how.accuracy) };
        let each = SolveOptions { accuracy: how.accuracy.max(ROUND_TOLERANCE), ..how.clone() };
        // a round is the minimum of a potential, however often the tangent is shifted on the way
        let of_round = Limits::new(each.max_newton, each.accuracy);
        let each_within = Limits { short_steps: limits.round, max_shifted_iterations: usize::MAX, ..of_round };
        let mut lag = FrictionLag { u: near.u.clone(), controls: near.controls.clone(), smoothing: 1.0 };
        let mut u = start.to_vec();
        for round in 1..=MAX_ROUNDS {
            let lagged = TimeStep { lag: Some(lag.clone()), ..step.clone() };
            let equations = self.equations(controls, 1.0, Some(&lagged), 1.0, &each);
            let mut end = u.clone();
            let solver = self.linear_solver(how, workspace);
            if let Err(stop) = equations.solve_either_way(each_within, &mut end, solver, report) {
                go_on(stop)?;
                workspace.forget();
                lag.smoothing *= limits.smoothing_growth;
                if lag.smoothing > MAX_SMOOTHING {
                    return Ok(None);
                }
                continue;
            }
            u = end;
            let Ok(now) = at_once.evaluate(&u) else { return Ok(None) };
            if at_once.residual(&now.sums).1 < MAX_IMPLICIT_RESIDUAL {
                let mut end = u.clone();
                match at_once.solve_within(at_once_within, &mut end, self.linear_solver(how, workspace), report) {
                    Ok(_) => return Ok(Some((end, round))),
                    Err(stop) => go_on(stop)?,
                }
                workspace.forget();
            }
            let smoothing = (lag.smoothing / limits.smoothing_decrease).max(1.0);
            lag = FrictionLag { u: Arc::new(u.clone()), controls: Arc::new(controls.clone()), smoothing };
        }
        Ok(None)
    }

    /// Whether the controls may change at once while the body moves to a displacement: no obstacle enters it by more than a few layers. Otherwise
    /// load steps are made.
    pub(crate) fn bears(
        &self,
        near: &State,
        controls: &Controls,
        u: &[f64],
        how: &SolveOptions,
        step: Option<&TimeStep>,
    ) -> bool {
        let at = self.instant(near, step, how.parallel);
        let to = Instant { u, controls, ..at };
        self.moves().admissible_change(&at, &to).is_ok_and(|share| share >= 1.0)
    }
}

/// Returns an error that no other attempt would avoid.
fn go_on(stop: Stop) -> Result<(), StateError> {
    stop.final_error().map_or(Ok(()), Err)
}

impl Moves<'_> {
    /// The displacement if the body moved with the obstacles that it touches, by the mean of their rigid motions, weighted by their contact
    /// forces; `None` without contact, or if obstacles do not move.
    pub fn carried(&self, near: &State, controls: &Controls, parallel: bool) -> Option<Vec<f64>> {
        if !self.model.unknowns().has_one_nodal_field() {
            return None;
        }
        let (at, mut moved) = (self.model.instant(near, None, parallel), Vec::new());
        self.model.each_touching(&at, |_, touches, at| {
            let pressing = touches.touch(at).map_or(0.0, |touch| touch.pressing);
            moved
                .extend(touches.pose(at).zip(touches.pose(&at.under(controls))).map(|(from, to)| (pressing, from, to)));
        });
        let all: f64 = moved.iter().map(|(pressing, ..)| pressing).sum();
        if all <= 0.0 || moved.iter().all(|(_, from, to)| from == to) {
            return None;
        }
        let (mesh, mut u) = (self.model.discretization().mesh(), near.u.to_vec());
        for (node, x) in mesh.points().iter().enumerate() {
            let own = &mut u[mesh.dim() * node..mesh.dim() * (node + 1)];
            let here: [f64; 3] = std::array::from_fn(|i| x[i] + own.get(i).copied().unwrap_or(0.0));
            for (pressing, from, to) in moved.iter().filter(|(pressing, ..)| *pressing > 0.0) {
                let there = from.carry(to, here);
                own.iter_mut().enumerate().for_each(|(i, u)| *u += pressing / all * (there[i] - here[i]));
            }
        }
        Some(u)
    }
}
