//! Products with the matrices of 27-node hexahedra by sum factorisation, sixteen cells at a time.
//!
//! Nodes and quadrature points stand on grids of 3 x 3 x 3: a gradient is taken along one direction after the other, by
//! matrices of 3 x 3. The change of stress follows from stored moduli, 45 numbers per point whatever the law:
//! `r_ia = sum_q d_K N_a A_iKjM(q) d_M v_j`, derivatives by the coordinates of the reference cell. Kronbichler, Kormann, ACM Trans.
//! Math. Softw. 45 (2019), article 29.

use pulp::{Arch, Simd, WithSimd};
use std::array::from_fn;

/// Cells computed together.
pub(crate) const CELLS: usize = 16;
/// Nodes of a cell, and points.
pub(crate) const NODES: usize = 27;
/// Moduli of a point: the upper triangle of a symmetric matrix of 9 rows.
pub(crate) const MODULI: usize = 45;
/// Numbers in the rows of the cells of a batch: `[node][component][cell]`.
pub(crate) const ROWS: usize = NODES * 3 * CELLS;

/// Shapes and their derivatives in one direction, `[point][node]`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Line {
    pub shapes: [[f32; 3]; 3],
    pub derivatives: [[f32; 3]; 3],
}

/// Sixteen cells and the vector that they are multiplied with.
pub(crate) struct Batch<'a> {
    pub line: &'a Line,
    /// `[point][45][cell]`, with quadrature weights.
    pub moduli: &'a [f32],
    /// `[node][cell]`
    pub nodes: &'a [u32],
    /// By node of the mesh, zero where supported.
    pub v: &'a [[f32; 4]],
    /// `[node][component][cell]`
    pub rows: &'a mut [f32],
}

impl Batch<'_> {
    /// Sets the rows.
    pub fn multiply(self) {
        Arch::new().dispatch(self);
    }
}

impl WithSimd for Batch<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let mut values = [[[0.0_f32; CELLS]; NODES]; 3];
        for (n, nodes) in self.nodes.as_chunks::<CELLS>().0.iter().enumerate().take(NODES) {
            for (cell, &node) in nodes.iter().enumerate() {
                let v = &self.v[node as usize];
                (0..3).for_each(|i| values[i][n][cell] = v[i]);
            }
        }
        for part in 0..CELLS / S::F32_LANES {
            let line = Splat::of(simd, self.line);
            let mut gradients = [[simd.splat_f32s(0.0); NODES]; 9];
            for (i, values) in values.iter().enumerate() {
                let values: [S::f32s; NODES] = from_fn(|n| S::as_simd_f32s(&values[n]).0[part]);
                line.gradient(simd, &values, &mut gradients[3 * i..3 * i + 3]);
            }
            stresses(simd, self.moduli, part, &mut gradients);
            for i in 0..3 {
                let rows = line.force(simd, &gradients[3 * i..3 * i + 3]);
                for (n, row) in rows.iter().enumerate() {
                    let start = (3 * n + i) * CELLS;
                    S::as_mut_simd_f32s(&mut self.rows[start..start + CELLS]).0[part] = *row;
                }
            }
        }
    }
}

/// `A_iKjM g_jM` at every point, in the place of g.
#[inline(always)]
fn stresses<S: Simd>(simd: S, moduli: &[f32], part: usize, g: &mut [[S::f32s; NODES]; 9]) {
    for (q, moduli) in moduli.as_chunks::<CELLS>().0.as_chunks::<MODULI>().0.iter().enumerate().take(NODES) {
        let change: [S::f32s; 9] = from_fn(|r| g[r][q]);
        let mut stress = [simd.splat_f32s(0.0); 9];
        let mut at = 0;
        for r in 0..9 {
            for c in r..9 {
                let modulus = S::as_simd_f32s(&moduli[at]).0[part];
                stress[r] = simd.mul_add_e_f32s(modulus, change[c], stress[r]);
                if c > r {
                    stress[c] = simd.mul_add_e_f32s(modulus, change[r], stress[c]);
                }
                at += 1;
            }
        }
        (0..9).for_each(|r| g[r][q] = stress[r]);
    }
}

