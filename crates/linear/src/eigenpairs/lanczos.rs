//! [`smallest_eigenpairs`]: `A x = lambda M x` by shift-invert Lanczos.

use super::inner_product::{DEPENDENCE_TOLERANCE, InnerProduct};
use super::{ENTRY_ROUNDING, Eigenpairs, MAX_BASIS_BYTES, MassMatrix};
use crate::error::{FactorError, StructureError};
use crate::factor::factor_size::fits;
use crate::factor::symbolic::Symbolic;
use crate::factor::symmetric::{Factor, Pivots};
use crate::pattern::matrix::SparseMatrix;
use crate::solver::LinearError;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn, SymmetricEigen};
use nastic_numeric::Random;
use nastic_numeric::vector::{axpy, dot, scale};
use std::borrow::Cow;
use std::sync::Arc;

/// `|B x - theta x|_M` over theta at which a Ritz pair has converged.
const TOLERANCE: f64 = 1e-11;
/// Least number of steps between two computations of the Ritz pairs.
const MIN_STEPS: usize = 4;
/// Steps made over those between two computations of the Ritz pairs, whose cost is cubic in the steps.
const STEP_DIVISOR: usize = 10;
/// Smallest shift below an indefinite matrix, as a share of the largest `|A_ii| / M_ii`.
const MIN_SHIFT: f64 = 1e-14;
/// Ratio of one shift to the one before.
const SHIFT_GROWTH: f64 = 16.0;
/// Largest shift, as a share of the largest `|A_ii| / M_ii`.
const MAX_SHIFT: f64 = 1e3;
/// Least distance of the shift from the lowest eigenvalue over its rounding: the factor of a singular A is rounding alone.
const MIN_ROUNDING_RATIO: f64 = 1e3;
/// The same as a share of the distance of the highest eigenvalue asked for, which is the share of its digits that B has.
const MIN_SHIFT_DISTANCE: f64 = 1e-6;
/// The share that a new shift has.
const SHIFT_DISTANCE: f64 = 1e-3;
/// Distance above an eigenvalue at which the others are counted, as a share of its distance from the shift; never less than
/// its rounding.
const COUNT_OFFSET: f64 = 1e-6;

/// `A x = lambda M x` on the unknowns that are not fixed; with constraints `A x + B p = lambda M x`, `B^T x = 0`.
#[derive(Clone, Copy)]
pub struct Eigenproblem<'a> {
    /// A, symmetric, with rows and columns of fixed unknowns replaced by positive multiples of those of the identity.
    pub matrix: &'a SparseMatrix,
    /// M, positive definite on the unknowns that are not fixed.
    pub mass: MassMatrix<'a>,
    /// By unknown: whether it is fixed.
    pub fixed: &'a [bool],
    /// Columns of B, zero where fixed: the pairs are those on the null space of `B^T`. Empty for all.
    pub constraints: &'a [Vec<f64>],
    /// The symbolic factorisation of A.
    pub symbolic: &'a Arc<Symbolic>,
    /// Whether to use all threads; the bits are the same.
    pub parallel: bool,
}

