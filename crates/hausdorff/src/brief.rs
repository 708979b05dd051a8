//! Tiles of 2^(-r) to eleven digits, for sums that are wanted to ten.
//!
//! Why the terms of a tile err by no more than `ERROR`, relative: coordinates are counted from the middle of the columns,
//! and r^2 = |x|^2 + |y|^2 - 2 x.y errs by rounding, at most 24 u R^2 with u the unit roundoff and R the largest distance
//! of two points (|x|, |y| <= R). With G the least distance r errs by 12 u R^2 / G, at most 12 u `FLATTEST`, the root by
//! another `ROOT_ERROR` r with r <= `FARTHEST`, and E by log 2 times these. 2^z adds `POWER_ERROR`. The pull (x - y) / r
//! comes as x sum_t k_t - sum_t k_t y_t, which rounds by 2 u R / G of each term at most, for adding up a few times that:
//! below 1e-12, with R <= 1000 G.

use std::f64::consts::LN_2;

use super::aligned::Aligned;
use super::bounds::Bounds;
use super::brief_lanes::{POWER_ERROR, ROOT_ERROR};
use super::lanes::{Lanes, Task, WIDTH};
use super::mask::Mask;
use super::pull::{PULL, add};
use super::tile::vectors;
use super::tree::{LEAF, Tree};

/// Relative error of the terms: 1.5e-11.
pub(super) const ERROR: f64 = LN_2 * (6.0 * f64::EPSILON * FLATTEST + ROOT_ERROR * FARTHEST) + POWER_ERROR + 1e-12;

/// Largest distance of two points of a tile, in units.
const FARTHEST: f64 = 100.0;

/// Largest R^2 / G, in units.
const FLATTEST: f64 = 1000.0;

/// Whether the points of two boxes may be summed in brief.
pub(super) fn fits(rows: &Bounds, columns: &Bounds) -> bool {
    let (gap, reach) = (rows.gap(columns), rows.reach(columns));
    reach <= FARTHEST && reach * reach <= FLATTEST * gap && reach <= FLATTEST * gap
}

/// Coordinates from the middle of each leaf, and their squares added up, numbered as the points (padded).
#[derive(Debug)]
pub(super) struct Centred {
    x: [Aligned; 4],
}

impl Centred {
    pub fn new(tree: &Tree, boxes: &[Bounds], x: [&[f64]; 3]) -> Self {
        let mut centred: [Vec<f64>; 4] = Default::default();
        for (node, bounds) in tree.nodes.iter().zip(boxes).filter(|(node, _)| node.is_leaf()) {
            let range = node.range().start..node.range().end.next_multiple_of(WIDTH);
            let origin = bounds.centre();
            for k in range {
                let y: [f64; 3] = std::array::from_fn(|d| x[d][k] - origin[d]);
                (0..3).for_each(|d| centred[d].push(y[d]));
                centred[3].push(square(y));
            }
        }
        Self { x: centred.map(|values| values.into_iter().collect()) }
    }

    /// Those of a leaf.
    pub fn leaf(&self, range: std::ops::Range<usize>) -> [&[f64]; 4] {
        std::array::from_fn(|d| &self.x[d][range.clone()])
    }
}

fn square(x: [f64; 3]) -> f64 {
    x[0] * x[0] + x[1] * x[1] + x[2] * x[2]
}

/// The pairs of a tile: coordinates of its rows, those of its columns from `origin`.
#[derive(Clone, Copy, Debug)]
pub(super) struct BriefTile<'a> {
    pub rows: [&'a [f64]; 3],
    pub columns: [&'a [f64]; 4],
    pub origin: [f64; 3],
    pub mask: Mask,
    /// The power of two that E are counted in, whole, and no more than one below the largest.
    pub shift: f64,
}

impl BriefTile<'_> {
    /// A row from the origin.
    #[inline(always)]
    fn row(&self, q: usize) -> [f64; 3] {
        [self.rows[0][q] - self.origin[0], self.rows[1][q] - self.origin[1], self.rows[2][q] - self.origin[2]]
    }

    #[inline(always)]
    fn columns<S: Lanes>(&self, n: usize) -> [&[S::f64s]; 4] {
        let [x, y, z, square] = self.columns;
        [vectors::<S>(x, n), vectors::<S>(y, n), vectors::<S>(z, n), vectors::<S>(square, n)]
    }
}

/// -2 x and |x|^2, the same in all lanes.
#[inline(always)]
fn splat<S: Lanes>(s: S, x: [f64; 3]) -> [S::f64s; 4] {
    [s.splat_f64s(-2.0 * x[0]), s.splat_f64s(-2.0 * x[1]), s.splat_f64s(-2.0 * x[2]), s.splat_f64s(square(x))]
}

