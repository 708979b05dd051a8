//! Factors: their structure, found once per pattern, and their numbers, symmetric (`L D L^T`) and general (`L U`).

mod bunch_kaufman;
mod columns;
mod dense;
pub(crate) mod factor_size;
pub(crate) mod joined_structure;
pub(crate) mod lu_factor;
mod numeric;
mod panel;
mod real;
pub(crate) mod rotations;
mod schedule;
mod solve;
pub(crate) mod structure;
pub(crate) mod symbolic;
pub(crate) mod symmetric;
