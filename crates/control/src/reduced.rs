//! [`Reduced`]: the cost as a function of the controls alone.

use crate::cost::{Cost, CostContext, CostPoint, Figure, IntoCost, Partials};
use crate::error::ControlError;
use crate::inner_product::{Metric, inner_product};
use crate::kept_factor::SharedWorkspace;
use crate::layout::Layout;
use crate::map::Space;
use crate::state_predictor::StatePredictor;
use nastic_fem::{Progress, Solid, SolveOptions, SolveReport, State};
use nastic_opt::{Failed, InnerProduct, Objective, Problem, Report, Request};
use std::borrow::Cow;
use std::fmt;
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, OnceLock};

/// `jhat(m) = j(u(m), m)` with its derivative by the adjoint.
///
/// Value: one equilibrium. Derivative: `K(u*) lambda = -dj/du`, then
/// `djhat/dm = dj/dm + int (dP/dm) : grad lambda dX`. Source: docs/model.md section 6; survey, section 4.
///
/// Built by chaining; without a call of [`control`](Self::control) every actuation is controlled cell by cell.
#[derive(Debug)]
pub struct Reduced {
    solid: Solid,
    layout: Layout,
    costs: Vec<Box<dyn Cost>>,
    metric: OnceLock<Box<dyn InnerProduct>>,
    kind: Metric,
    /// Compute on all threads; `false` for a member of an ensemble.
    parallel: bool,
    /// Whether points keep a factor for the next solve.
    keep_factors: bool,
    /// Whether the control fields are as wanted, even if there are none.
    settled: bool,
    cancel: Option<Arc<AtomicBool>>,
    progress: Option<SolveProgress>,
}

/// What is told after every Newton iteration.
#[derive(Clone)]
struct SolveProgress(Arc<dyn Fn(&Progress) + Send + Sync>);

impl fmt::Debug for SolveProgress {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("SolveProgress(..)")
    }
}

/// An evaluated control: its state, the values of the terms. A value; nothing in it can go stale.
#[derive(Debug, Clone)]
pub struct Evaluated {
    /// The control vector.
    pub m: Vec<f64>,
    /// The equilibrium.
    pub state: State,
    /// Value of every cost term, weights included, in the order they were added.
    pub terms: Vec<f64>,
    /// Continuation stage of the values.
    pub stage: usize,
    /// Work of this evaluation, and later of its adjoint.
    pub work: SolveReport,
    /// The evaluated terms, for their partials and figures; empty where points keep no factors.
    costs: Vec<Arc<dyn CostPoint>>,
    /// Shared with the point it was evaluated from.
    factor: SharedWorkspace,
    /// The points it was evaluated from, one after the other.
    predictor: StatePredictor,
    adjoint: OnceLock<AdjointPart>,
}

/// Values of the cost terms, and the evaluated terms.
type Terms = (Vec<f64>, Vec<Arc<dyn CostPoint>>);

/// What the derivative leaves behind for output; its factor takes the place of the evaluation's.
#[derive(Debug, Clone)]
struct AdjointPart {
    lambda: Vec<f64>,
    work: SolveReport,
}

/// Relative residual asked of a state solve per relative accuracy of the state: slender bodies amplify residuals.
const RESIDUAL_PER_ACCURACY: f64 = 1e-2;

impl Evaluated {
    /// Sum of the terms.
    pub fn cost(&self) -> f64 {
        self.terms.iter().sum()
    }

    /// The adjoint displacement, once the derivative was asked for.
    pub fn adjoint(&self) -> Option<&[f64]> {
        self.adjoint.get().map(|a| a.lambda.as_slice())
    }

    /// Work of the evaluation and of its adjoint so far.
    pub fn total_work(&self) -> SolveReport {
        let mut work = self.work;
        if let Some(adjoint) = self.adjoint.get() {
            work.add_work(&adjoint.work);
        }
        work
    }

    /// Memory of the factor kept for the next solve, in bytes: one, of a tangent nearby, that this point shares with the point
    /// it was evaluated from and with those evaluated from it.
    pub fn factor_bytes(&self) -> usize {
        self.factor.bytes()
    }

    /// Parts with its factor, which is large, and with the states before it: for points that are kept to be looked at.
    pub fn without_factors(mut self) -> Self {
        self.factor = SharedWorkspace::default();
        self.predictor = StatePredictor::default();
        self
    }
}

