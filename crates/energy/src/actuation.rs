//! Actuations: energies added to the passive one, with the sign in them.

pub mod dielectric;
mod fiber_tension;
pub mod magnet;
mod point_quantity;
mod polar;
mod turgor;

pub use dielectric::Dielectric;
pub use fiber_tension::FiberTension;
pub use magnet::{Magnet, MagnetIsochoric, MagnetRotation};
pub use point_quantity::PointQuantity;
pub use turgor::Turgor;
