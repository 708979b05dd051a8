//! From controls to an equilibrium: load steps, and what is tried where they fail.

pub mod ahead;
pub(crate) mod cell_laplacian;
pub mod connection;
pub(crate) mod continuation;
pub mod descent;
pub mod exact_contact;
pub(crate) mod gradient_fit;
pub(crate) mod load_rate;
pub(crate) mod load_steps;
pub mod options;
mod requests;
pub(crate) mod rotation_corrected_step;
pub(crate) mod settling;
pub(crate) mod slide;
