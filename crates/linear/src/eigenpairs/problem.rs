//! What an [`Eigenproblem`] takes, and the sizes of its matrices.

use super::{ApproximateInverse, BASIS_BYTES, Eigenproblem, MassMatrix, ROUNDING};
use crate::memory;
use crate::solver::{LinearError, System};
use crate::sums::dot;

/// Vectors of the basis of [`smallest_eigenpairs`](super::smallest_eigenpairs) before a restart, as a multiple of those of the block.
pub(super) const LONGEST: usize = 4;
/// Vectors of the block beyond those that are wanted, at least, and as a share of these with multigrid and with a factor: the next eigenvalues decide the
/// pace, and a larger block costs its square.
const GUARD: usize = 2;
const GUARD_SHARE: usize = 2;
const EXACT_GUARD_SHARE: usize = 8;
/// Magnitudes of a row of A over its diagonal entry, about.
const COUPLINGS: f64 = 8.0;

impl Eigenproblem<'_> {
    /// Number of unknowns, of a problem that has so many eigenvalues and fits into memory.
    pub(super) fn check(&self, count: usize) -> Result<usize, LinearError> {
        let free = self.system.fixed.iter().filter(|&&fixed| !fixed).count();
        let unknowns = match self.inverse {
            ApproximateInverse::Factor(by) => free.saturating_sub(by.constraints.len()),
            ApproximateInverse::Multigrid { .. } => free,
        };
        if !self.system.matrix.is_symmetric() {
            return Err(LinearError::NotSymmetric);
        }
        if count == 0 || count > unknowns {
            return Err(LinearError::EigenpairCount { count, unknowns });
        }
        self.block(count, unknowns)?;
        Ok(unknowns)
    }

    /// Vectors of a block for so many eigenvalues.
    pub(super) fn block(&self, wanted: usize, unknowns: usize) -> Result<usize, LinearError> {
        let (zeros, share) = match self.inverse {
            ApproximateInverse::Multigrid { zeros } => (zeros, GUARD_SHARE),
            ApproximateInverse::Factor(_) => (0, EXACT_GUARD_SHARE),
        };
        let block = unknowns.min(wanted.max(zeros) + GUARD.max(wanted / share));
        // the basis and its products, and what a restart makes of them
        let vectors = 2 * (LONGEST + 2) * block;
        let bytes = vectors.saturating_mul(self.system.fixed.len() * size_of::<f64>());
        if bytes > BASIS_BYTES {
            let gib = bytes as f64 / f64::from(1 << 30);
            return Err(LinearError::EigenpairsTooLarge { count: wanted, unknowns, gib });
        }
        memory::check("the vectors of eigenvalues", bytes)?;
        Ok(block)
    }

    /// `A_ii`, of products too.
    pub(super) fn diagonal(&self) -> Vec<f64> {
        let System { matrix, products, parallel, .. } = self.system;
        match products {
            Some(products) => products
                .diagonal_blocks(parallel)
                .as_flattened()
                .iter()
                .enumerate()
                .map(|(at, row)| row[at % 3])
                .collect(),
            None => matrix.diagonal(),
        }
    }

    /// `16 eps |x| . |A| |x|`, of products by some times the diagonal of A.
    pub(super) fn rounding(&self, vectors: &[Vec<f64>]) -> Vec<f64> {
        let System { matrix, products, parallel, .. } = self.system;
        if products.is_some() {
            let diagonal = self.diagonal();
            let of = |x: &Vec<f64>| x.iter().zip(&diagonal).map(|(x, d)| x * x * d.abs()).sum::<f64>();
            return vectors.iter().map(|x| ROUNDING * COUPLINGS * of(x)).collect();
        }
        let magnitudes = matrix.magnitudes();
        let of = |x: &Vec<f64>| {
            let (x, mut product) = (x.iter().map(|x| x.abs()).collect::<Vec<_>>(), vec![0.0; x.len()]);
            magnitudes.multiply_on(&x, &mut product, parallel);
            ROUNDING * dot(&x, &product, parallel)
        };
        vectors.iter().map(of).collect()
    }

    /// `M_ii`.
    pub(super) fn mass_diagonal(&self) -> Vec<f64> {
        match self.mass {
            MassMatrix::Diagonal(mass) => mass.to_vec(),
            MassMatrix::Sparse(mass) => mass.diagonal(),
        }
    }

    /// The mean magnitude over free unknowns.
    pub(super) fn mean(&self, diagonal: &[f64]) -> f64 {
        let free = diagonal.iter().zip(self.system.fixed).filter(|(_, fixed)| !**fixed);
        let (sum, count) = free.fold((0.0, 0), |(sum, count), (d, _)| (sum + d.abs(), count + 1));
        sum / f64::from(count.max(1))
    }
}
