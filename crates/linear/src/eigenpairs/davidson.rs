//! [`smallest_eigenpairs`]: `A x = lambda M x` by a block Davidson method.

use super::factor::{ShiftedFactor, count_below, count_negative};
use super::inner_product::{InnerProduct, SPANNED};
use super::preconditioner::ShiftedLevels;
use super::problem::LONGEST;
use super::{ApproximateInverse, ByProducts, Eigenpairs, Eigenproblem};
use crate::error::FactorError;
use crate::solver::{LinearError, System};
use crate::sums::{self, dot};
use nalgebra::{DMatrix, SymmetricEigen};
use nastic_numeric::Random;
use rayon::prelude::*;
use std::borrow::Cow;
use std::sync::atomic::Ordering;

/// A Ritz pair counts when the error of its vector in the energy norm is this share of it, as far as the preconditioned residual shows; that of the value is its square.
const TOLERANCE: f64 = 1e-7;
/// With a factor: `|B x - theta x|_M` as a share of theta, `B = (A + s M)^-1 M`, or of the largest theta where rounding allows no more.
const EXACT: f64 = 1e-11;
const LEAST: f64 = 16.0 * f64::EPSILON;
/// With a factor: least distance of the lowest eigenvalue from minus the shift, as a multiple of its rounding, since of a singular A the factor is
/// rounding alone; and how far above an eigenvalue the others are counted, as a share of that distance.
const SEPARATION: f64 = 1e3;
const ABOVE: f64 = 1e-6;
/// Iterations at most.
const MOST: usize = 60;
/// The first shift where the levels are not positive definite, as a share of the mean of `A_ii` over that of `M_ii`, from one to the next, and the largest.
const LEAST_SHIFT: f64 = 1e-12;
const SHIFT_GROWTH: f64 = 16.0;
const MOST_SHIFT: f64 = 1e3;
/// Least distance of the lowest eigenvalue from minus the shift, as a share of the spread of those of the block, and what it becomes.
const LEAST_SHARE: f64 = 1e-6;
const SHARE: f64 = 1e-2;
/// Levels at most that are made for other shifts.
const SHIFTS: usize = 8;

/// The `count` algebraically smallest eigenvalues with their vectors, and all negative ones where these are more.
///
/// The Rayleigh-Ritz values of a space that grows by the residuals `A x - theta M x` of a block of Ritz vectors, preconditioned, and is restarted with those
/// vectors and the ones before: the locally optimal gradients of Knyazev, "Toward the optimal preconditioned eigensolver", SIAM J. Sci. Comput. 23 (2001), with
/// the orthogonal basis of Stathopoulos, Saad, "Restarting techniques for the (Jacobi-)Davidson symmetric eigenvalue methods", ETNA 7 (1998). From a
/// seeded start.
///
/// The preconditioner is a V-cycle of A, where that is not positive definite of `A + s M`; or the inverse of that by a factor, and then values are those of
/// `B = (A + s M)^-1 M`, whose residuals are the preconditioned ones of A: Ericsson, Ruhe, "The spectral transformation Lanczos method for the numerical
/// solution of large sparse generalized symmetric eigenvalue problems", Math. Comp. 35 (1980). With a factor no eigenvalue is missed: those below the
/// largest one returned are counted by the pivots of `A - mu M` (Sylvester's law of inertia), and the block grows while there are more than were
/// found. Without one nothing proves that ([`Eigenpairs::counted`]): the block has half as many vectors again as are wanted, or are zero, and
/// what is orthogonal to all of these was not met.
///
/// With constraints `C = (A + s M)^-1` becomes `C - C B S^-1 B^T C`, `S = B^T C B`, the inverse on the null space of `B^T`, and the
/// number of eigenvalues below mu that of the negative pivots of `A - mu M` less the negative eigenvalues of `B^T (A - mu M)^-1 B`
/// (Haynsworth's inertia additivity).
///
/// # Errors
/// A matrix that is not symmetric or not finite; more eigenvalues wanted than there are unknowns, or than fit; a factor beyond 8 GiB;
/// [`LinearError::Eigenpairs`] where the iteration does not find them; [`LinearError::Cancelled`].
pub fn smallest_eigenpairs(problem: &Eigenproblem, count: usize) -> Result<Eigenpairs, LinearError> {
    let unknowns = problem.check(count)?;
    let mut search = Search::begin(problem, unknowns)?;
    let known = match problem.inverse {
        ApproximateInverse::Factor(_) if search.shift == 0.0 => Some(0),
        ApproximateInverse::Factor(by) => Some(count_negative(problem, by)?),
        ApproximateInverse::Multigrid { .. } => None,
    };
    let least = count.max(known.unwrap_or(0));
    let mut wanted = least;
    loop {
        search.widen(problem.block(wanted, unknowns)?, wanted)?;
        let found = search.run(wanted)?;
        let below_zero = || found.values.iter().zip(&found.rounding).filter(|(value, rounding)| **value < -**rounding);
        let negative = known.unwrap_or_else(|| below_zero().count());
        let more = match problem.inverse {
            ApproximateInverse::Factor(by) => {
                let last = found.values[least - 1];
                let mu = last + (ABOVE * (last + search.shift)).max(found.rounding[least - 1]);
                let met = found.values.iter().filter(|value| **value < mu).count();
                wanted + count_below(problem, by, mu)?.saturating_sub(met)
            }
            ApproximateInverse::Multigrid { .. } if negative == wanted => unknowns.min(2 * wanted),
            ApproximateInverse::Multigrid { .. } => wanted,
        };
        if more == wanted {
            return Ok(Eigenpairs { negative, counted: known.is_some(), ..found.first(count.max(negative)) });
        }
        wanted = more;
    }
}

