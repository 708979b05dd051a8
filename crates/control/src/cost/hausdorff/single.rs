//! Tiles in single precision, for pairs whose share of the sums is so small that its last digits do not count.
//!
//! Why the sums of a tile err by no more than `error` times its largest E times the weights: let u be the unit
//! roundoff, D the diagonal of the box around both nodes, in whose middle the origin is put, and G the gap. Every
//! coordinate rounds by u D_d / 2, a difference of two by another u D_d: x - y errs by 2 u D. Squares and their sum add
//! 3 u / 2 to the relative error of r, 1/sqrt 4 u, the exponent's own rounding u: it errs by 9 u D (with r <= D and
//! the shift, a whole number, exact), and E by log 2 times that, below 7 u D. The pull (x - y) / r errs by another
//! 10 u D / G. Constants: 5 u for 2^z, 3 u for weights and their products, 64 u for adding up the tile, rounded up
//! to 100 u in all. What underflows is below 2^-126 of the largest term.
//!
//! Weights are divided by the largest of their kind and seeds by theirs, so that nothing leaves the range of numbers.

use super::bounds::{Bounds, norm};
use super::lanes::{Lanes, Task, WIDTH};
use super::pull::PULL;
use super::single_lanes::ROUNDING;
use super::tile::Slab;
use super::tree::LEAF;

/// Largest diagonal, in units: whole shifts are exact up to here, and errors still small.
const WIDEST: f64 = 4096.0;

/// The bound of the relative error of the sums of a tile of 2^(-r), if it may be summed in single precision.
pub(super) fn error(rows: &Bounds, columns: &Bounds, gap: f64) -> Option<f64> {
    let diagonal = 2.0 * norm(rows.join(columns).half_sides());
    let units = 7.0 * diagonal + 10.0 * diagonal / gap + 100.0;
    (gap >= 1.0 && diagonal <= WIDEST).then_some(units * ROUNDING)
}

/// Where the coordinates of a tile are seen from, and the power of two (no more than the largest in it by 1, and whole)
/// that its E are counted in.
#[derive(Clone, Copy, Debug)]
pub(super) struct View {
    origin: [f64; 3],
    pub shift: f64,
}

impl View {
    pub fn of(rows: &Bounds, columns: &Bounds) -> Self {
        Self { origin: rows.join(columns).centre(), shift: -rows.gap(columns).floor() }
    }
}

/// Numbers of one leaf.
#[repr(align(64))]
struct Singles([f32; LEAF]);

impl Singles {
    /// (values - origin) factor.
    #[inline(always)]
    fn new(values: &[f64], origin: f64, factor: f64) -> Self {
        let mut all = Self([0.0; LEAF]);
        for (single, value) in all.0.iter_mut().zip(values) {
            *single = ((value - origin) * factor) as f32;
        }
        all
    }

    /// Coordinates, padded by copies of the last one.
    #[inline(always)]
    fn coordinates(x: &[f64], origin: f64) -> Self {
        let mut all = Self::new(x, origin, 1.0);
        let last = all.0[x.len() - 1];
        all.0[x.len()..].fill(last);
        all
    }

    #[inline(always)]
    fn vectors<S: Lanes>(&self) -> &[S::f32s] {
        S::as_simd_f32s(&self.0).0
    }
}

#[inline(always)]
fn points(slab: &Slab, view: &View) -> [Singles; 3] {
    [
        Singles::coordinates(slab.x[0], view.origin[0]),
        Singles::coordinates(slab.x[1], view.origin[1]),
        Singles::coordinates(slab.x[2], view.origin[2]),
    ]
}

#[inline(always)]
fn largest(values: &[f64]) -> f64 {
    let mut largest = 0.0;
    for value in values {
        largest = f64::max(largest, value.abs());
    }
    largest
}

/// One over a number, zero for zero.
#[inline(always)]
fn inverse(x: f64) -> f64 {
    if x > 0.0 { 1.0 / x } else { 0.0 }
}

#[inline(always)]
fn splat<S: Lanes>(s: S, x: &[Singles; 3], q: usize) -> [S::f32s; 3] {
    [s.splat_f32s(x[0].0[q]), s.splat_f32s(x[1].0[q]), s.splat_f32s(x[2].0[q])]
}

/// r^2, and x - y.
#[inline(always)]
fn apart<S: Lanes>(s: S, x: [S::f32s; 3], y: [S::f32s; 3]) -> (S::f32s, [S::f32s; 3]) {
    let d = [s.sub_f32s(x[0], y[0]), s.sub_f32s(x[1], y[1]), s.sub_f32s(x[2], y[2])];
    let r2 = s.mul_add_e_f32s(d[1], d[1], s.mul_f32s(d[2], d[2]));
    (s.mul_add_e_f32s(d[0], d[0], r2), d)
}