type Grid<S> = [<S as Simd>::f32s; NODES];
type Square<S> = [[<S as Simd>::f32s; 3]; 3];

/// A [`Line`] in all lanes, and its transpose.
struct Splat<S: Simd> {
    shapes: Square<S>,
    derivatives: Square<S>,
    shapes_back: Square<S>,
    derivatives_back: Square<S>,
}

impl<S: Simd> Splat<S> {
    #[inline(always)]
    fn of(simd: S, line: &Line) -> Self {
        let forth = |m: &[[f32; 3]; 3]| from_fn(|q| from_fn(|n| simd.splat_f32s(m[q][n])));
        let back = |m: &[[f32; 3]; 3]| from_fn(|n| from_fn(|q| simd.splat_f32s(m[q][n])));
        Splat {
            shapes: forth(&line.shapes),
            derivatives: forth(&line.derivatives),
            shapes_back: back(&line.shapes),
            derivatives_back: back(&line.derivatives),
        }
    }

    /// The derivatives at the points in the three directions of the reference cell.
    #[inline(always)]
    fn gradient(&self, simd: S, values: &Grid<S>, out: &mut [Grid<S>]) {
        let zero = [simd.splat_f32s(0.0); NODES];
        let (mut along, mut across) = (zero, zero);
        contract::<S, 1>(simd, &self.derivatives, values, &mut along);
        contract::<S, 1>(simd, &self.shapes, values, &mut across);
        let mut work = zero;
        contract::<S, 3>(simd, &self.shapes, &along, &mut work);
        contract::<S, 9>(simd, &self.shapes, &work, &mut out[0]);
        work = zero;
        contract::<S, 3>(simd, &self.derivatives, &across, &mut work);
        contract::<S, 9>(simd, &self.shapes, &work, &mut out[1]);
        work = zero;
        contract::<S, 3>(simd, &self.shapes, &across, &mut work);
        contract::<S, 9>(simd, &self.derivatives, &work, &mut out[2]);
    }

    /// The transpose of [`gradient`](Self::gradient).
    #[inline(always)]
    fn force(&self, simd: S, stress: &[Grid<S>]) -> Grid<S> {
        let zero = [simd.splat_f32s(0.0); NODES];
        let (mut along, mut across) = (zero, zero);
        let mut work = zero;
        contract::<S, 9>(simd, &self.shapes_back, &stress[0], &mut work);
        contract::<S, 3>(simd, &self.shapes_back, &work, &mut along);
        work = zero;
        contract::<S, 9>(simd, &self.shapes_back, &stress[1], &mut work);
        contract::<S, 3>(simd, &self.derivatives_back, &work, &mut across);
        work = zero;
        contract::<S, 9>(simd, &self.derivatives_back, &stress[2], &mut work);
        contract::<S, 3>(simd, &self.shapes_back, &work, &mut across);
        let mut out = zero;
        contract::<S, 1>(simd, &self.derivatives_back, &along, &mut out);
        contract::<S, 1>(simd, &self.shapes_back, &across, &mut out);
        out
    }
}

/// Adds `sum_n m[q][n] x[n]` along the direction in which neighbours are `STRIDE` apart.
#[inline(always)]
fn contract<S: Simd, const STRIDE: usize>(simd: S, m: &Square<S>, x: &Grid<S>, out: &mut Grid<S>) {
    for k in 0..NODES / 3 {
        let first = k % STRIDE + 3 * STRIDE * (k / STRIDE);
        let line: [S::f32s; 3] = from_fn(|n| x[first + STRIDE * n]);
        for (q, row) in m.iter().enumerate() {
            let at = &mut out[first + STRIDE * q];
            for n in 0..3 {
                *at = simd.mul_add_e_f32s(row[n], line[n], *at);
            }
        }
    }
}
