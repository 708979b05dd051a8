//! [`smallest_eigenpairs_by_products`]: `A x = lambda M x` by a block Davidson method with multigrid as preconditioner.

use super::inner_product::{DEPENDENCE_TOLERANCE, InnerProduct};
use super::preconditioner::ShiftedLevels;
use super::{ByProducts, ENTRY_ROUNDING, Eigenpairs, MAX_BASIS_BYTES, MassMatrix};
use crate::error::FactorError;
use crate::memory;
use crate::pattern::operator::Operator;
use crate::solver::{LinearError, System};
use crate::sums::{self, dot};
use nalgebra::{DMatrix, SymmetricEigen};
use nastic_numeric::Random;
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};

/// Relative error of the vector of a Ritz pair in the energy norm, as estimated by the preconditioned residual, at which the pair has converged; the error of the value is its square.
const TOLERANCE: f64 = 1e-7;
/// Vectors of the basis before a restart, over those of the block.
const MAX_BASIS_RATIO: usize = 4;
/// Eigenpairs asked for, over the further vectors of the block: the next eigenvalues determine the convergence rate.
const GUARD_DIVISOR: usize = 2;
/// Least number of further vectors of the block.
const MIN_GUARD_VECTORS: usize = 2;
/// Iterations.
const MAX_ITERATIONS: usize = 60;
/// First shift where the levels are not positive definite, as a share of the mean of `A_ii` over that of `M_ii`.
const FIRST_SHIFT: f64 = 1e-12;
/// Ratio of one shift to the one before.
const SHIFT_GROWTH: f64 = 16.0;
/// Largest shift.
const MAX_SHIFT: f64 = 1e3;
/// Least distance of the lowest eigenvalue from minus the shift, as a share of the spread of the eigenvalues of the block.
const MIN_SHIFT_DISTANCE: f64 = 1e-6;
/// The distance that a new shift has.
const SHIFT_DISTANCE: f64 = 1e-2;
/// Approximate sum of the magnitudes of a row of A over its diagonal entry.
const ROW_SUM_RATIO: f64 = 8.0;
/// Sets of levels for further shifts.
const MAX_SHIFTED_LEVELS: usize = 8;

/// `A x = lambda M x` on the unknowns that are not fixed, for a symmetric A without a factor.
#[derive(Clone, Copy)]
pub struct ProductEigenproblem<'a> {
    /// `out = A v`, zero where fixed for a v that is.
    pub product: &'a dyn Operator,
    /// A, or a matrix close to it, for the levels of multigrid.
    pub system: System<'a>,
    /// M, positive definite on the unknowns that are not fixed.
    pub mass: MassMatrix<'a>,
    /// Number of zero eigenvalues, of free rigid motions: the block is larger than this, since their vectors are arbitrary within one space.
    pub zeros: usize,
    /// Set to stop between iterations.
    pub cancel: Option<&'a AtomicBool>,
}

/// The `count` algebraically smallest eigenvalues with their vectors, and all negative ones that are found if there are more of them.
///
/// The Rayleigh-Ritz values of a space that grows by the residuals `A x - theta M x` of a block of Ritz vectors, preconditioned by a V-cycle of A (of
/// `A + s M` where A is not positive definite), and is restarted with the present and the previous Ritz vectors: the locally optimal gradients of Knyazev, "Toward the
/// optimal preconditioned eigensolver", SIAM J. Sci. Comput. 23 (2001), with the orthogonal basis of Stathopoulos, Saad, "Restarting techniques for the
/// (Jacobi-)Davidson symmetric eigenvalue methods", ETNA 7 (1998). The start is random with a fixed seed. Without a factor nothing proves that no eigenvalue is missed
/// ([`Eigenpairs::counted`]): an eigenvector that is orthogonal to all vectors of the block, half as many again as are asked for or are zero, is not found.
///
/// # Errors
/// More eigenvalues wanted than there are unknowns, or than fit; [`LinearError::Eigenpairs`] where the iteration does not find them;
/// [`LinearError::Cancelled`].
pub fn smallest_eigenpairs_by_products(problem: &ProductEigenproblem, count: usize) -> Result<Eigenpairs, LinearError> {
    let unknowns = problem.system.fixed.iter().filter(|&&fixed| !fixed).count();
    if count == 0 || count > unknowns {
        return Err(LinearError::EigenpairCount { count, unknowns });
    }
    let mut wanted = count;
    let mut search = Search::begin(problem, unknowns)?;
    loop {
        search.widen(problem.block(wanted, unknowns)?, wanted)?;
        let found = search.run(wanted)?;
        let negative =
            found.values.iter().zip(&found.rounding).filter(|(value, rounding)| **value < -**rounding).count();
        if negative < wanted || wanted == unknowns {
            let keep = count.max(negative);
            let Eigenpairs { mut values, mut vectors, mut rounding, mut by_products, .. } = found;
            values.truncate(keep);
            vectors.truncate(keep);
            rounding.truncate(keep);
            by_products.iter_mut().for_each(|how| how.errors.truncate(keep));
            return Ok(Eigenpairs { values, vectors, rounding, negative, counted: false, by_products });
        }
        wanted = unknowns.min(2 * wanted);
    }
}

