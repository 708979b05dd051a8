//! The element matrix, block by block: `K_ik = sum_q G_q^T C_ik(q) G_q`.

use super::{block_index, vectors, widest};
use nastic_tensor::Tangent;
use pulp::{Simd, WithSimd};
use std::array::from_fn;

/// See [`CellKernel::tangent`](super::CellKernel::tangent).
pub(super) struct Matrix<'a, const N: usize, const NP: usize, const D: usize> {
    pub g: &'a [f64],
    pub tangents: &'a [Tangent],
    pub matrix: &'a mut [f64],
    pub scratch: &'a mut Vec<f64>,
}

impl<const N: usize, const NP: usize, const D: usize> WithSimd for Matrix<'_, N, NP, D> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        self.scratch.resize(self.tangents.len() * D * NP, 0.0);
        let (g, _) = self.g.as_chunks::<NP>();
        let (t, _) = self.scratch.as_chunks_mut::<NP>();
        let (blocks, _) = self.matrix.as_chunks_mut::<NP>();
        for i in 0..D {
            for k in i..D {
                contract::<S, NP, D>(simd, g, self.tangents, i, k, t);
                let start = block_index(i, k, D) * N;
                product::<S, N, NP>(simd, g, t, &mut blocks[start..start + N], i == k);
            }
        }
    }
}

/// `t_J = sum_L C_iJkL g_L` at every point.
#[inline(always)]
fn contract<S: Simd, const NP: usize, const D: usize>(
    simd: S,
    g: &[[f64; NP]],
    tangents: &[Tangent],
    i: usize,
    k: usize,
    t: &mut [[f64; NP]],
) {
    for ((g, c), t) in g.as_chunks::<D>().0.iter().zip(tangents).zip(t.as_chunks_mut::<D>().0) {
        let c: [[S::f64s; D]; D] = from_fn(|j| from_fn(|l| simd.splat_f64s(c.0[9 * (3 * i + j) + 3 * k + l])));
        for v in 0..NP / S::F64_LANES {
            let g: [S::f64s; D] = from_fn(|l| vectors::<S, NP, 1>(&g[l], v)[0]);
            for (row, c) in t.iter_mut().zip(&c) {
                let mut sum = simd.mul_f64s(c[0], g[0]);
                for l in 1..D {
                    sum = simd.mul_add_e_f64s(c[l], g[l], sum);
                }
                S::as_mut_simd_f64s(row).0[v] = sum;
            }
        }
    }
}

/// `block[a][b] = sum_d g[d][a] t[d][b]`: a small matrix product, a few rows at a time so that the sums stay in
/// registers. Of a symmetric block only the vectors that hold entries `b <= a` are set.
#[inline(always)]
fn product<S: Simd, const N: usize, const NP: usize>(
    simd: S,
    g: &[[f64; NP]],
    t: &[[f64; NP]],
    block: &mut [[f64; NP]],
    symmetric: bool,
) {
    let reach = |end: usize| if symmetric { end.div_ceil(S::F64_LANES) } else { NP / S::F64_LANES };
    let mut a = 0;
    while a < N {
        if a + 8 <= N && reach(a + 8) <= widest::<S>() / 2 {
            rows::<S, NP, 8>(simd, g, t, a, reach(a + 8), block);
            a += 8;
        } else if N >= 4 {
            // The last rows are done together with some that are there already: whole tiles are faster than odd ones.
            let first = a.min(N - 4);
            rows::<S, NP, 4>(simd, g, t, first, reach(first + 4), block);
            a += 4;
        } else {
            rows::<S, NP, 1>(simd, g, t, a, reach(a + 1), block);
            a += 1;
        }
    }
}

/// `R` rows from row `a` on, the first `reach` vectors of each.
#[inline(always)]
fn rows<S: Simd, const NP: usize, const R: usize>(
    simd: S,
    g: &[[f64; NP]],
    t: &[[f64; NP]],
    a: usize,
    reach: usize,
    block: &mut [[f64; NP]],
) {
    let mut v = 0;
    while v < reach {
        v += match (reach - v).min(if R > 4 { widest::<S>() / 2 } else { widest::<S>() }) {
            4 => tile::<S, NP, R, 4>(simd, g, t, a, v, block),
            3 => tile::<S, NP, R, 3>(simd, g, t, a, v, block),
            2 => tile::<S, NP, R, 2>(simd, g, t, a, v, block),
            _ => tile::<S, NP, R, 1>(simd, g, t, a, v, block),
        };
    }
}

/// `R` rows from row `a` on, `V` vectors of each from vector `v` on; returns `V`.
#[inline(always)]
fn tile<S: Simd, const NP: usize, const R: usize, const V: usize>(
    simd: S,
    g: &[[f64; NP]],
    t: &[[f64; NP]],
    a: usize,
    v: usize,
    block: &mut [[f64; NP]],
) -> usize {
    let mut sums = [[simd.splat_f64s(0.0); V]; R];
    for (g, t) in g.iter().zip(t) {
        let t = vectors::<S, NP, V>(t, v);
        let g = &g[a..a + R];
        for r in 0..R {
            let g = simd.splat_f64s(g[r]);
            for k in 0..V {
                sums[r][k] = simd.mul_add_e_f64s(g, t[k], sums[r][k]);
            }
        }
    }
    for (row, sums) in block[a..a + R].iter_mut().zip(&sums) {
        S::as_mut_simd_f64s(row).0[v..v + V].copy_from_slice(sums);
    }
    V
}

/// See [`CellKernel::add_symmetric_product`](super::CellKernel::add_symmetric_product).
pub(super) fn add_symmetric_product<const N: usize, const NP: usize, const D: usize>(
    a: &[f64],
    b: &[f64],
    matrix: &mut [f64],
) {
    let ((a, _), (b, _)) = (a.as_chunks::<NP>(), b.as_chunks::<NP>());
    let (blocks, _) = matrix.as_chunks_mut::<NP>();
    for i in 0..D {
        for k in i..D {
            let start = block_index(i, k, D) * N;
            for (row, block) in blocks[start..start + N].iter_mut().enumerate() {
                let (left, right) = (a[i][row], b[i][row]);
                for (entry, (a, b)) in block.iter_mut().zip(a[k].iter().zip(&b[k])) {
                    *entry += left * b + right * a;
                }
            }
        }
    }
}
