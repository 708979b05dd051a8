//! Which equilibria are stable, and where they stop being so: modes, ramps, paths, deflation.

pub(crate) mod arc_length;
pub mod deflation;
pub(crate) mod limit_point;
pub mod modes;
pub mod path;
pub(crate) mod path_events;
pub mod ramp;