impl Reduced {
    /// The problem of a body, with no cost yet.
    pub fn new(solid: Solid) -> Self {
        let layout = Layout::new(solid.controls());
        Reduced {
            solid,
            layout,
            costs: vec![],
            metric: OnceLock::new(),
            kind: Metric::L2,
            parallel: true,
            keep_factors: true,
            settled: false,
            cancel: None,
            progress: None,
        }
    }

    /// Adds a control field on an actuation (`NAME`, or `NAME.SLOT` where it has several).
    ///
    /// # Errors
    /// Unknown names, a field given twice, a space that does not fit.
    pub fn control(mut self, of: &str, space: Space) -> Result<Self, ControlError> {
        self.layout.control(&self.solid, of, space)?;
        self.metric = OnceLock::new();
        Ok(self)
    }

    /// Gives the vectors of a control field one length at every point, also between the nodes: a magnetisation. To be
    /// minimised over a [`Sphere`](nastic_opt::Sphere) of that radius.
    ///
    /// # Errors
    /// As [`Layout::fix_length`].
    pub fn of_length(mut self, control: &str, length: f64) -> Result<Self, ControlError> {
        self.layout.fix_length(control, length)?;
        Ok(self)
    }

    /// Adds the amplitude of a vector along a fixed direction as a control field.
    ///
    /// # Errors
    /// As [`control`](Self::control); a slot that is no vector, a direction without a length.
    pub fn control_along(mut self, of: &str, space: Space, direction: [f64; 3]) -> Result<Self, ControlError> {
        self.layout.control_along(&self.solid, of, space, direction)?;
        self.metric = OnceLock::new();
        Ok(self)
    }

    /// Fixes a slot of an actuation that is not controlled, from one value per quadrature point.
    ///
    /// # Errors
    /// Wrong length or values that are not finite.
    pub fn fix(mut self, actuation: usize, slot: usize, at_points: &[f64]) -> Result<Self, ControlError> {
        self.layout.fixed_mut().set(actuation, slot, at_points)?;
        Ok(self)
    }

    /// Adds a cost term.
    ///
    /// # Errors
    /// What the cost does not find on the body.
    pub fn cost(mut self, cost: impl IntoCost) -> Result<Self, ControlError> {
        if self.layout.is_empty() && !self.settled {
            self = self.control_everything()?;
        }
        self.costs.push(cost.bind(&self.solid)?);
        Ok(self)
    }

    /// Chooses the inner product of the gradient (L2, lumped, unless told otherwise).
    pub fn metric(mut self, kind: Metric) -> Self {
        self.kind = kind;
        self.metric = OnceLock::new();
        self
    }

