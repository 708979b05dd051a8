//! [`TangentStructure`]: where the entries of the tangents of a discretisation stand.

use crate::discretization::quadrature_points::QuadraturePoints;
use nastic_linear::{Graph, NotCoupled, Pattern, Structure};
use nastic_mesh::Mesh;
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

/// Pattern and symbolic factorisation of the tangents that couple what a graph couples, and where cells are added to them.
pub(super) struct TangentStructure {
    pub equations: Arc<Structure>,
    /// Structures with other numbers of unknowns per node, made when first asked for.
    others: Mutex<BTreeMap<usize, Arc<Structure>>>,
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
        TangentStructure { equations, others: Mutex::default(), scatter }
    }

    /// The structure with so many unknowns per node, in the same order of nodes.
    pub fn with_components(&self, components: usize) -> Arc<Structure> {
        // A thread that died while it held the lock left a whole map behind.
        let mut others = self.others.lock().unwrap_or_else(PoisonError::into_inner);
        let make = || Structure::new(Arc::new(self.equations.pattern().with_dim(components)));
        others.entry(components).or_insert_with(make).clone()
    }
}

/// The scatter map of nodes that are known to be coupled; codes of no block where they are not, at which nothing can be added.
pub(crate) fn map_of_coupled(pattern: &Pattern, nodes: &[u32]) -> Vec<u32> {
    let nowhere = |_: NotCoupled| vec![u32::MAX; nodes.len() * (nodes.len() + 1) / 2];
    pattern.scatter_map(nodes).unwrap_or_else(nowhere)
}
