//! [`TangentStructure`]: which nodes are coupled in the tangents of a body.

mod kept;
mod mass;

use crate::discretization::quadrature_points::{CellGroup, QuadraturePoints};
use crate::error::FemError;
pub(crate) use kept::KeptStructures;
pub use kept::StructureCounts;
use nastic_linear::{
    Graph, Multigrid, NotCoupled, Pattern, Precision, Solver, SolverFactory, SparseMatrix, Structure, StructureError,
    Symbolic, Ties,
};
use nastic_mesh::Mesh;
use std::collections::BTreeMap;
use std::fmt;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

/// Which nodes are coupled in the tangents of a body (those that share a cell, and those that a formulation or a contribution couples
/// whatever the state), and what follows from that when first asked for: numbering, sparsity pattern, scatter maps; where a factor is made,
/// its symbolic factorisation.
///
/// Shared (by [`Arc`]) among all bodies on a mesh with the same couplings: scenarios and load cases differ in physics alone. The numbering
/// keeps supported components in, so that one symbolic analysis serves every choice of supports. Pairs of nodes that change with the
/// state are no part of it: they are blocks of a tangent [beyond its pattern](SparseMatrix::add_beyond).
pub struct TangentStructure {
    mesh: Arc<Mesh>,
    points: Arc<QuadraturePoints>,
    /// Node sets coupled beyond those of cells.
    couplings: Vec<Vec<u32>>,
    graph: Graph,
    laid_out: OnceLock<LaidOut>,
    kept: Arc<KeptStructures>,
}

/// What is made with the first tangent.
struct LaidOut {
    equations: Arc<Structure>,
    /// Structures with other numbers of unknowns per node, made when first asked for.
    others: Mutex<BTreeMap<usize, Arc<Structure>>>,
    /// Per kind of cell: the scatter map of every cell, one after the other. Made with the first matrix.
    scatter: OnceLock<Vec<Vec<u32>>>,
}

impl TangentStructure {
    /// That of a mesh with some sets of nodes coupled beyond its cells. Nothing is put in order for it yet.
    ///
    /// # Errors
    /// [`FemError::Structure`]: nodes that do not exist, more blocks than 32 bits can name.
    pub(crate) fn new(
        mesh: Arc<Mesh>,
        points: Arc<QuadraturePoints>,
        couplings: Vec<Vec<u32>>,
        kept: Arc<KeptStructures>,
    ) -> Result<Arc<Self>, FemError> {
        let cells = points.parts.iter().flat_map(|p| (0..p.cells.len()).map(|c| p.nodes_of(c)));
        let graph = Graph::from_cliques(mesh.points().len(), cells.chain(couplings.iter().map(Vec::as_slice)))?;
        Ok(Arc::new(TangentStructure { mesh, points, couplings, graph, laid_out: OnceLock::new(), kept }))
    }

    /// That in which these sets of nodes are coupled too; the same one where they are already, or one that another body has.
    ///
    /// # Errors
    /// [`FemError::Structure`].
    pub fn with_couplings(self: &Arc<Self>, more: &[Vec<u32>]) -> Result<Arc<Self>, FemError> {
        if more.iter().all(|nodes| self.graph.check_coupled(nodes).is_ok()) {
            return Ok(self.clone());
        }
        let couplings: Vec<Vec<u32>> = self.couplings.iter().chain(more).cloned().collect();
        let make = || Self::new(self.mesh.clone(), self.points.clone(), couplings.clone(), self.kept.clone());
        self.kept.find_or_add(|known| known.couplings == couplings, make)
    }

    /// That in which the nodes, of so many components, are coupled too that are so where some follow others.
    pub fn with_ties(self: &Arc<Self>, ties: &Ties, components: usize) -> Result<Arc<Self>, FemError> {
        self.with_couplings(&ties.couplings(&self.graph, components))
    }

    fn laid_out(&self) -> &LaidOut {
        self.laid_out.get_or_init(|| {
            let pattern = Arc::new(Pattern::of_graph(&self.graph, self.mesh.points(), self.mesh.dim()));
            LaidOut { equations: self.kept.counted(pattern), others: Mutex::default(), scatter: OnceLock::new() }
        })
    }

    /// Refuses nodes of which two are not coupled.
    pub(crate) fn check_coupled(&self, nodes: &[u32]) -> Result<(), StructureError> {
        Ok(self.graph.check_coupled(nodes)?)
    }

    pub(crate) fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// The sparsity pattern of the tangent.
    pub fn pattern(&self) -> &Arc<Pattern> {
        self.equations().pattern()
    }

    /// The pattern of the tangent by the displacement, with its symbolic factorisation once a solver has asked for it.
    pub fn equations(&self) -> &Arc<Structure> {
        &self.laid_out().equations
    }

    /// The same with another number of unknowns per node, in the same order of nodes; its analyses are not counted.
    pub fn with_components(&self, components: usize) -> Arc<Structure> {
        let LaidOut { equations, others, .. } = self.laid_out();
        // A thread that died while it held the lock left a whole map behind.
        let mut others = others.lock().unwrap_or_else(PoisonError::into_inner);
        let make = || Structure::new(Arc::new(equations.pattern().with_dim(components)));
        others.entry(components).or_insert_with(make).clone()
    }

    /// Scatter maps of the cells of one kind.
    pub fn scatter(&self, part: usize) -> &[u32] {
        let LaidOut { equations, scatter, .. } = self.laid_out();
        let maps = |part: &CellGroup| {
            let mut maps = Vec::with_capacity(part.cells.len() * part.table.nodes * (part.table.nodes + 1) / 2);
            (0..part.cells.len()).for_each(|c| maps.extend(map_of_coupled(equations.pattern(), part.nodes_of(c))));
            maps
        };
        &scatter.get_or_init(|| self.points.parts.iter().map(maps).collect())[part]
    }

    /// The symbolic factorisation of the tangent, made when first asked for.
    pub fn symbolic(&self) -> &Arc<Symbolic> {
        self.equations().symbolic()
    }

    /// Bytes of a factor of the tangent in double precision.
    pub fn factor_bytes(&self) -> usize {
        self.equations().factor_size().bytes()
    }

    /// Bytes of a factorisation of the tangent in double precision at its largest, predicted: the factor and its working memory.
    pub fn factorisation_bytes(&self) -> usize {
        self.symbolic().factorisation_bytes(Precision::Double)
    }

    /// Bytes of the tangent and of its levels of multigrid, predicted from counts.
    pub fn multigrid_bytes(&self) -> usize {
        let pattern = self.equations().pattern();
        size_of::<f64>() * pattern.values() + Multigrid::predicted_bytes(pattern)
    }

    /// The solver that a solve takes unless it is given one, see [`Solver::cheaper`].
    pub fn solver(&self) -> &'static dyn SolverFactory {
        Solver::cheaper(self.equations())
    }

    /// A zero matrix of the tangent's pattern.
    pub fn matrix(&self) -> SparseMatrix {
        SparseMatrix::zeros(self.pattern().clone())
    }
}

impl fmt::Debug for TangentStructure {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "TangentStructure of {} ({} sets of nodes beside cells)", self.mesh.name(), self.couplings.len())
    }
}

/// The scatter map of nodes that are known to be coupled; codes of no block where they are not, at which nothing can be added.
pub(crate) fn map_of_coupled(pattern: &Pattern, nodes: &[u32]) -> Vec<u32> {
    let nowhere = |_: NotCoupled| vec![u32::MAX; nodes.len() * (nodes.len() + 1) / 2];
    pattern.scatter_map(nodes).unwrap_or_else(nowhere)
}
