//! [`Ensemble`]: one control for many bodies.

mod builder;
mod constrained;
mod displacement;
mod first_order;
mod objective;
mod on_team;
mod report;
mod second_order;
mod shape;

pub use builder::EnsembleBuilder;
pub use report::Measured;

use crate::blocks::{EnsembleBlock, gather, scatter};
use crate::error::EnsembleError;
use crate::first_order::FirstOrder;
use crate::member::Member;
use crate::parcel::{MemberValues, Parcel};
use crate::point::{EnsemblePoint, EnsembleWorkspace, Held};
use crate::product::EnsembleProduct;
use crate::ranks::{self, Ranks};
use nastic_control::{ControlError, Evaluated, Lagrangian, MotionObserver, Reduced, ReducedWorkspace, StepUnderWay};
use nastic_fem::Progress;
use nastic_opt::Request;
use nastic_uncertainty::risk::Risk;
use std::fmt;
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Mutex};
use std::time::Instant;

/// The risk of one control vector over scenarios, each a weighted sum over load cases:
///
/// `jhat(m) = R(j_1(m), .., j_n(m))`, `j_s(m) = sum_l w_l j_sl(m_sl)`,
/// `djhat/dm = sum_s (dR/dj_s) sum_l w_l dj_sl/dm`.
///
/// Members share the controls that have the same names; a load case may have controls of its own
/// ([`LoadCase::own`](crate::LoadCase::own)). The vector holds every block once. Members are evaluated side by side, each on one thread and
/// from its own last state; vectors are summed along the binary tree of the members' numbers, so the bits depend neither on the number of
/// threads nor on that of ranks ([`Ensemble::share_out`]). Members built on one [`Discretization`](nastic_fem::Discretization) share mesh and symbolic analysis.
/// A member without an equilibrium is a failed trial that names it.
///
/// **Memory.** A point keeps its members' states. The workspace keeps at most one factor per member
/// ([`EnsembleWorkspace::factor_bytes`]), however many points there are; [`EnsembleBuilder::keep_factors`] does without.
///
/// Source: docs/model/derivative.md; survey, section 4.2.3.
///
/// ```
/// use nastic_control::{Reduced, Space, Target, Tracking};
/// use nastic_uncertainty::risk::MeanDeviation;
/// use nastic_energy::{MooneyRivlin, Turgor};
/// use nastic_ensemble::Ensemble;
/// use nastic_fem::{Discretization, Solid};
/// use nastic_mesh::{CellKind, box_mesh};
/// use nastic_opt::{Bounds, Optimizer, ProjectedGradient};
///
/// let mesh = Discretization::new(box_mesh([1.0, 0.2, 0.2], [2, 1, 1], CellKind::Hex8)?.into())?;
/// let longer = Target::position(|x| [1.05 * x[0], x[1], x[2]]);
/// let mut robust = Ensemble::new(MeanDeviation { lambda: 1.0 });
/// for (name, mu) in [("soft", 0.8e5), ("stiff", 1.2e5)] {
///     let body = Solid::on(mesh.clone())
///         .material("body", MooneyRivlin::new(mu, 2e4, 2e5)?)?
///         .actuate("body", "turgor", Turgor::new())?
///         .clamp("x-")?;
///     let problem =
///         Reduced::new(body).control("turgor", Space::Uniform)?.cost(Tracking::surface("x+", longer.clone()))?;
///     robust = robust.scenario(name, 0.5, problem);
/// }
/// let robust = robust.build()?;
/// // Not from 0: there all scenarios cost the same, and the deviation has a kink.
/// let best = ProjectedGradient::default().within(Bounds::new(0.0, 1e5)?).minimize(&robust, 1e3)?;
/// assert_eq!(best.point.costs.len(), 2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Ensemble {
    members: Vec<Member>,
    names: Vec<String>,
    probabilities: Vec<f64>,
    blocks: Vec<EnsembleBlock>,
    len: usize,
    risk: Box<dyn Risk>,
    first_order: Option<FirstOrder>,
    product: Arc<EnsembleProduct>,
    watch: Watch,
    ranks: Ranks,
    /// Motions that stay where they are while others move: number, saved, as they are.
    kept: Mutex<Vec<(usize, Vec<u8>, Evaluated)>>,
}

/// A member that has been evaluated: the argument of [`EnsembleBuilder::watched_by`].
#[derive(Debug, Clone, Copy)]
pub struct Finished<'a> {
    /// Index of the member.
    pub index: usize,
    /// How many members there are.
    pub of: usize,
    /// The member.
    pub name: &'a str,
    /// Its cost, or why there is none.
    pub cost: Result<f64, &'a ControlError>,
}

