//! [`AugmentedLagrangian`]: general constraints around any optimiser.

mod multipliers;
mod objective;
mod outer;
mod report;
mod run;

pub use objective::Augmented;
pub use outer::AugmentedState;
pub use report::{ConstraintReport, ConstraintsReport};
pub use run::{AugmentedBest, AugmentedRun};

use crate::admissible::Admissible;
use crate::constrained::Constrained;
use crate::inner_product::InnerProduct;
use crate::objective::Problem;
use crate::optimizer::Optimizer;
use crate::run::RunError;
use crate::start::Start;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// Minimises j(m) under constraints `c_k(m) <= 0` and `c_k(m) = 0` within an admissible set: any optimiser minimises
/// `j + psi(c)` (function of Powell, Hestenes and Rockafellar) again and again, from where it stood; in between the multipliers take their
/// first-order update `l_k <- dpsi/dc_k`, or the penalty grows where violation and complementarity have not fallen enough.
///
/// The run has converged when the largest violation and failing complementarity (relative to the [scales](crate::ConstraintGroup::scale))
/// are below [`feasibility`](Self::feasibility) and the projected gradient of the Lagrangian meets the optimiser's tolerances, relative to the
/// gradient of the cost at the start. Without constraints it is the optimiser's own run, to the bit.
///
/// Sign: multipliers of `c <= 0` are never negative, and `dj*/db = -y` for the optimal cost j* under `c <= b`: a multiplier says
/// how much the cost falls by a unit of slack.
///
/// Source: Nocedal and Wright, Numerical Optimization, 2nd ed., algorithm 17.4; Birgin and Martinez, Practical Augmented Lagrangian
/// Methods for Constrained Optimization, algorithm 4.1 (safeguarded multipliers).
///
/// ```
/// use nastic_opt::{
///     AugmentedLagrangian, Bounds, Constrained, ConstraintGroup, Diagonal, Failed, InnerProduct, Lbfgs, Objective, Problem, Request, Sense,
/// };
/// use std::sync::Arc;
///
/// /// The point of the half-plane x + y >= 1 nearest to the origin: (1/2, 1/2), multiplier 1/2.
/// struct Nearest;
///
/// impl Objective for Nearest {
///     type Point = Vec<f64>;
///     type Workspace = ();
///     fn evaluate(&self, m: &[f64], _: &Request<Vec<f64>>, _: &mut ()) -> Result<Vec<f64>, Failed> { Ok(m.to_vec()) }
///     fn value(&self, m: &Vec<f64>) -> f64 { 0.5 * (m[0] * m[0] + m[1] * m[1]) }
///     fn derivative(&self, m: &mut Vec<f64>, _: &mut ()) -> Result<Vec<f64>, Failed> { Ok(m.clone()) }
///     fn restage(&self, _: usize, m: &Vec<f64>) -> Result<Vec<f64>, Failed> { Ok(m.clone()) }
/// }
///
/// impl Problem for Nearest {
///     fn inner_product(&self) -> Result<Arc<dyn InnerProduct>, Failed> {
///         Ok(Arc::new(Diagonal::new(vec![1.0; 2]).map_err(Failed::new)?))
///     }
/// }
///
/// impl Constrained for Nearest {
///     fn constraints(&self) -> Vec<ConstraintGroup> {
///         vec![ConstraintGroup { name: "half-plane".into(), sense: Sense::AtMost, len: 1, scale: 1.0 }]
///     }
///     fn constraint_values(&self, m: &Vec<f64>) -> Vec<f64> { vec![1.0 - m[0] - m[1]] }
///     fn lagrangian_derivative(&self, m: &mut Vec<f64>, y: &[f64], _: &mut ()) -> Result<Vec<f64>, Failed> {
///         Ok(vec![m[0] - y[0], m[1] - y[0]])
///     }
/// }
///
/// let found = AugmentedLagrangian::default().minimize(&Lbfgs::default(), Nearest, Bounds::new(-2.0, 2.0)?, vec![-1.0, 2.0], &mut ())?;
/// assert!(found.best.stop.is_converged());
/// assert!((found.best.m[0] - 0.5).abs() < 1e-6 && (found.best.m[1] - 0.5).abs() < 1e-6);
/// assert!((found.constraints.groups[0].multipliers[0] - 0.5).abs() < 1e-5 && found.constraints.violation <= 1e-8);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AugmentedLagrangian {
    /// The largest violation and failing complementarity of a converged run, relative to the scales.
    pub feasibility: f64,
    /// The first penalty r, > 0, in the unit of the cost: a violation by one scale costs r/2. Without, ten times the absolute value of
    /// the cost at the start.
    pub penalty: Option<f64>,
    /// What the penalty grows by, > 1.
    pub growth: f64,
    /// The penalty grows unless violation and failing complementarity fall to this part from one update to the next; not where the
    /// optimiser used up its iterations in between.
    pub decrease: f64,
    /// Between updates the optimiser stops at this part of its first projected gradient (or where the whole run may stop).
    pub inner_tolerance: f64,
    /// Iterations of the optimiser between two updates, at most.
    pub inner_iterations: usize,
    /// Updates, at most.
    pub max_updates: usize,
}

