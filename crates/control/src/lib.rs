//! Control fields, costs, the adjoint and reduced problems.
//!
//! [`Reduced`] is the cost as a function of the controls alone: it takes a [`Solid`](nastic_fem::Solid), says which
//! actuations are controlled and how ([`Space`]), and adds up [`Cost`]s. It is an
//! [`Objective`](nastic_opt::Objective), so every optimiser of `nastic-opt` drives it.

pub mod cost;
mod ensemble;
mod error;
mod inner_product;
mod kept_factor;
mod layout;
mod map;
mod reduced;
pub mod risk;
mod snapshot;
pub mod stochastic;
mod trail;

pub use cost::hausdorff::Phi;
pub use cost::{
    BoundHausdorff, BoundTracking, ControlNorm, ControlSmoothness, Cost, IntoCost, Partials, Sight, SmoothedHausdorff,
    Target, Tracking,
};
pub use ensemble::{
    Ensemble, EnsembleBlock, EnsembleBuilder, EnsembleError, EnsemblePoint, Finished, LoadCase, Measured, Part,
};
pub use error::ControlError;
pub use inner_product::{Metric, inner_product};
pub use layout::{ControlBlock, Layout};
pub use map::{ControlMap, Space};
pub use reduced::{Evaluated, Reduced};
pub use risk::Risk;
