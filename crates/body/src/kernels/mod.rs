//! The dense arithmetic of one cell, sized at compile time and vectorised at run time.
//!
//! Everything is stored component by component: a nodal quantity of a cell is a row of `NP` numbers (the `N` nodes,
//! padded with zeros to a multiple of 8), so that the compiler turns every inner loop into whole vectors. The element
//! matrix is built block by block, `K_ik = sum_q G_q^T C_ik(q) G_q`, for `i <= k` alone; any tangent will do.
//!
//! [`pulp`] picks the widest instruction set of the processor at run time; a plain build is fast everywhere.

pub mod cell_scratch;
pub(crate) mod cell_sweep;
pub mod cells;
pub(crate) mod dilatation;
pub mod displaced;
pub mod hexahedra;
mod matrix;
pub mod patch;
mod scatter;

use matrix::Matrix;
use nastic_mesh::CellKind;
use nastic_tensor::{Mat3, Tangent};
use pulp::{Arch, Simd, WithSimd};
use scatter::{scatter, scatter_among};
use std::array::from_fn;

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
    /// Adds `a b^T + b a^T` to the element matrix, for rows a and b.
    fn add_symmetric_product(&self, a: &[f64], b: &[f64], matrix: &mut [f64]);
    /// Adds an element matrix to the first unknowns of the node blocks, of so many unknowns, of the global one, see
    /// [`Pattern::scatter_map`](nastic_linear::Pattern::scatter_map) for the codes.
    fn scatter(&self, map: &[u32], matrix: &[f64], block: usize, values: &mut [f64]);
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

    fn add_symmetric_product(&self, a: &[f64], b: &[f64], matrix: &mut [f64]) {
        matrix::add_symmetric_product::<N, NP, D>(a, b, matrix);
    }

    fn scatter(&self, map: &[u32], matrix: &[f64], block: usize, values: &mut [f64]) {
        match block == D {
            true => scatter::<N, NP, D>(map, matrix, values),
            false => scatter_among::<N, NP, D>(map, matrix, block, values),
        }
    }
}

struct Gradients<'a, const NP: usize, const D: usize> {
    reference: &'a [f64],
    inverse: &'a [[f64; 9]],
    g: &'a mut [f64],
}

impl<const NP: usize, const D: usize> WithSimd for Gradients<'_, NP, D> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let (reference, _) = self.reference.as_chunks::<NP>();
        let (g, _) = self.g.as_chunks_mut::<NP>();
        let points = reference.as_chunks::<D>().0.iter().zip(self.inverse);
        for ((reference, inverse), g) in points.zip(g.as_chunks_mut::<D>().0) {
            let inverse = |k: usize, j: usize| simd.splat_f64s(inverse[3 * k + j]);
            let inverse: [[S::f64s; D]; D] = from_fn(|k| from_fn(|j| inverse(k, j)));
            for v in 0..NP / S::F64_LANES {
                let reference: [S::f64s; D] = from_fn(|k| vectors::<S, NP, 1>(&reference[k], v)[0]);
                for (j, row) in g.iter_mut().enumerate() {
                    let mut sum = simd.mul_f64s(inverse[0][j], reference[0]);
                    for k in 1..D {
                        sum = simd.mul_add_e_f64s(inverse[k][j], reference[k], sum);
                    }
                    S::as_mut_simd_f64s(row).0[v] = sum;
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
    fn with_simd<S: Simd>(self, simd: S) {
        let (g, _) = self.g.as_chunks::<NP>();
        let (rows, _) = self.rows.as_chunks::<NP>();
        let Some(rows) = rows.first_chunk::<D>() else { return };
        for (g, out) in g.as_chunks::<D>().0.iter().zip(self.out) {
            let mut sums = [[simd.splat_f64s(0.0); D]; D];
            for v in 0..NP / S::F64_LANES {
                let g: [S::f64s; D] = from_fn(|j| vectors::<S, NP, 1>(&g[j], v)[0]);
                for i in 0..D {
                    let row = vectors::<S, NP, 1>(&rows[i], v)[0];
                    for j in 0..D {
                        sums[i][j] = simd.mul_add_e_f64s(row, g[j], sums[i][j]);
                    }
                }
            }
            for i in 0..D {
                for j in 0..D {
                    out[(i, j)] += simd.reduce_sum_f64s(sums[i][j]);
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
    fn with_simd<S: Simd>(self, simd: S) {
        let (g, _) = self.g.as_chunks::<NP>();
        let (rows, _) = self.rows.as_chunks_mut::<NP>();
        let vectors = NP / S::F64_LANES;
        let mut v = 0;
        while v < vectors {
            // as many columns at a time as leave all sums in registers
            v += match (vectors - v).min(widest::<S>()) {
                4 => force_columns::<S, NP, D, 4>(simd, g, self.stress, v, rows),
                3 => force_columns::<S, NP, D, 3>(simd, g, self.stress, v, rows),
                2 => force_columns::<S, NP, D, 2>(simd, g, self.stress, v, rows),
                _ => force_columns::<S, NP, D, 1>(simd, g, self.stress, v, rows),
            };
        }
    }
}

/// `V` vectors of every row of the force, from vector `v` on; returns `V`.
#[inline(always)]
fn force_columns<S: Simd, const NP: usize, const D: usize, const V: usize>(
    simd: S,
    g: &[[f64; NP]],
    stress: &[Mat3],
    v: usize,
    rows: &mut [[f64; NP]],
) -> usize {
    let mut sums = [[simd.splat_f64s(0.0); V]; D];
    for (g, stress) in g.as_chunks::<D>().0.iter().zip(stress) {
        for j in 0..D {
            let g = vectors::<S, NP, V>(&g[j], v);
            for i in 0..D {
                let stress = simd.splat_f64s(stress[(i, j)]);
                for k in 0..V {
                    sums[i][k] = simd.mul_add_e_f64s(stress, g[k], sums[i][k]);
                }
            }
        }
    }
    for (row, sums) in rows.iter_mut().zip(&sums) {
        let (row, _) = S::as_mut_simd_f64s(row);
        for (r, &sum) in row[v..v + V].iter_mut().zip(sums) {
            *r = simd.add_f64s(*r, sum);
        }
    }
    V
}

/// How many vectors of a row are summed at a time: all sums have to stay in the 32 registers of AVX-512, the 16 of others.
#[inline(always)]
fn widest<S: Simd>() -> usize {
    if S::F64_LANES == 8 { 4 } else { 2 }
}

/// `V` vectors of a row from vector `v` on.
#[inline(always)]
fn vectors<S: Simd, const NP: usize, const V: usize>(row: &[f64; NP], v: usize) -> [S::f64s; V] {
    let (row, _) = S::as_simd_f64s(row);
    from_fn(|k| row[v + k])
}