type Watcher = dyn Fn(&Finished) + Send + Sync;

#[derive(Clone)]
struct Watch(Option<Arc<Watcher>>);

impl fmt::Debug for Watch {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(if self.0.is_some() { "Watch(..)" } else { "Watch(nobody)" })
    }
}

impl Ensemble {
    /// Begins an ensemble that is judged by a measure of risk; `Box<dyn Risk>` is one chosen at run time.
    #[allow(clippy::new_ret_no_self)]
    pub fn new(risk: impl Risk + 'static) -> EnsembleBuilder {
        EnsembleBuilder::new(Box::new(risk))
    }

    /// The members, scenario by scenario, load case by load case.
    pub fn members(&self) -> &[Member] {
        &self.members
    }

    /// A flag that ends the state solves of all members, as [`EnsembleBuilder::cancelled_by`] does.
    pub fn cancel_by(&mut self, flag: &Arc<AtomicBool>) {
        self.members.iter_mut().for_each(|member| member.problem.set_cancel(flag.clone()));
    }

    /// Whether unstable equilibria of members fail: see [`Reduced::refuse_unstable`](nastic_control::Reduced::refuse_unstable).
    pub fn refuse_unstable(&mut self, refuse: bool) {
        self.members.iter_mut().for_each(|member| member.problem.set_refuse_unstable(refuse));
    }

    /// Names of the scenarios.
    pub fn scenarios(&self) -> &[String] {
        &self.names
    }

    /// Probabilities of the scenarios.
    pub fn probabilities(&self) -> &[f64] {
        &self.probabilities
    }

    /// The measure of risk.
    pub fn risk(&self) -> &dyn Risk {
        self.risk.as_ref()
    }

    /// Length of the control vector.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether nothing is controlled.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// The control fields, in the order they first occur.
    pub fn blocks(&self) -> &[EnsembleBlock] {
        &self.blocks
    }

    /// The control field of a name.
    ///
    /// # Errors
    /// [`EnsembleError::UnknownControl`] with the names there are.
    pub fn block(&self, name: &str) -> Result<&EnsembleBlock, EnsembleError> {
        self.blocks.iter().find(|b| b.name == name).ok_or_else(|| EnsembleError::UnknownControl {
            name: name.to_owned(),
            known: self.blocks.iter().map(|b| b.name.clone()).collect::<Vec<_>>().join(", "),
        })
    }

    /// Smallest convexity bound of a tension over all members that use the control; `None` where no law states one.
    ///
    /// # Errors
    /// [`EnsembleError::UnknownControl`].
    pub fn fiber_limit(&self, name: &str) -> Result<Option<f64>, EnsembleError> {
        let block = self.block(name)?;
        let mut lowest: Option<f64> = None;
        for member in &self.members {
            for (field, index) in member.problem.layout().blocks().iter().zip(&member.blocks) {
                if self.blocks[*index].first == block.first {
                    let body = member.problem.solid().body();
                    let limits = field.targets.iter().filter_map(|target| body.fiber_limit(target.actuation));
                    lowest = lowest.into_iter().chain(limits).reduce(f64::min);
                }
            }
        }
        Ok(lowest)
    }

    /// The control vector of one member.
    ///
    /// # Errors
    /// [`EnsembleError::Length`].
    pub fn local(&self, member: &Member, m: &[f64]) -> Result<Vec<f64>, EnsembleError> {
        self.check_len(m)?;
        Ok(gather(&self.blocks, member, m))
    }

    /// Equilibria and risk at m, from rest, in the first stage, to residuals of 1e-11. What
    /// [`Objective::evaluate`](nastic_opt::Objective::evaluate) does from elsewhere, in other stages, to other accuracies.
    ///
    /// # Errors
    /// The first member, in order, without an equilibrium or with a cost that is not finite.
    pub fn at(&self, m: &[f64]) -> Result<EnsemblePoint, EnsembleError> {
        self.evaluate_typed(
            m,
            &Request { accuracy: Reduced::AT_REST, ..Request::default() },
            &mut EnsembleWorkspace::default(),
        )
    }

    fn evaluate_typed(
        &self,
        m: &[f64],
        how: &Request<'_, EnsemblePoint>,
        workspace: &mut EnsembleWorkspace,
    ) -> Result<EnsemblePoint, EnsembleError> {
        self.observe(m, how, &[], workspace)
    }