impl ProductEigenproblem<'_> {
    /// Vectors of a block for this number of eigenvalues.
    fn block(&self, wanted: usize, unknowns: usize) -> Result<usize, LinearError> {
        let block = unknowns.min(wanted.max(self.zeros) + MIN_GUARD_VECTORS.max(wanted / GUARD_DIVISOR));
        // the basis and its products, and those of a restart
        let vectors = 2 * (MAX_BASIS_RATIO + 2) * block;
        let bytes = vectors.saturating_mul(self.system.fixed.len() * size_of::<f64>());
        if bytes > MAX_BASIS_BYTES {
            let gib = bytes as f64 / f64::from(1 << 30);
            return Err(LinearError::EigenpairsTooLarge { count: wanted, unknowns, gib });
        }
        memory::check("the vectors of eigenvalues", bytes)?;
        Ok(block)
    }

    /// `A_ii`, also by products.
    fn diagonal(&self) -> Vec<f64> {
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

    /// `16 eps |x| . |A| |x|`; for products |A| is a multiple of the diagonal of A.
    fn rounding(&self, vectors: &[Vec<f64>]) -> Vec<f64> {
        let System { matrix, products, parallel, .. } = self.system;
        if products.is_some() {
            let diagonal = self.diagonal();
            let of = |x: &Vec<f64>| x.iter().zip(&diagonal).map(|(x, d)| x * x * d.abs()).sum::<f64>();
            return vectors.iter().map(|x| ENTRY_ROUNDING * ROW_SUM_RATIO * of(x)).collect();
        }
        let magnitudes = matrix.magnitudes();
        let of = |x: &Vec<f64>| {
            let (x, mut product) = (x.iter().map(|x| x.abs()).collect::<Vec<_>>(), vec![0.0; x.len()]);
            magnitudes.multiply_on(&x, &mut product, parallel);
            ENTRY_ROUNDING * dot(&x, &product, parallel)
        };
        vectors.iter().map(of).collect()
    }

    /// `M_ii`.
    fn mass_diagonal(&self) -> Vec<f64> {
        match self.mass {
            MassMatrix::Diagonal(mass) => mass.to_vec(),
            MassMatrix::Sparse(mass) => mass.diagonal(),
        }
    }

    /// The mean magnitude over free unknowns.
    fn mean(&self, diagonal: &[f64]) -> f64 {
        let free = diagonal.iter().zip(self.system.fixed).filter(|(_, fixed)| !**fixed);
        let (sum, count) = free.fold((0.0, 0), |(sum, count), (d, _)| (sum + d.abs(), count + 1));
        sum / f64::from(count.max(1))
    }
}