/// r^2
#[inline(always)]
fn apart<S: Lanes>(s: S, x: &[S::f64s; 4], y: &[&[S::f64s]; 4], t: usize) -> S::f64s {
    let r2 = s.mul_add_e_f64s(x[2], y[2][t], s.add_f64s(y[3][t], x[3]));
    let r2 = s.mul_add_e_f64s(x[1], y[1][t], r2);
    s.mul_add_e_f64s(x[0], y[0][t], r2)
}

/// `tile::Sums` of 2^(-r).
pub(super) struct BriefSums<'a> {
    pub tile: BriefTile<'a>,
    pub row_weights: &'a [f64],
    pub column_weights: &'a [f64],
    pub row_factor: f64,
    pub column_factor: f64,
    pub row_sums: &'a mut [f64],
    pub column_sums: &'a mut [f64],
}

impl Task for BriefSums<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Lanes>(self, s: S) {
        let sums = S::as_mut_simd_f64s(self.column_sums).0;
        let n = sums.len();
        let y = self.tile.columns::<S>(n);
        let weights = vectors::<S>(self.column_weights, n);
        let base = -self.tile.shift;
        let runs = self.tile.mask.runs(n, S::F64_LANES);
        for (q, row_sums) in self.row_sums.chunks_exact_mut(WIDTH).enumerate() {
            let x = splat(s, self.tile.row(q));
            let weight = s.splat_f64s(self.row_weights[q] * self.column_factor);
            let mut sum = s.splat_f64s(0.0);
            for (first, end) in runs.of(q) {
                if first == end {
                    continue;
                }
                // Distances are formed one vector ahead of their exponentials: two short chains of operations in flight.
                let (mut ahead, _) = s.roots_brief(apart(s, &x, &y, first));
                for t in first..end {
                    let r = ahead;
                    (ahead, _) = s.roots_brief(apart(s, &x, &y, (t + 1).min(n - 1)));
                    let e = s.power_brief(base, r);
                    sum = s.mul_add_e_f64s(weights[t], e, sum);
                    sums[t] = s.mul_add_e_f64s(weight, e, sums[t]);
                }
            }
            add(s, row_sums, &[s.mul_f64s(sum, s.splat_f64s(self.row_factor))]);
        }
    }
}

/// `pull::Pull` of 2^(-r).
pub(super) struct BriefPull<'a> {
    pub tile: BriefTile<'a>,
    pub row_weights: &'a [f64],
    pub pull: &'a [f64],
    pub column_weights: &'a [f64],
    pub charge: &'a [f64],
    pub row_factor: f64,
    pub column_factor: f64,
    pub out: &'a mut [f64],
}

impl Task for BriefPull<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Lanes>(self, s: S) {
        let n = self.charge.len() / S::F64_LANES;
        let y = self.tile.columns::<S>(n);
        let weights = vectors::<S>(self.column_weights, n);
        let charges = vectors::<S>(self.charge, n);
        let base = -self.tile.shift;
        let runs = self.tile.mask.runs(n, S::F64_LANES);
        for (q, out) in self.out.chunks_exact_mut(PULL).enumerate() {
            let row = self.tile.row(q);
            let x = splat(s, row);
            let by_charge = s.splat_f64s(self.row_weights[q] * self.column_factor);
            let by_weight = s.splat_f64s(self.pull[q] * self.row_factor);
            let zero = s.splat_f64s(0.0);
            let (mut all, mut moments, mut mass) = (zero, [zero; 3], zero);
            for (first, end) in runs.of(q) {
                for t in first..end {
                    let (r, inverse) = s.roots_brief(apart(s, &x, &y, t));
                    let e = s.power_brief(base, r);
                    let k = s.mul_add_e_f64s(by_weight, weights[t], s.mul_f64s(by_charge, charges[t]));
                    let k = s.mul_f64s(k, s.mul_f64s(e, inverse));
                    all = s.add_f64s(all, k);
                    for c in 0..3 {
                        moments[c] = s.mul_add_e_f64s(k, y[c][t], moments[c]);
                    }
                    mass = s.mul_add_e_f64s(charges[t], e, mass);
                }
            }
            let mut sum = [zero, zero, zero, s.mul_f64s(mass, s.splat_f64s(self.column_factor))];
            for c in 0..3 {
                sum[c] = s.sub_f64s(s.mul_f64s(all, s.splat_f64s(row[c])), moments[c]);
            }
            add(s, out, &sum);
        }
    }
}

const _: () = assert!(LEAF.is_multiple_of(WIDTH), "leaves start on whole vectors");