/// `tile::Sums` of 2^(-r).
pub(super) struct SingleSums<'a> {
    pub view: View,
    pub rows: Slab<'a>,
    pub columns: Slab<'a>,
    pub row_factor: f64,
    pub column_factor: f64,
    pub row_sums: &'a mut [f64],
    pub column_sums: &'a mut [f64],
}

impl Task for SingleSums<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Lanes>(self, s: S) {
        let n = self.columns.weight.len().div_ceil(S::F32_LANES);
        let (x, y) = (points(&self.rows, &self.view), points(&self.columns, &self.view));
        let [y0, y1, y2] = [&y[0].vectors::<S>()[..n], &y[1].vectors::<S>()[..n], &y[2].vectors::<S>()[..n]];
        let [by_rows, by_columns] = [largest(self.rows.weight), largest(self.columns.weight)];
        let row_weights = Singles::new(self.rows.weight, 0.0, inverse(by_rows));
        let weights = Singles::new(self.columns.weight, 0.0, inverse(by_columns));
        let weights = &weights.vectors::<S>()[..n];
        let mut column_sums = Singles([0.0; LEAF]);
        let sums = &mut S::as_mut_simd_f32s(&mut column_sums.0).0[..n];
        let base = s.splat_f32s(-self.view.shift as f32);
        let factor = self.row_factor * by_columns;
        for (q, row_sums) in self.row_sums.chunks_exact_mut(WIDTH).enumerate() {
            let x = splat(s, &x, q);
            let weight = s.splat_f32s(row_weights.0[q]);
            let mut sum = s.splat_f32s(0.0);
            for t in 0..n {
                let (r2, _) = apart(s, x, [y0[t], y1[t], y2[t]]);
                let e = s.exp2_single(s.negate_mul_add_e_f32s(r2, s.rsqrt_single(r2), base));
                sum = s.mul_add_e_f32s(weights[t], e, sum);
                sums[t] = s.mul_add_e_f32s(weight, e, sums[t]);
            }
            s.add_single(sum, factor, row_sums);
        }
        let factor = self.column_factor * by_rows;
        for (sum, single) in self.column_sums.iter_mut().zip(&column_sums.0) {
            *sum += factor * f64::from(*single);
        }
    }
}

/// `pull::Pull` of 2^(-r).
pub(super) struct SinglePull<'a> {
    pub view: View,
    pub rows: Slab<'a>,
    pub pull: &'a [f64],
    pub columns: Slab<'a>,
    pub charge: &'a [f64],
    pub row_factor: f64,
    pub column_factor: f64,
    pub out: &'a mut [f64],
}

impl Task for SinglePull<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Lanes>(self, s: S) {
        let n = self.columns.weight.len().div_ceil(S::F32_LANES);
        let (x, y) = (points(&self.rows, &self.view), points(&self.columns, &self.view));
        let [y0, y1, y2] = [&y[0].vectors::<S>()[..n], &y[1].vectors::<S>()[..n], &y[2].vectors::<S>()[..n]];
        let [of_weights, of_charges] = [largest(self.columns.weight), largest(self.charge)];
        let weights = Singles::new(self.columns.weight, 0.0, inverse(of_weights));
        let charges = Singles::new(self.charge, 0.0, inverse(of_charges));
        let (weights, charges) = (&weights.vectors::<S>()[..n], &charges.vectors::<S>()[..n]);
        let (of_weights, of_charges) = (of_weights * self.row_factor, of_charges * self.column_factor);
        let unit = (largest(self.pull) * of_weights).max(largest(self.rows.weight) * of_charges);
        let by_weight = Singles::new(self.pull, 0.0, of_weights * inverse(unit));
        let by_charge = Singles::new(self.rows.weight, 0.0, of_charges * inverse(unit));
        let base = s.splat_f32s(-self.view.shift as f32);
        for (q, out) in self.out.chunks_exact_mut(PULL).enumerate() {
            let x = splat(s, &x, q);
            let (by_weight, by_charge) = (s.splat_f32s(by_weight.0[q]), s.splat_f32s(by_charge.0[q]));
            let mut sum = [s.splat_f32s(0.0); 4];
            for t in 0..n {
                let (r2, d) = apart(s, x, [y0[t], y1[t], y2[t]]);
                let g = s.rsqrt_single(r2);
                let e = s.exp2_single(s.negate_mul_add_e_f32s(r2, g, base));
                let k = s.mul_add_e_f32s(by_weight, weights[t], s.mul_f32s(by_charge, charges[t]));
                let k = s.mul_f32s(k, s.mul_f32s(e, g));
                for c in 0..3 {
                    sum[c] = s.mul_add_e_f32s(k, d[c], sum[c]);
                }
                sum[3] = s.mul_add_e_f32s(charges[t], e, sum[3]);
            }
            let (force, mass) = out.split_at_mut(3 * WIDTH);
            for (sum, out) in sum.into_iter().zip(force.chunks_exact_mut(WIDTH)) {
                s.add_single(sum, unit, out);
            }
            s.add_single(sum[3], of_charges, mass);
        }
    }
}
