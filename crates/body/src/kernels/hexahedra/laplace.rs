//! Products with the Laplace operator of cells, one number per node, by sum factorisation.

use super::lanes::{Lanes, Single};
use super::product::Gradient;
use super::{CELLS, Grid, Line, NODES};
use pulp::{Arch, Simd, WithSimd};
use std::array::from_fn;

/// Entries of the metric of a point: the upper triangle of a symmetric 3 x 3 matrix, row by row.
pub const METRIC: usize = 6;

/// Sixteen cells and the field that they are multiplied with.
pub struct LaplaceBatch<'a> {
    /// Shapes in one direction.
    pub line: &'a Line,
    /// `w dxi_K/dX_J dxi_M/dX_J`, `[point][6][cell]`.
    pub metric: &'a [f32],
    /// `[node][cell]`
    pub nodes: &'a [u32],
    /// By node of the mesh, zero where supported.
    pub v: &'a [f32],
    /// `[node][cell]`
    pub rows: &'a mut [f32],
}

impl LaplaceBatch<'_> {
    /// Sets the rows: `r_a = sum_q d_K N_a A_KM d_M v`.
    pub fn multiply(self) {
        Arch::new().dispatch(self);
    }
}

impl WithSimd for LaplaceBatch<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let lanes = Single(simd);
        let mut values = [[0.0_f32; CELLS]; NODES];
        for (nodes, values) in self.nodes.as_chunks::<CELLS>().0.iter().zip(&mut values) {
            (0..CELLS).for_each(|cell| values[cell] = self.v[nodes[cell] as usize]);
        }
        let metric = self.metric.as_chunks::<CELLS>().0.as_chunks::<METRIC>().0;
        let rows = self.rows.as_chunks_mut::<CELLS>().0;
        for part in 0..<Single<S> as Lanes>::PARTS {
            let line = Gradient::of(lanes, self.line);
            let mut gradient = [[lanes.splat(0.0); NODES]; 3];
            let values: Grid<Single<S>> = from_fn(|n| lanes.load(&values[n], part));
            line.gradient(lanes, &values, &mut gradient);
            for (q, metric) in metric.iter().enumerate().take(NODES) {
                let change: [_; 3] = from_fn(|k| gradient[k][q]);
                let entry = |k: usize, m: usize| {
                    let (k, m) = (k.min(m), k.max(m));
                    lanes.load(&metric[k * (5 - k) / 2 + m], part)
                };
                for k in 0..3 {
                    let mut sum = lanes.splat(0.0);
                    (0..3).for_each(|m| sum = lanes.mul_add(entry(k, m), change[m], sum));
                    gradient[k][q] = sum;
                }
            }
            let forces = line.force(lanes, &gradient);
            forces.iter().zip(&mut *rows).for_each(|(force, row)| lanes.store(*force, row, part));
        }
    }
}
