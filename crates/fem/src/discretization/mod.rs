//! [`Discretization`]: everything about a mesh that materials, loads and supports do not change.

pub(crate) mod cell_fields;
mod mass;
mod nodal_fields;
mod nodal_volumes;
mod patches;
pub(crate) mod quadrature_points;
pub(crate) mod structure;
pub(crate) mod supports;

use crate::discretization::quadrature_points::{CellGroup, QuadraturePoints};
use crate::error::FemError;
use nastic_linear::{
    Corners, Graph, Pattern, Precision, Solver, SolverFactory, Space, SparseMatrix, Structure, Symbolic,
};
use nastic_mesh::Mesh;
use std::fmt;
use std::sync::{Arc, Mutex, OnceLock, PoisonError, Weak};
pub use structure::StructureCounts;
use structure::{Counters, TangentStructure};

/// A mesh with its quadrature points, which nodes are coupled in tangents, and what follows from that when first asked for: numbering,
/// sparsity pattern, scatter maps; where a factor is made, its symbolic factorisation.
///
/// Shared (by [`Arc`]) among all solids on the mesh: scenarios and load cases differ in physics alone. The numbering
/// keeps supported components in, so that one symbolic analysis serves every choice of supports.
pub struct Discretization {
    mesh: Arc<Mesh>,
    points: Arc<QuadraturePoints>,
    graph: Graph,
    structure: OnceLock<TangentStructure>,
    counters: Arc<Counters>,
    corners: OnceLock<Option<Corners>>,
    /// See [`patches`](patches::patches).
    patches: OnceLock<Arc<Vec<u32>>>,
    /// Node sets coupled beyond those of cells.
    couplings: Vec<Vec<u32>>,
    /// Discretisations of the same mesh with more couplings, while somebody holds them.
    coupled: Mutex<Vec<Weak<Discretization>>>,
}

impl Discretization {
    /// The discretisation of the whole mesh with each element's default rule.
    ///
    /// # Errors
    /// [`FemError::InvertedReference`] where the reference configuration is inverted, [`FemError::Structure`] for a mesh
    /// whose tangent has more blocks than 32 bits can name.
    pub fn new(mesh: Arc<Mesh>) -> Result<Arc<Self>, FemError> {
        let points = QuadraturePoints::of_cells(&mesh, 0..mesh.cells() as u32, |kind| kind.rule().clone())?;
        Self::coupled_by(mesh, Arc::new(points), Vec::new(), (Arc::default(), OnceLock::new()))
    }

    fn coupled_by(
        mesh: Arc<Mesh>,
        points: Arc<QuadraturePoints>,
        couplings: Vec<Vec<u32>>,
        (counters, patches): (Arc<Counters>, OnceLock<Arc<Vec<u32>>>),
    ) -> Result<Arc<Self>, FemError> {
        let cells = points.parts.iter().flat_map(|p| (0..p.cells.len()).map(|c| p.nodes_of(c)));
        let graph = Graph::from_cliques(mesh.points().len(), cells.chain(couplings.iter().map(Vec::as_slice)))?;
        let (structure, corners, coupled) = (OnceLock::new(), OnceLock::new(), Mutex::default());
        Ok(Arc::new(Discretization { mesh, points, graph, structure, counters, corners, patches, couplings, coupled }))
    }

    /// The discretisation of the same mesh in whose tangents these sets of nodes are coupled too; the same one where they
    /// are already. Solids that ask for the same couplings share it. Nothing is put in order for it yet.
    ///
    /// # Errors
    /// [`FemError::Structure`].
    pub fn with_couplings(self: &Arc<Self>, more: &[Vec<u32>]) -> Result<Arc<Self>, FemError> {
        if more.iter().all(|nodes| self.graph.check_coupled(nodes).is_ok()) {
            return Ok(self.clone());
        }
        let couplings: Vec<Vec<u32>> = self.couplings.iter().chain(more).cloned().collect();
        // A thread that died while it held the lock left a whole list behind.
        let mut known = self.coupled.lock().unwrap_or_else(PoisonError::into_inner);
        known.retain(|weak| weak.strong_count() > 0);
        if let Some(found) = known.iter().filter_map(Weak::upgrade).find(|disc| disc.couplings == couplings) {
            return Ok(found);
        }
        let shared = (self.counters.clone(), self.patches.clone());
        let new = Self::coupled_by(self.mesh.clone(), self.points.clone(), couplings, shared)?;
        known.push(Arc::downgrade(&new));
        Ok(new)
    }

    fn tangents(&self) -> &TangentStructure {
        let make = || TangentStructure::new(&self.graph, &self.mesh, &self.points, &self.counters);
        self.structure.get_or_init(make)
    }

    /// How often the tangents of this mesh, with all couplings, were put in order and analysed so far.
    pub fn structure_counts(&self) -> StructureCounts {
        self.counters.read()
    }

    /// Which nodes are coupled.
    pub(crate) fn graph(&self) -> &Graph {
        &self.graph
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

    /// The sparsity pattern of the tangent.
    pub fn pattern(&self) -> &Arc<Pattern> {
        self.structure().pattern()
    }

    /// The structure of the tangent: its pattern, and its symbolic factorisation once a solver has asked for it.
    pub fn structure(&self) -> &Arc<Structure> {
        &self.tangents().equations
    }

    /// The symbolic factorisation of the tangent, made when first asked for.
    pub fn symbolic(&self) -> &Arc<Symbolic> {
        self.structure().symbolic()
    }

    /// Bytes of a factor of the tangent in double precision.
    pub fn factor_bytes(&self) -> usize {
        self.structure().factor_size().bytes()
    }

    /// Bytes of a factorisation of the tangent in double precision at its largest, predicted: the factor and its working memory.
    pub fn factorisation_bytes(&self) -> usize {
        self.symbolic().factorisation_bytes(Precision::Double)
    }

    /// The structure with another number of unknowns per node, in the same order of nodes; its analyses are not counted.
    pub(crate) fn structure_of(&self, components: usize) -> Arc<Structure> {
        self.tangents().with_components(components)
    }

    /// The solver that a solve on this mesh takes unless it is told which, see [`Solver::cheaper`].
    pub fn solver(&self) -> &'static dyn SolverFactory {
        Solver::cheaper(self.structure())
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

    /// The [patch](patches::patches) of every cell. Made when first asked for.
    pub(crate) fn patches(&self) -> &[u32] {
        self.patches.get_or_init(|| Arc::new(patches::patches(&self.mesh)))
    }

    /// `a . b` over the displacement unknowns of the whole mesh.
    pub(crate) fn dot(&self, a: &[f64], b: &[f64]) -> f64 {
        Space::LOCAL.dot(a, b)
    }

    /// A zero matrix of the tangent's pattern.
    pub fn matrix(&self) -> SparseMatrix {
        SparseMatrix::zeros(self.pattern().clone())
    }

    /// Scatter maps of the cells of one part of the body's sampling.
    pub(crate) fn scatter(&self, part: usize) -> &[u32] {
        &self.tangents().scatter[part]
    }
}

/// The shapes of the first-order kind at the nodes of a kind, `[node][corner]`.
fn corner_shapes(part: &CellGroup) -> Vec<f64> {
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
