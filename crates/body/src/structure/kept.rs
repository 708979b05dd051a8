//! [`KeptStructures`]: the structures of one mesh that somebody holds.

use super::TangentStructure;
use crate::error::FemError;
use nastic_linear::{Pattern, Structure};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError, Weak};

/// The structures of one mesh with couplings beyond its cells, while somebody holds them, and how much work went into all of its structures.
#[derive(Debug, Default)]
pub(crate) struct KeptStructures {
    known: Mutex<Vec<Weak<TangentStructure>>>,
    orderings: AtomicUsize,
    analyses: Arc<AtomicUsize>,
}

/// How often the tangents on a mesh were put in order, and how often analysed for a factor. It is not part of any report: which solve makes
/// what several share depends on the order in which they run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct StructureCounts {
    /// Orders of elimination sought.
    pub orderings: usize,
    /// Symbolic factorisations of tangents made.
    pub analyses: usize,
}

impl KeptStructures {
    /// The one that fits, or a new one.
    pub fn find_or_add(
        &self,
        fits: impl Fn(&TangentStructure) -> bool,
        make: impl FnOnce() -> Result<Arc<TangentStructure>, FemError>,
    ) -> Result<Arc<TangentStructure>, FemError> {
        // A thread that died while it held the lock left a whole list behind.
        let mut known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        known.retain(|weak| weak.strong_count() > 0);
        if let Some(found) = known.iter().filter_map(Weak::upgrade).find(|kept| fits(kept)) {
            return Ok(found);
        }
        let new = make()?;
        known.push(Arc::downgrade(&new));
        Ok(new)
    }

    /// The structure of a pattern that was put in order just now.
    pub fn counted(&self, pattern: Arc<Pattern>) -> Arc<Structure> {
        self.orderings.fetch_add(1, Ordering::Relaxed);
        Structure::counted(pattern, self.analyses.clone())
    }

    pub fn counts(&self) -> StructureCounts {
        let [orderings, analyses] = [&self.orderings, &*self.analyses].map(|count| count.load(Ordering::Relaxed));
        StructureCounts { orderings, analyses }
    }
}
