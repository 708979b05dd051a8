//! How many Chebyshev nodes a box needs so that a kernel is interpolated to a given error.
//!
//! What is interpolated is not E(x, y) itself but E 2^(-v.(x - c)) 2^(-w.(y - c')): a plane wave about equal to the
//! gradient of log2 E, taken out on both sides, leaves a factor that hardly varies however fast E decays. The wave
//! vectors lie on a lattice, so that many pairs share them.
//!
//! Proof that the error over E(X0) times the waves stays within 2^budget, with X = x - y, X0 between the centres. All
//! x and y below are any of the boxes, not of the points alone, for grid nodes lie anywhere on them.
//!
//! 1. Directions. With P_d the interpolation in direction d of the up to six of a pair,
//!    1 - P_1 .. P_n = sum_d P_1 .. P_(d-1) (1 - P_d). The norm of P_e is its Lebesgue constant, at most
//!    1 + 2/pi log p (Trefethen, Approximation Theory and Approximation Practice, ch. 15): so the error of direction d
//!    alone, all others real, may be 2^budget / n over the product of the constants of the directions before it.
//! 2. One direction. With p nodes on [-a, a], f analytic with |f| <= M in the ellipse with half axes
//!    A = a (rho + 1/rho) / 2 and b = a (rho - 1/rho) / 2, the coefficients of f are at most 2 M rho^(-k), and
//!    interpolation maps T_k, k >= p, to a T_j or zero: it errs by at most 4 M rho^(1-p) / (rho - 1) (the same, ch. 8).
//! 3. M. Let m = |Re X| and eta = |Im X|, Im X = eta e along the axis e. From
//!    |X.X|^2 = (m^2 + eta^2)^2 - 4 |Re X x Im X|^2 >= (m^2 - eta^2)^2 and 2 (Re r)^2 = |X.X| + m^2 - eta^2 follows
//!    (Re r)^2 >= m^2 - c with c = eta^2 |Re X x e|^2 / m^2 <= eta^2. Where c < m^2 therefore Re r > 0, E is analytic, and log2 |E| exceeds log2 E(m) by at most `Kernel::loss`. The smooth kernel is a function of
//!    s^2 = r^2 + 1: its lengths here are s, which never vanish, |s^2| >= m^2 + 1 - eta^2, and c is eta^2.
//! 4. At real arguments the second derivative of log2 E in any direction is within -`Kernel::dip` and
//!    `Kernel::bulge`, which bounds log2 E by its tangent at X0. What the waves leave of the tangent is the residue.
//! 5. m >= n.Re X for every unit vector n: the least of it over a box is its value at the centres less the half widths
//!    along n, and the same holds on the way from X0 to Re X, the boxes being convex. Two n are tried: along X0 and
//!    across the gap between the coordinate boxes.
//! 6. The derivative's function g E (x - y)_d is interpolated on the same grids: |g (x - y)_d| <= `Kernel::pull` in the
//!    ellipse. Its error is in proportion to `Kernel::slope`, the largest real |g r| of the pair.

use std::f64::consts::PI;

use super::bounds::norm;
use super::frame::{Frame, dot};
use super::kernel::Kernel;

/// Most nodes in one direction.
pub(super) const DEGREE: usize = 16;

/// Ellipses that are tried: b over the distance of the boxes.
const ELLIPSES: [f64; 11] = [4.0, 2.5, 1.6, 1.0, 0.85, 0.7, 0.55, 0.4, 0.28, 0.18, 0.1];

/// Cosine at the beginning and sine at the end of the arcs of a quarter of an ellipse.
const ARCS: [[f64; 2]; 3] = [[1.0, 0.5], [0.8660254037844387, 0.8660254037844387], [0.5, 1.0]];

/// Axes with a smaller cosine to the line between the centres have ellipses within the distance of the boxes.
const ACROSS: f64 = 0.6;

/// Spacing of the wave vectors: they change a wave by sqrt 2 between centre and face of the box.
const SPACING: f64 = 0.5;

/// Largest change of a wave between centre and corner, in powers of two.
const STEEPEST: f64 = 60.0;

/// Boxes nearer to each other than this times the largest half side are not interpolated.
const CLOSEST: f64 = 0.5;

/// Node counts per direction.
pub(super) type Orders = [u8; 3];

pub(super) fn nodes(orders: Orders) -> usize {
    orders.iter().map(|&p| p as usize).product()
}

/// A wave vector, in steps of the lattice of its box.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Wave([i16; 3]);