    /// The same as [`evaluate`](nastic_opt::Objective::evaluate), with an observer of the motion of each member: [`Reduced::observe`](nastic_control::Reduced::observe).
    ///
    /// # Errors
    /// As there, with their type.
    pub fn observe(
        &self,
        m: &[f64],
        how: &Request<'_, EnsemblePoint>,
        observers: &[&dyn MotionObserver],
        workspace: &mut EnsembleWorkspace,
    ) -> Result<EnsemblePoint, EnsembleError> {
        self.check_len(m)?;
        let began = Instant::now();
        let evaluate = |index: usize, member: &Member, workspace: &mut ReducedWorkspace| {
            let near = how.near.and_then(|point| point.member(index));
            let request = Request { near, accuracy: how.accuracy, stage: how.stage, budget: how.budget };
            let own = gather(&self.blocks, member, m);
            let outcome = match observers.get(index) {
                Some(observer) => member.problem.observe(&own, &request, *observer, workspace),
                None => member.problem.evaluate_typed(&own, &request, workspace),
            };
            self.report_trial(index, &outcome);
            outcome
        };
        let found = self.side_by_side(workspace, evaluate, |_, at| MemberValues::of(at));
        self.ranks.took(began.elapsed());
        let (points, values) = found?;
        self.with_first_order(self.joined(m, points, values)?, workspace)
    }

    fn check_len(&self, m: &[f64]) -> Result<(), EnsembleError> {
        let (found, expected) = (m.len(), self.len);
        if found == expected { Ok(()) } else { Err(EnsembleError::Length { found, expected }) }
    }

    /// Costs of the scenarios, and their risk.
    fn joined(
        &self,
        m: &[f64],
        members: Vec<Evaluated>,
        reports: Vec<MemberValues>,
    ) -> Result<EnsemblePoint, EnsembleError> {
        let mut costs = vec![0.0; self.names.len()];
        for (member, report) in self.members.iter().zip(&reports) {
            let value = report.cost();
            if !value.is_finite() {
                return Err(EnsembleError::Value { who: member.name.clone(), value });
            }
            costs[member.scenario] += member.weight * value;
        }
        let risk = self.risk.value(&self.probabilities, &costs);
        let held = if self.ranks.is_alone() { Held::All } else { Held::Own { first: self.ranks.own().start, reports } };
        Ok(EnsemblePoint { m: m.to_vec(), members, costs, risk, first_order: None, held })
    }

    /// Runs `each` for every member of this rank, and sends the others what `tell` makes of it: own results, and what was sent of all, in
    /// the members' order. Which of those behind a failure had run already depends on timing: their factors and the limit points that they
    /// met are dropped, so that the next evaluation does not depend on it.
    fn side_by_side<T: Send, R: Parcel>(
        &self,
        workspace: &mut EnsembleWorkspace,
        each: impl Fn(usize, &Member, &mut ReducedWorkspace) -> Result<T, ControlError> + Sync,
        tell: impl Fn(usize, &T) -> R,
    ) -> Result<(Vec<T>, Vec<R>), EnsembleError> {
        let own = self.ranks.own();
        let first = own.start;
        let workspaces = workspace.of(own.len());
        let outcome =
            ranks::side_by_side(workspaces, |k, workspace| each(first + k, &self.members[first + k], workspace));
        let (found, told) = match outcome {
            Ok(found) => {
                let told = (first..).zip(&found).map(|(index, found)| tell(index, found)).collect();
                (Some(found), Ok(told))
            }
            Err((k, error)) => (None, Err((first + k, error))),
        };
        match (self.ranks.share(told)?, found) {
            (Ok(told), found) => Ok((found.unwrap_or_default(), told)),
            (Err((failed, error)), _) => {
                let behind = (first..).zip(workspaces).filter(|(index, _)| *index > failed);
                behind.for_each(|(_, own)| own.after_failure());
                Err(EnsembleError::member(&self.members[failed].name, error))
            }
        }
    }

