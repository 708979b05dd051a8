//! Iterative refinement by a factor of the matrix.

use super::conjugate_gradients::{CgEnd, CgReport, relative, residual};
use crate::factor::symmetric::Factor;
use nastic_numeric::vector::norm;

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
