//! [`Within`]: an optimiser with its admissible set, options, inner product and observer.

use crate::admissible::Admissible;
use crate::certificate::Certificate;
use crate::inner_product::InnerProduct;
use crate::objective::Problem;
use crate::observer::Observer;
use crate::optimizer::{Optimizer, Options};
use crate::run::{Best, Run, RunError};
use crate::search::Setting;
use crate::start::Start;
use crate::state::RunState;
use crate::taylor::{TaylorError, Verdict};
use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// An optimiser within an admissible set, with its options, inner product and observer: [`Optimizer::within`] makes it,
/// [`minimize`](Self::minimize) runs it to its end, [`start`](Self::start) and [`resume`](Self::resume) give a [`Run`] to
/// be stepped by hand.
///
/// A problem is handed in by reference, by value or as an [`Arc`].
///
/// ```
/// # use nastic_opt::{Diagonal, Failed, InnerProduct, Objective, Problem, Request};
/// # use std::sync::Arc;
/// # struct Square;
/// # impl Objective for Square {
/// #     type Point = Vec<f64>;
/// #     type Workspace = ();
/// #     fn evaluate(&self, m: &[f64], _: &Request<Vec<f64>>, _: &mut ()) -> Result<Vec<f64>, Failed> { Ok(m.to_vec()) }
/// #     fn value(&self, m: &Vec<f64>) -> f64 { m[0] * m[0] + 1.0 }
/// #     fn derivative(&self, m: &mut Vec<f64>, _: &mut ()) -> Result<Vec<f64>, Failed> { Ok(vec![2.0 * m[0]]) }
/// #     fn restage(&self, _: usize, m: &Vec<f64>) -> Result<Vec<f64>, Failed> { Ok(m.clone()) }
/// # }
/// # impl Problem for Square {
/// #     fn inner_product(&self) -> Result<Arc<dyn InnerProduct>, Failed> {
/// #         Ok(Arc::new(Diagonal::new(vec![1.0]).map_err(Failed::new)?))
/// #     }
/// # }
/// use nastic_opt::{Bounds, Lbfgs, Optimizer, Outcome, Trial};
///
/// let mut costs = vec![];
/// let best = Lbfgs::default()
///     .within(Bounds::new(-2.0, 2.0)?)
///     .tolerance(1e-6)
///     .observe(|trial: &Trial<'_, Vec<f64>>| costs.extend(trial.cost))
///     .minimize(&Square, 1.5)?;
/// assert_eq!(costs.len(), 1 + best.counts.trials);
///
/// let mut run = Lbfgs::default().within(Bounds::new(-2.0, 2.0)?).start(Square, 1.5)?;
/// while run.step(&mut ()) == Outcome::Iterated {}
/// assert!(run.cost() < 1.001);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Within<M, W = ()> {
    optimizer: M,
    options: Options,
    set: Arc<dyn Admissible>,
    metric: Option<Arc<dyn InnerProduct>>,
    cancel: Option<Arc<AtomicBool>>,
    stages: Option<Range<usize>>,
    gradient_check: bool,
    seed: u64,
    observer: W,
}

impl<M: Optimizer> Within<M> {
    pub(crate) fn new(optimizer: M, set: impl Admissible + 'static) -> Self {
        let options = *optimizer.options();
        let set = Arc::new(set);
        Self {
            optimizer,
            options,
            set,
            metric: None,
            cancel: None,
            stages: None,
            gradient_check: true,
            seed: 1,
            observer: (),
        }
    }
}

impl<M: Optimizer, W> Within<M, W> {
    /// Calls an observer at every trial; it replaces an earlier one.
    pub fn observe<V>(self, observer: V) -> Within<M, V> {
        let Self { optimizer, options, set, metric, cancel, stages, gradient_check, seed, .. } = self;
        Within { optimizer, options, set, metric, cancel, stages, gradient_check, seed, observer }
    }

    /// Measures gradients and steps in this inner product, not in the problem's own.
    #[must_use]
    pub fn metric(mut self, product: impl InnerProduct + 'static) -> Self {
        self.metric = Some(Arc::new(product));
        self
    }

    /// When to stop, and what to ask of evaluations; these take the place of the optimiser's.
    #[must_use]
    pub fn options(mut self, options: Options) -> Self {
        self.options = options;
        self
    }