/// An orthonormal basis that grows, and its products.
struct Search<'a> {
    problem: &'a Eigenproblem<'a>,
    inner: InnerProduct<'a>,
    /// None while another one is made.
    inverse: Option<Inverse<'a>>,
    /// s of the inverse of `A + s diag(M)`; by products of A and the mean of that.
    shift: f64,
    shifts: usize,
    /// The largest one that was not enough.
    refused: f64,
    /// `M_ii`, and the means of `A_ii` and of these.
    masses: Vec<f64>,
    means: (f64, f64),
    unknowns: usize,
    /// Vectors of the block.
    block: usize,
    basis: Vec<Vec<f64>>,
    /// `A x`, or with a factor `B x`.
    images: Vec<Vec<f64>>,
    /// `x_i . A x_k` of the basis, or `x_i . M B x_k`, `k <= i`.
    projected: Vec<Vec<f64>>,
    random: Random,
    /// Iterations so far, those of smaller blocks too.
    iterations: usize,
}

/// What stands for `(A + s M)^-1`.
enum Inverse<'a> {
    Levels(Box<ShiftedLevels<'a>>),
    Factor(ShiftedFactor<'a>),
}

/// Ritz values, ascending, and the coefficients of their vectors.
struct Ritz {
    values: Vec<f64>,
    vectors: DMatrix<f64>,
}

impl<'a> Search<'a> {
    fn begin(problem: &'a Eigenproblem<'a>, unknowns: usize) -> Result<Self, LinearError> {
        let System { fixed, parallel, .. } = problem.system;
        let masses = problem.mass_diagonal();
        let means = (problem.mean(&problem.diagonal()), problem.mean(&masses));
        let mut search = Search {
            problem,
            inner: InnerProduct { mass: problem.mass, fixed, parallel },
            inverse: None,
            shift: 0.0,
            shifts: 0,
            refused: 0.0,
            masses,
            means,
            unknowns,
            block: 0,
            basis: Vec::new(),
            images: Vec::new(),
            projected: Vec::new(),
            random: Random::new(0),
            iterations: 0,
        };
        search.invert(0.0)?;
        Ok(search)
    }

    /// A larger block: vectors of random numbers that the inverse has smoothed.
    fn widen(&mut self, block: usize, wanted: usize) -> Result<(), LinearError> {
        let fixed = self.inner.fixed;
        for _ in self.block..block {
            let scattered: Vec<f64> =
                fixed.iter().map(|&fixed| if fixed { 0.0 } else { self.random.symmetric() }).collect();
            let smooth = match &self.inverse {
                Some(Inverse::Factor(factor)) => factor.images(&self.inner, &[&scattered]).pop(),
                Some(Inverse::Levels(levels)) => Some(levels.apply(&self.inner.times_mass(&scattered))),
                None => None,
            };
            // levels of a singular matrix leave its kernel alone
            let added = smooth.is_some_and(|smooth| self.add(smooth));
            if !added && self.by_levels() {
                self.add(scattered);
            }
        }
        self.complete();
        self.block = block;
        if self.basis.len() < block { Err(LinearError::Eigenpairs { found: 0, wanted }) } else { Ok(()) }
    }

    fn by_levels(&self) -> bool {
        matches!(self.problem.inverse, ApproximateInverse::Multigrid { .. })
    }

    /// Adds what a vector has beyond the basis; whether that is anything.
    fn add(&mut self, mut vector: Vec<f64>) -> bool {
        vector.iter_mut().zip(self.inner.fixed).for_each(|(x, &fixed)| *x = if fixed { 0.0 } else { *x });
        let size = self.inner.square(&vector).sqrt();
        let (_, left) = self.inner.orthogonalize(&mut vector, self.basis.iter());
        if !left.is_finite() || left <= SPANNED * size {
            return false;
        }
        vector.iter_mut().for_each(|x| *x /= left);
        self.basis.push(vector);
        true
    }

    /// Makes the images of what was added, and what they are by the basis.
    fn complete(&mut self) {
        let fresh: Vec<&[f64]> = self.basis[self.images.len()..].iter().map(Vec::as_slice).collect();
        let images = match &self.inverse {
            Some(Inverse::Factor(factor)) => factor.images(&self.inner, &fresh),
            _ => fresh.iter().map(|x| self.product(x)).collect(),
        };
        self.images.extend(images);
        let rows: Vec<Vec<f64>> = (self.projected.len()..self.basis.len()).map(|at| self.row(at)).collect();
        self.projected.extend(rows);
    }

    fn product(&self, x: &[f64]) -> Vec<f64> {
        let mut product = vec![0.0; x.len()];
        self.problem.product.apply(x, &mut product);
        product
    }

    fn row(&self, at: usize) -> Vec<f64> {
        let image = &self.images[at];
        let weighted = if self.by_levels() { Cow::Borrowed(image) } else { Cow::Owned(self.inner.times_mass(image)) };
        self.basis[..=at].iter().map(|x| dot(x, &weighted, self.inner.parallel)).collect()
    }

    fn ritz(&self) -> Ritz {
        let SymmetricEigen { eigenvalues, eigenvectors } =
            DMatrix::from_fn(self.basis.len(), self.basis.len(), |i, k| self.projected[i.max(k)][i.min(k)])
                .symmetric_eigen();
        let value = |theta: f64| match self.by_levels() {
            true => theta,
            false if theta > 0.0 => 1.0 / theta - self.shift,
            false => f64::INFINITY,
        };
        let values: Vec<f64> = eigenvalues.iter().map(|&theta| value(theta)).collect();
        let mut order: Vec<usize> = (0..values.len()).collect();
        order.sort_by(|&a, &b| values[a].total_cmp(&values[b]));
        let values = order.iter().map(|&k| values[k]).collect();
        Ritz { values, vectors: eigenvectors.select_columns(&order) }
    }

    /// Until so many pairs count.
    fn run(&mut self, wanted: usize) -> Result<Eigenpairs, LinearError> {
        let (mut before, mut found) = (DMatrix::zeros(0, 0), 0);
        for _ in 0..MOST {
            if self.problem.cancel.is_some_and(|cancel| cancel.load(Ordering::Relaxed)) {
                return Err(LinearError::Cancelled);
            }
            self.iterations += 1;
            let ritz = self.ritz();
            if self.adapt_shift(&ritz)? && !self.by_levels() {
                before = self.restart(&ritz, &DMatrix::zeros(0, 0), self.block.min(self.basis.len()), true);
                continue;
            }
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
            if self.basis.len() + directions.len() > LONGEST * self.block {
                before = self.restart(&ritz, &before, block, false);
            } else {
                before = ritz.vectors.columns(0, block).into_owned();
            }
            let grown =
                directions.into_iter().map(|direction| self.add(direction)).fold(false, |any, grown| any | grown);
            self.complete();
            if !grown {
                // nothing is left beyond the space, or what is left is no number
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

    /// The preconditioned residual of a Ritz pair, and the relative error of its vector that this shows; with a factor a multiple of it.
    fn correction(&self, ritz: &Ritz, k: usize) -> (Vec<f64>, f64) {
        let parallel = self.inner.parallel;
        let coefficients = ritz.vectors.column(k);
        let x = combined(&self.basis, coefficients.as_slice(), parallel);
        let mut residual = combined(&self.images, coefficients.as_slice(), parallel);
        let value = ritz.values[k];
        let Some(Inverse::Levels(levels)) = &self.inverse else {
            let [theta, largest] = [value, ritz.values[0]].map(|value| 1.0 / (value + self.shift));
            sums::zipped(&mut residual, &x, parallel, |r, x| *r -= theta * x);
            let error = self.inner.square(&residual).sqrt();
            return (residual, TOLERANCE * error / (EXACT * theta).max(LEAST * largest));
        };
        sums::zipped(&mut residual, &self.inner.times_mass(&x), parallel, |r, mx| *r -= value * mx);
        residual.iter_mut().zip(self.inner.fixed).for_each(|(r, &fixed)| *r = if fixed { 0.0 } else { *r });
        let direction = levels.apply(&residual);
        let size = sums::norm(&residual, parallel);
        // where the preconditioner shows no energy of the error, a bound of it
        let squared = match dot(&residual, &direction, parallel) {
            squared if squared > 0.0 => squared,
            _ => match size * sums::norm(&direction, parallel) {
                0.0 if size > 0.0 => f64::INFINITY,
                bound => bound,
            },
        };
        (direction, (squared / (value + self.shift).max(f64::MIN_POSITIVE)).sqrt())
    }

    /// An inverse for a shift that is at a distance from the lowest eigenvalue, where the one at hand is not; whether it is another one.
    fn adapt_shift(&mut self, ritz: &Ritz) -> Result<bool, LinearError> {
        let (first, last) = (ritz.values[0], ritz.values[self.block.min(ritz.values.len()) - 1]);
        let (spread, distance) = (last - first, first + self.shift);
        let mut least = LEAST_SHARE * spread;
        if !self.by_levels() {
            let x = combined(&self.basis, ritz.vectors.column(0).as_slice(), self.inner.parallel);
            least = least.max(SEPARATION * self.problem.rounding(&[x])[0]);
        }
        let too_far = self.shift > 0.0 && distance > spread;
        let needed = ((SHARE * spread).max(least) - first).max(0.0);
        let serves = distance >= least && !(too_far && needed > self.refused);
        if self.shifts == SHIFTS || spread <= 0.0 || !spread.is_finite() || serves {
            return Ok(false);
        }
        self.shifts += 1;
        self.invert(needed)?;
        Ok(true)
    }

    /// The inverse of the first shift from this one on that is large enough as far as it shows.
    fn invert(&mut self, from: f64) -> Result<(), LinearError> {
        self.inverse = None;
        let (stiffness, mass) = self.means;
        let (least, most) = (LEAST_SHIFT * stiffness / mass, MOST_SHIFT * stiffness / mass);
        self.shift = from;
        while self.shift <= most {
            let made = match self.problem.inverse {
                ApproximateInverse::Factor(by) => ShiftedFactor::new(self.problem, by, self.shift).map(Inverse::Factor),
                ApproximateInverse::Multigrid { .. } => {
                    let levels = ShiftedLevels::new(&self.problem.system, self.shift, (&self.masses, mass));
                    levels.map(|made| Inverse::Levels(Box::new(made))).map_err(LinearError::from)
                }
            };
            match made {
                Err(LinearError::Factor(FactorError::NotPositive { .. })) => {
                    self.refused = self.refused.max(self.shift);
                    self.shift = (SHIFT_GROWTH * self.shift).max(least);
                }
                made => {
                    self.inverse = Some(made?);
                    return Ok(());
                }
            }
        }
        Err(LinearError::Shift)
    }

    /// Keeps the Ritz vectors of the block, and what those before have beyond them; their coefficients in the new basis.
    fn restart(&mut self, ritz: &Ritz, before: &DMatrix<f64>, block: usize, moved: bool) -> DMatrix<f64> {
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
            if left > SPANNED.sqrt() {
                own.iter_mut().for_each(|x| *x /= left);
                kept.push(own);
            }
        }
        let parallel = self.inner.parallel;
        let all = |vectors: &[Vec<f64>]| kept.iter().map(|c| combined(vectors, c, parallel)).collect::<Vec<_>>();
        self.basis = all(&self.basis);
        self.images = if moved { Vec::new() } else { all(&self.images) };
        self.projected.clear();
        self.complete();
        let n = self.basis.len();
        DMatrix::identity(n, block)
    }

    /// The first pairs, as many as there are errors of them.
    fn pairs(&self, ritz: &Ritz, errors: Vec<f64>) -> Eigenpairs {
        let parallel = self.inner.parallel;
        // of each alone: sums over a basis have the rounding of its roughest vectors
        let of = |k: usize| {
            let x = combined(&self.basis, ritz.vectors.column(k).as_slice(), parallel);
            let product = self.product(&x);
            (dot(&x, &product, parallel) / self.inner.square(&x), x)
        };
        let mut pairs: Vec<((f64, Vec<f64>), f64)> =
            errors.into_iter().enumerate().map(|(k, error)| (of(k), error)).collect();
        pairs.sort_by(|((a, _), _), ((b, _), _)| a.total_cmp(b));
        let (pairs, errors): (Vec<(f64, Vec<f64>)>, Vec<f64>) = pairs.into_iter().unzip();
        let (values, vectors): (Vec<f64>, Vec<Vec<f64>>) = pairs.into_iter().unzip();
        let rounding = self.problem.rounding(&vectors);
        let by_products = self.by_levels().then_some(ByProducts { iterations: self.iterations, errors });
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
