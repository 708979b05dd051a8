//! The dense arithmetic of one cell, sized at compile time and vectorised at run time.
//!
//! Everything is stored component by component: a nodal quantity of a cell is a row of `NP` numbers (the `N` nodes,
//! padded with zeros to a multiple of 8), so that the compiler turns every inner loop into whole vectors. The element
//! matrix is built block by block, `K_ik = sum_q G_q^T C_ik(q) G_q`, for `i <= k` alone; any tangent will do.
//!
//! [`pulp`] picks the widest instruction set of the processor at run time; a plain build is fast everywhere.

use nastic_mesh::CellKind;
use nastic_tensor::{Mat3, Tangent};
use pulp::{Arch, Simd, WithSimd};

/// The sizes of one cell kind and its arithmetic. `D` components, `N` nodes, rows padded to `width()`.
///
/// Shapes: `g` holds `[q][J][NP]` shape-function gradients with respect to X, `rows` hold `[i][NP]`, the matrix holds
/// the blocks `(i, k)`, `i <= k`, each `[N][NP]`, in the order (0,0), (0,1), .., (1,1), ...
pub trait CellKernel: Send + Sync {
    /// Padded row length `NP`.
    fn width(&self) -> usize;
    /// Length of the element matrix buffer.
    fn matrix_len(&self) -> usize;
    /// Gradients with respect to X: `g_J = sum_K reference_K inverse[K][J]` at every point.
    fn gradients(&self, reference: &[f64], inverse: &[[f64; 9]], g: &mut [f64]);
    /// Adds `grad u` at every point to `out` (row i, column J).
    fn displacement_gradients(&self, g: &[f64], rows: &[f64], out: &mut [Mat3]);
    /// Adds `sum_q P_iJ g_J[a]` to `rows`; the stresses carry their quadrature weight.
    fn force(&self, g: &[f64], weighted_stress: &[Mat3], rows: &mut [f64]);
    /// Sets the element matrix; the tangents carry their quadrature weight. `scratch` is resized as needed.
    fn tangent(&self, g: &[f64], weighted: &[Tangent], matrix: &mut [f64], scratch: &mut Vec<f64>);
}

/// The kernel of a cell kind; `None` for lines, which are no bodies.
pub fn kernel(kind: CellKind) -> Option<&'static dyn CellKernel> {
    Some(match kind {
        CellKind::Line2 | CellKind::Line3 => return None,
        CellKind::Tri3 => &Sized::<3, 8, 2>,
        CellKind::Tri6 => &Sized::<6, 8, 2>,
        CellKind::Quad4 => &Sized::<4, 8, 2>,
        CellKind::Quad8 => &Sized::<8, 8, 2>,
        CellKind::Quad9 => &Sized::<9, 16, 2>,
        CellKind::Tet4 => &Sized::<4, 8, 3>,
        CellKind::Tet10 => &Sized::<10, 16, 3>,
        CellKind::Hex8 => &Sized::<8, 8, 3>,
        CellKind::Hex20 => &Sized::<20, 24, 3>,
        CellKind::Hex27 => &Sized::<27, 32, 3>,
    })
}

/// Where block `(i, k)`, `i <= k`, of the element matrix starts, in units of blocks.
#[inline]
pub const fn block_index(i: usize, k: usize, dim: usize) -> usize {
    i * dim - i * (i + 1) / 2 + k
}

struct Sized<const N: usize, const NP: usize, const D: usize>;

impl<const N: usize, const NP: usize, const D: usize> CellKernel for Sized<N, NP, D> {
    fn width(&self) -> usize {
        NP
    }

    fn matrix_len(&self) -> usize {
        D * (D + 1) / 2 * N * NP
    }

    fn gradients(&self, reference: &[f64], inverse: &[[f64; 9]], g: &mut [f64]) {
        Arch::new().dispatch(Gradients::<NP, D> { reference, inverse, g });
    }

    fn displacement_gradients(&self, g: &[f64], rows: &[f64], out: &mut [Mat3]) {
        Arch::new().dispatch(DisplacementGradients::<NP, D> { g, rows, out });
    }

    fn force(&self, g: &[f64], weighted_stress: &[Mat3], rows: &mut [f64]) {
        Arch::new().dispatch(Force::<NP, D> { g, stress: weighted_stress, rows });
    }

    fn tangent(&self, g: &[f64], weighted: &[Tangent], matrix: &mut [f64], scratch: &mut Vec<f64>) {
        Arch::new().dispatch(Matrix::<N, NP, D> { g, tangents: weighted, matrix, scratch });
    }
}

/// `a b + c`, fused where the processor fuses: without the instruction `mul_add` is a slow library call.
#[inline(always)]
fn fused<S: Simd>(a: f64, b: f64, c: f64) -> f64 {
    if S::IS_SCALAR { a * b + c } else { a.mul_add(b, c) }
}

/// `row += a * x`.
#[inline(always)]
fn axpy<S: Simd, const NP: usize>(a: f64, x: &[f64; NP], row: &mut [f64; NP]) {
    for (r, &x) in row.iter_mut().zip(x) {
        *r = fused::<S>(a, x, *r);
    }
}

