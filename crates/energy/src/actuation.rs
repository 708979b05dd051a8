//! Actuations: energies added to the passive one, with the sign in them.

mod fiber_tension;
pub mod magnet;
mod polar;
mod turgor;

pub use fiber_tension::FiberTension;
pub use magnet::{Magnet, MagnetIsochoric, MagnetRotation};
pub use turgor::Turgor;
