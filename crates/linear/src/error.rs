//! Errors of factorisation: of the structure (once per mesh) and of the numbers (once per factorisation).

/// An entry for two nodes that share no element of the pattern: there is no place to put it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("nodes {a} and {b} are not coupled in the pattern; build the pattern from every element that is assembled")]
pub struct NotCoupled {
    /// One node.
    pub a: u32,
    /// The other.
    pub b: u32,
}

/// The node graph, the ordering or the pattern cannot be built.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum StructureError {
    /// An element names a node that does not exist.
    #[error("element {element} refers to node {node}, but there are {nodes} nodes; check the connectivity")]
    NodeOutOfRange {
        /// Position of the element in the iteration.
        element: usize,
        /// The node it names.
        node: u32,
        /// Number of nodes.
        nodes: usize,
    },
    /// Two nodes of a scatter map share no element of the pattern.
    #[error(transparent)]
    NotCoupled(#[from] NotCoupled),
    /// An elimination order must hold every node exactly once.
    #[error("the elimination order is no permutation of {nodes} nodes: {problem}")]
    NotAPermutation {
        /// Number of nodes.
        nodes: usize,
        /// What is wrong with it.
        problem: String,
    },
    /// Arrays of different meshes were mixed.
    #[error("{what}: expected length {expected}, got {found}")]
    Length {
        /// Which array.
        what: &'static str,
        /// Length it should have.
        expected: usize,
        /// Length it has.
        found: usize,
    },
    /// More entries than 32-bit block indices can name.
    #[error("{what}: {count} exceeds the 32-bit limit; the mesh is too large for a direct solver")]
    TooLarge {
        /// What there is too much of.
        what: &'static str,
        /// How much.
        count: u64,
    },
}

/// The numbers of a matrix cannot be factorised.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FactorError {
    /// A NaN or infinity in the matrix itself.
    #[error(
        "matrix entry at node {node}, component {component} is {value}; the assembly produced a non-finite tangent"
    )]
    NotFinite {
        /// Node of the entry's column.
        node: usize,
        /// Component of the entry's column.
        component: usize,
        /// The entry.
        value: f64,
    },
    /// Cholesky met a pivot that is not positive: the matrix is not positive definite.
    #[error(
        "matrix is not positive definite: the pivot of node {node}, component {component} is not positive; \
         factorise with pivots of either sign, or shorten the step"
    )]
    NotPositive {
        /// Node at which positive definiteness was lost. It depends on the elimination order, not on the physics.
        node: usize,
        /// Component there.
        component: usize,
    },
    /// A zero pivot, or a factor that overflowed: the matrix is singular to working precision.
    #[error("matrix is singular: zero or non-finite pivot at node {node}, component {component}; check the supports")]
    Singular {
        /// Node of the pivot.
        node: usize,
        /// Component there.
        component: usize,
    },
    /// More memory than there is.
    #[error(
        "{what} takes {} where {} are available: try a coarser mesh, {}fewer threads (each scenario on a thread of its own holds a factor), \
         or raise the limit {}, if it is set",
        size(*.needed), size(*.available),
        if *.what == Self::COARSEST { "" } else { "multigrid where the matrix is symmetric (\"linear_solver\": \"multigrid\"), " },
        crate::memory::LIMIT
    )]
    Memory {
        /// What was to be allocated.
        what: &'static str,
        /// Bytes it takes, predicted from the symbolic factorisation.
        needed: usize,
        /// Bytes there are.
        available: usize,
    },
    /// The limit of memory in the environment cannot be read.
    #[error(transparent)]
    Limit(#[from] crate::memory::LimitError),
    /// A level of multigrid, or the arrays handed to it, cannot be used.
    #[error(transparent)]
    Structure(#[from] StructureError),
    /// Matrix and symbolic factorisation belong to different patterns.
    #[error("the matrix belongs to another pattern than the symbolic factorisation")]
    ForeignPattern,
    /// Blocks beyond the pattern have no place in a factor.
    #[error(
        "{blocks} blocks of the matrix are beyond its pattern; join them to a structure (JoinedStructure) and factorise that"
    )]
    Beyond {
        /// How many.
        blocks: usize,
    },
    /// The matrix is not symmetric.
    #[error("the matrix is not symmetric; factorise its symmetric part, or use the general solver")]
    NotSymmetric,
}

impl FactorError {
    /// What takes memory in multigrid.
    pub(crate) const COARSEST: &'static str = "the factor of multigrid's coarsest level";
}

/// `12.3 MB`, `45 kB`
fn size(bytes: usize) -> String {
    match bytes as f64 {
        small if small < 1e6 => format!("{:.0} kB", (small / 1e3).ceil()),
        large => format!("{:.1} MB", large / 1e6),
    }
}
