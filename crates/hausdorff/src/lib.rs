//! Smoothed Hausdorff distance between two weighted clouds of points, value and exact derivative.
//!
//! It knows no finite elements: a body is its quadrature points with their deformed weights. The formulas are on
//! `Evaluation`, the sums over all pairs on `Pairs`, the functions phi on `Phi`.

mod account;
mod adjoint;
mod aligned;
mod blocks;
mod bounds;
mod brief;
mod brief_lanes;
mod chebyshev;
mod cloud;
mod distance;
mod error;
mod floor;
mod frame;
mod kernel;
mod lanes;
mod mask;
mod pairs;
mod phi;
mod plan;
mod pull;
mod side;
mod single;
mod single_lanes;
mod smoothing;
mod sums;
mod tile;
mod transform;
mod tree;

#[cfg(test)]
mod tests;

pub use cloud::Cloud;
pub use distance::{Distance, Evaluation, Partials};
pub use error::HausdorffError;
pub use pairs::{Counts, LogSums, Method, Pairs, Vjp};
pub use phi::Phi;
pub use smoothing::Smoothing;
