//! From controls to an equilibrium: load steps, Newton's method, tangent systems.

pub(crate) mod ahead;
mod arc_length;
mod cell_laplacian;
pub(crate) mod connection;
mod continuation;
pub(crate) mod deflation;
pub(crate) mod descent;
pub(crate) mod exact_contact;
pub(crate) mod gradient_fit;
mod limit_point;
mod load_rate;
mod load_steps;
mod local_constraints;
pub(crate) mod modes;
pub(crate) mod nodal_rotations;
pub(crate) mod options;
pub(crate) mod path;
mod path_events;
pub(crate) mod ramp;
pub(crate) mod rotation_corrected_step;
pub(crate) mod saddle_point;
mod slide;
pub(crate) mod state;
pub(crate) mod tangent;
pub(crate) mod tangent_systems;
pub(crate) mod vibration_modes;
pub(crate) mod workspace;
