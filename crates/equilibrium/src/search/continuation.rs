//! Continuation in the load from one equilibrium to another, with an adaptive load step.

use crate::linear_systems::workspace::Workspace;
use crate::model::{Feature, Model};
use crate::nonlinear::equations::{Equations, moved};
use crate::nonlinear::iterate::Stop;
use crate::search::load_steps::LoadSteps;
use crate::search::options::SolveOptions;
use nastic_body::controls::Controls;
use nastic_body::error::{Cause, StateError};
use nastic_body::instant::{Instant, TimeStep};
use nastic_body::state::{SolveReport, State};
use nastic_body::strategy::Strategy;
use nastic_linear::LinearSolver;
use nastic_numeric::vector::sub;

/// Newton iterations of a warm start over those allowed for one step, after which the first step that fails makes the load
/// steps begin again at rest: a state that takes more is not nearby.
const MAX_WARM_START_RATIO: usize = 3;
/// Newton iterations from a guess.
const MAX_GUESS_ITERATIONS: usize = 15;
/// Newton iterations of load steps from rest after which the first step that fails ends them.
const MAX_ITERATIONS_FROM_REST: usize = 10_000;
/// Consecutive attempts with predicted pressures that may fail before no more are made.
const MAX_PRESSURE_FAILURES: usize = 2;
/// Ratio of bulk to shear modulus above which load steps that move prescribed components, which no line search shortens, begin with
/// independent strains at the quadrature points.
const MIN_RATIO_WITH_JUMP: f64 = 100.0;
/// Ratio of bulk to shear modulus above which other load steps try independent strains after a brief descent.
const MIN_RATIO: f64 = 1000.0;
/// Newton iterations of a brief descent.
const MAX_BRIEF_ITERATIONS: usize = 12;
/// Relative residual of intermediate states, where obstacles move.
const INTERMEDIATE_TOLERANCE: f64 = 1e-7;
/// Longest load step that is tried by descent after independent strains have failed, where descent is known to be slow; longer steps are halved at once.
const MAX_DESCENT_STEP: f64 = 1.0 / 16.0;

/// How load steps begin.
struct Way {
    /// Whether constraints hold the body.
    constrained: bool,
    /// Its ratio of bulk to shear modulus.
    ratio: f64,
    /// Whether independent strains have converged before.
    helped: bool,
}

impl Way {
    /// Steps in time are short, so that descent is not slow except under constraints without a potential, where the residual alone is searched.
    fn new(model: &Model, to: &Controls, in_time: bool) -> Self {
        let constrained = !(in_time && model.properties().has_potential()) && model.unknowns().multipliers() > 0;
        let ratio = if in_time { 0.0 } else { model.properties().bulk_over_shear(to) };
        Way { constrained, ratio, helped: false }
    }

    /// Whether descent on displacements is slow: a step that rotates or shears the body changes its volume, or violates the constraints.
    fn creeps(&self, jumps: bool) -> bool {
        self.constrained || jumps && self.ratio > MIN_RATIO_WITH_JUMP
    }

    /// Whether descent may be slow.
    fn may_creep(&self) -> bool {
        self.ratio > MIN_RATIO
    }
}

impl Model {
    /// The equilibrium under these controls, at full dead loads and prescribed displacements.
    ///
    /// 1. A guess (`how.guess`) is tried first, if a straight move from `how.near` to it is admissible.
    /// 2. The straight way from the starting state (rest with the designs of these controls, or `how.near`) is tried in one step. Where Newton's method is slow
    ///    (slender bodies), it continues with independent strains at the quadrature points. Steps under constraints, and those of nearly incompressible bodies
    ///    that move prescribed components, begin with them; other nearly incompressible bodies use them after a few iterations.
    /// 3. Where that fails too, the step is halved, and doubled again after a success; a load that failed is tried again from a quarter of the distance.
    ///    Steps below 1/4096 of the way fail, as does a limit point that two estimates agree on.
    /// 4. When a warm start fails, or needs more than three times `how.max_newton` iterations, the way from rest is tried.
    ///
    /// # Errors
    /// A typed [`StateError`]; where there was progress it holds the last equilibrium. [`StateError::Start`] where the way would begin
    /// outside of the admissible set.
    pub fn solve(&self, controls: &Controls, how: &SolveOptions) -> Result<State, StateError> {
        self.solve_with(controls, how, &mut Workspace::default())
    }

