//! Tiles in single precision, for pairs whose share of the sums is so small that its last digits do not count.
//!
//! Why the sums of a tile err by no more than `error` times its largest E times the weights: let u be the unit
//! roundoff, D the diagonal of the box around both nodes, D_d its sides, and G = `NEAREST` the least distance. Coordinates
//! are counted from the middle of the columns: they round by u D_d on the rows, u D_d / 2 on the columns, a difference of
//! two by another u D_d: x - y errs by 5 u D / 2. Squares and their sum add 3 u / 2 to the relative error of r, 1/sqrt 4 u,
//! the exponent's own rounding u: it errs by 9 u D (with r <= D and the shift, a whole number, exact), and E by log 2 times
//! that, below 7 u D. The pull (x - y) / r errs by another 10 u D / G. Constants: 5 u for 2^z, below 20 u for weights, seeds
//! and products, 64 u for adding up the tile: 100 u in all. What underflows is below 2^-126 of the largest weight, the spread of E being within 2^64.
//!
//! Weights are divided by the largest of their kind and seeds by theirs, so that nothing leaves the range of numbers.

use super::bounds::{Bounds, norm};
use super::lanes::{Lanes, Task, WIDTH};
use super::mask::Mask;
use super::pull::PULL;
use super::single_lanes::ROUNDING;
use super::tree::{LEAF, Tree};

/// Pairs that may be nearer to each other than this, in units, are left to double precision.
pub(super) const NEAREST: f64 = 8.0;

/// Largest diagonal, in units: whole shifts are exact up to here, and errors still small.
const WIDEST: f64 = 4096.0;

/// Largest spread of log2 E in a tile.
const SPREAD: f64 = 64.0;

/// The bound of the relative error of the sums of a tile of 2^(-r), if it may be summed in single precision.
pub(super) fn error(rows: &Bounds, columns: &Bounds) -> Option<f64> {
    let diagonal = 2.0 * norm(rows.join(columns).half_sides());
    let spread = rows.reach(columns) - rows.gap(columns);
    (diagonal <= WIDEST && spread <= SPREAD).then_some(((7.0 + 10.0 / NEAREST) * diagonal + 100.0) * ROUNDING)
}

/// Numbers at the points of a cloud in tree order, divided by the largest of their leaf.
#[derive(Debug)]
pub(super) struct Rounded {
    values: Vec<f32>,
    /// Per leaf, in the order of the points.
    largest: Vec<f64>,
}

impl Rounded {
    pub fn new(values: &[f64]) -> Self {
        let mut rounded = Self { values: Vec::with_capacity(values.len() + LEAF), largest: Vec::new() };
        for leaf in values.chunks(LEAF) {
            let largest = leaf.iter().fold(0.0, |largest, value| f64::max(largest, value.abs()));
            let inverse = if largest > 0.0 { 1.0 / largest } else { 0.0 };
            rounded.values.extend(leaf.iter().map(|value| (value * inverse) as f32));
            rounded.values.resize(rounded.values.len().next_multiple_of(LEAF), 0.0);
            rounded.largest.push(largest);
        }
        rounded
    }

    pub fn leaf(&self, first: usize) -> Part<'_> {
        Part { values: &self.values[first..first + LEAF], largest: self.largest[first / LEAF] }
    }
}

/// `Rounded` numbers of one leaf, padded by zeros, and what they were divided by.
#[derive(Clone, Copy, Debug)]
pub(super) struct Part<'a> {
    values: &'a [f32],
    largest: f64,
}

/// Coordinates from the middle of each leaf.
#[derive(Debug)]
pub(super) struct Local {
    x: [Vec<f32>; 3],
}

impl Local {
    pub fn new(tree: &Tree, boxes: &[Bounds], x: [&[f64]; 3]) -> Self {
        let mut local: [Vec<f32>; 3] = Default::default();
        for (node, bounds) in tree.nodes.iter().zip(boxes).filter(|(node, _)| node.is_leaf()) {
            let origin = bounds.centre();
            for d in 0..3 {
                local[d].extend(x[d][node.range()].iter().map(|x| (x - origin[d]) as f32));
                let last = local[d][local[d].len() - 1];
                local[d].resize(local[d].len().next_multiple_of(LEAF), last);
            }
        }
        Self { x: local }
    }

    pub fn leaf(&self, first: usize) -> [&[f32]; 3] {
        [&self.x[0][first..first + LEAF], &self.x[1][first..first + LEAF], &self.x[2][first..first + LEAF]]
    }
}

/// The pairs of a tile: coordinates of its rows, local ones of its columns and where they are counted from.
#[derive(Clone, Copy, Debug)]
pub(super) struct SingleTile<'a> {
    pub rows: [&'a [f64]; 3],
    pub columns: [&'a [f32]; 3],
    pub origin: [f64; 3],
    pub mask: Mask,
    /// The power of two that E are counted in, whole, and no more than one below the largest.
    pub shift: f64,
}

/// Numbers of one leaf.
#[repr(align(64))]
struct Singles([f32; LEAF]);

impl Singles {
    /// values - origin, padded by copies of the last
    #[inline(always)]
    fn new(values: &[f64], origin: f64) -> Self {
        let mut all = Self([0.0; LEAF]);
        for (single, value) in all.0.iter_mut().zip(values) {
            *single = (value - origin) as f32;
        }
        let last = all.0[values.len() - 1];
        all.0[values.len()..].fill(last);
        all
    }

    #[inline(always)]
    fn vectors<S: Lanes>(&self) -> &[S::f32s] {
        vectors::<S>(&self.0)
    }
}

impl SingleTile<'_> {
    #[inline(always)]
    fn rows(&self) -> [Singles; 3] {
        let ([x, y, z], [a, b, c]) = (self.rows, self.origin);
        [Singles::new(x, a), Singles::new(y, b), Singles::new(z, c)]
    }

    #[inline(always)]
    fn columns<S: Lanes>(&self) -> [&[S::f32s]; 3] {
        let [x, y, z] = self.columns;
        [vectors::<S>(x), vectors::<S>(y), vectors::<S>(z)]
    }
}

