//! Reference elements, nodes, cells, named regions and surfaces, generators, quality, spatial search and exact distances.
//!
//! Coordinates are always `[x, y, z]`; a plane mesh has z = 0 everywhere. Nodes of a cell stand in VTK's order for its
//! kind. A [`Mesh`] is immutable and has passed every check: readers and generators make a [`RawMesh`] and hand it to
//! [`Mesh::build`].
//!
//! ```
//! use nastic_mesh::{CellKind, box_mesh};
//!
//! let mesh = box_mesh([1.0, 0.2, 0.2], [10, 2, 2], CellKind::Hex27)?;
//! assert_eq!((mesh.points().len(), mesh.cells()), (525, 40));
//! assert_eq!(mesh.surface("x-")?.len(), 4);
//! # Ok::<(), nastic_mesh::MeshError>(())
//! ```

mod bisect;
mod build;
mod coincident;
mod columns;
pub mod element;
mod error;
mod generate;
mod geometry;
mod group_names;
mod least_width;
mod level_body;
mod level_part;
mod level_piece;
mod locate;
mod measure;
mod mesh;
mod moved;
mod names;
mod part;
mod patches;
mod pieces;
mod polyline;
pub mod quadrature;
mod quality;
mod snapshot;
pub mod spatial;
mod tabulated;
mod together;

pub use build::{RawBlock, RawMesh};
pub use columns::Column;
pub use element::{CellKind, Domain};
pub use error::{Fault, MeshError};
pub use generate::{box_mesh, rectangle};
pub use group_names::GroupNames;
pub use least_width::LeastWidth;
pub use level_body::{ClosedSurface, LevelBody, LevelSimplices};
pub use level_piece::WallKind;
pub use locate::Located;
pub use measure::Measures;
pub use mesh::{Cell, CellBlock, Facet, Mesh};
pub use part::Part;
pub use polyline::Polyline;
pub use quadrature::Rule;
pub use quality::{CellQuality, Quality};
pub use snapshot::{NamedArray, Snapshot};
pub use spatial::{Hausdorff, Shape, SpatialError, hausdorff, hausdorff_within};
