//! [`leading_eigenpairs`]: many smallest eigenvalues of a definite matrix whose factor is at hand.

use super::Eigenpairs;
use super::inner_product::{DEPENDENCE_TOLERANCE, rounding};
use crate::factor::symmetric::{Factor, Pivots};
use crate::memory;
use crate::pattern::matrix::SparseMatrix;
use crate::solver::LinearError;
use faer::diag::Diag;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::evd::{ComputeEigenvectors, self_adjoint_evd, self_adjoint_evd_scratch};
use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatMut, MatRef, Par};
use nastic_numeric::Random;
use nastic_numeric::vector::{axpy, dot};
use rayon::prelude::*;

/// Vectors of a block: sixteen right-hand sides cost 2.5 times one.
const BLOCK: usize = 16;
/// Blocks between two looks at the Ritz pairs.
const BLOCKS_BETWEEN: usize = 4;
/// Blocks at most, over those that as many vectors as are wanted take.
const MAX_BLOCK_RATIO: usize = 8;
/// Further blocks.
const FURTHER_BLOCKS: usize = 40;
/// Residual of a Ritz pair of the inverse, as a share of its value.
const TOLERANCE: f64 = 1e-8;
/// Distance above an eigenvalue at which those below are counted, as a share of it.
const COUNT_OFFSET: f64 = 1e-6;
/// Share of a column that is left beside those of its block below which what it has of the basis by rounding has grown too much.
const CANCELLED: f64 = 1e-3;
/// Rows at once.
const CHUNK: usize = 1 << 12;

/// `A x = lambda M x` with A symmetric and positive definite, M diagonal and positive.
#[derive(Clone, Copy)]
pub struct DefiniteProblem<'a> {
    /// A.
    pub matrix: &'a SparseMatrix,
    /// Its Cholesky factor.
    pub factor: &'a Factor,
    /// The diagonal of M.
    pub masses: &'a [f64],
    /// Whether to use all threads; the bits are the same.
    pub parallel: bool,
}

/// The `count` smallest eigenvalues with their vectors, by Lanczos' method in blocks of 16 with `A^-1 M` and full orthogonalisation, without restarts: for hundreds of pairs, where the
/// dense work of [`smallest_eigenpairs`](super::smallest_eigenpairs) would be most of it. The start is random with a fixed seed.
///
/// None is missed: those below the largest one returned are counted by the pivots of `A - mu M`, and further blocks are added until as many are found.
///
/// Source: Grimes, Lewis & Simon, "A shifted block Lanczos algorithm", SIAM J. Matrix Anal. Appl. 15 (1994) 228-272.
///
/// # Errors
/// A matrix that is not symmetric; more pairs than unknowns, or than fit; [`LinearError::Eigenpairs`] where the iteration does not find them.
pub fn leading_eigenpairs(problem: &DefiniteProblem, count: usize) -> Result<Eigenpairs, LinearError> {
    let unknowns = problem.masses.len();
    if count == 0 || count > unknowns {
        return Err(LinearError::EigenpairCount { count, unknowns });
    }
    if !problem.matrix.is_symmetric() {
        return Err(LinearError::NotSymmetric);
    }
    let most = unknowns.min(BLOCK * (MAX_BLOCK_RATIO * count.div_ceil(BLOCK) + FURTHER_BLOCKS));
    memory::check("the vectors of eigenvalues", 2 * count.div_ceil(BLOCK) * BLOCK * unknowns * size_of::<f64>())?;
    let mut space = Space { problem, basis: vec![], projected: vec![], random: Random::new(0) };
    let mut next = space.random_block();
    let mut wanted = count;
    loop {
        memory::check("the vectors of eigenvalues", 2 * next.len() * size_of::<f64>())?;
        let last = space.extend(next)?;
        let (dimension, full) = (space.dimension(), space.dimension() >= unknowns);
        let look = full || dimension >= most || space.basis.len().is_multiple_of(BLOCKS_BETWEEN);
        if dimension < wanted || !look {
            next = last.next;
            continue;
        }
        let ritz = space.ritz()?;
        let found = if full { wanted } else { ritz.converged(&last.coupling).min(wanted) };
        if found == wanted {
            let smallest: Vec<f64> = ritz.values.iter().take(wanted).map(|theta| 1.0 / theta).collect();
            let mu = smallest[wanted - 1] * (1.0 + COUNT_OFFSET);
            let below = problem.below(mu)?;
            // no more than there are: each Ritz value lies above an eigenvalue of its own
            let known = ritz.values.iter().filter(|theta| **theta > 0.0 && 1.0 / **theta < mu).count();
            if below <= known {
                return Ok(space.pairs(&ritz, count));
            }
            if full {
                return Err(LinearError::Eigenpairs { found: known, wanted: below });
            }
            // an eigenvalue may have more vectors than a block
            wanted = unknowns.min(wanted + below - known);
            next = space.widened(last.next);
            continue;
        } else if dimension >= most {
            return Err(LinearError::Eigenpairs { found, wanted });
        }
        next = last.next;
    }
}