    /// Leaves the control fields as they are, even if there are none: nothing is controlled that was not named.
    pub fn no_other_controls(mut self) -> Self {
        self.settled = true;
        self
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

    /// Computes on one thread: for members of an ensemble, which run side by side.
    pub fn sequential(mut self) -> Self {
        self.parallel = false;
        self
    }

    /// Whether evaluated points keep a factor of their tangent for the next solve, and what their costs need for partials
    /// (they do, unless told otherwise). Without, a solve begins with a factorisation of its own, costs are evaluated again
    /// for partials, and a point is little more than its state: for the many points of a sample that are evaluated once.
    pub fn keep_factors(mut self, keep: bool) -> Self {
        self.keep_factors = keep;
        self
    }

    fn control_everything(mut self) -> Result<Self, ControlError> {
        for name in Layout::names(&self.solid) {
            self = self.control(&name, Space::Cell)?;
        }
        Ok(self)
    }

    /// Builds what is built late, so that errors come now: the inner product, the checks of the body.
    ///
    /// # Errors
    /// An incomplete body, or a control that acts on nothing.
    pub fn check(&self) -> Result<(), ControlError> {
        self.solid.check()?;
        if self.metric.get().is_none() {
            let product = inner_product(&self.solid, &self.layout, self.kind)?;
            let _ = self.metric.set(product);
        }
        Ok(())
    }

    /// The body.
    pub fn solid(&self) -> &Solid {
        &self.solid
    }

    /// The control fields.
    pub fn layout(&self) -> &Layout {
        &self.layout
    }

    /// The cost terms.
    pub fn costs(&self) -> &[Box<dyn Cost>] {
        &self.costs
    }

    /// Equilibrium and cost at m.
    ///
    /// # Errors
    /// No equilibrium, or a cost that is not defined there.
    pub fn at(&self, m: &[f64], near: Option<&Evaluated>, stage: usize) -> Result<Evaluated, ControlError> {
        self.at_accuracy(m, near, stage, SolveOptions::default().accuracy)
    }

    /// [`Objective::evaluate`], with the typed error: what failed, and the last equilibrium on the way.
    ///
    /// # Errors
    /// As [`at`](Self::at).
    pub fn try_evaluate(&self, m: &[f64], how: &Request<'_, Evaluated>) -> Result<Evaluated, ControlError> {
        self.at_accuracy(m, how.near, how.stage, how.accuracy * RESIDUAL_PER_ACCURACY)
    }

    fn at_accuracy(
        &self,
        m: &[f64],
        near: Option<&Evaluated>,
        stage: usize,
        accuracy: f64,
    ) -> Result<Evaluated, ControlError> {
        let controls = self.layout.to_points(m)?;
        let predictor = near.map(|point| point.predictor.then(&point.m, &point.state.u)).unwrap_or_default();
        let guess = predictor.guess(m);
        let how = SolveOptions {
            guess: guess.as_deref(),
            near: near.map(|point| &point.state),
            parallel: self.parallel,
            accuracy,
            cancel: self.cancel.as_deref(),
            watch: self.progress.as_ref().map(|progress| &*progress.0 as &(dyn Fn(&Progress) + Sync)),
            ..SolveOptions::default()
        };
        let kept = near.filter(|_| self.keep_factors).map(|point| point.factor.clone()).unwrap_or_default();
        let mut workspace = kept.take();
        let solved = self.solid.solve_with(&controls, &how, &mut workspace);
        if self.keep_factors {
            kept.put(workspace);
        }
        let state = solved?;
        let (terms, costs) = self.terms(&state, m, stage)?;
        let (m, work) = (m.to_vec(), state.report);
        Ok(Evaluated { m, state, terms, stage, work, costs, factor: kept, predictor, adjoint: OnceLock::new() })
    }

    /// Values of the terms, and the evaluated terms where points keep them.
    fn terms(&self, state: &State, m: &[f64], stage: usize) -> Result<Terms, ControlError> {
        let mut costs = self.costs_at(state, m, stage)?;
        let values = costs.iter().map(|cost| cost.value()).collect();
        if !self.keep_factors {
            costs.clear();
        }
        Ok((values, costs))
    }

    /// Evaluates the terms in a state.
    ///
    /// # Errors
    /// A cost that is not defined there.
    pub fn costs_at(&self, state: &State, m: &[f64], stage: usize) -> Result<Vec<Arc<dyn CostPoint>>, ControlError> {
        let context = self.context(state, m, stage);
        self.costs.iter().map(|cost| cost.at(&context)).collect()
    }

    /// The evaluated terms of a point: those it keeps, or evaluated again.
    ///
    /// # Errors
    /// A cost that is not defined there.
    pub fn costs_of<'a>(&self, point: &'a Evaluated) -> Result<Cow<'a, [Arc<dyn CostPoint>]>, ControlError> {
        if point.costs.len() == self.costs.len() {
            return Ok(Cow::Borrowed(&point.costs));
        }
        self.costs_at(&point.state, &point.m, point.stage).map(Cow::Owned)
    }

    fn context<'a>(&'a self, state: &'a State, m: &'a [f64], stage: usize) -> CostContext<'a> {
        CostContext { solid: &self.solid, layout: &self.layout, u: &state.u, m, stage }
    }

    /// [`Objective::restage`] with the typed error.
    ///
    /// # Errors
    /// A cost that is not defined there.
    pub fn try_restage(&self, stage: usize, point: &Evaluated) -> Result<Evaluated, ControlError> {
        let (terms, costs) = self.terms(&point.state, &point.m, stage)?;
        let (m, state, factor) = (point.m.clone(), point.state.clone(), point.factor.clone());
        let predictor = point.predictor.clone();
        let work = SolveReport::default();
        Ok(Evaluated { m, state, terms, stage, work, costs, factor, predictor, adjoint: OnceLock::new() })
    }

    /// Partial derivatives of the cost (all terms, or one of them).
    ///
    /// # Errors
    /// A cost that is not defined there.
    pub fn partials(&self, point: &Evaluated, term: Option<usize>) -> Result<Partials, ControlError> {
        let mut partials = Partials { u: vec![0.0; point.state.u.len()], m: vec![0.0; point.m.len()] };
        for (k, cost) in self.costs_of(point)?.iter().enumerate() {
            if term.is_none_or(|t| t == k) {
                cost.add_partials(&mut partials)?;
            }
        }
        Ok(partials)
    }

    /// `djhat/dm` of all terms, or of one.
    ///
    /// # Errors
    /// A tangent that is singular, a cost that is not defined.
    pub fn derivative_of(&self, point: &Evaluated, term: Option<usize>) -> Result<Vec<f64>, ControlError> {
        let partials = self.partials(point, term)?;
        let mut derivative = partials.m;
        if partials.u.iter().all(|&d| d == 0.0) {
            return Ok(derivative);
        }
        let rhs: Vec<f64> = partials.u.iter().map(|d| -d).collect();
        let how = SolveOptions { parallel: self.parallel, ..SolveOptions::default() };
        let mut workspace = point.factor.take();
        let adjoint = self.solid.adjoint_with(&point.state, &[&rhs], &how, &mut workspace);
        if self.keep_factors {
            point.factor.put(workspace);
        }
        let adjoint = adjoint?;
        let lambda = adjoint.lambda.into_iter().next().unwrap_or_default();
        let by_point = self.solid.body().control_vjp(&point.state.u, &point.state.controls, &lambda, self.parallel)?;
        for (d, through_state) in derivative.iter_mut().zip(self.layout.control_vjp(&point.m, &by_point)) {
            *d += through_state;
        }
        if term.is_none() {
            let _ = point.adjoint.set(AdjointPart { lambda, work: adjoint.report });
        }
        Ok(derivative)
    }

    /// Names of the terms; those that occur several times are numbered, `tracking_0`, `tracking_1`.
    pub fn term_names(&self) -> Vec<String> {
        let of = |k: usize| self.costs[k].name();
        let name = |k: usize| match self.costs.iter().filter(|c| c.name() == of(k)).count() {
            1 => of(k).to_owned(),
            _ => format!("{}_{}", of(k), (0..k).filter(|&i| of(i) == of(k)).count()),
        };
        (0..self.costs.len()).map(name).collect()
    }

    /// Figures of every cost term beside its value (a true distance, say), more expensive than the values.
    ///
    /// # Errors
    /// Where a cost cannot.
    pub fn figures(&self, point: &Evaluated) -> Result<Vec<Vec<Figure>>, ControlError> {
        self.costs_of(point)?.iter().map(|cost| cost.figures()).collect()
    }
}

