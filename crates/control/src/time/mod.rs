//! Problems in time: instants, controls between knots, costs of trajectories.

mod control_rate;
mod knots;
mod memory;
mod rate_limit;
mod schedule;
mod timeline;
mod trajectory_cost;

pub use control_rate::ControlRate;
pub use knots::{Interpolation, Knots};
pub use memory::{MotionFootprint, MotionMemory};
pub use rate_limit::RateLimit;
pub(crate) use schedule::Schedule;
pub use schedule::When;
pub use timeline::Timeline;
pub use trajectory_cost::{TrajectoryContext, TrajectoryCost, TrajectoryPartials};