/// Sum of products in eight lanes, folded in a fixed order: strict summation would not vectorise.
#[inline(always)]
fn dot<S: Simd, const NP: usize>(a: &[f64; NP], b: &[f64; NP]) -> f64 {
    let mut lanes = [0.0; 8];
    for (a, b) in a.chunks_exact(8).zip(b.chunks_exact(8)) {
        for l in 0..8 {
            lanes[l] = fused::<S>(a[l], b[l], lanes[l]);
        }
    }
    ((lanes[0] + lanes[4]) + (lanes[1] + lanes[5])) + ((lanes[2] + lanes[6]) + (lanes[3] + lanes[7]))
}

struct Gradients<'a, const NP: usize, const D: usize> {
    reference: &'a [f64],
    inverse: &'a [[f64; 9]],
    g: &'a mut [f64],
}

impl<const NP: usize, const D: usize> WithSimd for Gradients<'_, NP, D> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let (reference, _) = self.reference.as_chunks::<NP>();
        let (g, _) = self.g.as_chunks_mut::<NP>();
        for ((reference, inverse), g) in reference.chunks_exact(D).zip(self.inverse).zip(g.chunks_exact_mut(D)) {
            for (j, row) in g.iter_mut().enumerate() {
                row.fill(0.0);
                for (k, reference) in reference.iter().enumerate() {
                    axpy::<S, NP>(inverse[3 * k + j], reference, row);
                }
            }
        }
    }
}

struct DisplacementGradients<'a, const NP: usize, const D: usize> {
    g: &'a [f64],
    rows: &'a [f64],
    out: &'a mut [Mat3],
}

impl<const NP: usize, const D: usize> WithSimd for DisplacementGradients<'_, NP, D> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let (g, _) = self.g.as_chunks::<NP>();
        let (rows, _) = self.rows.as_chunks::<NP>();
        for (g, out) in g.chunks_exact(D).zip(self.out) {
            for i in 0..D {
                for j in 0..D {
                    out[(i, j)] += dot::<S, NP>(&rows[i], &g[j]);
                }
            }
        }
    }
}

struct Force<'a, const NP: usize, const D: usize> {
    g: &'a [f64],
    stress: &'a [Mat3],
    rows: &'a mut [f64],
}

impl<const NP: usize, const D: usize> WithSimd for Force<'_, NP, D> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let (g, _) = self.g.as_chunks::<NP>();
        let (rows, _) = self.rows.as_chunks_mut::<NP>();
        for (i, row) in rows.iter_mut().take(D).enumerate() {
            for (g, stress) in g.chunks_exact(D).zip(self.stress) {
                for (j, g) in g.iter().enumerate() {
                    axpy::<S, NP>(stress[(i, j)], g, row);
                }
            }
        }
    }
}

struct Matrix<'a, const N: usize, const NP: usize, const D: usize> {
    g: &'a [f64],
    tangents: &'a [Tangent],
    matrix: &'a mut [f64],
    scratch: &'a mut Vec<f64>,
}

impl<const N: usize, const NP: usize, const D: usize> WithSimd for Matrix<'_, N, NP, D> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        self.scratch.resize(self.tangents.len() * D * NP, 0.0);
        let (g, _) = self.g.as_chunks::<NP>();
        let (t, _) = self.scratch.as_chunks_mut::<NP>();
        let (blocks, _) = self.matrix.as_chunks_mut::<NP>();
        for i in 0..D {
            for k in i..D {
                contract::<S, NP, D>(g, self.tangents, i, k, t);
                let start = block_index(i, k, D) * N;
                product::<S, N, NP>(g, t, &mut blocks[start..start + N]);
            }
        }
    }
}

/// `t_J = sum_L C_iJkL g_L` at every point.
#[inline(always)]
fn contract<S: Simd, const NP: usize, const D: usize>(
    g: &[[f64; NP]],
    tangents: &[Tangent],
    i: usize,
    k: usize,
    t: &mut [[f64; NP]],
) {
    for ((g, c), t) in g.chunks_exact(D).zip(tangents).zip(t.chunks_exact_mut(D)) {
        for (j, row) in t.iter_mut().enumerate() {
            row.fill(0.0);
            for (l, g) in g.iter().enumerate() {
                axpy::<S, NP>(c.0[9 * (3 * i + j) + 3 * k + l], g, row);
            }
        }
    }
}

/// `block[a][b] = sum_d g[d][a] t[d][b]`: a small matrix product, four rows at a time so that the sums stay in
/// registers.
#[inline(always)]
fn product<S: Simd, const N: usize, const NP: usize>(g: &[[f64; NP]], t: &[[f64; NP]], block: &mut [[f64; NP]]) {
    let mut a = 0;
    while a + 4 <= N {
        let mut sums = [[0.0; NP]; 4];
        for (g, t) in g.iter().zip(t) {
            for (r, sum) in sums.iter_mut().enumerate() {
                axpy::<S, NP>(g[a + r], t, sum);
            }
        }
        block[a..a + 4].copy_from_slice(&sums);
        a += 4;
    }
    while a < N {
        let mut sum = [0.0; NP];
        for (g, t) in g.iter().zip(t) {
            axpy::<S, NP>(g[a], t, &mut sum);
        }
        block[a] = sum;
        a += 1;
    }
}
