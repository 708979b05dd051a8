//! A [`Solid`] that is the part of one rank.

use super::Solid;
use nastic_body::discretization::Discretization;
use nastic_body::discretization::parted::Parted;
use nastic_body::error::FemError;
use nastic_mesh::{GroupNames, Mesh, Part};
use nastic_team::Team;
use std::collections::BTreeSet;
use std::sync::Arc;

impl Solid {
    /// The part of a body that a rank of a team has, without materials; every other rank has that of its number of the same division. All ranks build the
    /// same body, and call what solves together; groups of the mesh may have nothing on some of them.
    ///
    /// Solves and adjoints are for equilibria of laws and actuations, dead loads, supports that are held or moved, and
    /// [contributions that say so](nastic_body::contribution::Contribution::spans_ranks); all else is refused, also formulations over patches of cells that
    /// parts [cut](Mesh::with_whole_patches). It needs a [solver](Self::solver) that spans ranks. Vectors are in the numbers of the part: `u` is whole, [`nodal_force`](Self::nodal_force) and the derivatives by controls that a rank finds are its share of a sum.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn of_part(part: Part, team: Arc<dyn Team>) -> Result<Self, FemError> {
        let mesh = part.mesh().clone();
        Ok(Self::on(Discretization::of_part(mesh, Some(Parted::new(part, team)))?))
    }

    /// The nodes of surfaces or, failing that, of node sets; ascending, each once.
    ///
    /// # Errors
    /// A name is neither.
    pub fn nodes_of(&self, names: impl Into<GroupNames>) -> Result<Vec<u32>, FemError> {
        let mesh = self.mesh();
        let mut nodes = BTreeSet::new();
        for name in names.into().iter() {
            if mesh.surfaces().contains_key(name) || !mesh.node_sets().contains_key(name) {
                match self.discretization().parted() {
                    Some(parted) => nodes.extend(parted.part.nodes_of_surface(name)?),
                    None => nodes.extend(mesh.nodes_of_facets(mesh.surface(name)?)),
                }
            } else {
                nodes.extend(mesh.node_set(name)?);
            }
        }
        Ok(nodes.into_iter().collect())
    }

    /// The mesh, for what has to know all of it.
    pub(crate) fn whole_mesh(&self, what: &str) -> Result<&Arc<Mesh>, FemError> {
        self.model().ranks().refuse_ranks(what)?;
        Ok(self.mesh())
    }
}
