//! What the residual is made of.

pub(crate) mod body_energy;
pub(crate) mod controls;