    /// The projected gradient's norm, relative to the stage's first, at which the last stage has converged.
    #[must_use]
    pub fn tolerance(mut self, tolerance: f64) -> Self {
        self.options.tolerance = tolerance;
        self
    }

    /// The projected gradient's norm at which the last stage has converged, whatever the first one was.
    #[must_use]
    pub fn absolute_tolerance(mut self, tolerance: f64) -> Self {
        self.options.absolute_tolerance = tolerance;
        self
    }

    /// Iterations of the whole run.
    #[must_use]
    pub fn max_iterations(mut self, iterations: usize) -> Self {
        self.options.max_iterations = iterations;
        self
    }

    /// A flag that stops the run before its next trial.
    #[must_use]
    pub fn cancelled_by(mut self, flag: Arc<AtomicBool>) -> Self {
        self.cancel = Some(flag);
        self
    }

    /// Runs these continuation stages only, `1..2` the second alone; an evaluated start is [valued anew] by the first of
    /// them. Without it the run goes through all stages of the problem.
    ///
    /// [valued anew]: crate::Objective::restage
    #[must_use]
    pub fn stages(mut self, stages: Range<usize>) -> Self {
        self.stages = Some(stages);
        self
    }

    /// Whether [`minimize`](Self::minimize) begins with a check of the derivative at the start, as it does by default: one to four
    /// evaluations if the derivative is right.
    #[must_use]
    pub fn gradient_check(mut self, on: bool) -> Self {
        self.gradient_check = on;
        self
    }

    /// Seed of the gradient check's random direction; 1 by default.
    #[must_use]
    pub fn seed(mut self, seed: u64) -> Self {
        self.seed = seed;
        self
    }

    /// Begins a run, to be stepped by hand. Its observer is given to every step.
    ///
    /// # Errors
    /// As [`Run::start`]; an inner product that cannot be built.
    pub fn start<P: Problem>(&self, problem: P, start: impl Into<Start<P::Point>>) -> Result<Run<P>, RunError> {
        Run::begin(&self.optimizer, self.setting(problem)?, start.into())
    }

    /// Takes up a saved run of the same problem, set, inner product and optimiser.
    ///
    /// # Errors
    /// As [`Run::load`]; an inner product that cannot be built.
    pub fn resume<P: Problem>(&self, problem: P, state: &RunState) -> Result<Run<P>, RunError> {
        Run::resume(&self.optimizer, self.setting(problem)?, state)
    }

    /// Minimises from a start, whose derivative is checked first ([`Run::certify`]); the result holds the certificate.
    ///
    /// # Errors
    /// As [`start`](Self::start); [`RunError::Derivative`] when the derivative is wrong, [`RunError::Check`] when it
    /// could not be checked. Where nothing says how far to vary the control, the certificate is undecided.
    pub fn minimize<P: Problem>(
        &mut self,
        problem: P,
        start: impl Into<Start<P::Point>>,
    ) -> Result<Best<P::Point>, RunError>
    where
        W: Observer<P::Point>,
    {
        let run = self.start(problem, start)?;
        let certificate = if self.gradient_check { Some(self.certify(&run)?) } else { None };
        let mut best = run.minimize(&mut self.observer);
        best.certificate = certificate;
        Ok(best)
    }

    fn certify<P: Problem>(&self, run: &Run<P>) -> Result<Certificate, RunError> {
        match run.certify(None, self.seed) {
            Ok(certificate) if certificate.verdict == Verdict::Wrong => {
                Err(RunError::Derivative(Box::new(certificate)))
            }
            Ok(certificate) => Ok(certificate),
            Err(TaylorError::NoDirection) => Ok(Certificate::undecided()),
            Err(error) => Err(RunError::Check(error)),
        }
    }

    fn setting<P: Problem>(&self, problem: P) -> Result<Setting<P>, RunError> {
        let metric = match &self.metric {
            Some(metric) => metric.clone(),
            None => problem.inner_product().map_err(RunError::InnerProduct)?,
        };
        let mut setting = Setting::new(problem, self.set.clone(), metric, self.options);
        setting.cancel.clone_from(&self.cancel);
        if let Some(stages) = &self.stages {
            setting.stages.clone_from(stages);
        }
        Ok(setting)
    }
}
