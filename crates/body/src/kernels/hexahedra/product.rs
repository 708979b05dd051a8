//! Products by sum factorisation: a gradient is taken along one direction after the other, by matrices of 3 x 3. Kronbichler, Kormann,
//! ACM Trans. Math. Softw. 45 (2019), article 29.

use super::lanes::{Double, Lanes, Single};
use super::{CELLS, Grid, Line, MODULI, NODES, Square, contract, splat, splat_transposed};
use pulp::{Arch, Simd, WithSimd};
use std::array::from_fn;

/// Numbers in the rows of the cells of a batch: `[node][component][cell]`.
pub(crate) const ROWS: usize = NODES * 3 * CELLS;

/// Sixteen cells and the vector that they are multiplied with, in single or double precision.
pub(crate) struct Batch<'a, T> {
    pub line: &'a Line,
    /// `[point][45][cell]`, with quadrature weights.
    pub moduli: &'a [f32],
    /// `[node][cell]`
    pub nodes: &'a [u32],
    /// By node of the mesh, zero where supported.
    pub v: &'a [[T; 4]],
    /// `[node][component][cell]`
    pub rows: &'a mut [T],
}

impl<'a, T> Batch<'a, T>
where
    Self: WithSimd<Output = ()>,
{
    /// Sets the rows.
    pub fn multiply(self) {
        Arch::new().dispatch(self);
    }
}

impl WithSimd for Batch<'_, f32> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        multiply(Single(simd), self);
    }
}

impl WithSimd for Batch<'_, f64> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        multiply(Double(simd), self);
    }
}

#[inline(always)]
fn multiply<L: Lanes>(lanes: L, batch: Batch<L::One>) {
    let mut values = [[[L::One::default(); CELLS]; NODES]; 3];
    for (n, nodes) in batch.nodes.as_chunks::<CELLS>().0.iter().enumerate().take(NODES) {
        for (cell, &node) in nodes.iter().enumerate() {
            let v = &batch.v[node as usize];
            (0..3).for_each(|i| values[i][n][cell] = v[i]);
        }
    }
    let rows = batch.rows.as_chunks_mut::<CELLS>().0;
    for part in 0..L::PARTS {
        let line = Gradient::of(lanes, batch.line);
        let mut gradients = [[lanes.splat(0.0); NODES]; 9];
        for (i, values) in values.iter().enumerate() {
            let values: Grid<L> = from_fn(|n| lanes.load(&values[n], part));
            line.gradient(lanes, &values, &mut gradients[3 * i..3 * i + 3]);
        }
        stresses(lanes, batch.moduli, part, &mut gradients);
        for i in 0..3 {
            let forces = line.force(lanes, &gradients[3 * i..3 * i + 3]);
            for (n, force) in forces.iter().enumerate() {
                lanes.store(*force, &mut rows[3 * n + i], part);
            }
        }
    }
}

/// `A_iKjM g_jM` at every point, in the place of g.
#[inline(always)]
fn stresses<L: Lanes>(lanes: L, moduli: &[f32], part: usize, g: &mut [Grid<L>; 9]) {
    for (q, moduli) in moduli.as_chunks::<CELLS>().0.as_chunks::<MODULI>().0.iter().enumerate().take(NODES) {
        let change: [L::Numbers; 9] = from_fn(|r| g[r][q]);
        let mut stress = [lanes.splat(0.0); 9];
        let mut at = 0;
        for r in 0..9 {
            for c in r..9 {
                let modulus = lanes.moduli(&moduli[at], part);
                stress[r] = lanes.mul_add(modulus, change[c], stress[r]);
                if c > r {
                    stress[c] = lanes.mul_add(modulus, change[r], stress[c]);
                }
                at += 1;
            }
        }
        (0..9).for_each(|r| g[r][q] = stress[r]);
    }
}

/// The matrices of a [`Line`] and their transposes.
pub(super) struct Gradient<L: Lanes> {
    shapes: Square<L>,
    derivatives: Square<L>,
    shapes_back: Square<L>,
    derivatives_back: Square<L>,
}

impl<L: Lanes> Gradient<L> {
    #[inline(always)]
    pub(super) fn of(lanes: L, line: &Line) -> Self {
        Gradient {
            shapes: splat(lanes, &line.shapes),
            derivatives: splat(lanes, &line.derivatives),
            shapes_back: splat_transposed(lanes, &line.shapes),
            derivatives_back: splat_transposed(lanes, &line.derivatives),
        }
    }

    /// The derivatives at the points in the three directions of the reference cell.
    #[inline(always)]
    pub(super) fn gradient(&self, lanes: L, values: &Grid<L>, out: &mut [Grid<L>]) {
        let zero = [lanes.splat(0.0); NODES];
        let (mut along, mut across) = (zero, zero);
        contract::<L, 1>(lanes, &self.derivatives, values, &mut along);
        contract::<L, 1>(lanes, &self.shapes, values, &mut across);
        let mut work = zero;
        contract::<L, 3>(lanes, &self.shapes, &along, &mut work);
        contract::<L, 9>(lanes, &self.shapes, &work, &mut out[0]);
        work = zero;
        contract::<L, 3>(lanes, &self.derivatives, &across, &mut work);
        contract::<L, 9>(lanes, &self.shapes, &work, &mut out[1]);
        work = zero;
        contract::<L, 3>(lanes, &self.shapes, &across, &mut work);
        contract::<L, 9>(lanes, &self.derivatives, &work, &mut out[2]);
    }

    /// The transpose of [`gradient`](Self::gradient).
    #[inline(always)]
    pub(super) fn force(&self, lanes: L, stress: &[Grid<L>]) -> Grid<L> {
        let zero = [lanes.splat(0.0); NODES];
        let (mut along, mut across) = (zero, zero);
        let mut work = zero;
        contract::<L, 9>(lanes, &self.shapes_back, &stress[0], &mut work);
        contract::<L, 3>(lanes, &self.shapes_back, &work, &mut along);
        work = zero;
        contract::<L, 9>(lanes, &self.shapes_back, &stress[1], &mut work);
        contract::<L, 3>(lanes, &self.derivatives_back, &work, &mut across);
        work = zero;
        contract::<L, 9>(lanes, &self.derivatives_back, &stress[2], &mut work);
        contract::<L, 3>(lanes, &self.shapes_back, &work, &mut across);
        let mut out = zero;
        contract::<L, 1>(lanes, &self.derivatives_back, &along, &mut out);
        contract::<L, 1>(lanes, &self.shapes_back, &across, &mut out);
        out
    }
}
