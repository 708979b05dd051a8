//! [`Search`]: a block Davidson iteration for the smallest eigenpairs.

use super::cycles::mean_magnitude;
use super::inner_product::{DEPENDENCE_TOLERANCE, InnerProduct};
use super::shifted_matrix::{Inverse, SearchLimits, ShiftedMatrix};
use super::{ByProducts, Eigenpairs, Eigenproblem};
use crate::error::FactorError;
use crate::memory;
use crate::solver::LinearError;
use crate::sums::{self, dot};
use nalgebra::{DMatrix, SymmetricEigen};
use nastic_numeric::Random;
use rayon::prelude::*;
use std::sync::atomic::Ordering;

/// Memory of a basis: 8 GiB.
const MAX_BASIS_BYTES: usize = 8 << 30;
/// Vectors of the basis before a restart, over those of the block.
const MAX_BASIS_RATIO: usize = 4;
/// Eigenpairs asked for, over the further vectors of the block: the next eigenvalues determine the convergence rate.
const GUARD_DIVISOR: usize = 2;
/// Least number of further vectors of the block.
const MIN_GUARD_VECTORS: usize = 2;
/// First shift where A is not positive definite, as a share of the mean of `A_ii` over that of `M_ii`.
const FIRST_SHIFT: f64 = 1e-12;
/// Ratio of one shift to the one before.
const SHIFT_GROWTH: f64 = 16.0;
/// Largest shift.
const MAX_SHIFT: f64 = 1e3;
/// Least distance of the lowest eigenvalue from minus the shift, as a share of the spread of the eigenvalues of the block.
const MIN_SHIFT_DISTANCE: f64 = 1e-6;
/// The distance that a new shift has.
const SHIFT_DISTANCE: f64 = 1e-2;
/// Distance above an eigenvalue at which the others are counted, as a share of its distance from minus the shift; never less than its rounding.
const COUNT_OFFSET: f64 = 1e-6;
/// Share of the largest `|A_ii| / M_ii` below which an eigenvalue of a matrix without a factor is not counted as negative.
const ZERO_SHARE: f64 = 1e-14;
/// Inverses for further shifts.
const MAX_FURTHER_SHIFTS: usize = 8;

/// An orthonormal basis that grows, and its products.
pub(super) struct Search<'a> {
    problem: &'a Eigenproblem<'a>,
    matrix: &'a dyn ShiftedMatrix,
    inner: InnerProduct<'a>,
    limits: SearchLimits,
    /// `None` while a new one is made.
    inverse: Option<Box<dyn Inverse + 'a>>,
    /// s of the inverse of `A + s M`.
    shift: f64,
    shifts: usize,
    /// The largest shift that was too small.
    refused: f64,
    /// The mean of `A_ii` over that of `M_ii`, and the largest `|A_ii| / M_ii`.
    mean_quotient: f64,
    largest_quotient: f64,
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

/// Preconditioned residuals of Ritz pairs, one after the other, and the relative errors of their vectors as estimated by them.
struct Corrections {
    directions: Vec<f64>,
    errors: Vec<f64>,
}

impl<'a> Search<'a> {
    pub fn begin(problem: &'a Eigenproblem<'a>, matrix: &'a dyn ShiftedMatrix) -> Result<Self, LinearError> {
        let Eigenproblem { mass, fixed, parallel, .. } = *problem;
        let (diagonal, masses) = (matrix.diagonal(), mass.diagonal());
        let free = diagonal.iter().zip(&masses).zip(fixed).filter(|(_, fixed)| !**fixed);
        let mut search = Search {
            problem,
            matrix,
            inner: InnerProduct { mass, fixed, parallel },
            limits: matrix.search_limits(),
            inverse: None,
            shift: 0.0,
            shifts: 0,
            refused: 0.0,
            mean_quotient: mean_magnitude(&diagonal, fixed) / mean_magnitude(&masses, fixed),
            largest_quotient: free.fold(0.0, |most: f64, ((a, m), _)| most.max(a.abs() / m)),
            unknowns: problem.unknowns(),
            block: 0,
            basis: Vec::new(),
            products: Vec::new(),
            projected: Vec::new(),
            random: Random::new(0),
            iterations: 0,
        };
        search.invert(0.0)?;
        Ok(search)
    }

    /// Number of negative eigenvalues, of a matrix that has no factor, being singular, of those below rounding; `None` where nothing counts them.
    pub fn negative(&self) -> Result<Option<usize>, LinearError> {
        if self.shift == 0.0 {
            return Ok(self.matrix.counts().then_some(0));
        }
        match self.matrix.count_below(0.0) {
            Err(error) if error.is_singular() => self.matrix.count_below(-ZERO_SHARE * self.largest_quotient),
            counted => counted,
        }
    }