/// The `count` algebraically smallest eigenvalues with their vectors, and all negative ones where these are more.
///
/// Lanczos with full reorthogonalisation for `B = (A - sigma M)^-1 M` in the inner product of M, from a seeded start
/// vector, with sigma = 0 for a positive definite A and else a shift below the spectrum, which the Cholesky factor of
/// `A - sigma M` proves; a shift too near to the lowest eigenvalue for its rounding, as zero is of a singular A, or
/// for the distance of the others is moved away. No eigenvalue is missed: those below the largest one returned are counted by the pivots of
/// `A - mu M` (Sylvester's law of inertia), and as long as there are more than were found (of multiple eigenvalues a
/// Krylov space has one vector) the iteration begins again orthogonal to all found. Ericsson, Ruhe, "The spectral
/// transformation Lanczos method for the numerical solution of large sparse generalized symmetric eigenvalue problems",
/// Math. Comp. 35 (1980).
///
/// With constraints `C = (A - sigma M)^-1` becomes `C - C B S^-1 B^T C`, `S = B^T C B`, the inverse on the null space of `B^T`, and the
/// number of eigenvalues below mu that of the negative pivots of `A - mu M` less the negative eigenvalues of `B^T (A - mu M)^-1 B`
/// (Haynsworth's inertia additivity).
///
/// # Errors
/// A matrix that is not symmetric or not finite; more eigenvalues wanted than there are unknowns; a factor beyond 8
/// GiB; [`LinearError::Eigenpairs`] where the iteration does not find them.
pub fn smallest_eigenpairs(problem: &Eigenproblem, count: usize) -> Result<Eigenpairs, LinearError> {
    let free = problem.fixed.iter().filter(|&&fixed| !fixed).count();
    let unknowns = free.saturating_sub(problem.constraints.len());
    problem.check(count, unknowns)?;
    let (mut sigma, mut inverse) = problem.below_spectrum()?;
    let negative = if sigma == 0.0 { 0 } else { problem.count_negative()? };
    let wanted = count.max(negative);
    let magnitudes = problem.matrix.magnitudes();
    let rounding = |x: &[f64]| {
        let magnitude: Vec<f64> = x.iter().map(|x| x.abs()).collect();
        ENTRY_ROUNDING * quadratic_form(&magnitudes, &magnitude, problem.parallel)
    };
    let mut found = KnownPairs::default();
    let mut missing = wanted;
    // A run that adds no eigenpair adds none the next time either; one that does may have found a copy of a multiple value alone.
    for run in 0..=unknowns {
        let (steps, before) = (steps(missing, unknowns), found.values.len());
        found.add(lanczos(problem, &inverse, &found.vectors, missing, steps, run as u64), problem);
        if let Some(distance) = found.separation(wanted, sigma, &rounding) {
            (sigma, inverse) = problem.shifted_below(found.values[0], distance)?;
            (found, missing) = (KnownPairs::default(), wanted);
            continue;
        }
        if found.values.len() == before {
            break;
        }
        let Some(&last) = found.values.get(wanted - 1) else {
            missing = wanted - found.values.len();
            continue;
        };
        let mu = last + (COUNT_OFFSET * (last - sigma)).max(rounding(&found.vectors[wanted - 1]));
        let known = found.values.iter().filter(|&&value| value < mu).count();
        missing = problem.count_below(mu)?.saturating_sub(known);
        if missing == 0 {
            found.values.truncate(wanted);
            found.vectors.truncate(wanted);
            let rounding = found.vectors.iter().map(|x| rounding(x)).collect();
            let KnownPairs { values, vectors } = found;
            return Ok(Eigenpairs { values, vectors, rounding, negative, counted: true, by_products: None });
        }
    }
    Err(LinearError::Eigenpairs { found: wanted.saturating_sub(missing), wanted })
}

/// Largest number of steps of one iteration, by the number of eigenvalues.
fn steps(wanted: usize, unknowns: usize) -> usize {
    unknowns.min(wanted.saturating_mul(10).saturating_add(200))
}

