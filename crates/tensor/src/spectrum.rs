//! [`SymmetricSpectrum`]: eigenvalues and eigenvectors of a symmetric tensor.

use crate::{Mat3, Vec3};

/// Eigenvalues and orthonormal eigenvectors of a symmetric 3x3 tensor, by Jacobi's rotations: both to rounding relative to the tensor, of a positive definite one
/// small eigenvalues too relative to themselves, whether some coincide or not. In no particular order.
///
/// **Source.** C. G. J. Jacobi (1846); H. Rutishauser, Numer. Math. 9 (1966) 1-10, doi 10.1007/BF02165223; accuracy by J. Demmel & K. Veselic, SIAM J. Matrix Anal. Appl. 13
/// (1992) 1204-1245, doi 10.1137/0613074.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SymmetricSpectrum {
    /// Eigenvalues.
    pub values: Vec3,
    /// Eigenvectors, column by column.
    pub axes: Mat3,
}

/// Off-diagonal entries below this share of the smaller of both diagonal ones change neither.
const NEGLIGIBLE: f64 = 0.125 * f64::EPSILON;
/// Sweeps at most; convergence is quadratic, and takes three to five.
const MAX_SWEEPS: usize = 16;

impl SymmetricSpectrum {
    /// Of a symmetric tensor, whose lower triangle is read. Entries that are no finite numbers give such eigenvalues.
    #[must_use]
    pub fn new(a: &Mat3) -> Self {
        let mut diagonal = [a[(0, 0)], a[(1, 1)], a[(2, 2)]];
        // entry k is that of the two axes other than k
        let mut beside = [a[(2, 1)], a[(2, 0)], a[(1, 0)]];
        let mut axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        for _ in 0..MAX_SWEEPS {
            let mut turned = false;
            for (p, q, r) in [(0, 1, 2), (0, 2, 1), (1, 2, 0)] {
                turned |= turn(&mut diagonal, &mut beside, &mut axes, p, q, r);
            }
            if !turned {
                break;
            }
        }
        let [x, y, z] = axes.map(Vec3::from);
        SymmetricSpectrum { values: diagonal.into(), axes: Mat3::from_columns(&[x, y, z]) }
    }
}

/// Makes the entry of the axes p and q zero; r is the third axis. Whether it had to.
fn turn(
    diagonal: &mut [f64; 3],
    beside: &mut [f64; 3],
    axes: &mut [[f64; 3]; 3],
    p: usize,
    q: usize,
    r: usize,
) -> bool {
    let entry = beside[r];
    if entry.abs() <= NEGLIGIBLE * diagonal[p].abs().min(diagonal[q].abs()) || !entry.is_finite() {
        beside[r] = if entry.is_finite() { 0.0 } else { entry };
        return false;
    }
    let theta = (diagonal[q] - diagonal[p]) / (2.0 * entry);
    let t = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
    let cosine = 1.0 / (t * t + 1.0).sqrt();
    let sine = t * cosine;
    diagonal[p] -= t * entry;
    diagonal[q] += t * entry;
    beside[r] = 0.0;
    // the entries of p and r, and of q and r
    let (with_p, with_q) = (beside[q], beside[p]);
    beside[q] = cosine * with_p - sine * with_q;
    beside[p] = sine * with_p + cosine * with_q;
    let (old_p, old_q) = (axes[p], axes[q]);
    for k in 0..3 {
        axes[p][k] = cosine * old_p[k] - sine * old_q[k];
        axes[q][k] = sine * old_p[k] + cosine * old_q[k];
    }
    true
}