/// An orthonormal basis that grows, and its products.
struct Search<'a> {
    problem: &'a ProductEigenproblem<'a>,
    inner: InnerProduct<'a>,
    /// `None` while new ones are made.
    levels: Option<ShiftedLevels<'a>>,
    /// s of the levels of `A + s diag(M)`; with products the mean of `diag(M)` replaces it.
    shift: f64,
    shifts: usize,
    /// The largest shift that was too small.
    refused: f64,
    /// `M_ii`, and the means of `A_ii` and `M_ii`.
    masses: Vec<f64>,
    means: (f64, f64),
    unknowns: usize,
    /// Vectors of the block.
    block: usize,
    basis: Vec<Vec<f64>>,
    products: Vec<Vec<f64>>,
    /// `x_i . A x_k` of the basis, `k <= i`.
    projected: Vec<Vec<f64>>,
    random: Random,
    /// Iterations so far, those of smaller blocks included.
    iterations: usize,
}

/// Ritz values, ascending, and the coefficients of their vectors.
struct Ritz {
    values: Vec<f64>,
    vectors: DMatrix<f64>,
}

impl<'a> Search<'a> {
    fn begin(problem: &'a ProductEigenproblem<'a>, unknowns: usize) -> Result<Self, LinearError> {
        let System { fixed, parallel, .. } = problem.system;
        let masses = problem.mass_diagonal();
        let means = (problem.mean(&problem.diagonal()), problem.mean(&masses));
        let mut search = Search {
            problem,
            inner: InnerProduct { mass: problem.mass, fixed, parallel },
            levels: None,
            shift: 0.0,
            shifts: 0,
            refused: 0.0,
            masses,
            means,
            unknowns,
            block: 0,
            basis: Vec::new(),
            products: Vec::new(),
            projected: Vec::new(),
            random: Random::new(0),
            iterations: 0,
        };
        search.make_levels(0.0)?;
        Ok(search)
    }

    /// Enlarges the block by random vectors that are smoothed by the levels.
    fn widen(&mut self, block: usize, wanted: usize) -> Result<(), LinearError> {
        for _ in self.block..block {
            let fixed = self.inner.fixed;
            let scattered: Vec<f64> =
                fixed.iter().map(|&fixed| if fixed { 0.0 } else { self.random.symmetric() }).collect();
            let smooth = self.preconditioned(&self.inner.times_mass(&scattered));
            // levels of a singular matrix do not change vectors of its kernel
            if !self.add(smooth) {
                self.add(scattered);
            }
        }
        self.block = block;
        if self.basis.len() < block { Err(LinearError::Eigenpairs { found: 0, wanted }) } else { Ok(()) }
    }

    fn preconditioned(&self, residual: &[f64]) -> Vec<f64> {
        self.levels.as_ref().map_or(residual.to_vec(), |levels| levels.apply(residual))
    }

    /// Adds the part of a vector that is orthogonal to the basis; whether it is not zero.
    fn add(&mut self, mut vector: Vec<f64>) -> bool {
        let parallel = self.inner.parallel;
        vector.iter_mut().zip(self.inner.fixed).for_each(|(x, &fixed)| *x = if fixed { 0.0 } else { *x });
        let size = self.inner.square(&vector).sqrt();
        let (_, left) = self.inner.orthogonalize(&mut vector, self.basis.iter());
        if !left.is_finite() || left <= DEPENDENCE_TOLERANCE * size {
            return false;
        }
        vector.iter_mut().for_each(|x| *x /= left);
        let mut product = vec![0.0; vector.len()];
        self.problem.product.apply(&vector, &mut product);
        let at = self.basis.len();
        self.basis.push(vector);
        self.products.push(product);
        let (basis, products) = (&self.basis, &self.products);
        self.projected.push(basis.iter().map(|x| dot(x, &products[at], parallel)).collect());
        true
    }

    fn ritz(&self) -> Ritz {
        let SymmetricEigen { eigenvalues, eigenvectors } =
            DMatrix::from_fn(self.basis.len(), self.basis.len(), |i, k| self.projected[i.max(k)][i.min(k)])
                .symmetric_eigen();
        let mut order: Vec<usize> = (0..eigenvalues.len()).collect();
        order.sort_by(|&a, &b| eigenvalues[a].total_cmp(&eigenvalues[b]));
        let values = order.iter().map(|&k| eigenvalues[k]).collect();
        Ritz { values, vectors: eigenvectors.select_columns(&order) }
    }