    /// The sum over all members of dual vectors of theirs times weights, along the tree; `of` has those of the members of this rank.
    fn sum<'d>(&self, of: impl Iterator<Item = Option<(f64, &'d [f64])>>) -> Result<Vec<f64>, EnsembleError> {
        let (first, of): (usize, Vec<_>) = (self.ranks.own().start, of.collect());
        self.ranks.sum(self.len, |index| {
            let (weight, own) = of.get(index - first).copied().flatten()?;
            let mut out = vec![0.0; self.len];
            scatter(&self.blocks, &self.members[index], weight, own, &mut out);
            Some(out)
        })
    }

    /// The members of this rank.
    fn own(&self) -> &[Member] {
        &self.members[self.ranks.own()]
    }

    fn report_trial(&self, index: usize, outcome: &Result<Evaluated, ControlError>) {
        if let Some(watch) = &self.watch.0 {
            let cost = outcome.as_ref().map(Evaluated::cost);
            watch(&Finished { index, of: self.members.len(), name: &self.members[index].name, cost });
        }
    }

    fn restage_typed(&self, stage: usize, point: &EnsemblePoint) -> Result<EnsemblePoint, EnsembleError> {
        let none = &mut EnsembleWorkspace::default();
        let restage = |index: usize, member: &Member, _: &mut ReducedWorkspace| match point.member(index) {
            Some(at) => member.problem.restage_typed(stage, at),
            None => Err(ControlError::Length { found: point.members.len(), expected: self.members.len() }),
        };
        let (points, values) = self.side_by_side(none, restage, |_, at| MemberValues::of(at))?;
        self.with_first_order(self.joined(&point.m, points, values)?, none)
    }

    /// Calls `watch` after every evaluated member from now on, as [`EnsembleBuilder::watched_by`] does.
    pub fn watch(&mut self, watch: impl Fn(&Finished) + Send + Sync + 'static) {
        self.watch = Watch(Some(Arc::new(watch)));
    }

    /// Calls `watch` after every Newton iteration of every member, with the member's name.
    pub fn watch_solves(&mut self, watch: impl Fn(&str, &Progress) + Send + Sync + 'static) {
        let watch = Arc::new(watch);
        for member in &mut self.members {
            let (watch, name) = (watch.clone(), member.name.clone());
            member.problem.watch_solves(move |progress| watch(&name, progress));
        }
    }

    /// Calls `watch` before every step of every member's motion, with the member's name.
    pub fn watch_steps(&mut self, watch: impl Fn(&str, &StepUnderWay) + Send + Sync + 'static) {
        let watch = Arc::new(watch);
        for member in &mut self.members {
            let (watch, name) = (watch.clone(), member.name.clone());
            member.problem.watch_steps(move |step| watch(&name, step));
        }
    }

    /// The derivative of one term's expected value `sum_s p_s sum_l w_l`, whatever the measure of risk.
    ///
    /// # Errors
    /// The first member, in order, whose adjoint cannot be had.
    pub fn derivative_of_term(
        &self,
        point: &EnsemblePoint,
        term: &str,
        workspace: &mut EnsembleWorkspace,
    ) -> Result<Vec<f64>, EnsembleError> {
        let of = |index: usize, member: &Member, workspace: &mut ReducedWorkspace| {
            let own = member.problem.term_names().iter().position(|name| name == term);
            match (own, point.member(index)) {
                (Some(own), Some(at)) => member.problem.derivative_of_term(at, own, workspace).map(Some),
                _ => Ok(None),
            }
        };
        self.expected(&self.side_by_side(workspace, of, |_, _| ())?.0)
    }

    /// The expected value of dual vectors of the members of this rank.
    fn expected(&self, of: &[Option<Vec<f64>>]) -> Result<Vec<f64>, EnsembleError> {
        let weight = |member: &Member| self.probabilities[member.scenario] * member.weight;
        self.sum(self.own().iter().zip(of).map(|(member, own)| Some((weight(member), own.as_deref()?))))
    }

    /// The derivative of the risk; the adjoint states go into the members' points.
    fn derivative_typed(
        &self,
        point: &mut EnsemblePoint,
        workspace: &mut EnsembleWorkspace,
    ) -> Result<Vec<f64>, EnsembleError> {
        if let Some(at) = &point.first_order {
            // of the adjoints that its value took
            let mut out = at.by_control.clone();
            self.add_first_order(&mut out, point, workspace)?;
            return Ok(out);
        }
        let by_cost = self.risk.weights(&self.probabilities, &point.costs);
        let weight = |member: &Member| by_cost[member.scenario] * member.weight;
        let (known, costs) = (&*point, Lagrangian { costs: true, y: &[] });
        let of = |index: usize, member: &Member, workspace: &mut ReducedWorkspace| match (
            weight(member),
            known.member(index),
        ) {
            (weight, Some(at)) if weight != 0.0 => {
                member.problem.lagrangian_sensitivity(at, costs, workspace).map(Some)
            }
            _ => Ok(None),
        };
        let (found, work) = self.side_by_side(workspace, of, |index, found| known.adjoint_work(index, found))?;
        let of = self.own().iter().zip(&found);
        let out = self.sum(of.map(|(member, found)| Some((weight(member), found.as_ref()?.0.as_slice()))))?;
        point.take_adjoints(self.ranks.own().start, found, work);
        Ok(out)
    }
}
