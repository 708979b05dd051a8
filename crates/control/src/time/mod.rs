//! Problems in time: instants, controls between knots, costs of trajectories.

mod actuation_work;
mod control_rate;
mod fixed_in_time;
mod instants;
mod kinetic_energy;
mod memory;
mod observer;
mod rate_limit;
mod schedule;
mod timeline;
mod trajectory_cost;

pub use actuation_work::ActuationWork;
pub use control_rate::ControlRate;
pub(crate) use fixed_in_time::FixedInTime;
pub use instants::Instants;
pub use kinetic_energy::KineticEnergy;
pub use memory::{MotionFootprint, MotionMemory};
pub use observer::{MotionObserver, StepUnderWay};
pub use rate_limit::RateLimit;
pub(crate) use schedule::Schedule;
pub use schedule::When;
pub use timeline::Timeline;
pub use trajectory_cost::{TrajectoryContext, TrajectoryCost, TrajectoryPartials};

use crate::cost::CostForm;

/// Every cost of a whole motion, as case files name it.
pub const COSTS: &[&CostForm] = &[&control_rate::FORM, &kinetic_energy::FORM, &actuation_work::FORM];
