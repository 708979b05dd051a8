//! Tiles of second derivatives along a motion of the rows: each row moves by `v_q` and its weight changes by `omega_q`.
//!
//! With `f_qt = g (x_q - y_t)`, `e_qt = -factor f_qt . v_q` the change of log E, and a scale for every row and column, see
//! `WideVjpTile`, `RateTile` gives
//!
//! ```text
//! sum_q (w_q e_qt + omega_q) E_qt / A_t  by column,      sum_t w_t e_qt E_qt / B_q  by row,
//! ```
//!
//! and `SecondTile`, from seeds a_t, b_q and what they change by, for every row,
//!
//! ```text
//! force_q = sum_t c_qt f_qt + (w_q a_t E_qt / A_t + b_q w_t E_qt / B_q) df_qt
//!           c_qt = (E_qt / A_t) (w_q k_t + a_t (w_q e_qt + omega_q)) + w_t (E_qt / B_q) (l_q + b_q e_qt)
//! mass_q  = sum_t (E_qt / A_t) (k_t + a_t e_qt),        first_q = sum_t (E_qt / A_t) a_t
//! ```

use super::kernel::Form;
use super::lanes::{Lanes, Task, WIDTH};
use super::sum_tiles::{Slab, apart, coordinates, splat, vectors};
use super::vjp_tiles::add;

/// Numbers kept per row by `SecondTile`: force, mass and first, each spread over `WIDTH` numbers.
pub(super) const SECOND: usize = 5 * WIDTH;

/// How the rows of a tile move, in units of the kernel: one array per coordinate, and changes of the weights over the measure.
#[derive(Clone, Copy, Debug)]
pub(super) struct RowMotion<'a> {
    pub v: [&'a [f64]; 3],
    pub omega: &'a [f64],
}

/// Adds the sums by row, spread over `WIDTH` numbers each, and by column. `log_row` = log2 B_q, `log_column` = log2 A_t.
pub(super) struct RateTile<'a, F> {
    pub form: F,
    pub rows: Slab<'a>,
    pub motion: RowMotion<'a>,
    pub log_row: &'a [f64],
    pub columns: Slab<'a>,
    pub log_column: &'a [f64],
    pub row_sums: &'a mut [f64],
    pub column_sums: &'a mut [f64],
}

impl<F: Form> Task for RateTile<'_, F> {
    type Output = ();

    #[inline(always)]
    fn run<S: Lanes>(self, s: S) {
        let sums = S::as_mut_simd_f64s(self.column_sums).0;
        let n = sums.len();
        let y = coordinates::<S>(&self.columns, n);
        let weights = vectors::<S>(self.columns.weight, n);
        let logs = vectors::<S>(self.log_column, n);
        let factor = s.splat_f64s(-self.form.factor());
        for (q, row_sums) in self.row_sums.chunks_exact_mut(WIDTH).enumerate() {
            let (x, v) = (splat(s, &self.rows.x, q), splat(s, &self.motion.v, q));
            let (weight, omega) = (s.splat_f64s(self.rows.weight[q]), s.splat_f64s(self.motion.omega[q]));
            let log = s.splat_f64s(self.log_row[q]);
            let mut sum = [s.splat_f64s(0.0)];
            for t in 0..n {
                let (r2, d) = apart(s, x, [y[0][t], y[1][t], y[2][t]]);
                let [z, g, _] = self.form.log2_and_slopes(s, r2);
                let e = s.mul_f64s(s.mul_f64s(factor, g), along(s, d, v));
                let by_row = s.mul_f64s(weights[t], s.exp2(s.sub_f64s(z, log)));
                sum[0] = s.mul_add_e_f64s(by_row, e, sum[0]);
                let by_column = s.exp2(s.sub_f64s(z, logs[t]));
                sums[t] = s.mul_add_e_f64s(by_column, s.mul_add_e_f64s(weight, e, omega), sums[t]);
            }
            add(s, row_sums, &sum);
        }
    }
}

/// Seeds of rows and columns, with what they change by: `change_row` = l_q, `change_column` = k_t.
pub(super) struct SecondTile<'a, F> {
    pub form: F,
    pub rows: Slab<'a>,
    pub motion: RowMotion<'a>,
    pub log_row: &'a [f64],
    pub seed_row: &'a [f64],
    pub change_row: &'a [f64],
    pub columns: Slab<'a>,
    pub log_column: &'a [f64],
    pub seed_column: &'a [f64],
    pub change_column: &'a [f64],
    pub out: &'a mut [f64],
}

impl<F: Form> Task for SecondTile<'_, F> {
    type Output = ();

    #[inline(always)]
    fn run<S: Lanes>(self, s: S) {
        let n = self.seed_column.len() / S::F64_LANES;
        let y = coordinates::<S>(&self.columns, n);
        let weights = vectors::<S>(self.columns.weight, n);
        let logs = vectors::<S>(self.log_column, n);
        let (seeds, changes) = (vectors::<S>(self.seed_column, n), vectors::<S>(self.change_column, n));
        let factor = s.splat_f64s(-self.form.factor());
        for (q, out) in self.out.chunks_exact_mut(SECOND).enumerate() {
            let (x, v) = (splat(s, &self.rows.x, q), splat(s, &self.motion.v, q));
            let (weight, omega) = (s.splat_f64s(self.rows.weight[q]), s.splat_f64s(self.motion.omega[q]));
            let (seed, change) = (s.splat_f64s(self.seed_row[q]), s.splat_f64s(self.change_row[q]));
            let log = s.splat_f64s(self.log_row[q]);
            let mut sum = [s.splat_f64s(0.0); 5];
            for t in 0..n {
                let (r2, d) = apart(s, x, [y[0][t], y[1][t], y[2][t]]);
                let [z, g, h] = self.form.log2_and_slopes(s, r2);
                let dv = along(s, d, v);
                let e = s.mul_f64s(s.mul_f64s(factor, g), dv);
                let by_row = s.mul_f64s(weights[t], s.exp2(s.sub_f64s(z, log)));
                let by_column = s.exp2(s.sub_f64s(z, logs[t]));
                // seeds with the weights of both sums, and their changes
                let moved = s.mul_add_e_f64s(weight, e, omega);
                let column = s.mul_add_e_f64s(weight, changes[t], s.mul_f64s(seeds[t], moved));
                let row = s.mul_f64s(by_row, s.mul_add_e_f64s(seed, e, change));
                let c = s.mul_add_e_f64s(by_column, column, row);
                let mass = s.mul_f64s(by_column, seeds[t]);
                let still = s.mul_add_e_f64s(by_row, seed, s.mul_f64s(mass, weight));
                // c g d + still (g v + h (d.v) d)
                let along_d = s.mul_add_e_f64s(s.mul_f64s(still, h), dv, s.mul_f64s(c, g));
                let along_v = s.mul_f64s(still, g);
                for i in 0..3 {
                    sum[i] = s.mul_add_e_f64s(along_d, d[i], s.mul_add_e_f64s(along_v, v[i], sum[i]));
                }
                sum[3] = s.mul_add_e_f64s(by_column, s.mul_add_e_f64s(seeds[t], e, changes[t]), sum[3]);
                sum[4] = s.add_f64s(sum[4], mass);
            }
            add(s, out, &sum);
        }
    }
}

/// d.v
#[inline(always)]
fn along<S: Lanes>(s: S, d: [S::f64s; 3], v: [S::f64s; 3]) -> S::f64s {
    s.mul_add_e_f64s(d[2], v[2], s.mul_add_e_f64s(d[1], v[1], s.mul_f64s(d[0], v[0])))
}
