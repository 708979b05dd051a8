//! [`Reduced`]: the cost as a function of the controls alone.

mod adaptive_steps;
mod constrained;
mod controlled;
mod in_time;
mod instant;
mod motion;
mod motion_derivative;
mod motion_progress;
mod objective;
mod outputs;
mod over_ranks;
mod second_order;
mod sensitivity;
mod static_trial;
mod terms;
mod uncertain;
mod watches;

pub use adaptive_steps::AdaptiveSteps;
pub use constrained::Lagrangian;
pub(crate) use in_time::Motion;
pub use objective::work_summary;
pub use outputs::OutputJacobian;
pub use second_order::SecondDerivative;

use crate::constraint::Constraint;
use crate::cost::{Cost, IntoCost};
use crate::evaluated::{Evaluated, SolvedStates};
use crate::time::{MotionObserver, StepUnderWay, Timeline, When};
use crate::workspace::ReducedWorkspace;
use nastic_fem::{
    Begin, Body, Controls, FemError, Progress, Solid, SolveOptions, SolveReport, State, StateError, Workspace,
};
use nastic_fields::{ControlError, ControlValues, Layout, Metric, inner_product};
use nastic_opt::{InnerProduct, Request};
use std::borrow::Cow;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use uncertain::Uncertain;
use watches::{SolveProgress, StepProgress};

/// `jhat(m) = j(u(m), m)` with its derivative by the adjoint.
///
/// Value: one equilibrium. Derivative: `K(u*) lambda = -dj/du`, then
/// `djhat/dm = dj/dm + int (dP/dm) : grad lambda dX`. Source: docs/model/derivative.md; survey, section 4.
///
/// Built by chaining. What is controlled is said by [`control`](Self::control); nothing is controlled unasked.
///
/// Of a body over ranks ([`Solid::of_part`]) all ranks build the same problem and call the same methods together. The control vector is that of the whole body, with the numbers
/// and in the order of one process; vectors, costs and derivatives have the same bits on all ranks, so that an optimiser on each of them takes the same
/// decisions. States are those of the part. See docs/one-body-over-ranks.md.
///
/// ```
/// use nastic_control::{ControlEntity, Reduced, ReducedWorkspace, Space, Target, Tracking};
/// use nastic_energy::{FiberTension, NeoHooke};
/// use nastic_fem::Solid;
/// use nastic_mesh::{CellKind, box_mesh};
/// use nastic_opt::{Bounds, Lbfgs, Objective, Optimizer};
/// use nastic_tensor::Vec3;
///
/// let body = Solid::new(box_mesh([1.0, 0.2, 0.2], [3, 1, 2], CellKind::Hex8)?)?
///     .material("body", NeoHooke::from_young_poisson(3e5, 0.3)?)?
///     .actuate("body", "tension", FiberTension::along(Vec3::x())?)?
///     .clamp("x-")?;
/// let shorter = Target::position(|x| [0.9 * x[0], x[1], x[2]]);
/// let problem = Reduced::new(body).control("tension", Space::Cell)?.cost(Tracking::surface("x+", shorter))?;
///
/// // One control: its equilibrium, its cost, the derivative dj/dm.
/// let mut start = problem.at(&[0.0; 6])?;
/// let derivative = problem.derivative(&mut start, &mut ReducedWorkspace::default())?;
/// assert!((start.cost() - 0.5 * 0.1 * 0.1 * 0.04).abs() < 1e-12); // 1/2 int (0.1 m)^2 dA, 0.04 m^2
/// assert!(derivative.iter().all(|d| *d > 0.0)); // less tension shortens the bar
///
/// // Any optimiser of nastic-opt takes it.
/// let best = Lbfgs::default().within(Bounds::new(-2e5, 0.0)?).minimize(&problem, &start)?;
/// assert!(best.cost < 1e-2 * start.cost());
///
/// // Which cell has which tension.
/// let values = problem.values("tension", &best.m)?;
/// assert_eq!(values.unit(), "Pa");
/// for (cell, tension) in values {
///     assert!(matches!(cell, ControlEntity::Cell(_)) && tension[0] < 0.0, "{cell}: {} Pa", tension[0]);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Reduced {
    solid: Solid,
    layout: Layout,
    /// Numbers beside the controls, by which the cost has derivatives.
    uncertain: Option<Uncertain>,
    /// By stage, where the maps of fields change from stage to stage.
    staged: Vec<Layout>,
    costs: Vec<Box<dyn Cost>>,
    constraints: Vec<Box<dyn Constraint>>,
    metric: Metric,
    /// What finds states in place of the model of the body.
    projected: Option<Arc<dyn Body>>,
    /// Of a problem in time.
    motion: Option<Motion>,
    /// Compute on all threads; `false` for a member of an ensemble.
    parallel: bool,
    /// Whether the workspace keeps a factor for the next solve.
    keep_factors: bool,
    /// Whether a state with negative pivots is no answer.
    refuse_unstable: bool,
    /// Whether rigid motions of the body may be free.
    may_float: bool,
    cancel: Option<Arc<AtomicBool>>,
    progress: Option<SolveProgress>,
    steps: Option<StepProgress>,
}

