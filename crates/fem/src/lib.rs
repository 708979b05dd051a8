//! Finite elements at finite strain: assembly, linear solvers, Newton's method, continuation, states.
//!
//! A [`Solid`] is a body on a [`Discretization`] with energy terms, supports and loads; [`Solid::solve`] finds its
//! equilibrium and [`Solid::adjoint`] solves with the tangent there. What is known here about laws is what
//! [`EnergyTerm`](nastic_energy::EnergyTerm) says, and about costs nothing.

mod adjoint;
mod assembly;
mod bend;
mod body;
mod continuation;
mod controls;
mod discretization;
mod error;
mod fields;
mod frame;
mod kernel;
mod levels;
pub mod linear;
mod newton;
mod product;
mod pull_back;
mod request;
mod sampling;
mod scratch;
mod solid;
mod solver;
mod state;
mod supports;
mod sweep;
mod tangent;
mod volume;

pub use adjoint::Adjoint;
pub use body::{Attached, Body, Evaluation};
pub use controls::Controls;
pub use discretization::Discretization;
pub use error::{FemError, InvertedAt, StateError};
pub use fields::CellFields;
pub use request::{Progress, Request};
pub use sampling::Sampling;
pub use solid::Solid;
pub use solver::Solver;
pub use state::{SolveReport, Solved, State};
pub use supports::{AXES, Supports};
