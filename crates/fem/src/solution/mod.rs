//! From controls to an equilibrium: load steps, Newton's method, tangent systems.

mod continuation;
mod levels;
pub(crate) mod newton;
pub(crate) mod nodal_rotations;
pub(crate) mod options;
pub(crate) mod rotation_corrected_step;
pub(crate) mod solver;
pub(crate) mod state;
pub(crate) mod tangent;
pub(crate) mod workspace;
