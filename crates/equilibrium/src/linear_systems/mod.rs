//! Tangent systems and what solves them.

pub(crate) mod local_constraints;
pub(crate) mod nodal_rotations;
pub(crate) mod saddle_point;
mod step_without_border;
pub(crate) mod tangent;
pub mod tangent_systems;
pub mod workspace;
