//! [`Numbering`]: the numbers of nodes in the order of ranks.

use crate::session::{PetscError, count};
use nastic_linear::{Share, Space};
use std::sync::Arc;

/// Nodes in the order of ranks, of each rank those that belong to it in its own order.
#[derive(Clone, Debug)]
pub(crate) struct Numbering {
    share: Option<Arc<Share>>,
    /// By node of this rank.
    pub global: Vec<i32>,
    /// How many belong to this rank.
    pub owned: usize,
    /// How many there are.
    pub nodes: usize,
}

impl Numbering {
    /// Found by messages between the ranks.
    pub fn of(space: &Space) -> Result<Self, PetscError> {
        let (share, local) = (space.share().cloned(), space.nodes());
        let Some(of) = &share else {
            let last = count("nodes", local)?;
            return Ok(Numbering { share, global: (0..last).collect(), owned: local, nodes: local });
        };
        let mut counts = vec![0.0; of.team().size()];
        counts[of.team().rank()] = of.owned() as f64;
        of.sum(&mut counts);
        let before: f64 = counts[..of.team().rank()].iter().sum();
        let nodes = counts.iter().sum::<f64>() as usize;
        // the same on all ranks
        count("unknowns", nodes * space.block())?;
        let number = |node| if node < of.owned() { before + node as f64 } else { 0.0 };
        let mut global: Vec<f64> = (0..local).map(number).collect();
        // only the owner knows one
        of.add_up(1, &mut global);
        if let Some(failure) = of.failure() {
            return Err(failure.into());
        }
        Ok(Numbering { owned: of.owned(), global: global.into_iter().map(|node| node as i32).collect(), nodes, share })
    }

    /// Whether it is that of a space.
    pub fn fits(&self, space: &Space) -> bool {
        let same = match (&self.share, space.share()) {
            (Some(own), Some(other)) => Arc::ptr_eq(own, other),
            (own, other) => own.is_none() && other.is_none(),
        };
        same && self.global.len() == space.nodes()
    }
}
