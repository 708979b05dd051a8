//! Preconditioned conjugate gradients on operators given as closures.

use nastic_numeric::vector::{axpy, dot};

/// Solves A x = b to a relative residual in the preconditioner's norm. Every iterate x satisfies b . x > 0 (b != 0), so
/// a solve that ends early still gives a descent direction.
pub(crate) fn conjugate_gradient(
    apply: impl Fn(&[f64]) -> Vec<f64>,
    precondition: impl Fn(&[f64]) -> Vec<f64>,
    b: &[f64],
    tolerance: f64,
    max_iterations: usize,
) -> Vec<f64> {
    let mut x = vec![0.0; b.len()];
    let mut r = b.to_vec();
    let mut z = precondition(&r);
    let mut p = z.clone();
    let mut rz = dot(&r, &z);
    let first = rz;
    for _ in 0..max_iterations {
        let ap = apply(&p);
        let curvature = dot(&p, &ap);
        // Also terminates at NaN.
        let goes_on = rz > tolerance * tolerance * first && curvature > 0.0;
        if !goes_on {
            break;
        }
        let alpha = rz / curvature;
        axpy(alpha, &p, &mut x);
        axpy(-alpha, &ap, &mut r);
        z = precondition(&r);
        let next = dot(&r, &z);
        let beta = next / rz;
        rz = next;
        for (p, z) in p.iter_mut().zip(&z) {
            *p = z + beta * *p;
        }
    }
    x
}
