//! Conjugate gradients with a preconditioner: a factor of a nearby matrix, multigrid.

use crate::pattern::operator::Preconditioner;
use crate::sums;

/// Largest ratio of the true residual to the recursive one at which the steps taken are used.
const MAX_RESIDUAL_DRIFT: f64 = 2.0;

/// Why conjugate gradients stopped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CgEnd {
    /// The residual is small enough.
    Converged,
    /// The allowed number of iterations is used up.
    Exhausted,
    /// The residual itself no longer falls, whatever its recurrence says: double precision ends here.
    Stagnated,
    /// `curvature = p^T A p / p^T p <= 0` along a search direction: the operator is not positive definite.
    NegativeCurvature {
        /// The Rayleigh quotient found.
        curvature: f64,
    },
    /// The preconditioner is not positive definite: `r^T M^-1 r <= 0`.
    IndefinitePreconditioner,
    /// A NaN or infinity turned up.
    NotFinite,
}

/// What an iteration did.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CgReport {
    /// Why it stopped.
    pub end: CgEnd,
    /// Applications of the preconditioner (back substitutions where it is a factor).
    pub iterations: usize,
    /// `|b - A x| / |b|`, Euclidean, recomputed at the end and not carried along.
    pub residual: f64,
}

impl CgReport {
    /// Whether the residual is small enough.
    pub fn converged(&self) -> bool {
        self.end == CgEnd::Converged
    }
}

/// When a solution is good enough.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StoppingTest {
    /// `|b - A x| <= tolerance |b|`, Euclidean.
    Residual(f64),
    /// `|x - A^-1 b|_A <= tolerance |A^-1 b|_A` in the norm `|v|_A^2 = v . A v`, as far as an estimate shows: strains, stresses
    /// and what is linear in them are known as exactly as that, where a residual says little in a slender body.
    ///
    /// The k-th step takes `s_k = |x_{k+1} - x_k|_A` off the error exactly, so what it leaves is the sum of the steps to come
    /// (Hestenes, Stiefel; Strakos, Tichy, ETNA 13, 2002). Those are taken to shrink by the worse of the last two ratios.
    Error(f64),
    /// The least residual, or the error where the residual is within a thousand of it: of preconditioners that may be poor, whose steps
    /// say less of those to come.
    Either {
        /// As in [`Error`](Self::Error).
        error: f64,
        /// As in [`Residual`](Self::Residual).
        residual: f64,
    },
}

/// Residual over the one asked for, up to which an estimate of the error is used.
const RESIDUAL_RATIO: f64 = 1e3;
/// Largest residual at which an estimate of the error is used.
const MAX_RESIDUAL: f64 = 1e-4;

/// The residual within which an estimate of the error is believed where this one is asked for.
fn near(residual: f64) -> f64 {
    (RESIDUAL_RATIO * residual).min(MAX_RESIDUAL).max(residual)
}

impl StoppingTest {
    /// By the recurrence.
    fn is_met(&self, relative: f64, steps: &Steps, asked: f64) -> bool {
        match *self {
            StoppingTest::Residual(tolerance) => relative <= tolerance,
            StoppingTest::Error(tolerance) => {
                relative == 0.0 || steps.left() <= tolerance || corrected(steps, asked, tolerance)
            }
            StoppingTest::Either { error, residual } => {
                relative <= residual
                    || relative <= near(residual) && StoppingTest::Error(error).is_met(relative, steps, asked)
            }
        }
    }

    /// By the residual itself, where the recurrence had another one.
    fn holds(&self, relative: f64, carried: f64, steps: &Steps, asked: f64) -> bool {
        match *self {
            StoppingTest::Residual(tolerance) => relative <= tolerance,
            StoppingTest::Error(tolerance) => {
                relative <= MAX_RESIDUAL_DRIFT * carried || corrected(steps, asked, tolerance)
            }
            StoppingTest::Either { error, residual } => {
                relative <= residual
                    || relative <= near(residual) && StoppingTest::Error(error).holds(relative, carried, steps, asked)
            }
        }
    }
}

impl From<f64> for StoppingTest {
    /// A residual.
    fn from(tolerance: f64) -> Self {
        StoppingTest::Residual(tolerance)
    }
}

/// The lengths `s_k^2` of the steps so far.
#[derive(Default)]
struct Steps {
    /// Of the last three since the residual was last recomputed, newest first.
    last: [Option<f64>; 3],
    /// Of all.
    sum: f64,
}

impl Steps {
    fn add(&mut self, squared: f64) {
        let [newest, before, _] = self.last;
        self.last = [Some(squared), newest, before];
        self.sum += squared;
    }

    /// The error expected to be left, relative to the solution; after a single step nothing is known of the next.
    fn left(&self) -> f64 {
        let [Some(newest), Some(before), first] = self.last else { return f64::INFINITY };
        let ratio = (newest / before).max(first.map_or(0.0, |first| before / first));
        // s^2 (q + q^2 + ...)
        if ratio < 1.0 { (newest * ratio / (1.0 - ratio) / self.sum).sqrt() } else { f64::INFINITY }
    }