impl Eigenproblem<'_> {
    fn check(&self, count: usize, unknowns: usize) -> Result<(), LinearError> {
        if !self.matrix.is_symmetric() {
            return Err(LinearError::NotSymmetric);
        }
        if count == 0 || count > unknowns {
            return Err(LinearError::EigenpairCount { count, unknowns });
        }
        let vectors = steps(count, unknowns) + count;
        let bytes = vectors.saturating_mul(self.fixed.len() * size_of::<f64>());
        if bytes > MAX_BASIS_BYTES {
            let gib = bytes as f64 / f64::from(1 << 30);
            return Err(LinearError::EigenpairsTooLarge { count, unknowns, gib });
        }
        if !fits(self.symbolic.factor_bytes()) {
            return Err(LinearError::FactorTooLarge { gib: self.symbolic.factor_bytes() as f64 / f64::from(1 << 30) });
        }
        Ok(())
    }

    /// `A - sigma M`, fixed unknowns left alone.
    fn shifted(&self, sigma: f64) -> Result<SparseMatrix, FactorError> {
        let mut matrix = self.matrix.clone();
        match self.mass {
            MassMatrix::Diagonal(mass) => {
                let entry = |(m, &fixed): (&f64, &bool)| if fixed { 0.0 } else { -sigma * m };
                matrix.add_diagonal(&mass.iter().zip(self.fixed).map(entry).collect::<Vec<_>>());
            }
            MassMatrix::Sparse(mass) => matrix.add_scaled(-sigma, mass).map_err(StructureError::from)?,
        }
        Ok(matrix)
    }

    /// Zero, or a shift below all eigenvalues, with the Cholesky factor of the shifted matrix.
    fn below_spectrum(&self) -> Result<(f64, Inverse<'_>), LinearError> {
        match self.symbolic.factorize(self.matrix, Pivots::Positive, self.parallel) {
            Err(FactorError::NotPositive { .. }) => self.shifted_below(0.0, 0.0),
            done => Ok((0.0, Inverse::new(done?, self.constraints)?)),
        }
    }

    /// The first shift at this distance below a value, or farther, that is below all eigenvalues.
    fn shifted_below(&self, value: f64, distance: f64) -> Result<(f64, Inverse<'_>), LinearError> {
        let most = self.largest_quotient();
        let mut distance = distance.max(MIN_SHIFT * most);
        while distance < MAX_SHIFT * most {
            let sigma = value - distance;
            match self.symbolic.factorize(&self.shifted(sigma)?, Pivots::Positive, self.parallel) {
                Err(FactorError::NotPositive { .. }) => distance *= SHIFT_GROWTH,
                done => return Ok((sigma, Inverse::new(done?, self.constraints)?)),
            }
        }
        Err(LinearError::Shift)
    }

    /// The largest `|A_ii| / M_ii`, which no eigenvalue exceeds by much.
    fn largest_quotient(&self) -> f64 {
        let diagonal = self.matrix.diagonal();
        let mass = match self.mass {
            MassMatrix::Diagonal(mass) => Cow::Borrowed(mass),
            MassMatrix::Sparse(mass) => Cow::Owned(mass.diagonal()),
        };
        let free = diagonal.iter().zip(mass.iter()).zip(self.fixed).filter(|(_, fixed)| !**fixed);
        free.fold(0.0, |most: f64, ((a, m), _)| most.max(a.abs() / m))
    }

    /// Number of negative eigenvalues; of a matrix that has no factor, being singular, of those below rounding.
    fn count_negative(&self) -> Result<usize, LinearError> {
        match self.count_below(0.0) {
            Err(error) if error.is_singular() => self.count_below(-MIN_SHIFT * self.largest_quotient()),
            counted => counted,
        }
    }

    /// Number of eigenvalues below mu.
    fn count_below(&self, mu: f64) -> Result<usize, LinearError> {
        let factor = self.symbolic.factorize(&self.shifted(mu)?, Pivots::AnySign, self.parallel)?;
        if self.constraints.is_empty() {
            return Ok(factor.negative_pivots());
        }
        let (_, mut schur) = schur(&factor, self.constraints);
        // Congruence with a diagonal matrix keeps the signs, and takes the units of the constraints away.
        let size: Vec<f64> = (0..schur.nrows()).map(|k| schur.row(k).amax().sqrt().max(f64::MIN_POSITIVE)).collect();
        schur = DMatrix::from_fn(size.len(), size.len(), |i, k| schur[(i, k)] / (size[i] * size[k]));
        let of_constraints = schur.symmetric_eigenvalues().iter().filter(|value| **value < 0.0).count();
        Ok(factor.negative_pivots().saturating_sub(of_constraints))
    }

    fn inner_product(&self) -> InnerProduct<'_> {
        InnerProduct { mass: self.mass, fixed: self.fixed, parallel: self.parallel }
    }

    /// `x . A x / x . M x`: twice as many digits as the vector has.
    fn rayleigh(&self, x: &[f64]) -> f64 {
        quadratic_form(self.matrix, x, self.parallel) / self.inner_product().square(x)
    }
}

/// `x . A x`.
fn quadratic_form(matrix: &SparseMatrix, x: &[f64], parallel: bool) -> f64 {
    let mut product = vec![0.0; x.len()];
    matrix.multiply_on(x, &mut product, parallel);
    dot(x, &product)
}

/// `B^T A^-1 B` and the columns `A^-1 B`.
fn schur(factor: &Factor, constraints: &[Vec<f64>]) -> (Vec<Vec<f64>>, DMatrix<f64>) {
    let inverse = |column: &Vec<f64>| {
        let mut z = column.clone();
        factor.solve(&mut z, 1);
        z
    };
    let z: Vec<Vec<f64>> = constraints.iter().map(inverse).collect();
    let schur =
        DMatrix::from_fn(z.len(), z.len(), |i, k| 0.5 * (dot(&constraints[i], &z[k]) + dot(&constraints[k], &z[i])));
    (z, schur)
}

/// The inverse of a positive definite matrix on the null space of `B^T`.
struct Inverse<'a> {
    factor: Factor,
    constraints: &'a [Vec<f64>],
    z: Vec<Vec<f64>>,
    schur: Cholesky<f64, Dyn>,
}

impl<'a> Inverse<'a> {
    fn new(factor: Factor, constraints: &'a [Vec<f64>]) -> Result<Self, LinearError> {
        let (z, schur) = schur(&factor, constraints);
        let schur = schur.cholesky().ok_or(LinearError::Border { scalars: constraints.len() })?;
        Ok(Inverse { factor, constraints, z, schur })
    }

    fn apply(&self, x: &mut [f64]) {
        self.factor.solve(x, 1);
        let slopes = DVector::from_iterator(self.z.len(), self.constraints.iter().map(|column| dot(column, x)));
        let p = self.schur.solve(&slopes);
        self.z.iter().zip(p.iter()).for_each(|(z, p)| axpy(-p, z, x));
    }
}

/// Eigenpairs found so far, ascending.
#[derive(Default)]
struct KnownPairs {
    values: Vec<f64>,
    vectors: Vec<Vec<f64>>,
}

