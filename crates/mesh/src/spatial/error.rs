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
    /// A plane solid and a spatial one cannot be compared.
    #[error("cannot compare a {a}D solid with a {b}D solid; mesh both in the same dimension")]
    Dimension {
        /// Dimension of the first solid.
        a: usize,
        /// Dimension of the second solid.
        b: usize,
    },
    /// The mesh has no such region.
    #[error(transparent)]
    Mesh(#[from] MeshError),
}
