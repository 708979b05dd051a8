use crate::MeshError;

/// What may be wrong with a solid given to the exact searches.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SpatialError {
    /// One position per mesh node is needed.
    #[error(
        "{found} positions given for the {nodes} nodes of mesh \"{mesh}\"; give one per node (mesh.points() at rest)"
    )]
    Positions {
        /// Name of the mesh.
        mesh: String,
        /// Nodes of the mesh.
        nodes: usize,
        /// Positions given.
        found: usize,
    },
    /// A coordinate is NaN or infinite.
    #[error("position of node {node} of mesh \"{mesh}\" is {position:?}; coordinates must be finite")]
    NotFinite {
        /// Name of the mesh.
        mesh: String,
        /// Node number (from 0).
        node: usize,
        /// The position given.
        position: [f64; 3],
    },
    /// The region has no cell.
    #[error("region \"{region}\" of mesh \"{mesh}\" has no cells, so it has no distance to anything")]
    Empty {
        /// Name of the mesh.
        mesh: String,
        /// Name of the region.
        region: String,
    },
    /// A solid with flat faces is wanted.
    #[error(
        "mesh \"{mesh}\" has {kind} cells, whose faces may be curved; mesh the solid by linear cells (tet4, hex8; tri3, quad4 in the plane; in Gmsh -order 1)"
    )]
    Curved {
        /// Name of the mesh.
        mesh: String,
        /// The kind of a cell.
        kind: &'static str,
    },
    /// A face without area.
    #[error("the face of mesh \"{mesh}\" between the nodes {nodes:?} has no area, so no normal")]
    Flat {
        /// Name of the mesh.
        mesh: String,
        /// Its corners.
        nodes: Vec<u32>,
    },
    /// A plane solid and a spatial one cannot be compared.
    #[error("cannot compare a {a}D solid with a {b}D solid; mesh both in the same dimension")]
    Dimension {
        /// Dimension of the first solid.
        a: usize,
        /// Dimension of the second solid.
        b: usize,
    },
    /// No length.
    #[error("the {what} of the grid of a distance is {length}; it is a positive, finite length")]
    GridSpacing {
        /// Spacing or margin.
        what: &'static str,
        /// The value given.
        length: f64,
    },
    /// More numbers than a grid keeps.
    #[error(
        "a grid of spacing {spacing} around the solid takes {numbers:.1e} nodes, {most:.0e} are the most ({} MB): take a spacing of {coarser} or more",
        most * 8e-6
    )]
    LargeGrid {
        /// Distance of neighbouring nodes.
        spacing: f64,
        /// Nodes it takes.
        numbers: f64,
        /// The most it may take.
        most: f64,
        /// A spacing that is large enough.
        coarser: f64,
    },
    /// A grid that has no node inside of the solid.
    #[error(
        "a grid of spacing {spacing} has no node inside of the solid, whose bounding box is {size:?}: take a spacing below the thickness of its walls"
    )]
    CoarseGrid {
        /// Distance of neighbouring nodes.
        spacing: f64,
        /// Sides of the bounding box.
        size: Vec<f64>,
    },
    /// An invalid obstacle.
    #[error("{what}")]
    Obstacle {
        /// What is wrong.
        what: String,
    },
    /// The mesh has no such region.
    #[error(transparent)]
    Mesh(#[from] MeshError),
}
