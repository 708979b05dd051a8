//! Objectives, admissible sets, optimisers and the Taylor test: no mesh, no physics.
//!
//! A problem is an [`Objective`] (a cost of a control vector m, with its derivative), a set ([`Admissible`]: box, sphere
//! per point, ball per point, products) and an [`InnerProduct`] that turns derivatives into gradients. An [`Optimizer`]
//! [within a set](Within) begins a [`Run`], which is stepped, observed ([`Observer`], [`Print`]), stopped, saved and resumed.
//!
//! What every run keeps to:
//! * nothing is evaluated outside the set; a failed evaluation shortens the step;
//! * derivatives are asked for at accepted points alone; the accepted point travels on as [`Request::near`];
//! * it ends with a [`Stop`] that says why;
//! * no default depends on the unit system: a problem in other units takes the same steps, as long as all components and
//!   the inner product are scaled by one factor (blocks of different kinds, Pa and T, are not weighed against each other);
//! * the same input gives the same bits, also after [`Run::save`] and [`Run::load`].
//!
//! ```
//! use nastic_opt::{Bounds, Diagonal, Failed, InnerProduct, Lbfgs, Objective, Optimizer, Problem, Request};
//! use std::sync::Arc;
//!
//! /// j(m) = sum_i w_i ((m_i - i)^2 + 1) over cells of measure w_i.
//! struct Distance(Diagonal);
//!
//! impl Objective for Distance {
//!     type Point = Vec<f64>;
//!     type Workspace = ();
//!     fn evaluate(&self, m: &[f64], _: &Request<Vec<f64>>, _: &mut ()) -> Result<Vec<f64>, Failed> {
//!         Ok(m.to_vec())
//!     }
//!     fn value(&self, m: &Vec<f64>) -> f64 {
//!         let e: Vec<f64> = m.iter().enumerate().map(|(i, m)| m - i as f64).collect();
//!         self.0.inner(&e, &e) + 1.0
//!     }
//!     fn derivative(&self, m: &mut Vec<f64>, _: &mut ()) -> Result<Vec<f64>, Failed> {
//!         let e: Vec<f64> = m.iter().enumerate().map(|(i, m)| 2.0 * (m - i as f64)).collect();
//!         Ok(self.0.apply(&e))
//!     }
//!     fn restage(&self, _: usize, m: &Vec<f64>) -> Result<Vec<f64>, Failed> {
//!         Ok(m.clone())
//!     }
//! }
//!
//! impl Problem for Distance {
//!     fn inner_product(&self) -> Result<Arc<dyn InnerProduct>, Failed> {
//!         Ok(Arc::new(self.0.clone()))
//!     }
//! }
//!
//! let problem = Distance(Diagonal::new(vec![0.1, 0.2, 0.3])?);
//! let best = Lbfgs::default().within(Bounds::new(-1.0, 1.5)?).minimize(&problem, 0.0)?;
//! assert!(best.stop.is_converged());
//! assert!((best.m[1] - 1.0).abs() < 1e-3 && best.m[2] == 1.5);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod admissible;
mod augmented;
mod catalogue;
mod certificate;
mod conjugate_gradient;
mod constrained;
mod covariance;
pub mod early_stopping;
mod failed;
mod feedback;
mod held;
mod hessian;
mod inner_product;
mod lbfgs;
mod line_search;
mod method;
mod mma;
mod model;
mod newton_cg;
mod objective;
mod observer;
mod optimizer;
mod print;
mod projected_gradient;
mod run;
pub mod saved;
mod search;
mod spectral;
mod spectrum;
mod start;
mod state;
mod stop;
mod summary;
mod taylor;
mod trial_table;
mod trust_region;
mod within;

pub use admissible::{
    Admissible, Ball, Bounds, Face, Intervals, Limit, NotBounds, Optimality, Outside, Product, SetError, Sphere,
};
pub use augmented::{
    Augmented, AugmentedBest, AugmentedLagrangian, AugmentedRun, AugmentedState, ConstraintReport, ConstraintsReport,
    Domain,
};
pub use catalogue::{CATALOGUE, OptimizerRow, by_name};
pub use certificate::{Base, Certificate};
pub use constrained::{Constrained, ConstraintGroup, NoConstraintDerivatives, Sense};
pub use covariance::{Covariance, Determined};
pub use failed::Failed;
pub use feedback::{Feedback, FeedbackInputs, MovedDirection};
pub use held::Held;
pub use hessian::Hessian;
pub use inner_product::{Diagonal, Euclidean, INNER_PRODUCTS, InnerProduct, InnerProductError, InnerProductRow};
pub use lbfgs::Lbfgs;
pub use line_search::LineSearch;
pub use method::{Current, HessianProducts, Judgement, Memory, Method, Proposed, Secant, Tried};
pub use mma::{Asymptotes, Mma};
pub use newton_cg::NewtonCg;
pub use objective::{Budget, DEFAULT_ACCURACY, NoSecondDerivatives, Objective, Problem, Request};
pub use observer::{Observer, Reason, Trial};
pub use optimizer::{Optimizer, Options, Unfit};
pub use print::Print;
pub use projected_gradient::ProjectedGradient;
pub use run::{Best, Outcome, Run, RunError};
pub use saved::{Saved, SavedError};
pub use spectral::Spectral;
pub use spectrum::{Spectrum, SpectrumError, SpectrumOptions};
pub use start::{EvaluatedStart, Start};
pub use state::{Counts, Progress, RunState, SavedPoint, StageEnd};
pub use stop::{Stall, Stop, Tolerance};
pub use summary::Summary;
pub use taylor::{Row, SecondOrder, Taylor, TaylorDirection, TaylorError, TaylorReport, Verdict};
pub use trial_table::{TRUE_DISTANCE, TrialTable};
pub use within::Within;