/// Relative residual asked of a state solve per relative accuracy of the state: slender bodies amplify residuals.
const RESIDUAL_PER_ACCURACY: f64 = 1e-2;

impl Reduced {
    /// Relative accuracy of the states of evaluations that nothing was said about ([`at`](Self::at)): residuals of 1e-11.
    pub const AT_REST: f64 = 1e-9;

    /// The problem of a body, with no cost yet.
    pub fn new(solid: Solid) -> Self {
        let layout = Layout::new(solid.controls());
        Reduced {
            solid,
            projected: None,
            layout,
            uncertain: None,
            staged: vec![],
            costs: vec![],
            constraints: vec![],
            metric: Metric::L2,
            motion: None,
            parallel: true,
            keep_factors: true,
            refuse_unstable: false,
            may_float: false,
            cancel: None,
            progress: None,
            steps: None,
        }
    }

    /// With states in the space that another body allows, a projection of this one on modes, say: equilibria and first derivatives.
    ///
    /// # Errors
    /// [`FemError::Unsupported`] of a motion, and of a body over ranks.
    pub fn projected(self, body: Arc<dyn Body>) -> Result<Self, ControlError> {
        self.solid.model().ranks().refuse_ranks(body.name())?;
        match self.motion {
            Some(_) => Err(not_projected("a problem in time", body.name())),
            None => Ok(Reduced { projected: Some(body), ..self }),
        }
    }

    /// The state that the body finds; one of a projection is held to what a state is.
    pub(crate) fn solved(
        &self,
        controls: &Controls,
        how: &SolveOptions<'_>,
        workspace: &mut Workspace,
    ) -> Result<State, StateError> {
        let state = self.body().solve(controls, how, workspace)?;
        let Some(body) = &self.projected else { return Ok(state) };
        let is_state = state.u.len() == self.solid.model().unknowns().len() && state.u.iter().all(|u| u.is_finite());
        match is_state && *state.controls == *controls {
            true => Ok(state),
            false => {
                let what = format!(
                    "\"{}\" found no state of the body under the controls asked for: one finite number for each of its unknowns",
                    body.name()
                );
                Err(FemError::Meaningless { what }.into())
            }
        }
    }

    /// Refuses what the model does by itself.
    fn refuse_projection(&self, what: &str) -> Result<(), ControlError> {
        self.projected.as_ref().map_or(Ok(()), |body| Err(not_projected(what, body.name())))
    }

    /// What finds states and adjoints: the model of the body, or its [projection](Self::projected).
    pub(crate) fn body(&self) -> &dyn Body {
        self.projected.as_deref().unwrap_or(self.solid.model())
    }

