//! Motions: time schemes as tables, steps, the balance of energy, the discrete adjoint, vibration modes.

pub mod adaptive;
mod beginning;
pub mod catalogue;
pub mod checkpoints;
pub mod energy_balance;
mod force_families;
mod initial_acceleration;
pub mod instant_adjoint;
mod modal_step;
pub mod numerical_damping;
mod parts;
mod points;
pub mod recording;
pub mod reverse_sweep;
pub mod scheme;
mod step;
mod supported;
mod time_stepping;
pub mod trajectory;
pub mod vibration_modes;

pub use time_stepping::TimeStepping;