    /// [`solve`](Self::solve) with the workspace of earlier solves; a solve that fails clears it.
    ///
    /// # Errors
    /// As there.
    pub fn solve_with(
        &self,
        controls: &Controls,
        how: &SolveOptions,
        workspace: &mut Workspace,
    ) -> Result<State, StateError> {
        self.check()?;
        self.properties().supports(Feature::Equilibrium)?;
        self.find(controls, how, None, false, workspace)
    }

    /// The equilibrium, of a time step if there is one.
    pub fn find(
        &self,
        controls: &Controls,
        how: &SolveOptions,
        time_step: Option<&TimeStep>,
        shorter: bool,
        workspace: &mut Workspace,
    ) -> Result<State, StateError> {
        let found = self.search(controls, how, time_step, shorter, workspace);
        self.ranks().unless_parted(found).inspect_err(|_| workspace.forget())
    }

    fn search(
        &self,
        controls: &Controls,
        how: &SolveOptions,
        time_step: Option<&TimeStep>,
        shorter: bool,
        workspace: &mut Workspace,
    ) -> Result<State, StateError> {
        self.ranks().all_accept(self.check_request(controls, how))?;
        let rest = self.rest_under(controls);
        let mut spent = SolveReport::default();
        let start = how.near.unwrap_or(&rest);
        // the controls of a motion were checked at its beginning
        if time_step.is_none() {
            self.moves().check_start(start, how.parallel)?;
        }
        if let Some(guess) = how.guess
            && how.tries(Strategy::Guess, &mut spent)
            && let Some(found) = self.jump(guess, controls, how, time_step, workspace, &mut spent)?
        {
            return Ok(found);
        }
        if let (Some(step), Some(near)) = (time_step, how.near)
            && self.properties().depends_on_path()
            && how.tries(Strategy::LaggedFriction, &mut spent)
            && let Some(found) = self.slide(near, controls, how, step, workspace, &mut spent)?
        {
            return Ok(found);
        }
        let most = match time_step {
            Some(_) if !shorter => MAX_ITERATIONS_FROM_REST,
            Some(_) => spent.newton + MAX_WARM_START_RATIO * how.max_newton,
            None => MAX_WARM_START_RATIO * how.max_newton,
        };
        let Some(near) = how.near else {
            return self.walk(&rest, controls, (how, time_step), MAX_ITERATIONS_FROM_REST, workspace, &mut spent);
        };
        match self.walk(near, controls, (how, time_step), most, workspace, &mut spent) {
            // a motion does not begin again at rest in the middle
            Err(error) if error.is_final() || time_step.is_some() => Err(error),
            Err(failed) if !how.tries(Strategy::FromRest, &mut spent) => Err(failed),
            Err(failed) => {
                workspace.forget();
                let left = how.budget.map(|budget| budget.saturating_sub(spent.newton));
                let left = SolveOptions { budget: left, ..how.clone() };
                let found = self.walk(
                    &rest,
                    controls,
                    (&left, None),
                    MAX_ITERATIONS_FROM_REST,
                    workspace,
                    &mut SolveReport::default(),
                );
                let mut state = found.map_err(|again| again.or_cut(failed, how.budget))?;
                state.report.add_work(&spent);
                state.report.restarts += 1;
                Ok(state)
            }
            solved => solved,
        }
    }