    /// Shares vectors with other problems on the [`Discretization`](nastic_fem::Discretization) that have equal ones, as members of an
    /// ensemble do: supports, dead loads, fixed values.
    pub fn share_equal_parts(mut self) -> Self {
        self.solid.share_equal_parts();
        self.layout.share_equal_parts(self.solid.discretization());
        self.update_layout();
        self
    }

    /// Adds a cost term; in a problem in time [at its end](crate::When::End).
    ///
    /// # Errors
    /// What the cost does not find on the body.
    pub fn cost(mut self, cost: impl IntoCost) -> Result<Self, ControlError> {
        if self.motion.is_some() {
            return self.cost_when(When::End, cost);
        }
        let model = self.solid.model();
        if let Some(what) = cost.not_over_ranks() {
            model.ranks().refuse_ranks(&what)?;
        }
        self.costs.push(model.ranks().all_accept(cost.bind(&self.solid))?);
        Ok(self)
    }

    /// Chooses the inner product of the gradient (default: L2, lumped).
    pub fn metric(mut self, kind: Metric) -> Self {
        self.metric = kind;
        self
    }

    /// Which inner product the gradient has: see [`metric`](Self::metric).
    pub fn metric_kind(&self) -> Metric {
        self.metric
    }

    /// A flag that ends a state solve between its iterations, with [`StateError::Cancelled`](nastic_fem::StateError).
    pub fn cancelled_by(mut self, flag: Arc<AtomicBool>) -> Self {
        self.cancel = Some(flag);
        self
    }

    /// Calls `watch` after every Newton iteration of a state solve.
    pub fn watch_solves(&mut self, watch: impl Fn(&Progress) + Send + Sync + 'static) {
        self.progress = Some(SolveProgress(Arc::new(watch)));
    }

    /// Calls `watch` before every step of a motion, those that are computed again for a derivative excepted.
    pub fn watch_steps(&mut self, watch: impl Fn(&StepUnderWay) + Send + Sync + 'static) {
        self.steps = Some(StepProgress(Arc::new(watch)));
    }

    /// Computes on one thread: for members of an ensemble, which run side by side.
    pub fn sequential(mut self) -> Self {
        self.parallel = false;
        self
    }

    /// Whether the workspace keeps a factor of the tangent for the next solve, and points what their costs need for partials
    /// (the default). Without, a solve begins with a factorisation of its own, costs are evaluated again for partials, and a
    /// point is little more than its state: for the many members of a sample that are evaluated once.
    pub fn keep_factors(mut self, keep: bool) -> Self {
        self.keep_factors = keep;
        self
    }

    /// Whether an equilibrium whose tangent has negative pivots fails with [`ControlError::Unstable`] (one whose tangent is
    /// singular fails with the error of the factor), so that optimisers reject such trials (default: accepted). It takes one factorisation more per evaluation.
    pub fn refuse_unstable(mut self, refuse: bool) -> Self {
        self.refuse_unstable = refuse;
        self
    }

    /// Whether rigid motions of the body may be free, for what solves no equilibrium (modes of the undeformed body); equilibria then fail by a singular tangent.
    #[must_use]
    pub fn may_float(self, may_float: bool) -> Self {
        Reduced { may_float, ..self }
    }

    /// The same as [`cancelled_by`](Self::cancelled_by), of a problem that is in use.
    pub fn set_cancel(&mut self, flag: Arc<AtomicBool>) {
        self.cancel = Some(flag);
    }

    /// The same as [`refuse_unstable`](Self::refuse_unstable), of a problem that is in use.
    pub fn set_refuse_unstable(&mut self, refuse: bool) {
        self.refuse_unstable = refuse;
    }

