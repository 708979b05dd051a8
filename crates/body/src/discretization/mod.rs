//! [`Discretization`]: everything about a mesh that materials, loads and supports do not change.

pub mod hexahedra;
mod nodal_fields;
mod nodal_volumes;
pub mod parted;
pub mod quadrature_points;
pub mod rigid_motions;
mod shared;
pub mod supports;

use crate::discretization::hexahedra::Hexahedra;
use crate::discretization::quadrature_points::{CellGroup, QuadraturePoints};
use crate::discretization::shared::Shared;
use crate::error::FemError;
use crate::structure::{KeptStructures, StructureCounts, TangentStructure};
use nastic_linear::{Corners, Share, Space};
use nastic_mesh::{Mesh, Part};
use parted::Parted;
use std::fmt;
use std::sync::{Arc, OnceLock};

/// A mesh with its quadrature points.
///
/// Shared (by [`Arc`]) among all solids on the mesh: scenarios and load cases differ in physics alone. Which nodes are coupled in their
/// tangents is said by their [`TangentStructure`]s, which share the work of those with the same couplings.
pub struct Discretization {
    mesh: Arc<Mesh>,
    points: Arc<QuadraturePoints>,
    corners: OnceLock<Option<Corners>>,
    hexahedra: OnceLock<Option<Arc<Hexahedra>>>,
    /// See [`Mesh::patches`].
    patches: OnceLock<Vec<u32>>,
    /// That of tangents with the couplings of cells alone.
    of_cells: Arc<TangentStructure>,
    structures: Arc<KeptStructures>,
    shared: Shared,
    parted: Option<Parted>,
}

impl Discretization {
    /// The discretisation of the whole mesh with each element's default rule.
    ///
    /// # Errors
    /// [`FemError::InvertedReference`] where the reference configuration is inverted, [`FemError::Structure`] for a mesh
    /// whose tangent has more blocks than 32 bits can name.
    pub fn new(mesh: Arc<Mesh>) -> Result<Arc<Self>, FemError> {
        Self::of_part(mesh, None)
    }

    /// The same of a mesh that is part of another one.
    pub fn of_part(mesh: Arc<Mesh>, parted: Option<Parted>) -> Result<Arc<Self>, FemError> {
        let points = Arc::new(QuadraturePoints::of_cells(&mesh, 0..mesh.cells() as u32, |kind| kind.rule().clone())?);
        let structures = Arc::<KeptStructures>::default();
        let of_cells = TangentStructure::new(mesh.clone(), points.clone(), Vec::new(), structures.clone())?;
        let (corners, hexahedra, patches) = (OnceLock::new(), OnceLock::new(), OnceLock::new());
        let shared = Shared::default();
        Ok(Arc::new(Discretization { mesh, points, corners, hexahedra, patches, of_cells, structures, shared, parted }))
    }

    /// The structure of tangents in which nodes are coupled by cells alone.
    pub(crate) fn of_cells(&self) -> &Arc<TangentStructure> {
        &self.of_cells
    }

    /// How often the tangents of this mesh, with whatever couplings, were put in order and analysed so far.
    pub fn structure_counts(&self) -> StructureCounts {
        self.structures.counts()
    }