    /// Iterates until `wanted` pairs have converged.
    fn run(&mut self, wanted: usize) -> Result<Eigenpairs, LinearError> {
        let (mut before, mut found) = (DMatrix::zeros(0, 0), 0);
        for _ in 0..MAX_ITERATIONS {
            if self.problem.cancel.is_some_and(|cancel| cancel.load(Ordering::Relaxed)) {
                return Err(LinearError::Cancelled);
            }
            self.iterations += 1;
            let ritz = self.ritz();
            self.adapt_shift(&ritz)?;
            let block = self.block.min(self.basis.len());
            let (mut directions, mut errors, mut missing) = (Vec::new(), Vec::new(), 0);
            for k in 0..block {
                let (direction, error) = self.correction(&ritz, k);
                errors.push(error);
                if error.is_nan() || error > TOLERANCE {
                    directions.push(direction);
                    missing += usize::from(k < wanted);
                }
            }
            found = wanted - missing;
            if missing == 0 {
                errors.truncate(wanted);
                return Ok(self.pairs(&ritz, errors));
            }
            if self.basis.len() + directions.len() > MAX_BASIS_RATIO * self.block {
                before = self.restart(&ritz, &before, block);
            } else {
                before = ritz.vectors.columns(0, block).into_owned();
            }
            let grown =
                directions.into_iter().map(|direction| self.add(direction)).fold(false, |any, grown| any | grown);
            if !grown {
                // all residuals lie in the space, or are NaN
                if self.basis.len() < self.unknowns {
                    return Err(LinearError::Eigenpairs { found, wanted });
                }
                let ritz = self.ritz();
                let errors = (0..wanted).map(|k| self.correction(&ritz, k).1).collect();
                return Ok(self.pairs(&ritz, errors));
            }
        }
        Err(LinearError::Eigenpairs { found, wanted })
    }

    /// The preconditioned residual of a Ritz pair, and the relative error of its vector as estimated by it.
    fn correction(&self, ritz: &Ritz, k: usize) -> (Vec<f64>, f64) {
        let parallel = self.inner.parallel;
        let coefficients = ritz.vectors.column(k);
        let x = combined(&self.basis, coefficients.as_slice(), parallel);
        let mut residual = combined(&self.products, coefficients.as_slice(), parallel);
        let theta = ritz.values[k];
        sums::zipped(&mut residual, &self.inner.times_mass(&x), parallel, |r, mx| *r -= theta * mx);
        residual.iter_mut().zip(self.inner.fixed).for_each(|(r, &fixed)| *r = if fixed { 0.0 } else { *r });
        let direction = self.preconditioned(&residual);
        let size = sums::norm(&residual, parallel);
        // a bound where the estimate of the error's energy is not positive
        let squared = match dot(&residual, &direction, parallel) {
            squared if squared > 0.0 => squared,
            _ => match size * sums::norm(&direction, parallel) {
                0.0 if size > 0.0 => f64::INFINITY,
                bound => bound,
            },
        };
        (direction, (squared / (theta + self.shift).max(f64::MIN_POSITIVE)).sqrt())
    }

    /// New levels, whose shift has a distance from the lowest eigenvalue, where the present shift has not.
    fn adapt_shift(&mut self, ritz: &Ritz) -> Result<(), LinearError> {
        let (first, last) = (ritz.values[0], ritz.values[self.block.min(ritz.values.len()) - 1]);
        let (spread, distance) = (last - first, first + self.shift);
        let too_far = self.shift > 0.0 && distance > spread;
        let needed = (SHIFT_DISTANCE * spread - first).max(0.0);
        let serves = distance >= MIN_SHIFT_DISTANCE * spread && !(too_far && needed > self.refused);
        if self.shifts == MAX_SHIFTED_LEVELS || spread <= 0.0 || serves {
            return Ok(());
        }
        self.shifts += 1;
        self.make_levels(needed)
    }

