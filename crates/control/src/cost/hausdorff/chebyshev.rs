//! How many Chebyshev nodes a box needs so that a kernel is interpolated to a given error.
//!
//! What is interpolated is not E(x, y) itself but E 2^(-v.(x - c)) 2^(-w.(y - c')): a plane wave about equal to the
//! gradient of log2 E, taken out on both sides, leaves a factor that hardly varies however fast E decays. The wave
//! vectors lie on a lattice, so that many pairs share them.
//!
//! With p nodes, interpolating f on [-a, a] errs by at most 4 M rho^(1-p) / (rho - 1) when |f| <= M in the ellipse
//! with half axes A = a (rho + 1/rho) / 2 and b = a (rho - 1/rho) / 2 (Trefethen, Approximation Theory and
//! Approximation Practice, thm 8.2). Over the six directions of a pair of boxes these errors E_d f add, each under the
//! interpolations of other directions. Those amplify by their Lebesgue constants 1 + 2/pi log p, or, because E_d f is
//! itself analytic in the other directions, by 1 + 4 * 2^(1-p) if M is taken over their ellipses of rho = 2 as well.
//!
//! M: let X = x - y be on ellipses, m the length of its real part, eta its imaginary part and X0 between the centres.
//! From |X.X|^2 = (m^2 + eta^2)^2 - 4 |Re X x eta|^2 follows Re r >= sqrt(m^2 - c) with c the lesser of eta^2 and
//! 2 |Re X x eta|^2 / m^2, and log2 E there exceeds its value at Re X by at most `Kernel::loss`. At real arguments
//! log2 E is at most its tangent at X0 plus `Kernel::bulge` |X - X0|^2 / 2, and at least the tangent minus
//! `Kernel::dip` |X - X0|^2 / 2. The smooth kernel is a function of s^2 = r^2 + 1: its lengths here are s, which never
//! vanish, and c is eta^2.

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

/// b / a, and A / a - 1, of the ellipse of rho = 2.
const SMALL: [f64; 2] = [0.75, 0.25];

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
    /// Distance between the centres, and a lower bound of any between the boxes.
    apart: f64,
    near: f64,
    /// Half widths of both boxes along the line between the centres.
    support: f64,
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
    /// `gap`: some lower bound of the distance between the boxes' points.
    pub fn new(kernel: &'a Kernel, frames: [&'a Frame; 2], gap: f64) -> Option<Self> {
        let x0: [f64; 3] = std::array::from_fn(|i| frames[0].centre[i] - frames[1].centre[i]);
        let apart = norm(x0);
        let line = x0.map(|x| if apart > 0.0 { x / apart } else { 0.0 });
        let support = frames[0].support(line) + frames[1].support(line);
        let near = (apart - support).max(gap);
        let largest = frames.iter().flat_map(|frame| frame.half).fold(0.0, f64::max);
        if near.hypot(kernel.softening()) <= CLOSEST * largest {
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
            support,
            radii: frames.map(Frame::radius),
            waves,
            cosines,
            residue,
            all_residue: residue.iter().flatten().sum(),
            centre: kernel.at(apart),
            slope: kernel.slope(near),
        })
    }

    /// log2 of how far E may fall below its waves between the boxes, and of how far the waves rise above the centre.
    pub fn dip_and_height(&self) -> (f64, f64) {
        let near = self.near.hypot(self.kernel.softening());
        let dip = 0.5 * self.kernel.dip(near) * (self.radii[0] + self.radii[1]).powi(2) + self.all_residue;
        (dip, self.waves[0].height() + self.waves[1].height())
    }

    /// The smallest grid on one side with fewer than `limit` nodes that keeps the error, over E between the centres
    /// times the waves, within 2^budget in all directions, given what the interpolations of others amplify by.
    pub fn grid(&self, side: usize, budget: f64, amplified: f64, limit: usize) -> Option<Grid> {
        let directions = self.frames.iter().flat_map(|frame| frame.half).filter(|&a| a > 0.0).count();
        let budget = budget - (4.0 * amplified * directions as f64).log2();
        let mut orders = [1; 3];
        for d in 0..3 {
            orders[d] = self.order(side, d, budget)?;
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
        let cosine = self.cosines[side][d].abs();
        // The other directions on their small ellipses: how much nearer, farther, and how far from real.
        let (radii2, own) = (self.radii[0].powi(2) + self.radii[1].powi(2), cosine * a);
        let radius = (1.0 + SMALL[1]) * (self.radii[0] + self.radii[1]);
        let nearest = self.near - SMALL[1] * (self.support - own);
        let others2 = SMALL[0] * SMALL[0] * (radii2 - a * a).max(0.0);
        let others = others2.sqrt();
        // The part of X across the axis is at most this.
        let across = self.apart * (1.0 - cosine * cosine).max(0.0).sqrt()
            + (1.0 + SMALL[1]) * ((self.radii[side].powi(2) - a * a).max(0.0).sqrt() + self.radii[1 - side]);
        let scale = (self.near * self.near + soft2).sqrt();
        let mut best = f64::INFINITY;
        for part in ELLIPSES {
            let (b, t) = (part * scale, part * scale / a);
            let longer = (t * t + 1.0).sqrt();
            // The ellipse in three arcs, each as if its largest extension came with its largest imaginary part.
            let mut rise: f64 = 0.0;
            for [cosine_from, sine_to] in ARCS {
                let beyond = (a * longer * cosine_from - a).max(0.0);
                let near = nearest - beyond * cosine;
                let near2 = near * near + soft2;
                let eta = b * sine_to;
                let eta2 = eta * eta + others2;
                let mut c = eta2;
                if soft2 == 0.0 {
                    c = c.min(2.0 * (across / near * eta + others).powi(2));
                }
                if near <= 0.0 || near2 <= c {
                    rise = f64::INFINITY;
                    break;
                }
                let from_centre = radius + beyond;
                let bulge = 0.5 * self.kernel.bulge(near2.sqrt()) * from_centre * from_centre;
                let pull = self.kernel.pull(near2, c, eta2) / self.slope;
                rise = rise.max(self.kernel.loss(near2.sqrt(), c) + bulge + log2_above(pull.max(1.0)));
            }
            if rise == f64::INFINITY {
                continue;
            }
            let residue = (1.0 + SMALL[1]) * self.all_residue + (longer - 1.0) * self.residue[side][d];
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

/// What the interpolations of a grid amplify an analytic function by.
pub(super) fn amplification(orders: Orders) -> f64 {
    orders.iter().map(|&p| lebesgue_constant(p).min(1.0 + 8.0 * (-f64::from(p)).exp2())).product()
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