    /// An equal value that another problem on this discretisation shared before and still has, else this one: members of an ensemble differ in
    /// few of their vectors.
    pub fn share<T: PartialEq + Send + Sync + 'static>(&self, value: Arc<T>) -> Arc<T> {
        self.shared.share(value)
    }

    /// The part that it is of, where several ranks have the body.
    pub fn parted(&self) -> Option<&Parted> {
        self.parted.as_ref()
    }

    /// Of a body over ranks the part of this rank, and what passes between the ranks: numbers of nodes and cells of the whole are the part's.
    pub fn over_ranks(&self) -> Option<(&Part, &Arc<Share>)> {
        self.parted.as_ref().map(|parted| (&parted.part, &parted.share))
    }

    /// Diagonal of the bounding box of the body, also where the mesh is part of it.
    pub fn diagonal(&self) -> f64 {
        self.parted.as_ref().map_or_else(|| self.mesh.diagonal(), |parted| parted.part.diagonal())
    }

    /// The mesh.
    pub fn mesh(&self) -> &Arc<Mesh> {
        &self.mesh
    }

    /// Displacement components per node: 2 (plane strain) or 3.
    pub fn dim(&self) -> usize {
        self.mesh.dim()
    }

    /// Number of displacement unknowns, supported ones included.
    pub fn dofs(&self) -> usize {
        self.mesh.points().len() * self.dim()
    }

    /// The body's quadrature points, in mesh cell order.
    pub fn points(&self) -> &QuadraturePoints {
        &self.points
    }

    /// The cells' quadrature points: number of the first and how many, by cell.
    pub fn points_of_cells(&self) -> Vec<(usize, usize)> {
        let part = |p: &CellGroup| (0..p.cells.len()).map(|c| (p.first_point(c), p.table.points)).collect::<Vec<_>>();
        self.points.parts.iter().flat_map(part).collect()
    }

    /// Average over each cell of a quantity at the quadrature points, weighted by reference volume;
    /// shape `[cells][components]`.
    pub fn cell_average(&self, at_points: &[f64], components: usize) -> Vec<f64> {
        let mut out = Vec::with_capacity(self.mesh.cells() * components);
        for (first, count) in self.points_of_cells() {
            let weights = &self.points.weights()[first..first + count];
            let volume: f64 = weights.iter().sum();
            for i in 0..components {
                let sum: f64 = (0..count).map(|q| weights[q] * at_points[(first + q) * components + i]).sum();
                out.push(sum / volume);
            }
        }
        out
    }

    /// How second-order cells contain first-order ones; nothing on a mesh of first-order cells. Made when first asked for.
    pub fn corners(&self) -> Option<&Corners> {
        let make = || {
            let shapes: Vec<Vec<f64>> = self.points.parts.iter().map(corner_shapes).collect();
            let elements = self.points.parts.iter().zip(&shapes).flat_map(|(part, shapes)| {
                (0..part.cells.len()).map(move |c| (part.nodes_of(c), part.kind.corners(), shapes.as_slice()))
            });
            Corners::new(self.mesh.points().len(), elements)
        };
        self.corners.get_or_init(make).as_ref()
    }

    /// Its cells in batches, if all are 27-node hexahedra. Made when first asked for.
    pub fn hexahedra(&self) -> Option<&Arc<Hexahedra>> {
        let make = || Hexahedra::new(&self.points, self.mesh.points().len()).map(Arc::new);
        self.hexahedra.get_or_init(make).as_ref()
    }

    /// The [patch](Mesh::patches) of every cell, that of the whole mesh where this is part of one. Made when first asked for.
    pub(crate) fn patches(&self) -> &[u32] {
        match &self.parted {
            Some(parted) => parted.part.patches(),
            None => self.patches.get_or_init(|| self.mesh.patches()),
        }
    }

    /// `a . b` over the displacement unknowns of the whole mesh.
    pub fn dot(&self, a: &[f64], b: &[f64]) -> f64 {
        Space::LOCAL.dot(a, b)
    }
}

/// The shapes of the first-order kind at the nodes of a kind, `[node][corner]`.
pub fn corner_shapes(part: &CellGroup) -> Vec<f64> {
    let corners = part.kind.corners();
    let mut shapes = vec![0.0; part.kind.nodes() * corners];
    for (xi, row) in part.kind.reference_nodes().iter().zip(shapes.chunks_exact_mut(corners)) {
        part.kind.corner_kind().shapes(xi, row);
    }
    shapes
}

impl fmt::Debug for Discretization {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "Discretization of {} ({} unknowns, {} points)", self.mesh.name(), self.dofs(), self.points.len())
    }
}
