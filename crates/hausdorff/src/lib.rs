//! Smoothed Hausdorff distance between two weighted clouds of points, value and exact derivative.
//!
//! It knows no finite elements: a body is its quadrature points with their deformed weights. The formulas are on
//! `Evaluation`, the sums over all pairs on `Pairs`, the functions phi on `Phi`.

mod aligned;
mod bounding_box;
mod cloud;
mod distance;
mod distance_change;
mod error;
mod kernel;
mod lanes;
mod leaf_pairs;
mod lower_bounds;
mod pairs;
mod phi;
mod point_set;
mod second;
mod second_tiles;
mod smoothing;
mod sum_tiles;
mod summation;
mod together;
mod tree;
mod truncation;
mod vjp;
mod vjp_tiles;

#[cfg(test)]
mod tests;

pub use cloud::Cloud;
pub use distance::{Distance, Evaluation, Partials};
pub use distance_change::SecondPartials;
pub use error::HausdorffError;
pub use pairs::{Counts, LogSums, Pairs, Vjp};
pub use phi::{CATALOGUE, Phi, PhiRow};
pub use second::{Motion, Rates, SecondVjp, Seeds};
pub use smoothing::Smoothing;
pub use summation::Summation;
pub use together::Together;