impl Default for AugmentedLagrangian {
    fn default() -> Self {
        Self {
            feasibility: 1e-8,
            penalty: None,
            growth: 10.0,
            decrease: 0.1,
            inner_tolerance: 1e-2,
            inner_iterations: 100,
            max_updates: 60,
        }
    }
}

/// Where a run takes place: the admissible set, the inner product, a flag that stops it.
#[derive(Clone, Debug)]
pub struct Domain {
    /// The admissible set.
    pub set: Arc<dyn Admissible>,
    /// The inner product of the controls.
    pub metric: Arc<dyn InnerProduct>,
    /// Stops the run before its next trial when it is raised.
    pub cancel: Option<Arc<AtomicBool>>,
}

impl AugmentedLagrangian {
    /// Begins a run, to be stepped by hand.
    ///
    /// # Errors
    /// As [`Run::start`](crate::Run::start); [`RunError::NoPenalty`] where nothing gives the first penalty.
    pub fn start<O: Constrained>(
        &self,
        optimizer: &dyn Optimizer,
        objective: O,
        domain: Domain,
        start: impl Into<Start<O::Point>>,
    ) -> Result<AugmentedRun<O>, RunError> {
        AugmentedRun::begin(*self, optimizer, objective, domain, start.into())
    }

    /// Takes up a saved run of the same problem, set, inner product, optimiser and options, with an empty workspace.
    ///
    /// # Errors
    /// As [`Run::load`](crate::Run::load); a state of other constraints.
    pub fn load<O: Constrained>(
        &self,
        optimizer: &dyn Optimizer,
        objective: O,
        domain: Domain,
        state: &AugmentedState,
    ) -> Result<AugmentedRun<O>, RunError> {
        AugmentedRun::resume(*self, optimizer, objective, domain, state)
    }

    /// Minimises from a start within a set, in the problem's inner product.
    ///
    /// # Errors
    /// As [`start`](Self::start); an inner product that cannot be built.
    pub fn minimize<O: Constrained + Problem>(
        &self,
        optimizer: &dyn Optimizer,
        problem: O,
        set: impl Admissible + 'static,
        start: impl Into<Start<O::Point>>,
        observer: &mut dyn crate::observer::Observer<O::Point>,
    ) -> Result<AugmentedBest<O::Point>, RunError> {
        let metric = problem.inner_product().map_err(RunError::InnerProduct)?;
        let mut run = self.start(optimizer, problem, Domain { set: Arc::new(set), metric, cancel: None }, start)?;
        let stop = run.run(observer);
        Ok(run.finish(stop))
    }
}