    /// Refuses what does not fit into memory.
    pub fn check_size(problem: &Eigenproblem, count: usize) -> Result<(), LinearError> {
        let unknowns = problem.unknowns();
        // the basis and its products, and those of a restart
        let vectors = 2 * (MAX_BASIS_RATIO + 2) * block(problem, count);
        let bytes = vectors.saturating_mul(problem.fixed.len() * size_of::<f64>());
        if bytes > MAX_BASIS_BYTES {
            let gib = bytes as f64 / f64::from(1 << 30);
            return Err(LinearError::EigenpairsTooLarge { count, unknowns, gib });
        }
        Ok(memory::check("the vectors of eigenvalues", bytes)?)
    }

    /// Eigenvalues up to the last one that is wanted that are not among those found, by the pivots of a factor just above it.
    pub fn missing(&self, found: &Eigenpairs, wanted: usize) -> Result<usize, LinearError> {
        let last = found.values[wanted - 1];
        let mu = last + (COUNT_OFFSET * (last + self.shift)).max(found.rounding[wanted - 1]);
        let known = found.values.iter().filter(|&&value| value < mu).count();
        Ok(self.matrix.count_below(mu)?.map_or(0, |count| count.saturating_sub(known)))
    }

    /// Enlarges the block to one for this number of eigenvalues, by random vectors that are smoothed by the inverse.
    pub fn widen(&mut self, wanted: usize) -> Result<(), LinearError> {
        Self::check_size(self.problem, wanted)?;
        let block = block(self.problem, wanted);
        for _ in self.block..block {
            let fixed = self.inner.fixed;
            let scattered: Vec<f64> =
                fixed.iter().map(|&fixed| if fixed { 0.0 } else { self.random.symmetric() }).collect();
            let mut smooth = self.inner.times_mass(&scattered);
            self.precondition(&mut smooth, 1);
            // the inverse of a singular matrix does not change vectors of its kernel, or leaves nothing else
            if !self.add(&smooth) {
                let mut scattered = scattered;
                self.inverse.iter().for_each(|inverse| inverse.constrain(&mut scattered));
                self.add(&scattered);
            }
        }
        self.block = block;
        if self.basis.len() < block { Err(LinearError::Eigenpairs { found: 0, wanted }) } else { Ok(()) }
    }

    fn precondition(&self, columns: &mut [f64], count: usize) {
        self.inverse.iter().for_each(|inverse| inverse.apply(columns, count));
    }