impl Wave {
    /// The one nearest to `v` on the lattice of a box; none if it would be too steep.
    fn nearest(v: [f64; 3], half: [f64; 3]) -> Option<Self> {
        let steps: [f64; 3] = std::array::from_fn(|d| (v[d] * half[d] / SPACING).round());
        (steps.iter().map(|k| k.abs()).sum::<f64>() * SPACING < STEEPEST).then_some(Self(steps.map(|k| k as i16)))
    }

    /// Powers of two per unit of length.
    pub fn vector(self, half: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|d| if half[d] > 0.0 { f64::from(self.0[d]) * SPACING / half[d] } else { 0.0 })
    }

    /// log2 of the largest value on the box.
    fn height(self) -> f64 {
        self.0.iter().map(|&k| f64::from(k).abs()).sum::<f64>() * SPACING
    }
}

/// A grid of one side of a pair.
pub(super) type Grid = (Wave, Orders);

/// Two boxes, as the kernel between them is interpolated.
pub(super) struct FarPair<'a> {
    kernel: &'a Kernel,
    frames: [&'a Frame; 2],
    /// Distance between the centres.
    apart: f64,
    /// A lower bound of the distance between the boxes, and per side and axis the cosine of the angle to its normal.
    near: f64,
    to_normal: [[f64; 3]; 2],
    radii: [f64; 2],
    waves: [Wave; 2],
    /// Per side and axis: cosine of the angle to the line between the centres.
    cosines: [[f64; 3]; 2],
    /// Per side and axis: what the lattice leaves of the gradient, times the half side.
    residue: [[f64; 3]; 2],
    all_residue: f64,
    /// log2 E between the centres.
    pub centre: f64,
    /// The largest real pull.
    slope: f64,
}

