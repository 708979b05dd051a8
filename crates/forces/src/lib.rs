//! What acts on a body beside the energy of its cells: a [`Contribution`](nastic_body::contribution::Contribution) each.

pub mod cavity;
pub mod contact;
pub mod dead_load;
pub mod dielectric_body;
pub mod electrode;
mod element_matrices;
pub mod fill;
mod filled_mass;
pub mod foundation;
pub mod free_shape;
mod guides;
pub mod inertia;
mod matter_cells;
pub mod medium;
pub mod moving_support;
mod no_force;
pub mod nodal_value;
pub mod rayleigh_damping;
pub mod rigid_body;
pub mod rigid_motion;
pub mod spring;
pub mod tendon;
pub mod varying_load;
pub mod weak_form;
