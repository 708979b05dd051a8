//! [`TangentStructure`]: where the entries of the tangents of a discretisation stand.

use crate::discretization::quadrature_points::QuadraturePoints;
use nastic_linear::{Graph, NotCoupled, Pattern, Structure, Symbolic};
use nastic_mesh::Mesh;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, OnceLock};

/// Pattern and symbolic factorisation of the tangents that couple what a graph couples, and where cells are added to them.
pub(super) struct TangentStructure {
    pub equations: Arc<Structure>,
    /// Symbolic factorisation of one unknown per node, made when first asked for.
    scalar: OnceLock<Arc<Symbolic>>,
    /// Per kind of cell: the scatter map of every cell, one after the other.
    pub scatter: Vec<Vec<u32>>,
}

/// Work on structures, of all discretisations of one mesh. It is not part of any report: which solve makes what several share depends on
/// the order in which they run.
#[derive(Debug, Default)]
pub(super) struct Counters {
    pub orderings: AtomicUsize,
    pub analyses: Arc<AtomicUsize>,
}

/// How often the tangents on a mesh were put in order, and how often analysed for a factor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct StructureCounts {
    /// Orders of elimination sought.
    pub orderings: usize,
    /// Symbolic factorisations of tangents made.
    pub analyses: usize,
}

impl Counters {
    pub fn read(&self) -> StructureCounts {
        let [orderings, analyses] = [&self.orderings, &self.analyses].map(|count| count.load(Ordering::Relaxed));
        StructureCounts { orderings, analyses }
    }
}

impl TangentStructure {
    pub fn new(graph: &Graph, mesh: &Mesh, points: &QuadraturePoints, counters: &Counters) -> Self {
        counters.orderings.fetch_add(1, Ordering::Relaxed);
        let pattern = Arc::new(Pattern::of_graph(graph, mesh.points(), mesh.dim()));
        let maps = |part: &crate::discretization::quadrature_points::CellGroup| {
            (0..part.cells.len()).flat_map(|c| map_of_coupled(&pattern, part.nodes_of(c))).collect()
        };
        let scatter = points.parts.iter().map(maps).collect();
        let equations = Structure::counted(pattern, counters.analyses.clone());
        TangentStructure { equations, scalar: OnceLock::new(), scatter }
    }

    pub fn scalar(&self) -> &Arc<Symbolic> {
        self.scalar.get_or_init(|| Arc::new(Symbolic::new(&Arc::new(self.equations.pattern().with_dim(1)))))
    }
}

/// The scatter map of nodes that are known to be coupled; codes of no block where they are not, at which nothing can be added.
pub(crate) fn map_of_coupled(pattern: &Pattern, nodes: &[u32]) -> Vec<u32> {
    let nowhere = |_: NotCoupled| vec![u32::MAX; nodes.len() * (nodes.len() + 1) / 2];
    pattern.scatter_map(nodes).unwrap_or_else(nowhere)
}
