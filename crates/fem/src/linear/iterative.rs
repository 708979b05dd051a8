//! Conjugate gradients with a preconditioner (a factor of a nearby matrix, multigrid), and iterative refinement.

use super::factor::Factor;

/// An approximate inverse, symmetric and positive definite: `vector = M^-1 vector`.
pub trait Preconditioner {
    /// Overwrites the vector, dofs by mesh node.
    fn apply(&self, vector: &mut [f64]);
}

impl Preconditioner for Factor {
    fn apply(&self, vector: &mut [f64]) {
        self.solve(vector, 1);
    }
}

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

/// Solves `A x = b` by preconditioned conjugate gradients, from the given `x` (which may be zero).
///
/// `apply(v, out)` sets `out = A v` for a symmetric `A`. Stops at `|b - A x| <= tolerance |b|` or after
/// `max_iterations` applications of the preconditioner; `x` is always the best iterate so far by construction of the method.
/// Hestenes, Stiefel, J. Res. NBS 49 (1952).
pub fn conjugate_gradient(
    apply: &dyn Fn(&[f64], &mut [f64]),
    preconditioner: &dyn Preconditioner,
    b: &[f64],
    x: &mut [f64],
    tolerance: f64,
    max_iterations: usize,
) -> CgReport {
    let n = b.len();
    let target = tolerance * norm(b);
    let mut r = b.to_vec();
    if x.iter().any(|&x| x != 0.0) {
        residual(apply, b, x, &mut r);
    }
    let (mut p, mut ap) = (vec![0.0; n], vec![0.0; n]);
    let (mut asked, mut rz_before) = (f64::INFINITY, 0.0);
    let mut iterations = 0;
    let end = loop {
        let size = norm(&r);
        if !size.is_finite() {
            break CgEnd::NotFinite;
        }
        if size <= target {
            // The recurrence drifts from the truth: ask once more.
            residual(apply, b, x, &mut r);
            let true_size = norm(&r);
            if true_size <= target {
                break CgEnd::Converged;
            }
            if true_size > 0.5 * asked {
                break CgEnd::Stagnated;
            }
            (asked, rz_before) = (true_size, 0.0);
        }
        if iterations == max_iterations {
            break CgEnd::Exhausted;
        }
        let mut z = r.clone();
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
        p.iter_mut().zip(&z).for_each(|(p, z)| *p = z + beta * *p);
        apply(&p, &mut ap);
        let curvature = dot(&p, &ap);
        if curvature.is_nan() {
            break CgEnd::NotFinite;
        }
        if curvature <= 0.0 {
            break CgEnd::NegativeCurvature { curvature: curvature / dot(&p, &p) };
        }
        let step = rz / curvature;
        x.iter_mut().zip(&p).for_each(|(x, p)| *x += step * p);
        r.iter_mut().zip(&ap).for_each(|(r, ap)| *r -= step * ap);
    };
    // At these two ends it has just been recomputed.
    if !matches!(end, CgEnd::Converged | CgEnd::Stagnated) {
        residual(apply, b, x, &mut r);
    }
    CgReport { end, iterations, residual: relative(norm(&r), norm(b)) }
}

/// Improves `x` by `x += M^-1 (b - A x)` until `|b - A x| <= tolerance |b|`, the residual stops falling, or
/// `max_iterations` back substitutions are used. Works for indefinite `A` whose factor is (nearly) exact.
pub fn refine(
    apply: &dyn Fn(&[f64], &mut [f64]),
    factor: &Factor,
    b: &[f64],
    x: &mut [f64],
    tolerance: f64,
    max_iterations: usize,
) -> CgReport {
    let scale = norm(b);
    let mut r = vec![0.0; b.len()];
    residual(apply, b, x, &mut r);
    let mut size = norm(&r);
    let mut iterations = 0;
    let end = loop {
        if !size.is_finite() {
            break CgEnd::NotFinite;
        }
        if size <= tolerance * scale {
            break CgEnd::Converged;
        }
        if iterations == max_iterations {
            break CgEnd::Exhausted;
        }
        let before = x.to_vec();
        factor.solve(&mut r, 1);
        iterations += 1;
        x.iter_mut().zip(&r).for_each(|(x, dx)| *x += dx);
        residual(apply, b, x, &mut r);
        let improved = norm(&r);
        if improved.is_nan() || improved >= size {
            x.copy_from_slice(&before);
            break CgEnd::Exhausted;
        }
        size = improved;
    };
    CgReport { end, iterations, residual: relative(size, scale) }
}

fn residual(apply: &dyn Fn(&[f64], &mut [f64]), b: &[f64], x: &[f64], r: &mut [f64]) {
    apply(x, r);
    r.iter_mut().zip(b).for_each(|(r, b)| *r = b - *r);
}

fn relative(size: f64, scale: f64) -> f64 {
    if size == 0.0 { 0.0 } else { size / scale }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}
