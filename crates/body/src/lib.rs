//! Bodies at finite strain, discretised: quadrature points, supports, the energy of the cells, controls, states, and the trait
//! that everything which acts on a body implements ([`Contribution`](contribution::Contribution)).

pub mod body_energy;
pub mod contribution;
pub mod controls;
pub mod discretization;
pub mod error;
pub mod history;
pub mod instant;
pub mod kernels;
pub mod rotation;
pub mod state;
pub mod strategy;
pub mod structure;