impl<'a> FarPair<'a> {
    /// `gaps`: between the coordinate boxes of the points, per direction.
    pub fn new(kernel: &'a Kernel, frames: [&'a Frame; 2], gaps: [f64; 3]) -> Option<Self> {
        let x0: [f64; 3] = std::array::from_fn(|i| frames[0].centre[i] - frames[1].centre[i]);
        let apart = norm(x0);
        let line = unit(x0);
        let across = unit(std::array::from_fn(|i| gaps[i].copysign(x0[i])));
        let from = |n: [f64; 3]| dot(n, x0) - frames[0].support(n) - frames[1].support(n);
        let (on_line, on_gap) = (from(line), from(across));
        let (near, normal) = if on_gap > on_line { (on_gap, across) } else { (on_line, line) };
        let real = near.max(0.0);
        let largest = frames.iter().flat_map(|frame| frame.half).fold(0.0, f64::max);
        if real.hypot(kernel.softening()) <= CLOSEST * largest {
            return None;
        }
        let cosines = frames.map(|frame| frame.axes.map(|axis| dot(axis, line)));
        let slopes = [kernel.log_slope(apart), -kernel.log_slope(apart)];
        let gradient = |side: usize| cosines[side].map(|cosine| slopes[side] * cosine);
        let waves = [Wave::nearest(gradient(0), frames[0].half)?, Wave::nearest(gradient(1), frames[1].half)?];
        let residue = [0, 1].map(|side| {
            let (v, wave, half) = (gradient(side), waves[side].vector(frames[side].half), frames[side].half);
            std::array::from_fn(|d| (v[d] - wave[d]).abs() * half[d])
        });
        Some(Self {
            kernel,
            frames,
            apart,
            near,
            to_normal: frames.map(|frame| frame.axes.map(|axis| dot(axis, normal))),
            radii: frames.map(Frame::radius),
            waves,
            cosines,
            residue,
            all_residue: residue.iter().flatten().sum(),
            centre: kernel.at(apart),
            slope: kernel.slope(real),
        })
    }

    /// What the error of the derivative's functions is in proportion to.
    #[cfg(test)]
    pub fn slope(&self) -> f64 {
        self.slope
    }

    /// log2 of how far E may fall below its waves between the boxes, and of how far the waves rise above the centre.
    pub fn dip_and_height(&self) -> (f64, f64) {
        let near = self.near.max(0.0).hypot(self.kernel.softening());
        let dip = 0.5 * self.kernel.dip(near) * (self.radii[0] + self.radii[1]).powi(2) + self.all_residue;
        (dip, self.waves[0].height() + self.waves[1].height())
    }

    /// Nodes that a grid on one side has at least, about: what ellipses of the largest size give, their values not rising.
    /// Cheap, and decides only what is worth trying.
    pub fn least_nodes(&self, side: usize, budget: f64) -> f64 {
        let scale = self.near.max(0.0).hypot(self.kernel.softening());
        let needed = |d: usize| {
            let half = self.frames[side].half[d];
            let part = if self.cosines[side][d].abs() < ACROSS { 1.0 } else { ELLIPSES[0] };
            let t = part * scale / half;
            if half > 0.0 { (-budget / log2_above(t + t.hypot(1.0))).max(0.0) + 1.0 } else { 1.0 }
        };
        needed(0).floor() * needed(1).floor() * needed(2).floor()
    }

    /// The smallest grid on one side with fewer than `limit` nodes that keeps its share of an error, over E between the
    /// centres times the waves, of 2^budget in all directions, under interpolations before it that amplify by
    /// `amplified`.
    pub fn grid(&self, side: usize, budget: f64, mut amplified: f64, limit: usize) -> Option<Grid> {
        let directions = self.frames.iter().flat_map(|frame| frame.half).filter(|&a| a > 0.0).count();
        let mut orders = [1; 3];
        for d in 0..3 {
            orders[d] = self.order(side, d, budget - (4.0 * amplified * directions as f64).log2())?;
            amplified *= lebesgue_constant(orders[d]);
            if nodes(orders) >= limit {
                return None;
            }
        }
        Some((self.waves[side], orders))
    }

    fn order(&self, side: usize, d: usize, budget: f64) -> Option<u8> {
        let a = self.frames[side].half[d];
        if a == 0.0 {
            return Some(1);
        }
        let soft2 = self.kernel.softening().powi(2);
        let cosine = self.cosines[side][d];
        let to_normal = self.to_normal[side][d].abs();
        let radius = self.radii[0] + self.radii[1];
        // The part of Re X across the axis is at most this.
        let across = self.apart * (1.0 - cosine * cosine).max(0.0).sqrt()
            + (self.radii[side].powi(2) - a * a).max(0.0).sqrt()
            + self.radii[1 - side];
        let scale = (self.near.max(0.0).powi(2) + soft2).sqrt();
        let mut best = f64::INFINITY;
        for part in ELLIPSES {
            let (b, t) = (part * scale, part * scale / a);
            let longer = (t * t + 1.0).sqrt();
            // The ellipse in arcs, each as if its largest extension came with its largest imaginary part.
            let mut rise: f64 = 0.0;
            for [cosine_from, sine_to] in ARCS {
                let beyond = (a * longer * cosine_from - a).max(0.0);
                let near = (self.near - beyond * to_normal).max(0.0);
                let near2 = near * near + soft2;
                let eta = b * sine_to;
                let mut c = eta * eta;
                if soft2 == 0.0 && across < near {
                    c = (across / near * eta).powi(2);
                }
                if near2 <= c {
                    rise = f64::INFINITY;
                    break;
                }
                let from_centre = radius + beyond;
                let bulge = 0.5 * self.kernel.bulge(near2.sqrt()) * from_centre * from_centre;
                let pull = self.kernel.pull(near2, c, eta * eta) / self.slope;
                rise = rise.max(self.kernel.loss(near2.sqrt(), c) + bulge + log2_above(pull.max(1.0)));
            }
            if rise == f64::INFINITY {
                continue;
            }
            let residue = self.all_residue + (longer - 1.0) * self.residue[side][d];
            let rho = t + longer;
            let needed = 1.0 + (rise + residue + log2_above(1.0 / (rho - 1.0)) - budget) / log2_below(rho);
            if needed > best {
                break;
            }
            best = needed;
        }
        if best > DEGREE as f64 {
            return None;
        }
        let least = best.max(1.0) as u8;
        Some(if best > f64::from(least) { least + 1 } else { least })
    }
}

/// A vector's direction; zero for zero.
fn unit(x: [f64; 3]) -> [f64; 3] {
    let length = norm(x);
    x.map(|c| if length > 0.0 { c / length } else { 0.0 })
}

/// At least log2 x, by at most 0.09, for normal x.
fn log2_above(x: f64) -> f64 {
    log2_below(x) + 0.0861
}

/// At most log2 x, by at most 0.09, for normal x.
fn log2_below(x: f64) -> f64 {
    let exponent = (x.to_bits() >> 52) as f64 - 1023.0;
    let mantissa = f64::from_bits((x.to_bits() & 0x000F_FFFF_FFFF_FFFF) | 0x3FF0_0000_0000_0000);
    exponent + (mantissa - 1.0)
}

/// A bound of the Lebesgue constant of p nodes.
fn lebesgue_constant(p: u8) -> f64 {
    1.0 + 2.0 / PI * f64::from(p).ln()
}

/// Product of the Lebesgue constants of a grid: what rounding is amplified by.
pub(super) fn lebesgue(orders: Orders) -> f64 {
    orders.iter().map(|&p| lebesgue_constant(p)).product()
}