    /// Whether all is there to be optimised: a complete body, controls, and an inner product of theirs. A run checks the
    /// same when it begins.
    ///
    /// # Errors
    /// An incomplete body; [`ControlError::NoControls`]; a control that acts on nothing.
    pub fn check(&self) -> Result<(), ControlError> {
        self.check_body()?;
        self.build_inner_product().map(drop)
    }

    /// Whether the body is complete, whatever is controlled. A motion from a given state needs no support, nor does what is not solved.
    ///
    /// # Errors
    /// What it lacks.
    pub fn check_body(&self) -> Result<(), ControlError> {
        let from_given = |timeline: &Timeline| timeline.begin() == Begin::Given && !timeline.scheme().is_quasi_static();
        let moves = self.timeline().is_some_and(from_given);
        match self.solid.check() {
            Err(FemError::RigidMotion { .. }) if moves || self.may_float => {
                Ok(self.solid.model().checks().check_in_motion()?)
            }
            checked => Ok(checked?),
        }
    }

    /// The inner product of the control fields.
    pub(crate) fn build_inner_product(&self) -> Result<Arc<dyn InnerProduct>, ControlError> {
        if self.layout.is_empty() {
            return Err(ControlError::NoControls { known: Layout::names(&self.solid).join(", ") });
        }
        inner_product(&self.solid, &self.layout, self.metric)
    }

    /// The body.
    pub fn solid(&self) -> &Solid {
        &self.solid
    }

    /// The control fields.
    pub fn layout(&self) -> &Layout {
        &self.layout
    }

    /// The values of a control field in a control vector, each with the cell, node or region it belongs to, and their unit.
    ///
    /// # Errors
    /// [`ControlError::UnknownControl`], [`ControlError::Length`].
    pub fn values<'a>(&'a self, control: &str, m: &'a [f64]) -> Result<ControlValues<'a>, ControlError> {
        self.layout.check(m)?;
        Ok(ControlValues::new(self.layout.block(control)?, m))
    }

    /// The cost terms.
    pub fn costs(&self) -> &[Box<dyn Cost>] {
        &self.costs
    }

    /// Equilibrium and cost at m, from rest, in the first stage, to a residual of 1e-11. What
    /// [`Objective::evaluate`](nastic_opt::Objective::evaluate) does from elsewhere, in other stages, to other accuracies.
    ///
    /// # Errors
    /// No equilibrium, or a cost that is not defined there.
    pub fn at(&self, m: &[f64]) -> Result<Evaluated, ControlError> {
        self.evaluate_typed(
            m,
            &Request { accuracy: Self::AT_REST, ..Request::default() },
            &mut ReducedWorkspace::default(),
        )
    }

    /// The same as [`evaluate`](nastic_opt::Objective::evaluate), with an observer of the motion while it runs; of a problem that is
    /// not one in time nothing is reported.
    ///
    /// # Errors
    /// As there, with their type; what the observer returns; bytes to go on from that are damaged or of another problem.
    pub fn observe(
        &self,
        m: &[f64],
        how: &Request<'_, Evaluated>,
        observer: &dyn MotionObserver,
        workspace: &mut ReducedWorkspace,
    ) -> Result<Evaluated, ControlError> {
        match &self.motion {
            Some(motion) => self.evaluate_motion(motion, m, how, Some(observer), workspace),
            None => self.evaluate_typed(m, how, workspace),
        }
    }

    /// The same as [`evaluate`](nastic_opt::Objective::evaluate), with the type of its errors.
    ///
    /// # Errors
    /// As there.
    pub fn evaluate_typed(
        &self,
        m: &[f64],
        how: &Request<'_, Evaluated>,
        workspace: &mut ReducedWorkspace,
    ) -> Result<Evaluated, ControlError> {
        if let Some(motion) = &self.motion {
            return self.evaluate_motion(motion, m, how, None, workspace);
        }
        self.check_same_control(m)?;
        self.solid.model().ranks().unless_parted(self.evaluate_static(m, how, workspace))
    }

