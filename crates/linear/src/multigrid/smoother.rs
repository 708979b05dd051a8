//! The smoother: Chebyshev polynomials in the matrix scaled by its diagonal blocks.

use nalgebra::DMatrix;
use nastic_numeric::vector::dot;

use super::block_matrix::BlockMatrix;

/// Lanczos steps for the largest eigenvalue, and what the bound is raised by.
const LANCZOS_STEPS: usize = 12;
const SAFETY: f64 = 1.08;

/// `x += q(D^-1 A) D^-1 (b - A x)` with D the diagonal blocks of A and `1 - t q(t)` the Chebyshev polynomial of the
/// fourth kind on `(0, bound]`: the one that multigrid gains most by, without a guess of the lowest eigenvalue to be
/// smoothed. Lottes, Numer. Linear Algebra Appl. 30 (2023), e2518. Symmetric, and positive as long as `bound` holds.
#[derive(Debug)]
pub(super) struct Smoother {
    /// Inverses of the diagonal blocks.
    inverse: BlockMatrix<f32>,
    /// Above the largest eigenvalue of `D^-1 A`.
    pub bound: f64,
    degree: usize,
}

/// Block row whose diagonal block is not positive definite.
pub(super) struct NotPositive(pub usize);

impl Smoother {
    pub fn new(matrix: &BlockMatrix<f64>, degree: usize, parallel: bool) -> Result<Self, NotPositive> {
        let mut inverse = BlockMatrix {
            shape: matrix.shape,
            block_columns: matrix.rows(),
            starts: (0..=matrix.rows()).collect(),
            columns: (0..matrix.rows() as u32).collect(),
            values: Vec::with_capacity(matrix.rows() * matrix.shape.0 * matrix.shape.1),
        };
        for i in 0..matrix.rows() {
            let block = matrix.diagonal_block(i).ok_or(NotPositive(i))?;
            let n = matrix.shape.0;
            let cholesky = DMatrix::from_column_slice(n, n, block).cholesky().ok_or(NotPositive(i))?;
            let mut inverted = cholesky.inverse();
            inverted.fill_lower_triangle_with_upper_triangle();
            inverse.values.extend(inverted.iter().map(|&value| value as f32));
        }
        let largest = largest_eigenvalue(matrix, &inverse, parallel);
        if !largest.is_finite() || largest <= 0.0 {
            return Err(NotPositive(0));
        }
        Ok(Smoother { inverse, bound: SAFETY * largest, degree })
    }

    /// `D^-1 A`, for the smoothing of prolongators.
    pub fn scale(&self, matrix: &mut BlockMatrix<f64>) {
        let n = matrix.shape.0;
        let size = matrix.shape.0 * matrix.shape.1;
        for i in 0..matrix.rows() {
            let inverse = self.inverse.block(i);
            for column in matrix.values[size * matrix.starts[i]..size * matrix.starts[i + 1]].chunks_exact_mut(n) {
                let before = column.to_vec();
                for (r, value) in column.iter_mut().enumerate() {
                    *value = (0..n).map(|k| f64::from(inverse[n * k + r]) * before[k]).sum();
                }
            }
        }
    }

    /// One application. On entry `r = b - A x`; it is used up. `d` and `z` are working memory.
    pub fn apply(
        &self,
        matrix: &BlockMatrix<f32>,
        x: &mut [f64],
        r: &mut [f64],
        work: [&mut [f64]; 2],
        parallel: bool,
    ) {
        let [d, z] = work;
        self.inverse.multiply(r, d, parallel);
        let first = 4.0 / (3.0 * self.bound);
        d.iter_mut().zip(x.iter_mut()).for_each(|(d, x)| {
            *d *= first;
            *x += *d;
        });
        for k in 1..self.degree {
            matrix.subtract(d, r, parallel);
            self.inverse.multiply(r, z, parallel);
            let k = k as f64;
            let (old, new) = ((2.0 * k - 1.0) / (2.0 * k + 3.0), (8.0 * k + 4.0) / ((2.0 * k + 3.0) * self.bound));
            for ((d, z), x) in d.iter_mut().zip(z.iter()).zip(x.iter_mut()) {
                *d = old * *d + new * z;
                *x += *d;
            }
        }
    }
}

/// Lanczos' method for `D^-1 A` in the product of D, from a fixed start. The value is approached from below.
fn largest_eigenvalue(matrix: &BlockMatrix<f64>, inverse: &BlockMatrix<f32>, parallel: bool) -> f64 {
    let n = matrix.shape.0 * matrix.rows();
    // r = D w throughout, so that D itself is never needed
    let mut r = scattered(n);
    let mut w = vec![0.0; n];
    inverse.multiply(&r, &mut w, parallel);
    let (mut before, mut z) = (vec![0.0; n], vec![0.0; n]);
    let (mut alpha, mut beta) = (Vec::new(), vec![dot(&r, &w).max(0.0).sqrt()]);
    for k in 0..LANCZOS_STEPS.min(n) {
        let length = beta[k];
        if length <= f64::EPSILON * beta[0] {
            break;
        }
        r.iter_mut().for_each(|r| *r /= length);
        w.iter_mut().for_each(|w| *w /= length);
        matrix.multiply(&w, &mut z, parallel);
        let here = dot(&w, &z);
        alpha.push(here);
        let back = if k == 0 { 0.0 } else { length };
        for ((z, r), before) in z.iter_mut().zip(&r).zip(&before) {
            *z -= here * r + back * before;
        }
        std::mem::swap(&mut before, &mut r);
        std::mem::swap(&mut r, &mut z);
        inverse.multiply(&r, &mut w, parallel);
        beta.push(dot(&r, &w).max(0.0).sqrt());
    }
    let entry = |i: usize, j: usize| match i.abs_diff(j) {
        0 => alpha[i],
        1 => beta[i.max(j)],
        _ => 0.0,
    };
    let tridiagonal = DMatrix::from_fn(alpha.len(), alpha.len(), entry);
    tridiagonal.symmetric_eigenvalues().iter().fold(f64::NEG_INFINITY, |most, &value| most.max(value))
}

/// Numbers in [-1, 1) without a pattern, the same every time (xorshift64).
fn scattered(n: usize) -> Vec<f64> {
    let mut state = 0x9E37_79B9_7F4A_7C15_u64;
    let next = |_| {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    };
    (0..n).map(next).collect()
}