#[inline(always)]
fn vectors<S: Lanes>(values: &[f32]) -> &[S::f32s] {
    &S::as_simd_f32s(values).0[..LEAF / S::F32_LANES]
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
    pub tile: SingleTile<'a>,
    pub row_weights: Part<'a>,
    pub column_weights: Part<'a>,
    pub row_factor: f64,
    pub column_factor: f64,
    pub row_sums: &'a mut [f64],
    pub column_sums: &'a mut [f64],
}

impl Task for SingleSums<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Lanes>(self, s: S) {
        let n = LEAF / S::F32_LANES;
        let (x, [y0, y1, y2]) = (self.tile.rows(), self.tile.columns::<S>());
        let weights = vectors::<S>(self.column_weights.values);
        let mut column_sums = Singles([0.0; LEAF]);
        let sums = S::as_mut_simd_f32s(&mut column_sums.0).0;
        let base = s.splat_f32s(-self.tile.shift as f32);
        let runs = self.tile.mask.runs(n, S::F32_LANES);
        let factor = self.row_factor * self.column_weights.largest;
        for (q, row_sums) in self.row_sums.chunks_exact_mut(WIDTH).enumerate() {
            let x = splat(s, &x, q);
            let weight = s.splat_f32s(self.row_weights.values[q]);
            let mut sum = s.splat_f32s(0.0);
            for (first, end) in runs.of(q) {
                for t in first..end {
                    let (r2, _) = apart(s, x, [y0[t], y1[t], y2[t]]);
                    let e = s.exp2_single(s.negate_mul_add_e_f32s(r2, s.rsqrt_single(r2), base));
                    sum = s.mul_add_e_f32s(weights[t], e, sum);
                    sums[t] = s.mul_add_e_f32s(weight, e, sums[t]);
                }
            }
            s.add_single(sum, factor, row_sums);
        }
        let factor = self.column_factor * self.row_weights.largest;
        for (sum, single) in self.column_sums.iter_mut().zip(&column_sums.0) {
            *sum += factor * f64::from(*single);
        }
    }
}

/// `pull::Pull` of 2^(-r).
pub(super) struct SinglePull<'a> {
    pub tile: SingleTile<'a>,
    pub row_weights: Part<'a>,
    pub pull: Part<'a>,
    pub column_weights: Part<'a>,
    pub charge: Part<'a>,
    pub row_factor: f64,
    pub column_factor: f64,
    pub out: &'a mut [f64],
}

impl Task for SinglePull<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Lanes>(self, s: S) {
        let (x, y) = (self.tile.rows(), self.tile.columns);
        let (weights, charges) = (self.column_weights.values, self.charge.values);
        // The larger of the two causes has the factor one.
        let of_charge = self.charge.largest * self.column_factor;
        let by_charge = self.row_weights.largest * of_charge;
        let by_weight = self.pull.largest * self.column_weights.largest * self.row_factor;
        let unit = by_charge.max(by_weight);
        let inverse = if unit > 0.0 { 1.0 / unit } else { 0.0 };
        let (by_charge, by_weight) =
            (s.splat_f32s((by_charge * inverse) as f32), s.splat_f32s((by_weight * inverse) as f32));
        let base = s.splat_f32s(-self.tile.shift as f32);
        let runs = self.tile.mask.runs(LEAF, 1);
        let rows = self.out.len() / PULL;
        // Here the lanes are rows: columns leave nothing behind.
        for block in 0..rows.div_ceil(S::F32_LANES) {
            let first_row = block * S::F32_LANES;
            let x = [x[0].vectors::<S>()[block], x[1].vectors::<S>()[block], x[2].vectors::<S>()[block]];
            let by_weight = s.mul_f32s(vectors::<S>(self.pull.values)[block], by_weight);
            let by_charge = s.mul_f32s(vectors::<S>(self.row_weights.values)[block], by_charge);
            let mut sum = [s.splat_f32s(0.0); 4];
            for (first, end) in runs.of(first_row) {
                for t in first..end {
                    let (r2, d) = apart(s, x, [s.splat_f32s(y[0][t]), s.splat_f32s(y[1][t]), s.splat_f32s(y[2][t])]);
                    let g = s.rsqrt_single(r2);
                    let e = s.exp2_single(s.negate_mul_add_e_f32s(r2, g, base));
                    let charge = s.splat_f32s(charges[t]);
                    let k = s.mul_add_e_f32s(by_weight, s.splat_f32s(weights[t]), s.mul_f32s(by_charge, charge));
                    let k = s.mul_f32s(k, s.mul_f32s(e, g));
                    for c in 0..3 {
                        sum[c] = s.mul_add_e_f32s(k, d[c], sum[c]);
                    }
                    sum[3] = s.mul_add_e_f32s(charge, e, sum[3]);
                }
            }
            let mut spread = [[0.0; 2 * WIDTH]; 4];
            for c in 0..4 {
                S::as_mut_simd_f32s(&mut spread[c]).0[0] = sum[c];
            }
            let out = &mut self.out[first_row * PULL..];
            for (k, out) in out.chunks_exact_mut(PULL).take(S::F32_LANES).enumerate() {
                for c in 0..3 {
                    out[c * WIDTH] += unit * f64::from(spread[c][k]);
                }
                out[3 * WIDTH] += of_charge * f64::from(spread[3][k]);
            }
        }
    }
}