    /// One load step: descent and, where that is slow, independent strains at the quadrature points from its last iterate. Once these have
    /// converged, the next steps begin with them, as all steps do for which descent is known to be slow. Independent strains are not used where the
    /// path seems to turn back, nor beyond the convexity bound (`hopeless`). On failure u is the last iterate.
    fn attempt(
        &self,
        newton: &Equations,
        u: &mut Vec<f64>,
        (way, distance, hopeless): (&mut Way, f64, bool),
        workspace: &mut Workspace,
        report: &mut SolveReport,
    ) -> Result<(), Stop> {
        if newton.is_static() && self.settles() && newton.options.tries(Strategy::ProximalSteps, report) {
            let mut end = u.clone();
            match self.settle(newton, &mut end, workspace, report) {
                Err(stop) if !stop.is_final() && self.checks().is_held_without_contact() => workspace.forget(),
                ended => {
                    *u = end;
                    return ended;
                }
            }
        }
        let suited = !hopeless && self.suits_point_strains() && newton.options.strategies.has(Strategy::PointStrains);
        let jumps = newton.jump(u).is_some();
        let creeps = way.creeps(jumps);
        let first = suited && (creeps || way.helped && !jumps);
        if !first && !hopeless && self.attempt_with_pressures(newton, u, workspace, report)? {
            return Ok(());
        }
        if first {
            report.strategies.count(Strategy::PointStrains);
            let from = u.clone();
            match newton.solve_with_point_strains(u, self.linear_solver(newton.options, workspace), report) {
                Ok(()) => return Ok(()),
                Err(stop) if stop.is_final() => return Err(stop),
                Err(stop @ Stop::Linear(_)) => return Err(stop),
                Err(stop) if creeps && distance > MAX_DESCENT_STEP => return Err(stop),
                Err(_) => workspace.forget(),
            }
            *u = from;
        }
        if suited
            && !first
            && !jumps
            && way.may_creep()
            && newton.options.tries(Strategy::BriefDescent, report)
            && self.attempt_briefly(newton, u, way, workspace, report)?
        {
            return Ok(());
        }
        let slow = match newton.solve_by_displacement(u, self.linear_solver(newton.options, workspace), report) {
            Ok(_) => return Ok(()),
            Err(slow @ Stop::Slow { .. }) => slow,
            Err(other) => return Err(other),
        };
        if first || !suited || newton.jump(u).is_some() {
            return Err(slow);
        }
        workspace.forget();
        report.strategies.count(Strategy::PointStrains);
        match newton.solve_with_point_strains(u, self.linear_solver(newton.options, workspace), report) {
            Ok(()) => {
                way.helped = true;
                Ok(())
            }
            Err(stop) if stop.is_final() => Err(stop),
            Err(_) => Err(slow),
        }
    }

    /// With predicted pressures, unless these have failed before; on failure u is unchanged.
    fn attempt_with_pressures(
        &self,
        newton: &Equations,
        u: &mut Vec<f64>,
        workspace: &mut Workspace,
        report: &mut SolveReport,
    ) -> Result<bool, Stop> {
        if workspace.unpredicted >= MAX_PRESSURE_FAILURES
            || !newton.options.strategies.has(Strategy::PredictedPressures)
        {
            return Ok(false);
        }
        let before = report.unpredicted;
        let found = newton.solve_with_pressures(u, self.linear_solver(newton.options, workspace), report)?;
        match found {
            Some(_) => workspace.unpredicted = 0,
            None => workspace.unpredicted += report.unpredicted - before,
        }
        Ok(found.is_some())
    }

    /// A few iterations of descent, then independent strains at the quadrature points from the same start; where neither converges, u is the
    /// last iterate of the descent.
    fn attempt_briefly(
        &self,
        newton: &Equations,
        u: &mut Vec<f64>,
        way: &mut Way,
        workspace: &mut Workspace,
        report: &mut SolveReport,
    ) -> Result<bool, Stop> {
        let brief =
            SolveOptions { max_newton: newton.options.max_newton.min(MAX_BRIEF_ITERATIONS), ..newton.options.clone() };
        let briefly = Equations { options: &brief, ..*newton };
        let mut from = u.clone();
        match briefly.solve_by_displacement(u, self.linear_solver(newton.options, workspace), report) {
            Ok(_) => return Ok(true),
            Err(Stop::Slow { .. }) => workspace.forget(),
            Err(other) => return Err(other),
        }
        match newton.solve_with_point_strains(&mut from, self.linear_solver(newton.options, workspace), report) {
            Ok(()) => {
                way.helped = true;
                *u = from;
                Ok(true)
            }
            Err(stop) if stop.is_final() => Err(stop),
            Err(_) => {
                workspace.forget();
                Ok(false)
            }
        }
    }

    /// Whether its equations can be solved with independent strains at the quadrature points.
    pub(crate) fn suits_point_strains(&self) -> bool {
        let searched = self.properties().has_potential() || self.unknowns().multipliers() > 0;
        searched
            && !self.ranks().is_over_ranks()
            && self.unknowns().has_one_nodal_field()
            && !self.inequalities().contains(&true)
    }

