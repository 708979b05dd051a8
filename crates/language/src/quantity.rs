//! Dimensions, unit suffixes and the consistent system a case computes in.

mod dimension;
mod unit;
mod units;
mod want;

pub use dimension::Dimension;
pub use unit::{UNITS, Unit};
pub use units::Units;
pub use want::{Sign, Want};
