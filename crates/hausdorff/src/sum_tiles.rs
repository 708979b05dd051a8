//! Sums over a tile: all pairs of a few rows and a few columns, each exponential computed once.

use super::kernel::{Form, SQUARE_OFFSET};
use super::lanes::{Lanes, Task, WIDTH};

/// Points with weights, one array per coordinate, in units of the kernel. As columns their number is a multiple of
/// `WIDTH`, and what pads them has weight zero.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slab<'a> {
    pub x: [&'a [f64]; 3],
    pub weight: &'a [f64],
}

/// r^2 + SQUARE_OFFSET between one row and one vector of columns, and x - y.
#[inline(always)]
pub(super) fn apart<S: Lanes>(s: S, x: [S::f64s; 3], y: [S::f64s; 3]) -> (S::f64s, [S::f64s; 3]) {
    let d = [s.sub_f64s(x[0], y[0]), s.sub_f64s(x[1], y[1]), s.sub_f64s(x[2], y[2])];
    let r2 = s.mul_add_e_f64s(d[2], d[2], s.splat_f64s(SQUARE_OFFSET));
    let r2 = s.mul_add_e_f64s(d[1], d[1], r2);
    (s.mul_add_e_f64s(d[0], d[0], r2), d)
}

/// `slice` as `n` vectors.
#[inline(always)]
pub(super) fn vectors<S: Lanes>(slice: &[f64], n: usize) -> &[S::f64s] {
    &S::as_simd_f64s(slice).0[..n]
}

#[inline(always)]
pub(super) fn coordinates<'a, S: Lanes>(columns: &Slab<'a>, n: usize) -> [&'a [S::f64s]; 3] {
    [vectors::<S>(columns.x[0], n), vectors::<S>(columns.x[1], n), vectors::<S>(columns.x[2], n)]
}

/// One row, the same in all lanes. (Closures, as in `map`, would not be compiled for the instructions.)
#[inline(always)]
pub(super) fn splat<S: Lanes>(s: S, x: &[&[f64]; 3], q: usize) -> [S::f64s; 3] {
    [s.splat_f64s(x[0][q]), s.splat_f64s(x[1][q]), s.splat_f64s(x[2][q])]
}

/// The vector at the head of one row's `WIDTH` running sums.
#[inline(always)]
fn head<S: Lanes>(sums: &mut [f64]) -> &mut S::f64s {
    &mut S::as_mut_simd_f64s(sums).0[0]
}

/// With E scaled by 2^(-shift): adds to row q  row_factor sum_t w_t E_qt, spread over `WIDTH` numbers per row,
/// and to column t  column_factor sum_q w_q E_qt.
pub(super) struct SumTile<'a, F> {
    pub form: F,
    pub rows: Slab<'a>,
    pub columns: Slab<'a>,
    pub shift: f64,
    pub row_factor: f64,
    pub column_factor: f64,
    pub row_sums: &'a mut [f64],
    pub column_sums: &'a mut [f64],
}

impl<F: Form> Task for SumTile<'_, F> {
    type Output = ();

    #[inline(always)]
    fn run<S: Lanes>(self, s: S) {
        let sums = S::as_mut_simd_f64s(self.column_sums).0;
        let n = sums.len();
        let y = coordinates::<S>(&self.columns, n);
        let weights = vectors::<S>(self.columns.weight, n);
        let base = s.splat_f64s(-self.shift);
        for (q, row_sums) in self.row_sums.chunks_exact_mut(WIDTH).enumerate() {
            let x = splat(s, &self.rows.x, q);
            let weight = s.splat_f64s(self.rows.weight[q] * self.column_factor);
            let mut sum = s.splat_f64s(0.0);
            // The logarithm is formed one vector ahead of its exponential: two short chains of operations in flight instead of
            // a long one.
            let mut ahead = log2(s, self.form, x, y, 0, base);
            for t in 0..n {
                let z = ahead;
                ahead = log2(s, self.form, x, y, (t + 1).min(n - 1), base);
                let e = s.exp2(z);
                sum = s.mul_add_e_f64s(weights[t], e, sum);
                sums[t] = s.mul_add_e_f64s(weight, e, sums[t]);
            }
            let row = head::<S>(row_sums);
            *row = s.mul_add_e_f64s(sum, s.splat_f64s(self.row_factor), *row);
        }
    }
}

#[inline(always)]
fn log2<S: Lanes>(s: S, form: impl Form, x: [S::f64s; 3], y: [&[S::f64s]; 3], t: usize, base: S::f64s) -> S::f64s {
    let (r2, _) = apart(s, x, [y[0][t], y[1][t], y[2][t]]);
    form.log2(s, r2, base)
}

/// The same where E varies too much within the tile for one scale: every row and column has its own, no less than the
/// largest log2 E it meets (or below it by little), and every pair needs two exponentials.
pub(super) struct WideSumTile<'a, F> {
    pub form: F,
    pub rows: Slab<'a>,
    pub columns: Slab<'a>,
    pub row_scale: &'a [f64],
    pub column_scale: &'a [f64],
    pub row_sums: &'a mut [f64],
    pub column_sums: &'a mut [f64],
}

impl<F: Form> Task for WideSumTile<'_, F> {
    type Output = ();

    #[inline(always)]
    fn run<S: Lanes>(self, s: S) {
        let sums = S::as_mut_simd_f64s(self.column_sums).0;
        let n = sums.len();
        let y = coordinates::<S>(&self.columns, n);
        let weights = vectors::<S>(self.columns.weight, n);
        let scales = vectors::<S>(self.column_scale, n);
        for (q, row_sums) in self.row_sums.chunks_exact_mut(WIDTH).enumerate() {
            let x = splat(s, &self.rows.x, q);
            let weight = s.splat_f64s(self.rows.weight[q]);
            let scale = s.splat_f64s(self.row_scale[q]);
            let row = head::<S>(row_sums);
            for t in 0..n {
                let (r2, _) = apart(s, x, [y[0][t], y[1][t], y[2][t]]);
                let z = self.form.log2(s, r2, s.splat_f64s(0.0));
                *row = s.mul_add_e_f64s(weights[t], s.exp2(s.sub_f64s(z, scale)), *row);
                sums[t] = s.mul_add_e_f64s(weight, s.exp2(s.sub_f64s(z, scales[t])), sums[t]);
            }
        }
    }
}

/// Largest log2 E of every row, spread over `WIDTH` numbers.
pub(super) struct MaxTile<'a, F> {
    pub form: F,
    pub rows: Slab<'a>,
    pub columns: Slab<'a>,
    pub largest: &'a mut [f64],
}

impl<F: Form> Task for MaxTile<'_, F> {
    type Output = ();

    #[inline(always)]
    fn run<S: Lanes>(self, s: S) {
        let n = self.columns.weight.len() / S::F64_LANES;
        let y = coordinates::<S>(&self.columns, n);
        for (q, largest) in self.largest.chunks_exact_mut(WIDTH).enumerate() {
            let x = splat(s, &self.rows.x, q);
            let largest = head::<S>(largest);
            for t in 0..n {
                let (r2, _) = apart(s, x, [y[0][t], y[1][t], y[2][t]]);
                *largest = s.max_f64s(*largest, self.form.log2(s, r2, s.splat_f64s(0.0)));
            }
        }
    }
}
