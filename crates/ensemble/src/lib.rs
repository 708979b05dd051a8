//! One control for many bodies: the risk of a control over scenarios and load cases.
//!
//! [`Ensemble`] is made of [`Reduced`](nastic_control::Reduced) problems, its members, and is an
//! [`Objective`](nastic_opt::Objective) as they are. Members are evaluated side by side, on threads and on the ranks of a
//! [`Team`](nastic_team::Team).

mod blocks;
mod ensemble;
mod error;
mod first_order;
mod matern;
mod member;
mod parcel;
mod point;
mod product;
mod ranks;
mod saved;

pub use blocks::EnsembleBlock;
pub use ensemble::{Ensemble, EnsembleBuilder, Finished, Measured};
pub use error::EnsembleError;
pub use first_order::{FirstOrder, FirstOrderPoint, UncertainSource, VarianceShare};
pub use matern::{Kept, Matern, MaternModes};
pub use member::{LoadCase, Member};
pub use parcel::{MemberValues, Parcel};
pub use point::{EnsemblePoint, EnsembleWorkspace};
pub use saved::{MemberBlock, SavedMembers, blocks as blocks_of_members};
