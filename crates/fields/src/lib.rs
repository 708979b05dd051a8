//! Control fields: spaces over a body, chains of maps in front of them, and how fields stand in one vector.
//!
//! A [`Layout`] holds the unknowns of a problem, field by field ([`ControlBlock`]): each has a [`Basis`] over cells, regions, nodes or a
//! grid, a [`Chain`] of [`ControlMap`]s, and slots of a body that follow from it. [`inner_product`] makes gradients of derivatives.
//! Nothing here solves an equilibrium.

mod control_block;
mod control_limit;
mod control_names;
mod control_values;
mod design;
mod error;
mod field_chain;
mod field_operator;
mod free_shape;
mod grid;
mod inner_product;
mod knots;
mod layout;
mod map;
mod over_ranks;
mod total_variation;

pub use control_block::{ControlBlock, ControlTarget, Shown};
pub use control_limit::{ControlAt, ControlLimit};
pub use control_values::{ControlEntity, ControlValues, Pairs};
pub use design::Consumer;
pub use error::{ControlError, RemoteFailure};
pub use field_operator::{FieldOperator, mass_product, stiffness_product};
pub use grid::Grid;
pub use inner_product::{METRICS, Metric, MetricRow, inner_product};
pub use knots::{Interpolation, Knots};
pub use layout::Layout;
pub use map::{
    Basis, Chain, ControlMap, Direction, Expansion, Exponential, Filter, Held, Length, MAPS, MapRow, Mirror, Plane,
    PowerLaw, Projection, SPACES, Space, SpaceRow, Staged, Step,
};
pub use over_ranks::{add_up, gathered};