    /// The last step, relative to the solution.
    fn newest(&self) -> f64 {
        self.last[0].map_or(f64::INFINITY, |newest| (newest / self.sum).sqrt())
    }
}

/// Whether a recomputed residual has been corrected for, by a step that was as short as the error may be: the residual that is
/// there again afterwards is the limit of double precision.
fn corrected(steps: &Steps, asked: f64, tolerance: f64) -> bool {
    asked.is_finite() && steps.newest() <= tolerance
}

/// Solves `A x = b` by preconditioned conjugate gradients, from the given `x` (which may be zero).
///
/// `apply(v, out)` sets `out = A v` for a symmetric `A`. Stops where the aim (a number: of the relative residual) is met or after
/// `max_iterations` applications of the preconditioner; `x` is always the best iterate so far by construction of the method.
/// Hestenes, Stiefel, J. Res. NBS 49 (1952).
pub fn conjugate_gradient(
    apply: &dyn Fn(&[f64], &mut [f64]),
    preconditioner: &dyn Preconditioner,
    b: &[f64],
    x: &mut [f64],
    aim: impl Into<StoppingTest>,
    max_iterations: usize,
) -> CgReport {
    conjugate_gradient_while(apply, preconditioner, b, x, aim.into(), &|iterations, _| iterations < max_iterations)
}

/// The same while a number of iterations and the relative residual that they left, by the recurrence, allow another one.
pub(crate) fn conjugate_gradient_while(
    apply: &dyn Fn(&[f64], &mut [f64]),
    preconditioner: &dyn Preconditioner,
    b: &[f64],
    x: &mut [f64],
    aim: StoppingTest,
    go_on: &dyn Fn(usize, f64) -> bool,
) -> CgReport {
    let parallel = preconditioner.parallel();
    let dot = |a: &[f64], b: &[f64]| sums::dot(a, b, parallel);
    let norm = |a: &[f64]| sums::norm(a, parallel);
    let (n, scale) = (b.len(), norm(b));
    let mut r = b.to_vec();
    if x.iter().any(|&x| x != 0.0) {
        residual(apply, b, x, &mut r);
    }
    let (mut p, mut ap, mut z) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
    let (mut asked, mut rz_before) = (f64::INFINITY, 0.0);
    let (mut size, mut steps, mut iterations) = (norm(&r), Steps::default(), 0);
    let end = loop {
        if !size.is_finite() {
            break CgEnd::NotFinite;
        }
        if aim.is_met(relative(size, scale), &steps, asked) {
            // The recurrence drifts from the truth: ask once more.
            let carried = size;
            residual(apply, b, x, &mut r);
            size = norm(&r);
            let holds = aim.holds(relative(size, scale), relative(carried, scale), &steps, asked);
            if holds {
                break CgEnd::Converged;
            }
            if size > 0.5 * asked {
                break CgEnd::Stagnated;
            }
            (asked, rz_before, steps.last) = (size, 0.0, [None; 3]);
        }
        if !go_on(iterations, relative(size, scale)) {
            break CgEnd::Exhausted;
        }
        z.copy_from_slice(&r);
        preconditioner.apply(&mut z);
        iterations += 1;
        let rz = dot(&r, &z);
        if rz.is_nan() {
            break CgEnd::NotFinite;
        }
        if rz <= 0.0 {
            break CgEnd::IndefinitePreconditioner;
        }
        let beta = if rz_before > 0.0 { rz / rz_before } else { 0.0 };
        rz_before = rz;
        sums::zipped(&mut p, &z, parallel, |p, z| *p = z + beta * *p);
        apply(&p, &mut ap);
        let curvature = dot(&p, &ap);
        if curvature.is_nan() {
            break CgEnd::NotFinite;
        }
        if curvature <= 0.0 {
            break CgEnd::NegativeCurvature { curvature: curvature / dot(&p, &p) };
        }
        let step = rz / curvature;
        sums::zipped(x, &p, parallel, |x, p| *x += step * p);
        sums::zipped(&mut r, &ap, parallel, |r, ap| *r -= step * ap);
        steps.add(step * rz);
        size = norm(&r);
    };
    // At these two ends it has just been recomputed.
    if !matches!(end, CgEnd::Converged | CgEnd::Stagnated) {
        residual(apply, b, x, &mut r);
        size = norm(&r);
    }
    CgReport { end, iterations, residual: relative(size, scale) }
}

pub(super) fn residual(apply: &dyn Fn(&[f64], &mut [f64]), b: &[f64], x: &[f64], r: &mut [f64]) {
    apply(x, r);
    r.iter_mut().zip(b).for_each(|(r, b)| *r = b - *r);
}

pub(super) fn relative(size: f64, scale: f64) -> f64 {
    if size == 0.0 { 0.0 } else { size / scale }
}
