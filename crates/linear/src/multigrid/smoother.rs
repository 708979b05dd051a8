//! The smoother: Chebyshev polynomials in the matrix scaled by its diagonal blocks.

use nalgebra::DMatrix;

use super::block_matrix::{BlockMatrix, with_size};
use super::chunks::{self, CHUNK};
use crate::sums::{self, dot};

/// Lanczos steps for the largest eigenvalue.
const LANCZOS_STEPS: usize = 12;
/// Safety factor of the bound.
const BOUND_SAFETY: f64 = 1.08;

/// `x += q(D^-1 A) D^-1 (b - A x)` with D the diagonal blocks of A and `1 - t q(t)` the Chebyshev polynomial of the
/// fourth kind on `(0, bound]`: the one that multigrid gains most by, without a guess of the lowest eigenvalue to be
/// smoothed. Lottes, Numer. Linear Algebra Appl. 30 (2023), e2518. Symmetric, and positive as long as `bound` holds.
#[derive(Debug, Default)]
pub(super) struct Smoother {
    /// Inverses of the diagonal blocks, column by column.
    inverse: Vec<f32>,
    /// Above the largest eigenvalue of `D^-1 A`.
    pub bound: f64,
    degree: usize,
}

/// Block row whose diagonal block is not positive definite.
pub(super) struct NotPositive(pub usize);

impl Smoother {
    /// One of a degree, of no matrix yet.
    pub fn new(degree: usize) -> Self {
        Smoother { degree, ..Smoother::default() }
    }

    /// Becomes that of a matrix with these symmetric blocks on its diagonal.
    pub fn fill<'d>(
        &mut self,
        matrix: &BlockMatrix,
        diagonal: impl Fn(usize) -> Option<&'d [f64]> + Sync + Send,
        parallel: bool,
    ) -> Result<(), NotPositive> {
        with_size!(matrix.couplings.size, self.invert(matrix.couplings.rows.rows(), &diagonal, parallel))?;
        let largest = with_size!(matrix.couplings.size, self.largest_eigenvalue(matrix, parallel));
        if !largest.is_finite() || largest <= 0.0 {
            return Err(NotPositive(0));
        }
        self.bound = BOUND_SAFETY * largest;
        Ok(())
    }

    fn invert<'d, const N: usize>(
        &mut self,
        rows: usize,
        diagonal: &(impl Fn(usize) -> Option<&'d [f64]> + Sync + Send),
        parallel: bool,
    ) -> Result<(), NotPositive> {
        let of_chunk = |range: std::ops::Range<usize>| {
            let inverted = |i| diagonal(i).and_then(inverted::<N>).ok_or(NotPositive(i));
            range.map(inverted).collect::<Result<Vec<_>, _>>()
        };
        self.inverse.clear();
        for part in chunks::map(rows, parallel, of_chunk) {
            self.inverse.extend_from_slice(part?.as_flattened().as_flattened());
        }
        Ok(())
    }

    /// Memory, in bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.inverse[..])
    }

    /// The inverse of the diagonal block of a row, column by column.
    #[inline(always)]
    pub fn inverse_block<const N: usize>(&self, i: usize) -> &[[f32; N]] {
        &self.inverse.as_chunks::<N>().0[N * i..N * (i + 1)]
    }

    /// `D_i^-1 r`.
    #[inline(always)]
    fn scaled<const N: usize>(&self, i: usize, r: &[f64; N]) -> [f64; N] {
        let (block, mut z) = (self.inverse_block::<N>(i), [0.0; N]);
        for c in 0..N {
            for k in 0..N {
                z[k] += f64::from(block[c][k]) * r[c];
            }
        }
        z
    }

    /// One application. On entry `r = b - A x`; on return it lacks the last of the corrections that x has, which is `d`:
    /// `r - A d` is the residual. With `fresh`, x counts as zero. `z` is working memory.
    pub fn apply(&self, matrix: &BlockMatrix, vectors: Working, fresh: bool, parallel: bool) {
        with_size!(matrix.couplings.size, self.apply_blocks(matrix, vectors, fresh, parallel));
    }

    fn apply_blocks<const N: usize>(&self, matrix: &BlockMatrix, vectors: Working, fresh: bool, parallel: bool) {
        let Working { x, r, d, z } = vectors;
        let first = 4.0 / (3.0 * self.bound);
        let parts = chunks::rows(x.as_chunks_mut::<N>().0, 1).zip(chunks::rows(d.as_chunks_mut::<N>().0, 1)).collect();
        let (residual, _) = r.as_chunks::<N>();
        chunks::each(parts, parallel, |k, (x, d): (&mut [[f64; N]], &mut [[f64; N]])| {
            for ((i, x), d) in (CHUNK * k..).zip(x).zip(d) {
                let z = self.scaled(i, &residual[i]);
                for c in 0..N {
                    d[c] = first * z[c];
                    x[c] = if fresh { d[c] } else { x[c] + d[c] };
                }
            }
        });
        for k in 1..self.degree {
            let k = k as f64;
            let factors = ((2.0 * k - 1.0) / (2.0 * k + 3.0), (8.0 * k + 4.0) / ((2.0 * k + 3.0) * self.bound));
            self.step::<N>(matrix, factors.0, factors.1, [x, r, z], d, parallel);
            std::mem::swap(d, z);
        }
    }

    /// `r -= A d, next = old d + new D^-1 r, x += next`, in one pass over the matrix.
    fn step<const N: usize>(
        &self,
        matrix: &BlockMatrix,
        old: f64,
        new: f64,
        [x, r, next]: [&mut Vec<f64>; 3],
        d: &[f64],
        parallel: bool,
    ) {
        let of_d = matrix.times::<N>(d, parallel);
        let (d, _) = d.as_chunks::<N>();
        let [x, r, next] = [x, r, next].map(|v| chunks::rows(v.as_chunks_mut::<N>().0, 1));
        let parts = x.zip(r).zip(next).collect();
        type Rows<'a, const N: usize> = &'a mut [[f64; N]];
        chunks::each(parts, parallel, |k, ((x, r), next): ((Rows<N>, Rows<N>), Rows<N>)| {
            let first = CHUNK * k;
            of_d.rows(first..first + x.len(), |at, product| {
                let r = &mut r[at];
                (0..N).for_each(|c| r[c] -= product[c]);
                let z = self.scaled(first + at, r);
                for c in 0..N {
                    next[at][c] = old * d[first + at][c] + new * z[c];
                    x[at][c] += next[at][c];
                }
            });
        });
    }

    /// Lanczos' method for `D^-1 A` in the product of D, from a fixed start. The value is approached from below.
    fn largest_eigenvalue<const N: usize>(&self, matrix: &BlockMatrix, parallel: bool) -> f64 {
        let n = matrix.couplings.unknowns();
        // r = D w throughout, so that D itself is never needed
        let mut r = scattered(n);
        let mut w = vec![0.0; n];
        let scale = |r: &[f64], w: &mut [f64]| {
            let (r, _) = r.as_chunks::<N>();
            chunks::each(chunks::rows(w.as_chunks_mut::<N>().0, 1).collect(), parallel, |k, w: &mut [[f64; N]]| {
                (CHUNK * k..).zip(w).for_each(|(i, w)| *w = self.scaled(i, &r[i]));
            });
        };
        scale(&r, &mut w);
        let (mut before, mut z) = (vec![0.0; n], vec![0.0; n]);
        let (mut alpha, mut beta) = (Vec::new(), vec![dot(&r, &w, parallel).max(0.0).sqrt()]);
        for k in 0..LANCZOS_STEPS.min(n) {
            let length = beta[k];
            if length <= f64::EPSILON * beta[0] {
                break;
            }
            sums::zipped(&mut r, &w, parallel, |r, _| *r /= length);
            sums::zipped(&mut w, &before, parallel, |w, _| *w /= length);
            matrix.multiply(&w, &mut z, parallel);
            let here = dot(&w, &z, parallel);
            alpha.push(here);
            let back = if k == 0 { 0.0 } else { length };
            sums::zipped(&mut z, &r, parallel, |z, r| *z -= here * r);
            sums::zipped(&mut z, &before, parallel, |z, before| *z -= back * before);
            std::mem::swap(&mut before, &mut r);
            std::mem::swap(&mut r, &mut z);
            scale(&r, &mut w);
            beta.push(dot(&r, &w, parallel).max(0.0).sqrt());
        }
        largest_of_tridiagonal(&alpha, &beta)
    }
}