impl Objective for Reduced {
    type Point = Evaluated;

    fn evaluate(&self, m: &[f64], how: &Request<'_, Evaluated>) -> Result<Evaluated, Failed> {
        self.try_evaluate(m, how).map_err(|e| Failed::new(e.to_string()))
    }

    fn value(&self, point: &Evaluated) -> f64 {
        point.cost()
    }

    fn derivative(&self, point: &Evaluated) -> Result<Vec<f64>, Failed> {
        self.derivative_of(point, None).map_err(|e| Failed::new(e.to_string()))
    }

    fn stages(&self) -> usize {
        self.costs.iter().map(|cost| cost.stages()).max().unwrap_or(1)
    }

    fn restage(&self, stage: usize, point: &Evaluated) -> Result<Evaluated, Failed> {
        self.try_restage(stage, point).map_err(|e| Failed::new(e.to_string()))
    }

    fn report(&self, point: &Evaluated) -> Report {
        let mut entries: Vec<(String, f64)> = self.term_names().into_iter().zip(point.terms.iter().copied()).collect();
        for (name, _) in entries.iter_mut() {
            name.insert_str(0, "terms/");
        }
        let work = point.total_work();
        entries.push(("newton".into(), work.newton as f64));
        entries.push(("factorisations".into(), work.factorisations as f64));
        entries.push(("back_substitutions".into(), work.back_substitutions as f64));
        entries.push(("min_J".into(), point.state.report.min_j));
        entries.push(("factor_bytes".into(), point.factor_bytes() as f64));
        Report(entries)
    }
}

impl Problem for Reduced {
    /// The inner product; the lumped L2 one where [`check`](Self::check) was not called.
    fn inner_product(&self) -> &dyn InnerProduct {
        let build = || {
            inner_product(&self.solid, &self.layout, self.kind)
                .unwrap_or_else(|_| Box::new(nastic_opt::Euclidean::new(self.layout.len())))
        };
        self.metric.get_or_init(build).as_ref()
    }
}
