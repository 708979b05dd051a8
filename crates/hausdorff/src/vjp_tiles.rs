//! Tiles of the vector-Jacobian product: from seeds on the columns and on the rows to the rows.
//!
//! With f_qt = g(r) (x_q - y_t), see `Form`, the sums are, for every row q,
//!
//! ```text
//! force_q = sum_t (w_q a_t / A_t + b_q w_t / B_q) E_qt f_qt,    mass_q = sum_t a_t / A_t E_qt.
//! ```

use super::kernel::Form;
use super::lanes::{Lanes, Task, WIDTH};
use super::sum_tiles::{Slab, apart, coordinates, splat, vectors};

/// Numbers kept per row by `VjpTile` and `WideVjpTile`: force and mass, each spread over `WIDTH` numbers.
pub(super) const VJP: usize = 4 * WIDTH;

/// With E scaled by 2^(-shift), `column_quotient` = a_t / A_t and `row_quotient` = b_q / B_q in the scales of their nodes, and the
/// factors that make up for both scales. `columns.weight` are w_t, `rows.weight` w_q.
pub(super) struct VjpTile<'a, F> {
    pub form: F,
    pub rows: Slab<'a>,
    pub row_quotient: &'a [f64],
    pub columns: Slab<'a>,
    pub column_quotient: &'a [f64],
    pub shift: f64,
    pub row_factor: f64,
    pub column_factor: f64,
    pub out: &'a mut [f64],
}

impl<F: Form> Task for VjpTile<'_, F> {
    type Output = ();

    #[inline(always)]
    fn run<S: Lanes>(self, s: S) {
        let n = self.column_quotient.len() / S::F64_LANES;
        let y = coordinates::<S>(&self.columns, n);
        let weights = vectors::<S>(self.columns.weight, n);
        let quotients = vectors::<S>(self.column_quotient, n);
        let base = s.splat_f64s(-self.shift);
        for (q, out) in self.out.chunks_exact_mut(VJP).enumerate() {
            let x = splat(s, &self.rows.x, q);
            let by_column = s.splat_f64s(self.rows.weight[q] * self.column_factor);
            let by_row = s.splat_f64s(self.row_quotient[q] * self.row_factor);
            let mut sum = [s.splat_f64s(0.0); 4];
            for t in 0..n {
                let (r2, d) = apart(s, x, [y[0][t], y[1][t], y[2][t]]);
                let (z, g) = self.form.log2_and_slope(s, r2, base);
                let e = s.exp2(z);
                let k = s.mul_add_e_f64s(by_row, weights[t], s.mul_f64s(by_column, quotients[t]));
                let k = s.mul_f64s(k, s.mul_f64s(e, g));
                for c in 0..3 {
                    sum[c] = s.mul_add_e_f64s(k, d[c], sum[c]);
                }
                sum[3] = s.mul_add_e_f64s(quotients[t], e, sum[3]);
            }
            sum[3] = s.mul_f64s(sum[3], s.splat_f64s(self.column_factor));
            add(s, out, &sum);
        }
    }
}

/// The same with a scale for every row and column: `log_row` = log2 B_q and `log_column` = log2 A_t themselves.
pub(super) struct WideVjpTile<'a, F> {
    pub form: F,
    pub rows: Slab<'a>,
    pub seed_row: &'a [f64],
    pub log_row: &'a [f64],
    pub columns: Slab<'a>,
    pub seed_column: &'a [f64],
    pub log_column: &'a [f64],
    pub out: &'a mut [f64],
}

impl<F: Form> Task for WideVjpTile<'_, F> {
    type Output = ();

    #[inline(always)]
    fn run<S: Lanes>(self, s: S) {
        let n = self.seed_column.len() / S::F64_LANES;
        let y = coordinates::<S>(&self.columns, n);
        let weights = vectors::<S>(self.columns.weight, n);
        let seeds = vectors::<S>(self.seed_column, n);
        let logs = vectors::<S>(self.log_column, n);
        for (q, out) in self.out.chunks_exact_mut(VJP).enumerate() {
            let x = splat(s, &self.rows.x, q);
            let (weight, seed) = (s.splat_f64s(self.rows.weight[q]), s.splat_f64s(self.seed_row[q]));
            let log = s.splat_f64s(self.log_row[q]);
            let mut sum = [s.splat_f64s(0.0); 4];
            for t in 0..n {
                let (r2, d) = apart(s, x, [y[0][t], y[1][t], y[2][t]]);
                let (z, g) = self.form.log2_and_slope(s, r2, s.splat_f64s(0.0));
                let mass = s.mul_f64s(seeds[t], s.exp2(s.sub_f64s(z, logs[t])));
                let k = s.mul_f64s(s.mul_f64s(seed, weights[t]), s.exp2(s.sub_f64s(z, log)));
                let k = s.mul_f64s(s.mul_add_e_f64s(weight, mass, k), g);
                for c in 0..3 {
                    sum[c] = s.mul_add_e_f64s(k, d[c], sum[c]);
                }
                sum[3] = s.add_f64s(sum[3], mass);
            }
            add(s, out, &sum);
        }
    }
}

/// Adds vector c to the c-th group of `WIDTH` numbers.
#[inline(always)]
pub(super) fn add<S: Lanes, const N: usize>(s: S, out: &mut [f64], sum: &[S::f64s; N]) {
    for (group, &sum) in out.chunks_exact_mut(WIDTH).zip(sum) {
        let group = &mut S::as_mut_simd_f64s(group).0[0];
        *group = s.add_f64s(*group, sum);
    }
}

/// Adds up a row's sums, which are spread over lanes.
pub(super) fn collect<const N: usize>(spread: &[f64]) -> [f64; N] {
    std::array::from_fn(|c| spread[c * WIDTH..(c + 1) * WIDTH].iter().sum())
}