    /// The levels of the first shift from this one on with which they are positive definite.
    fn make_levels(&mut self, from: f64) -> Result<(), LinearError> {
        self.levels = None;
        let (stiffness, mass) = self.means;
        let (least, most) = (FIRST_SHIFT * stiffness / mass, MAX_SHIFT * stiffness / mass);
        self.shift = from;
        while self.shift <= most {
            match ShiftedLevels::new(&self.problem.system, self.shift, &self.masses, mass) {
                Err(FactorError::NotPositive { .. }) => {
                    self.refused = self.refused.max(self.shift);
                    self.shift = (SHIFT_GROWTH * self.shift).max(least);
                }
                made => {
                    self.levels = Some(made?);
                    return Ok(());
                }
            }
        }
        Err(LinearError::Shift)
    }

    /// Reduces the basis to the Ritz vectors of the block and the orthogonal parts of the previous ones; the coefficients of the block in the new basis.
    fn restart(&mut self, ritz: &Ritz, before: &DMatrix<f64>, block: usize) -> DMatrix<f64> {
        let mut kept: Vec<Vec<f64>> = (0..block).map(|k| ritz.vectors.column(k).as_slice().to_vec()).collect();
        for column in before.column_iter() {
            let mut own = column.as_slice().to_vec();
            own.resize(self.basis.len(), 0.0);
            for _ in 0..2 {
                for q in &kept {
                    let share = dot(q, &own, false);
                    own.iter_mut().zip(q).for_each(|(x, q)| *x -= share * q);
                }
            }
            let left = dot(&own, &own, false).sqrt();
            if left > DEPENDENCE_TOLERANCE.sqrt() {
                own.iter_mut().for_each(|x| *x /= left);
                kept.push(own);
            }
        }
        let parallel = self.inner.parallel;
        let all = |vectors: &[Vec<f64>]| kept.iter().map(|c| combined(vectors, c, parallel)).collect::<Vec<_>>();
        self.basis = all(&self.basis);
        self.products = all(&self.products);
        let n = self.basis.len();
        let entry = |i: usize, k: usize| dot(&self.basis[i], &self.products[k], parallel);
        self.projected = (0..n).map(|k| (0..=k).map(|i| entry(i, k)).collect()).collect();
        DMatrix::identity(n, block)
    }

    /// The first pairs, one for each of `errors`.
    fn pairs(&self, ritz: &Ritz, errors: Vec<f64>) -> Eigenpairs {
        let parallel = self.inner.parallel;
        // by a product with each vector: sums over a basis have the rounding of its largest eigenvalues
        let of = |k: usize| {
            let x = combined(&self.basis, ritz.vectors.column(k).as_slice(), parallel);
            let mut product = vec![0.0; x.len()];
            self.problem.product.apply(&x, &mut product);
            (dot(&x, &product, parallel) / self.inner.square(&x), x)
        };
        let mut pairs: Vec<((f64, Vec<f64>), f64)> =
            errors.into_iter().enumerate().map(|(k, error)| (of(k), error)).collect();
        pairs.sort_by(|((a, _), _), ((b, _), _)| a.total_cmp(b));
        let (pairs, errors): (Vec<(f64, Vec<f64>)>, Vec<f64>) = pairs.into_iter().unzip();
        let (values, vectors): (Vec<f64>, Vec<Vec<f64>>) = pairs.into_iter().unzip();
        let rounding = self.problem.rounding(&vectors);
        let by_products = Some(ByProducts { iterations: self.iterations, errors });
        Eigenpairs { values, vectors, rounding, negative: 0, counted: false, by_products }
    }
}

/// `sum_k c_k x_k`.
fn combined(vectors: &[Vec<f64>], coefficients: &[f64], parallel: bool) -> Vec<f64> {
    const CHUNK: usize = 1 << 12;
    let mut sum = vec![0.0; vectors.first().map_or(0, Vec::len)];
    let add = |(at, out): (usize, &mut [f64])| {
        for (x, c) in vectors.iter().zip(coefficients) {
            let x = &x[at * CHUNK..at * CHUNK + out.len()];
            out.iter_mut().zip(x).for_each(|(out, x)| *out += c * x);
        }
    };
    if parallel {
        sum.par_chunks_mut(CHUNK).enumerate().for_each(add);
    } else {
        sum.chunks_mut(CHUNK).enumerate().for_each(add);
    }
    sum
}
