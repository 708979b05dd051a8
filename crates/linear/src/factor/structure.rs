//! [`Structure`]: what all matrices of one pattern share.

use super::factor_size::{FactorSize, fits};
use super::symbolic::Symbolic;
use crate::error::StructureError;
use crate::pattern::entries::Pattern;
use crate::pattern::graph::Graph;
use crate::pattern::ordering::Ordering;
use std::sync::atomic::{AtomicUsize, Ordering as Memory};
use std::sync::{Arc, OnceLock};

/// The pattern of a matrix, and its symbolic factorisation, made when first asked for: solvers that make no factor need none.
#[derive(Debug)]
pub struct Structure {
    pattern: Arc<Pattern>,
    symbolic: OnceLock<Arc<Symbolic>>,
    /// Symbolic factorisations made of all structures that share it.
    analyses: Arc<AtomicUsize>,
}

impl Structure {
    /// That of a pattern.
    pub fn new(pattern: Arc<Pattern>) -> Arc<Self> {
        Self::counted(pattern, Arc::default())
    }

    /// That of a pattern, whose symbolic factorisation is counted where others are.
    pub fn counted(pattern: Arc<Pattern>, analyses: Arc<AtomicUsize>) -> Arc<Self> {
        Arc::new(Structure { pattern, symbolic: OnceLock::new(), analyses })
    }

    /// That of a symbolic factorisation.
    pub fn analysed(symbolic: Arc<Symbolic>) -> Arc<Self> {
        Arc::new(Structure {
            pattern: symbolic.pattern().clone(),
            symbolic: OnceLock::from(symbolic),
            analyses: Arc::default(),
        })
    }

    /// The structure in which these sets of nodes are coupled too, in the same order of elimination: the fill alone is counted
    /// anew. The order is that of the first pattern, and the better the fewer pairs are added.
    ///
    /// # Errors
    /// A node that does not exist; more blocks than 32 bits can name.
    pub fn with_couplings(&self, more: &[Vec<u32>]) -> Result<Arc<Self>, StructureError> {
        let pairs = self.pattern.pairs();
        let cliques = pairs.iter().map(<[u32; 2]>::as_slice).chain(more.iter().map(Vec::as_slice));
        let graph = Graph::from_cliques(self.pattern.nodes(), cliques)?;
        let ordering = Ordering::given(&graph, self.pattern.ordering().new_to_old())?;
        let pattern = Arc::new(Pattern::new(&graph, self.pattern.dim(), ordering)?);
        Ok(Self::counted(pattern, self.analyses.clone()))
    }

    /// The pattern.
    pub fn pattern(&self) -> &Arc<Pattern> {
        &self.pattern
    }

    /// The symbolic factorisation; the first call makes it.
    pub fn symbolic(&self) -> &Arc<Symbolic> {
        self.symbolic.get_or_init(|| {
            self.analyses.fetch_add(1, Memory::Relaxed);
            Arc::new(Symbolic::new(&self.pattern))
        })
    }

    /// Whether the symbolic factorisation has been made.
    pub fn is_analysed(&self) -> bool {
        self.symbolic.get().is_some()
    }

    /// How many symbolic factorisations have been made, of this structure and all that are counted with it.
    pub fn analyses(&self) -> usize {
        self.analyses.load(Memory::Relaxed)
    }

    /// What a factor takes, from the fronts of the elimination order alone: the numbers of [`symbolic`](Self::symbolic), which is
    /// not made for them.
    pub fn factor_size(&self) -> FactorSize {
        FactorSize::new(&self.pattern)
    }

    /// Whether one may be made unasked: it has at most 8 GiB.
    pub fn factor_fits(&self) -> bool {
        fits(self.factor_size().bytes())
    }
}
