//! Convex neural networks of invariants: what the law [`ConvexNetwork`](crate::ConvexNetwork) is made of.

mod activation;
mod compiled;
mod error;
mod input;
mod layer;

pub(crate) use compiled::pair;
pub use compiled::{CheckedNetwork, MOST_INPUTS};
pub use error::NetworkError;
pub use input::{NetworkInput, SquareOf};
pub use layer::{ExampleLayer, Network, NetworkLayer, WeightKind};
