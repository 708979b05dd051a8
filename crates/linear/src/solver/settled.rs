//! [`settled`]: whether a solution is one, where its residual says little.

use super::System;
use crate::factor::symmetric::Factor;

/// Relative error of a solution by rounding alone.
const ROUNDING_ERROR: f64 = 1e-7;

/// Whether the factor's correction of x is below [`ROUNDING_ERROR`] of it: an estimate of the error, not of the residual.
pub(super) fn settled(system: &System, factor: &Factor, b: &[f64], x: &[f64]) -> bool {
    let mut correction = vec![0.0; b.len()];
    system.multiply(x, &mut correction);
    correction.iter_mut().zip(b).for_each(|(r, b)| *r = b - *r);
    factor.solve(&mut correction, 1);
    let size = |v: &[f64]| v.iter().map(|v| v * v).sum::<f64>();
    let (correction, x) = (size(&correction), size(x));
    x.is_finite() && correction <= ROUNDING_ERROR * ROUNDING_ERROR * x
}
