//! Multigrid for elastic bodies: a preconditioner whose cost grows with the number of unknowns, for bodies whose factor
//! does not.
//!
//! Second-order elements, known by [products](CellProducts) alone where there are some, first hand over to the first-order elements on their corners ([`Corners`]); below that come
//! smoothed aggregates of nodes that carry the rigid motions of the *displaced* body; the last level is factorised. One
//! application is a symmetric V-cycle with Chebyshev smoothing, so it serves conjugate gradients.
//!
//! Vanek, Mandel, Brezina, "Algebraic multigrid by smoothed aggregation for second and fourth order elliptic problems",
//! Computing 56 (1996); Adams et al., "Parallel multigrid smoothing", J. Comput. Phys. 188 (2003).

mod aggregation;
mod block_matrix;
mod cell_products;
mod chunks;
mod coarsest;
mod corner_matrix;
mod corners;
mod couplings;
mod cycle;
mod galerkin;
mod hierarchy;
mod level;
mod modes;
mod prolongator;
mod size;
mod smoother;
mod tentative;
mod transfer;

pub use cell_products::{CellProducts, CornerMatrix};
pub use corners::Corners;
pub use hierarchy::{Geometry, Multigrid};