impl DefiniteProblem<'_> {
    /// Number of eigenvalues below mu.
    fn below(&self, mu: f64) -> Result<usize, LinearError> {
        let mut shifted = self.matrix.clone();
        shifted.add_diagonal(&self.masses.iter().map(|mass| -mu * mass).collect::<Vec<_>>());
        Ok(self.factor.symbolic().factorize(&shifted, Pivots::AnySign, self.parallel)?.negative_pivots())
    }

    fn times_mass(&self, block: &[f64]) -> Vec<f64> {
        let of = |column: &[f64]| column.iter().zip(self.masses).map(|(x, mass)| x * mass).collect::<Vec<_>>();
        block.chunks_exact(self.masses.len()).flat_map(of).collect()
    }
}

/// An orthonormal basis of blocks, columns one after the other, and `Q^T M A^-1 M Q` by columns, what is above the diagonal.
struct Space<'a> {
    problem: &'a DefiniteProblem<'a>,
    basis: Vec<Vec<f64>>,
    projected: Vec<Vec<f64>>,
    random: Random,
}

/// What follows the last block: the next one, and what couples it with the last, row by row.
struct Next {
    next: Vec<f64>,
    coupling: Mat<f64>,
}

/// Ritz values of the inverse, falling, with their coefficients.
struct Ritz {
    values: Vec<f64>,
    vectors: Mat<f64>,
}

impl Ritz {
    /// How many of the first pairs have converged.
    fn converged(&self, coupling: &Mat<f64>) -> usize {
        let (d, b) = (self.vectors.nrows(), coupling.ncols());
        let residual = |k: usize| {
            let end = (0..b).map(|i| self.vectors[(d - b + i, k)]).collect::<Vec<f64>>();
            let row = |r: usize| (0..b).map(|i| coupling[(r, i)] * end[i]).sum::<f64>().powi(2);
            (0..coupling.nrows()).map(row).sum::<f64>().sqrt()
        };
        (0..d).take_while(|k| residual(*k) <= TOLERANCE * self.values[*k]).count()
    }
}

