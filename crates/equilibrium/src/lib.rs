//! Equilibria: the sum of contributions ([`Model`](model::Model)), tangent systems, Newton's method, the search along load steps, adjoints,
//! stability.

pub mod adjoint;
pub mod contribution_check;
pub mod linear_systems;
pub mod model;
pub mod nonlinear;
pub mod search;
pub mod stability;
