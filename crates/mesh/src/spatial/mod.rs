//! Exact searches on solids: is a point inside, what is the nearest point of the solid, how far are two solids apart.
//!
//! A solid is the union of the (possibly curved) cells of a mesh, or of one of its regions, at given positions. Nothing
//! here is node to node: points are found inside cells by inverting the cell's map, nearest points lie on the curved
//! boundary faces, and the [Hausdorff distance](hausdorff) comes with a bound on its error.
//!
//! Cells and faces are rewritten once as Bézier patches, whose control points bound them rigorously and whose second
//! differences say how far any piece of them is from flat.

mod boundary;
mod cell;
mod cell_piece;
mod closest_point;
mod directed;
mod enclosure;
mod error;
mod hausdorff;
mod interpolation_error;
mod obstacle;
mod patch;
mod patch_space;
mod polyhedron;
mod self_intersection;
mod shape;
mod simplex;
mod split;
mod subcell;
mod surface;
mod tree;

pub use error::SpatialError;
pub use hausdorff::{Hausdorff, hausdorff, hausdorff_within};
pub use obstacle::{DistanceGrid, LostWall, Obstacle, SignedDistance};
pub use polyhedron::{Feature, Polyhedron, SurfacePoint};
pub use self_intersection::SelfIntersection;
pub use shape::Shape;
pub use surface::{Surface, exterior_facets};
pub use tree::{Aabb, Tree};

type V = nalgebra::Vector3<f64>;