impl Space<'_> {
    fn unknowns(&self) -> usize {
        self.problem.masses.len()
    }

    fn dimension(&self) -> usize {
        self.projected.len()
    }

    fn random_block(&mut self) -> Vec<f64> {
        let count = BLOCK.min(self.unknowns());
        let mut block: Vec<f64> = (0..count * self.unknowns()).map(|_| self.random.symmetric()).collect();
        self.orthonormalise(&mut block);
        block
    }

    /// A block with random columns beside its own.
    fn widened(&mut self, mut block: Vec<f64>) -> Vec<f64> {
        let (n, own) = (self.unknowns(), block.len());
        let count = BLOCK.min(n.saturating_sub(self.dimension() + own / n));
        block.extend((0..count * n).map(|_| self.random.symmetric()));
        self.orthogonalise(&mut block[own..]);
        self.orthogonalise(&mut block[own..]);
        self.orthonormalise(&mut block);
        block
    }

    /// Adds an orthonormal block, and makes the next one of its image.
    fn extend(&mut self, block: Vec<f64>) -> Result<Next, LinearError> {
        let n = self.unknowns();
        let mut image = self.problem.times_mass(&block);
        let columns = image.len() / n;
        self.problem.factor.solve(&mut image, columns);
        if image.iter().any(|x| !x.is_finite()) {
            return Err(LinearError::Eigenpairs { found: 0, wanted: self.dimension() });
        }
        self.basis.push(block);
        let first = self.dimension();
        let mut sums = self.orthogonalise(&mut image);
        let again = self.orthogonalise(&mut image);
        sums.iter_mut().zip(&again).for_each(|(sum, own)| *sum += own);
        for k in 0..columns {
            let entry = |j: usize| sums[j * columns + k];
            self.projected.push((0..=first + k).map(entry).collect());
        }
        let left = self.unknowns() - self.dimension();
        image.truncate(left.min(columns) * n);
        let coupling = self.orthonormalise(&mut image);
        let coupling = Mat::from_fn(image.len() / n, columns, |r, k| {
            coupling.get(k).and_then(|c| c.get(r)).copied().unwrap_or(0.0)
        });
        Ok(Next { next: image, coupling })
    }

    /// Makes the columns of a block orthogonal to the basis; their coefficients, one row for each vector of it.
    fn orthogonalise(&self, block: &mut [f64]) -> Vec<f64> {
        let n = self.unknowns();
        let columns = block.len() / n;
        let weighted = self.problem.times_mass(block);
        let with = MatRef::from_column_major_slice(&weighted, n, columns);
        let of = |q: &Vec<f64>| {
            let q = MatRef::from_column_major_slice(q, n, q.len() / n);
            let mut own = Mat::zeros(q.ncols(), columns);
            matmul(own.as_mut(), Accum::Replace, q.transpose(), with, 1.0, Par::Seq);
            own
        };
        let sums: Vec<Mat<f64>> = match self.problem.parallel {
            true => self.basis.par_iter().map(of).collect(),
            false => self.basis.iter().map(of).collect(),
        };
        let rows: Vec<usize> = (0..n).step_by(CHUNK).collect();
        let change = |first: &usize| {
            let count = CHUNK.min(n - first);
            let mut own = Mat::zeros(count, columns);
            for (q, sums) in self.basis.iter().zip(&sums) {
                let q = MatRef::from_column_major_slice(q, n, q.len() / n).subrows(*first, count);
                matmul(own.as_mut(), Accum::Add, q, sums.as_ref(), -1.0, Par::Seq);
            }
            own
        };
        let changes: Vec<Mat<f64>> = match self.problem.parallel {
            true => rows.par_iter().map(change).collect(),
            false => rows.iter().map(change).collect(),
        };
        let mut block = MatMut::from_column_major_slice_mut(block, n, columns);
        for (first, change) in rows.iter().zip(&changes) {
            let mut own = block.as_mut().subrows_mut(*first, change.nrows());
            own += change;
        }
        sums.iter().flat_map(|own| (0..own.nrows()).flat_map(move |i| (0..columns).map(move |k| own[(i, k)]))).collect()
    }

    /// Makes a block that is orthogonal to the basis orthonormal; what each column was by the new ones. A column that depends on the others becomes a random one.
    fn orthonormalise(&mut self, block: &mut [f64]) -> Vec<Vec<f64>> {
        let n = self.unknowns();
        let mut out = Vec::new();
        for k in 0..block.len() / n {
            let (before, own) = block[..(k + 1) * n].split_at_mut(k * n);
            let mut coefficients = vec![0.0; k + 1];
            let size = self.norm(own);
            let mut left = self.reduce(before, own, &mut coefficients);
            coefficients[k] = left;
            while left.is_nan() || left <= DEPENDENCE_TOLERANCE * size.max(f64::MIN_POSITIVE) {
                coefficients[k] = 0.0;
                own.iter_mut().for_each(|x| *x = self.random.symmetric());
                self.orthogonalise(own);
                self.orthogonalise(own);
                left = self.reduce(before, own, &mut vec![0.0; k + 1]);
                if left > 0.0 {
                    break;
                }
            }
            own.iter_mut().for_each(|x| *x /= left);
            if left < CANCELLED * size {
                self.orthogonalise(own);
                let again = self.reduce(before, own, &mut vec![0.0; k + 1]);
                own.iter_mut().for_each(|x| *x /= again);
            }
            out.push(coefficients);
        }
        out
    }

    /// Takes what is along earlier columns out of one, and adds their coefficients; what is left of its norm.
    fn reduce(&self, before: &[f64], own: &mut [f64], coefficients: &mut [f64]) -> f64 {
        for _ in 0..2 {
            let weighted = self.problem.times_mass(own);
            let others = || before.chunks_exact(weighted.len());
            let shares: Vec<f64> = others().map(|other| dot(other, &weighted)).collect();
            for ((other, share), coefficient) in others().zip(&shares).zip(&mut *coefficients) {
                axpy(-share, other, own);
                *coefficient += share;
            }
        }
        self.norm(own)
    }

    fn norm(&self, x: &[f64]) -> f64 {
        dot(x, &self.problem.times_mass(x)).sqrt()
    }

    fn ritz(&self) -> Result<Ritz, LinearError> {
        let d = self.dimension();
        let matrix = Mat::from_fn(d, d, |i, k| self.projected[i.max(k)][i.min(k)]);
        let (mut rising, mut vectors) = (Diag::zeros(d), Mat::zeros(d, d));
        // one thread: with several the bits would depend on their number
        let scratch = self_adjoint_evd_scratch::<f64>(d, ComputeEigenvectors::Yes, Par::Seq, Default::default());
        let mut memory = MemBuffer::new(scratch);
        let (s, u, stack) = (rising.as_mut(), Some(vectors.as_mut()), MemStack::new(&mut memory));
        self_adjoint_evd(matrix.as_ref(), s, u, Par::Seq, stack, Default::default())
            .map_err(|_| LinearError::Eigenpairs { found: 0, wanted: d })?;
        let values = (0..d).rev().map(|k| rising[k]).collect();
        Ok(Ritz { values, vectors: Mat::from_fn(d, d, |i, k| vectors[(i, d - 1 - k)]) })
    }

    fn pairs(&self, ritz: &Ritz, count: usize) -> Eigenpairs {
        let n = self.unknowns();
        let rows: Vec<usize> = (0..n).step_by(CHUNK).collect();
        let part = |first: &usize| {
            let height = CHUNK.min(n - first);
            let (mut own, mut at) = (Mat::zeros(height, count), 0);
            for q in &self.basis {
                let q = MatRef::from_column_major_slice(q, n, q.len() / n).subrows(*first, height);
                let coefficients = ritz.vectors.as_ref().submatrix(at, 0, q.ncols(), count);
                matmul(own.as_mut(), Accum::Add, q, coefficients, 1.0, Par::Seq);
                at += q.ncols();
            }
            own
        };
        let parts: Vec<Mat<f64>> = match self.problem.parallel {
            true => rows.par_iter().map(part).collect(),
            false => rows.iter().map(part).collect(),
        };
        let vector = |k: usize| parts.iter().flat_map(|own| (0..own.nrows()).map(move |i| own[(i, k)])).collect();
        let vectors: Vec<Vec<f64>> = (0..count).map(vector).collect();
        // by a product with each vector: those of the inverse have the rounding of its largest values
        let quotient = |x: &Vec<f64>| {
            let mut product = vec![0.0; n];
            self.problem.matrix.multiply_on(x, &mut product, self.problem.parallel);
            dot(x, &product) / self.norm(x).powi(2)
        };
        let mut pairs: Vec<(f64, Vec<f64>)> = vectors.into_iter().map(|x| (quotient(&x), x)).collect();
        pairs.sort_by(|(a, _), (b, _)| a.total_cmp(b));
        let (values, vectors): (Vec<f64>, Vec<Vec<f64>>) = pairs.into_iter().unzip();
        let rounding = rounding(&self.problem.matrix.magnitudes(), &vectors, self.problem.parallel);
        Eigenpairs { values, vectors, rounding, negative: 0, counted: true, by_products: None }
    }
}