    fn solve_options(&self, accuracy: f64) -> SolveOptions<'_> {
        SolveOptions {
            parallel: self.parallel,
            accuracy: accuracy * RESIDUAL_PER_ACCURACY,
            cancel: self.cancel.as_deref(),
            watch: self.progress.as_ref().map(|progress| &*progress.0 as &(dyn Fn(&Progress) + Sync)),
            ..SolveOptions::default()
        }
    }

    /// The values of costs and constraints in a state.
    fn valued(
        &self,
        solved: SolvedStates,
        m: &[f64],
        stage: usize,
        work: SolveReport,
    ) -> Result<Evaluated, ControlError> {
        let state = solved.recording.part().end();
        let (terms, costs) = self.terms(state, m, stage)?;
        let mut constraint_points = self.constraints_at(state, m, stage)?;
        let constraints = constraint_points.iter().flat_map(|point| point.values().to_vec()).collect();
        if !self.keep_factors {
            constraint_points.clear();
        }
        let m = m.to_vec();
        Ok(Evaluated { m, solved, terms, constraints, stage, work, costs, constraint_points, adjoint: None })
    }

    fn check_stable(&self, state: &State) -> Result<(), ControlError> {
        if !self.refuse_unstable {
            return Ok(());
        }
        let how = SolveOptions { parallel: self.parallel, ..SolveOptions::default() };
        match self.body().negative_pivots(state, &how)? {
            0 => Ok(()),
            negative => Err(ControlError::Unstable { negative, newton: state.report.newton }),
        }
    }

    /// Drops the factor where none is to be kept.
    fn forget(&self, workspace: &mut ReducedWorkspace) {
        if !self.keep_factors {
            workspace.solve.clear();
            workspace.limits.forget_states();
        }
    }

    /// The control fields at one instant: what costs of states see.
    pub fn layout_of_instant(&self) -> &Layout {
        self.motion.as_ref().map_or(&self.layout, |motion| &motion.layout)
    }

    /// The control fields with the maps of a stage; where these do not change from stage to stage, [`layout`](Self::layout).
    pub fn layout_in_stage(&self, stage: usize) -> &Layout {
        self.staged.get(stage).unwrap_or(&self.layout)
    }

    /// The same at one instant.
    pub fn layout_at(&self, stage: usize) -> &Layout {
        self.motion.as_ref().map_or(self.layout_in_stage(stage), |motion| &motion.layout)
    }

    /// Their vector at an instant.
    pub(crate) fn at_instant<'m>(&self, m: &'m [f64], t: f64) -> Result<Cow<'m, [f64]>, ControlError> {
        match self.motion {
            Some(_) => self.layout.at(m, t).map(Cow::Owned),
            None => Ok(Cow::Borrowed(m)),
        }
    }

    /// The same as [`restage`](nastic_opt::Objective::restage), with the type of its errors.
    ///
    /// # Errors
    /// As there.
    pub fn restage_typed(&self, stage: usize, point: &Evaluated) -> Result<Evaluated, ControlError> {
        match &self.motion {
            Some(motion) => self.restage_motion(motion, point, stage),
            // other maps give other values, and another state
            None if self.map_stage(stage) != self.map_stage(point.stage) => {
                let how = Request { near: Some(point), accuracy: point.solved.accuracy, stage, ..Request::default() };
                self.evaluate_typed(&point.m, &how, &mut ReducedWorkspace::default())
            }
            None => self.valued(point.solved.clone(), &point.m, stage, SolveReport::default()),
        }
    }

    /// The stage of the maps of fields in a stage.
    fn map_stage(&self, stage: usize) -> usize {
        stage.min(self.layout.stages() - 1)
    }
}

fn not_projected(what: &str, with: &str) -> ControlError {
    let why = "which has equilibria and first derivatives alone: take the body itself".to_owned();
    FemError::Unsupported { what: what.to_owned(), with: with.to_owned(), why }.into()
}