impl KnownPairs {
    fn add(&mut self, vectors: Vec<Vec<f64>>, problem: &Eigenproblem) {
        for x in vectors {
            let value = problem.rayleigh(&x);
            let at = self.values.partition_point(|known| *known <= value);
            self.values.insert(at, value);
            self.vectors.insert(at, x);
        }
    }

    /// The distance that a shift should have from the lowest eigenvalue, where sigma is too near.
    fn separation(&self, wanted: usize, sigma: f64, rounding: &impl Fn(&[f64]) -> f64) -> Option<f64> {
        let (first, x) = self.values.first().zip(self.vectors.first())?;
        let spread = self.values[wanted.min(self.values.len()) - 1] - first;
        let (least, below) = (MIN_ROUNDING_RATIO * rounding(x), first - sigma);
        (below < least.max(MIN_SHIFT_DISTANCE * spread)).then(|| (SHIFT_GROWTH * least).max(SHIFT_DISTANCE * spread))
    }
}

/// Up to `wanted` eigenvectors of the largest eigenvalues of B, orthogonal to those that are known; fewer where the
/// steps do not suffice or the space is exhausted.
fn lanczos(
    problem: &Eigenproblem,
    inverse: &Inverse,
    known: &[Vec<f64>],
    wanted: usize,
    steps: usize,
    seed: u64,
) -> Vec<Vec<f64>> {
    let (mut random, inner) = (Random::new(seed), problem.inner_product());
    let mut q: Vec<f64> = problem.fixed.iter().map(|&fixed| if fixed { 0.0 } else { random.symmetric() }).collect();
    if !problem.constraints.is_empty() {
        q = inner.times_mass(&q);
        inverse.apply(&mut q);
    }
    let size = inner.square(&q).sqrt();
    let (_, left) = inner.orthogonalize(&mut q, known.iter());
    if left <= DEPENDENCE_TOLERANCE * size {
        return Vec::new();
    }
    scale(1.0 / left, &mut q);
    let mut basis = vec![q];
    let (mut alpha, mut beta): (Vec<f64>, Vec<f64>) = (Vec::new(), Vec::new());
    let mut look = MIN_STEPS;
    loop {
        let j = basis.len() - 1;
        let mut w = inner.times_mass(&basis[j]);
        inverse.apply(&mut w);
        let (h, left) = inner.orthogonalize(&mut w, known.iter().chain(&basis));
        alpha.push(h[known.len() + j]);
        let largest = alpha.iter().chain(&beta).fold(0.0, |most: f64, t| most.max(t.abs()));
        let exhausted = left <= DEPENDENCE_TOLERANCE * largest;
        if exhausted || j + 1 == steps || j + 1 == look {
            look += MIN_STEPS.max(look / STEP_DIVISOR);
            let pairs = Ritz::of(&alpha, &beta);
            let done = pairs.converged(if exhausted { 0.0 } else { left }).min(wanted);
            if exhausted || j + 1 == steps || done == wanted {
                return (0..done).map(|k| pairs.vector(k, &basis)).collect();
            }
        }
        beta.push(left);
        scale(1.0 / left, &mut w);
        basis.push(w);
    }
}

/// Eigenpairs of the tridiagonal matrix, the largest first.
struct Ritz {
    values: Vec<f64>,
    vectors: DMatrix<f64>,
    order: Vec<usize>,
}

impl Ritz {
    fn of(alpha: &[f64], beta: &[f64]) -> Self {
        let n = alpha.len();
        let tridiagonal = DMatrix::from_fn(n, n, |i, k| match i.abs_diff(k) {
            0 => alpha[i],
            1 => beta[i.min(k)],
            _ => 0.0,
        });
        let SymmetricEigen { eigenvalues, eigenvectors } = tridiagonal.symmetric_eigen();
        let values: Vec<f64> = eigenvalues.iter().copied().collect();
        let mut order: Vec<usize> = (0..n).collect();
        order.sort_by(|&a, &b| values[b].total_cmp(&values[a]));
        Ritz { values, vectors: eigenvectors, order }
    }

    /// How many of the largest, without a gap, are eigenvalues of B; `left` is the norm of the next basis vector.
    fn converged(&self, left: f64) -> usize {
        let last = self.values.len() - 1;
        let holds = |&k: &usize| (left * self.vectors[(last, k)]).abs() <= TOLERANCE * self.values[k];
        self.order.iter().take_while(|k| holds(k)).count()
    }

    fn vector(&self, k: usize, basis: &[Vec<f64>]) -> Vec<f64> {
        let mut x = vec![0.0; basis[0].len()];
        basis.iter().zip(self.vectors.column(self.order[k]).iter()).for_each(|(q, c)| axpy(*c, q, &mut x));
        x
    }
}
