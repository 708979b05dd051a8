//! The shapes that costs aim at.

use nastic_control::CostTarget;
use nastic_fem::Discretization;
use nastic_language::syntax::At;
use nastic_mesh::{GroupNames, Mesh};
use std::sync::Arc;

/// The shape a cost aims at, for pictures and `target.vtu`.
#[derive(Clone, Debug)]
pub struct TargetShape {
    /// Path of the cost's block.
    pub at: At,
    /// Name of the cost.
    pub cost: String,
    /// The target's mesh, in the case's units; of a tracking target the body's own.
    pub mesh: Arc<Mesh>,
    /// The regions of its mesh that are the target; all of it if `None`.
    pub regions: Option<GroupNames>,
    /// Displacement of the nodes where the mesh is the body's, with a flag for those it matters at; empty otherwise.
    pub displacement: Arc<Vec<([f64; 3], bool)>>,
}

impl TargetShape {
    /// That of a cost of this name and block, for a body on a discretisation.
    pub(super) fn of(at: At, cost: &str, target: CostTarget, disc: &Discretization) -> Self {
        let CostTarget { mesh, regions, displacement } = target;
        let displacement = disc.share(Arc::new(displacement));
        Self { at, cost: cost.to_owned(), mesh, regions, displacement }
    }

    /// Whether it is the same shape.
    pub fn is_same(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.mesh, &other.mesh) && self.cost == other.cost && self.displacement == other.displacement
    }

    /// Whether it says where every node should be: such a shape can be drawn.
    #[must_use]
    pub fn is_whole(&self) -> bool {
        self.displacement.iter().all(|(_, matters)| *matters)
    }
}
