//! A problem in words: what `nastic check` prints of a case.

mod body;
mod contact;
mod controls;
mod conventions;
mod costs;
mod line;
mod pace;
mod parameters;
mod shape_cost;
mod time;

pub use body::{blocks, groups, materials, mesh, supports, units};
pub use contact::{contacts, rigid_bodies};
pub use controls::{controls, optimizer};
pub use conventions::conventions;
pub use costs::{cost_line, costs};
pub use line::{Line, line};
pub use pace::MultigridPace;
pub use parameters::{catalogue_of, parameters, scalar, vector_field};
pub use time::time;