    /// Whether the line search on the residual under constraints, which is slow, can be replaced by independent strains.
    pub(crate) fn residual_creeps(&self) -> bool {
        !self.properties().has_potential() && self.unknowns().multipliers() > 0 && self.suits_point_strains()
    }

    /// The equilibrium in one step from a guess; `None` where Newton's method does not converge.
    fn jump(
        &self,
        guess: &[f64],
        controls: &Controls,
        how: &SolveOptions,
        time_step: Option<&TimeStep>,
        workspace: &mut Workspace,
        report: &mut SolveReport,
    ) -> Result<Option<State>, StateError> {
        // with friction an impact takes many short steps; where the step fails, rounds of lagged friction follow, each of which is a solve
        let most = if self.properties().depends_on_path() { usize::MAX } else { MAX_GUESS_ITERATIONS };
        let brief = SolveOptions { max_newton: how.max_newton.min(most), ..how.clone() };
        let newton = self.equations(controls, 1.0, time_step, 1.0, &brief);
        let is_borne = match how.near {
            Some(near) => self.bears(near, controls, guess, how, time_step),
            None => newton.admissible_chord(guess, guess).is_ok(),
        };
        // a step of Newton's method may move a free body arbitrarily far
        let drifts = || newton.is_static() && self.settles() && newton.at(guess, |at| self.free_motion(at)).is_some();
        if !is_borne || drifts() {
            return Ok(None);
        }
        let mut u = guess.to_vec();
        match newton.solve(&mut u, self.linear_solver(how, workspace), report) {
            Ok(_) => {
                report.load_steps += 1;
                Ok(Some(State::equilibrium(u, controls.clone(), 1.0, *report)))
            }
            Err(stop) => stop.final_error().map_or(Ok(None), Err),
        }
    }

    /// The undeformed state without loads, all multipliers zero: the default start of every solve.
    pub fn rest(&self) -> State {
        let report = SolveReport { min_j: 1.0, ..SolveReport::default() };
        State::equilibrium(vec![0.0; self.unknowns().len()], self.controls(), 0.0, report)
    }

    /// The same with the designs of these controls, which hold from the first load step on: in the shape that they give the body.
    pub fn rest_under(&self, controls: &Controls) -> State {
        let controls = self.with_designs(self.controls(), controls);
        State { u: self.unstressed(&controls).into(), controls: controls.into(), ..self.rest() }
    }

