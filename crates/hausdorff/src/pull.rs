//! Tiles of the derivative: what seeds on the columns and on the rows do to the rows.
//!
//! With f_qt = g(r) (x_q - y_t), see `Form`, the wanted sums are, for every row q,
//!
//! ```text
//! force_q = sum_t (w_q a_t / A_t + b_q w_t / B_q) E_qt f_qt,    mass_q = sum_t a_t / A_t E_qt.
//! ```

use super::kernel::Form;
use super::lanes::{Lanes, Task, WIDTH};
use super::mask::Mask;
use super::tile::{Slab, apart, coordinates, splat, vectors};

/// Numbers kept per row by `Pull` and `WidePull`: force and mass, each spread over `WIDTH` numbers.
pub(super) const PULL: usize = 4 * WIDTH;

/// Numbers kept per row by `Field`: the force by `charge` and by `weight`, and the sum of E times `charge`.
pub(super) const FIELD: usize = FIELDS * WIDTH;
pub(super) const FIELDS: usize = 7;

/// With E scaled by 2^(-shift), `charge` = a_t / A_t and `pull` = b_q / B_q in the scales of their nodes, and the
/// factors that make up for both scales. `columns.weight` are w_t, `rows.weight` w_q.
pub(super) struct Pull<'a, F> {
    pub form: F,
    pub rows: Slab<'a>,
    pub pull: &'a [f64],
    pub columns: Slab<'a>,
    pub charge: &'a [f64],
    pub mask: Mask,
    pub shift: f64,
    pub row_factor: f64,
    pub column_factor: f64,
    pub out: &'a mut [f64],
}

impl<F: Form> Task for Pull<'_, F> {
    type Output = ();

    #[inline(always)]
    fn run<S: Lanes>(self, s: S) {
        let n = self.charge.len() / S::F64_LANES;
        let y = coordinates::<S>(&self.columns, n);
        let weights = vectors::<S>(self.columns.weight, n);
        let charges = vectors::<S>(self.charge, n);
        let base = s.splat_f64s(-self.shift);
        let runs = self.mask.runs(n, S::F64_LANES);
        for (q, out) in self.out.chunks_exact_mut(PULL).enumerate() {
            let x = splat(s, &self.rows.x, q);
            let by_charge = s.splat_f64s(self.rows.weight[q] * self.column_factor);
            let by_weight = s.splat_f64s(self.pull[q] * self.row_factor);
            let mut sum = [s.splat_f64s(0.0); 4];
            for (first, end) in runs.of(q) {
                for t in first..end {
                    let (r2, d) = apart(s, x, [y[0][t], y[1][t], y[2][t]]);
                    let (z, g) = self.form.log2_and_slope(s, r2, base);
                    let e = s.exp2(z);
                    let k = s.mul_add_e_f64s(by_weight, weights[t], s.mul_f64s(by_charge, charges[t]));
                    let k = s.mul_f64s(k, s.mul_f64s(e, g));
                    for c in 0..3 {
                        sum[c] = s.mul_add_e_f64s(k, d[c], sum[c]);
                    }
                    sum[3] = s.mul_add_e_f64s(charges[t], e, sum[3]);
                }
            }
            sum[3] = s.mul_f64s(sum[3], s.splat_f64s(self.column_factor));
            add(s, out, &sum);
        }
    }
}

/// The same with a scale for every row and column: `log_row` = log2 B_q and `log_column` = log2 A_t themselves.
pub(super) struct WidePull<'a, F> {
    pub form: F,
    pub rows: Slab<'a>,
    pub seed_row: &'a [f64],
    pub log_row: &'a [f64],
    pub columns: Slab<'a>,
    pub seed_column: &'a [f64],
    pub log_column: &'a [f64],
    pub out: &'a mut [f64],
}

impl<F: Form> Task for WidePull<'_, F> {
    type Output = ();

    #[inline(always)]
    fn run<S: Lanes>(self, s: S) {
        let n = self.seed_column.len() / S::F64_LANES;
        let y = coordinates::<S>(&self.columns, n);
        let weights = vectors::<S>(self.columns.weight, n);
        let seeds = vectors::<S>(self.seed_column, n);
        let logs = vectors::<S>(self.log_column, n);
        for (q, out) in self.out.chunks_exact_mut(PULL).enumerate() {
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

/// The sums apart by what causes them, for rows that are nodes of an interpolation and carry no seed of their own:
/// per row  sum_t a_t E f (3),  sum_t w_t E f (3),  sum_t a_t E, times the factor of each cause.
pub(super) struct Field<'a, F> {
    pub form: F,
    pub rows: [&'a [f64]; 3],
    pub columns: Slab<'a>,
    pub charge: &'a [f64],
    pub shift: f64,
    pub row_factor: f64,
    pub column_factor: f64,
    pub out: &'a mut [f64],
}

impl<F: Form> Task for Field<'_, F> {
    type Output = ();

    #[inline(always)]
    fn run<S: Lanes>(self, s: S) {
        let n = self.charge.len() / S::F64_LANES;
        let y = coordinates::<S>(&self.columns, n);
        let weights = vectors::<S>(self.columns.weight, n);
        let charges = vectors::<S>(self.charge, n);
        let base = s.splat_f64s(-self.shift);
        let factor = [s.splat_f64s(self.column_factor), s.splat_f64s(self.row_factor)];
        for (q, out) in self.out.chunks_exact_mut(FIELD).enumerate() {
            let x = splat(s, &self.rows, q);
            let mut sum = [s.splat_f64s(0.0); 7];
            for t in 0..n {
                let (r2, d) = apart(s, x, [y[0][t], y[1][t], y[2][t]]);
                let (z, g) = self.form.log2_and_slope(s, r2, base);
                let e = s.exp2(z);
                let k = s.mul_f64s(e, g);
                let (by_charge, by_weight) = (s.mul_f64s(k, charges[t]), s.mul_f64s(k, weights[t]));
                for c in 0..3 {
                    sum[c] = s.mul_add_e_f64s(by_charge, d[c], sum[c]);
                    sum[3 + c] = s.mul_add_e_f64s(by_weight, d[c], sum[3 + c]);
                }
                sum[6] = s.mul_add_e_f64s(charges[t], e, sum[6]);
            }
            for c in 0..7 {
                sum[c] = s.mul_f64s(sum[c], factor[usize::from((3..6).contains(&c))]);
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

/// What a row's spread sums come to.
pub(super) fn collect<const N: usize>(spread: &[f64]) -> [f64; N] {
    std::array::from_fn(|c| spread[c * WIDTH..(c + 1) * WIDTH].iter().sum())
}
