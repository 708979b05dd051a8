//! Motion: time schemes as tables, their steps, and the discrete adjoint that follows from the same tables.

pub(crate) mod adaptive;
mod beginning;
pub mod catalogue;
pub(crate) mod checkpoints;
pub(crate) mod energy_balance;
mod force_families;
pub(crate) mod initial_acceleration;
pub(crate) mod instant_adjoint;
pub(crate) mod modal_step;
pub(crate) mod numerical_damping;
pub(crate) mod parts;
mod points;
pub(crate) mod recording;
pub(crate) mod reverse_sweep;
pub(crate) mod scheme;
pub(crate) mod step;
mod supported;
pub(crate) mod trajectory;
