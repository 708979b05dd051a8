//! [`CostTarget`]: the shape that a cost aims at.

use nastic_mesh::{GroupNames, Mesh};
use std::sync::Arc;

/// The shape that a cost aims at, for those who draw it or measure distances from it: a mesh where it is, or the body's own mesh with a
/// displacement.
#[derive(Clone, Debug)]
pub struct CostTarget {
    /// The target's mesh, or the body's own.
    pub mesh: Arc<Mesh>,
    /// The regions of the mesh that are the target; all of it if `None`.
    pub regions: Option<GroupNames>,
    /// Displacement of the nodes where the mesh is the body's, each with a flag whether it matters there; empty otherwise.
    pub displacement: Vec<([f64; 3], bool)>,
}