    /// The linear solver of a workspace for this model.
    pub fn linear_solver<'w>(&self, how: &SolveOptions, workspace: &'w mut Workspace) -> &'w mut dyn LinearSolver {
        workspace.solver(how.solver.unwrap_or_else(|| self.solver()), self)
    }

    /// By load steps, as few as converge; it fails at the first failed step after `most` iterations.
    fn walk(
        &self,
        from: &State,
        to: &Controls,
        (how, time_step): (&SolveOptions, Option<&TimeStep>),
        most: usize,
        workspace: &mut Workspace,
        report: &mut SolveReport,
    ) -> Result<State, StateError> {
        let mut here = from.clone();
        let (mut steps, mut follow, mut failed) = (LoadSteps::default(), None::<Vec<f64>>, false);
        let mut way = Way::new(self, to, time_step.is_some());
        let unbounded = self.unknowns().any(self.body.excess_tension(to).is_some());
        // in time, steps are short
        let obstacles_move = time_step.is_none() && {
            let instant = self.instant(from, None, how.parallel);
            self.contacts().poses(&instant) != self.contacts().poses(&instant.under(to))
        };
        while steps.done < 1.0 {
            let instant = Instant { controls: &here.controls, ..self.instant(&here, time_step, how.parallel) };
            let bears =
                self.moves().admissible_change(&instant, &instant.under(to)).map_err(|at| StateError::Start { at })?;
            // where obstacles move, the predictor is the tangent of the contact, unless the last step with it failed; else the last increment
            let tangent = match obstacles_move && !failed && how.tries(Strategy::Rate, report) {
                true => self.rate_along((&here, from, to), how, steps.done, bears, workspace, report),
                false => None,
            };
            let rate = tangent.or_else(|| follow.take().filter(|_| bears < 1.0));
            let ahead = |length| rate.as_ref().map(|rate| moved(&here.u, rate, length));
            let borne =
                |u: Vec<f64>| self.moves().admissible_change(&instant, &Instant { u: &u, ..instant.under(to) }).ok();
            let followed = ahead(1.0 - steps.done).and_then(borne).filter(|share| *share > bears || *share == 1.0);
            let path = match followed.unwrap_or(bears) {
                share if share < 1.0 => steps.next().min(steps.done + share * (1.0 - steps.done)),
                _ => steps.next(),
            };
            let controls = from.controls.blend(to, path);
            // exactly 1 at the end of the way
            let load = if path == 1.0 { 1.0 } else { from.load + path * (1.0 - from.load) };
            let rough = SolveOptions { accuracy: how.accuracy.max(INTERMEDIATE_TOLERANCE), ..how.clone() };
            let how_here = if obstacles_move && path < 1.0 { &rough } else { how };
            let newton = self.equations(&controls, load, time_step, path, how_here);
            let hopeless = unbounded || steps.limit_point().is_some();
            let ahead = followed.and_then(|_| ahead(path - steps.done)).filter(|u| newton.evaluate(u).is_ok());
            let mut u = ahead.unwrap_or_else(|| here.u.to_vec());
            let step = (&mut way, path - steps.done, hopeless);
            let attempted = self.attempt(&newton, &mut u, step, workspace, report);
            failed = attempted.is_err();
            match attempted {
                Ok(()) => {
                    report.load_steps += 1;
                    if bears < 1.0 {
                        let length = path - steps.done;
                        follow = Some(u.iter().zip(here.u.iter()).map(|(to, from)| (to - from) / length).collect());
                    }
                    steps.succeeded(path, self.unknowns().norm(&sub(self.nodal(&u), self.nodal(&here.u))));
                    here = State::equilibrium(u, controls, load, *report);
                }
                Err(Stop::Cancelled) => return Err(StateError::Cancelled),
                Err(Stop::Linear(error)) => return Err(error.into()),
                Err(stop) if stop.is_final() => {
                    steps.failed(path);
                    return Err(self.give_up(stop, path, (&steps, None), (to, how.budget), report, here));
                }
                Err(stop) => {
                    // a body that no contact holds is not held under less load either
                    let lost = matches!(stop, Stop::Lost { .. });
                    if steps.failed(path) || report.newton > most || lost {
                        let known = steps.limit_point().is_some() || time_step.is_some();
                        let free = || {
                            (!known).then(|| newton.at(&u, |at| self.free_motion(at))).flatten().map(Cause::FreeMotion)
                        };
                        let suspect = newton.at(&u, |at| self.suspect(at)).or_else(free);
                        let error = self.give_up(stop, path, (&steps, suspect), (to, None), report, here);
                        // the caller of a trial from a state nearby finds its cause
                        let alone = time_step.is_none() && how.near.is_none() && !self.ranks().is_over_ranks();
                        return Err(if alone { self.explained(error, to, how) } else { error });
                    }
                    report.cuts += 1;
                    workspace.forget();
                }
            }
        }
        here.report = *report;
        Ok(here)
    }

    fn give_up(
        &self,
        stop: Stop,
        load: f64,
        (steps, suspect): (&LoadSteps, Option<Cause>),
        (controls, budget): (&Controls, Option<usize>),
        report: &SolveReport,
        here: State,
    ) -> StateError {
        let (cuts, last) = (report.cuts, Box::new(here));
        match stop {
            Stop::Inadmissible(at) => StateError::inadmissible(at, load, cuts, last),
            Stop::Slow { residual } | Stop::Lost { residual } | Stop::Spent { residual } => {
                let excess = self.body.excess_tension(controls).map(Cause::Convexity);
                let limit = || steps.limit_point().map(|load| Cause::LimitPoint { load });
                let cause = excess.or(suspect).or_else(limit).unwrap_or(Cause::Unknown);
                StateError::NoConvergence {
                    load,
                    cuts,
                    newton: report.newton,
                    residual,
                    reached: steps.done,
                    cause,
                    budget,
                    last,
                }
            }
            Stop::Linear(error) => error.into(),
            Stop::Cancelled => StateError::Cancelled,
        }
    }
}