/// The vectors that an application works on.
pub(super) struct Working<'a> {
    pub x: &'a mut Vec<f64>,
    pub r: &'a mut Vec<f64>,
    pub d: &'a mut Vec<f64>,
    pub z: &'a mut Vec<f64>,
}

fn largest_of_tridiagonal(alpha: &[f64], beta: &[f64]) -> f64 {
    let entry = |i: usize, j: usize| match i.abs_diff(j) {
        0 => alpha[i],
        1 => beta[i.max(j)],
        _ => 0.0,
    };
    let tridiagonal = DMatrix::from_fn(alpha.len(), alpha.len(), entry);
    tridiagonal.symmetric_eigenvalues().iter().fold(f64::NEG_INFINITY, |most, &value| most.max(value))
}

/// The inverse of a symmetric block, column by column; nothing where it is not positive definite. By Cholesky's factor L:
/// `B^-1 = L^-T L^-1`.
fn inverted<const N: usize>(block: &[f64]) -> Option<[[f32; N]; N]> {
    let mut l = [[0.0; N]; N];
    for r in 0..N {
        for c in 0..=r {
            let rest = block[N * c + r] - (0..c).map(|k| l[r][k] * l[c][k]).sum::<f64>();
            l[r][c] = match r == c {
                true if rest > 0.0 => rest.sqrt(),
                true => return None,
                false => rest / l[c][c],
            };
        }
    }
    let mut inverse = [[0.0; N]; N];
    for c in 0..N {
        inverse[c][c] = 1.0 / l[c][c];
        for r in c + 1..N {
            inverse[r][c] = -(c..r).map(|k| l[r][k] * inverse[k][c]).sum::<f64>() / l[r][r];
        }
    }
    let entry = |r: usize, c: usize| (r.max(c)..N).map(|k| inverse[k][r] * inverse[k][c]).sum::<f64>();
    Some(std::array::from_fn(|r| std::array::from_fn(|c| entry(r, c) as f32)))
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