    /// Adds the part of a vector that is orthogonal to the basis; whether it is not zero.
    fn add(&mut self, vector: &[f64]) -> bool {
        let (parallel, mut vector) = (self.inner.parallel, vector.to_vec());
        vector.iter_mut().zip(self.inner.fixed).for_each(|(x, &fixed)| *x = if fixed { 0.0 } else { *x });
        let size = self.inner.square(&vector).sqrt();
        let (_, left) = self.inner.orthogonalize(&mut vector, self.basis.iter());
        if !left.is_finite() || left <= DEPENDENCE_TOLERANCE * size {
            return false;
        }
        vector.iter_mut().for_each(|x| *x /= left);
        let mut product = vec![0.0; vector.len()];
        self.matrix.multiply(&vector, &mut product);
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
    pub fn run(&mut self, wanted: usize) -> Result<Eigenpairs, LinearError> {
        let (mut before, mut found) = (DMatrix::zeros(0, 0), 0);
        for _ in 0..self.limits.iterations {
            if self.problem.cancel.is_some_and(|cancel| cancel.load(Ordering::Relaxed)) {
                return Err(LinearError::Cancelled);
            }
            self.iterations += 1;
            let ritz = self.ritz();
            self.adapt_shift(&ritz)?;
            let block = self.block.min(self.basis.len());
            let Corrections { directions, mut errors } = self.corrections(&ritz, block);
            let open: Vec<usize> = (0..block).filter(|&k| !self.has_converged(&ritz, k, errors[k])).collect();
            let missing = open.iter().filter(|&&k| k < wanted).count();
            found = wanted - missing;
            if missing == 0 {
                errors.truncate(wanted);
                return Ok(self.pairs(&ritz, errors));
            }
            if self.basis.len() + open.len() > MAX_BASIS_RATIO * self.block {
                before = self.restart(&ritz, &before, block);
            } else {
                before = ritz.vectors.columns(0, block).into_owned();
            }
            let length = self.inner.fixed.len();
            let grown = open
                .iter()
                .map(|k| self.add(&directions[k * length..(k + 1) * length]))
                .fold(false, |any, grown| any | grown);
            if !grown {
                // all residuals lie in the space, or are NaN
                if self.basis.len() < self.unknowns {
                    return Err(LinearError::Eigenpairs { found, wanted });
                }
                let ritz = self.ritz();
                let errors = self.corrections(&ritz, wanted).errors;
                return Ok(self.pairs(&ritz, errors));
            }
        }
        Err(LinearError::Eigenpairs { found, wanted })
    }

    /// Whether an error is below what is asked for, or what rounding of the products of A leaves of it.
    fn has_converged(&self, ritz: &Ritz, k: usize, error: f64) -> bool {
        let scale = (ritz.values[k] + self.shift).max(f64::MIN_POSITIVE);
        error <= self.limits.tolerance.max(self.limits.rounding * self.largest_quotient / scale)
    }

    /// Of the first pairs.
    fn corrections(&self, ritz: &Ritz, count: usize) -> Corrections {
        let (parallel, length) = (self.inner.parallel, self.inner.fixed.len());
        let mut residuals = Vec::with_capacity(count * length);
        for k in 0..count {
            let coefficients = ritz.vectors.column(k);
            let x = combined(&self.basis, coefficients.as_slice(), parallel);
            let mut residual = combined(&self.products, coefficients.as_slice(), parallel);
            let theta = ritz.values[k];
            sums::zipped(&mut residual, &self.inner.times_mass(&x), parallel, |r, mx| *r -= theta * mx);
            residual.iter_mut().zip(self.inner.fixed).for_each(|(r, &fixed)| *r = if fixed { 0.0 } else { *r });
            residuals.extend(residual);
        }
        let mut directions = residuals.clone();
        self.precondition(&mut directions, count);
        let columns = residuals.chunks(length).zip(directions.chunks(length)).zip(&ritz.values);
        let errors = columns.map(|((residual, direction), theta)| self.error(residual, direction, *theta)).collect();
        Corrections { directions, errors }
    }

    fn error(&self, residual: &[f64], direction: &[f64], theta: f64) -> f64 {
        let parallel = self.inner.parallel;
        let size = sums::norm(residual, parallel);
        // a bound where the estimate of the error's energy is not positive
        let squared = match dot(residual, direction, parallel) {
            squared if squared > 0.0 => squared,
            _ => match size * sums::norm(direction, parallel) {
                0.0 if size > 0.0 => f64::INFINITY,
                bound => bound,
            },
        };
        (squared / (theta + self.shift).max(f64::MIN_POSITIVE)).sqrt()
    }

    /// A new inverse, whose shift has a distance from the lowest eigenvalue, where the present shift has not.
    fn adapt_shift(&mut self, ritz: &Ritz) -> Result<(), LinearError> {
        let (first, last) = (ritz.values[0], ritz.values[self.block.min(ritz.values.len()) - 1]);
        let (spread, distance) = (last - first, first + self.shift);
        let too_far = self.shift > 0.0 && distance > spread;
        let needed = (SHIFT_DISTANCE * spread - first).max(0.0);
        let serves = distance >= MIN_SHIFT_DISTANCE * spread && !(too_far && needed > self.refused);
        if self.shifts == MAX_FURTHER_SHIFTS || spread <= 0.0 || serves {
            return Ok(());
        }
        self.shifts += 1;
        self.invert(needed)
    }

    /// The inverse for the first shift from this one on with which A is positive definite.
    fn invert(&mut self, from: f64) -> Result<(), LinearError> {
        self.inverse = None;
        let (least, most) = (FIRST_SHIFT * self.mean_quotient, MAX_SHIFT * self.largest_quotient);
        self.shift = from;
        while self.shift <= most {
            match self.matrix.inverse(self.shift) {
                Err(LinearError::Factor(FactorError::NotPositive { .. })) => {
                    self.refused = self.refused.max(self.shift);
                    let next = (SHIFT_GROWTH * self.shift).max(least);
                    // of a matrix without a diagonal nothing is a larger one
                    if next <= self.shift || next.is_nan() {
                        break;
                    }
                    self.shift = next;
                }
                made => {
                    self.inverse = Some(made?);
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
            self.matrix.multiply(&x, &mut product);
            (dot(&x, &product, parallel) / self.inner.square(&x), x)
        };
        let mut pairs: Vec<((f64, Vec<f64>), f64)> =
            errors.into_iter().enumerate().map(|(k, error)| (of(k), error)).collect();
        pairs.sort_by(|((a, _), _), ((b, _), _)| a.total_cmp(b));
        let (pairs, errors): (Vec<(f64, Vec<f64>)>, Vec<f64>) = pairs.into_iter().unzip();
        let (values, vectors): (Vec<f64>, Vec<Vec<f64>>) = pairs.into_iter().unzip();
        let rounding = self.matrix.rounding(&vectors);
        let by_products = (!self.matrix.counts()).then_some(ByProducts { iterations: self.iterations, errors });
        Eigenpairs { values, vectors, rounding, negative: 0, counted: false, by_products }
    }
}

/// Vectors of a block for this number of eigenvalues.
fn block(problem: &Eigenproblem, wanted: usize) -> usize {
    problem.unknowns().min(wanted.max(problem.zeros) + MIN_GUARD_VECTORS.max(wanted / GUARD_DIVISOR))
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
