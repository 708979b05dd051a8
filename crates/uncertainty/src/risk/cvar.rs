//! [`Cvar`]: the expected cost of the worst share of cases.

use super::standard::Standard;
use super::{Risk, RiskError, check_signs, check_smoothing};

/// Conditional value at risk: the expected cost of the worst `1 - level` of the cases, smoothed.
///
/// `R = min_t t + 1/(1 - level) sum p_i g((j_i - t)/e) e` with `g(x) = log(1 + exp x)` in place of `max(0, x)`. The
/// auxiliary t solves `sum p_i g'((j_i - t)/e) = 1 - level`, which is monotone in t: Newton's method inside a bracket.
/// `CVaR <= R <= CVaR + e log 2/(1 - level)`. The width is `e = s D`, 0.05 standard
/// deviations by default. Convex, scales with the costs.
///
/// Weights: `p_i g'_i/(1 - level) + (dR/de)(de/dj_i)`, t being stationary (the envelope theorem),
/// `dR/de = 1/(1 - level) sum p_i (g_i - x_i g'_i)`, `de/dj_i = s p_i y_i`; `p_i` where all costs are equal.
///
/// Source: Rockafellar & Uryasev, Journal of Risk 2 (2000); smoothed plus function: Kouri & Surowiec, SIAM J. Optim. 26
/// (2016).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cvar {
    /// Share of cases that are not looked at, in (0, 1); 0.9 looks at the worst tenth.
    pub level: f64,
    /// Width over which the plus function is rounded, as a share of the standard deviation.
    pub smoothing: f64,
}

impl Default for Cvar {
    fn default() -> Self {
        Cvar { level: 0.9, smoothing: 0.05 }
    }
}

/// `log(1 + exp x)`, without overflow.
fn plus(x: f64) -> f64 {
    x.max(0.0) + (-x.abs()).exp().ln_1p()
}

/// Its derivative, `1/(1 + exp(-x))`.
fn sigmoid(x: f64) -> f64 {
    let small = (-x.abs()).exp();
    if x >= 0.0 { 1.0 / (1.0 + small) } else { small / (1.0 + small) }
}

impl Cvar {
    fn tail(&self) -> f64 {
        1.0 - self.level
    }

    /// The minimising t, in units of the deviation.
    fn auxiliary(&self, p: &[f64], y: &[f64], width: f64) -> f64 {
        // At these ends every g' is at least, at most, the tail.
        let shift = width * (self.tail() / self.level).ln();
        let real = || p.iter().zip(y).filter(|(p, _)| **p > 0.0).map(|(_, y)| *y);
        let mut low = real().fold(f64::INFINITY, f64::min) - shift;
        let mut high = real().fold(f64::NEG_INFINITY, f64::max) - shift;
        let mut t = 0.5 * (low + high);
        for _ in 0..Self::MAX_STEPS {
            let (mut excess, mut slope) = (-self.tail(), 0.0);
            for (p, y) in p.iter().zip(y) {
                let s = sigmoid((y - t) / width);
                excess += p * s;
                slope -= p * s * (1.0 - s) / width;
            }
            if excess > 0.0 {
                low = t
            } else {
                high = t
            }
            let newton = t - excess / slope;
            let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
            let moved = (next - t).abs();
            t = next;
            if moved <= f64::EPSILON * width.max(t.abs()) {
                break;
            }
        }
        t
    }

    /// Halving alone needs this many to come from any bracket to rounding.
    const MAX_STEPS: usize = 200;
}

impl Risk for Cvar {
    fn name(&self) -> &'static str {
        "cvar"
    }

    fn level(&self) -> Option<f64> {
        Some(self.level)
    }

    fn value(&self, p: &[f64], j: &[f64]) -> f64 {
        let costs = Standard::new(p, j);
        if costs.is_flat() {
            return costs.mean;
        }
        let width = self.smoothing;
        let t = self.auxiliary(p, &costs.y, width);
        let excess: f64 = p.iter().zip(&costs.y).map(|(p, y)| p * plus((y - t) / width)).sum();
        costs.mean + costs.deviation * (t + width * excess / self.tail())
    }

    fn weights(&self, p: &[f64], j: &[f64]) -> Vec<f64> {
        let costs = Standard::new(p, j);
        if costs.is_flat() {
            return p.to_vec();
        }
        let width = self.smoothing;
        let t = self.auxiliary(p, &costs.y, width);
        let x: Vec<f64> = costs.y.iter().map(|y| (y - t) / width).collect();
        let by_width: f64 = p.iter().zip(&x).map(|(p, x)| p * (plus(*x) - x * sigmoid(*x))).sum::<f64>() / self.tail();
        let by_deviation = self.smoothing * by_width;
        let weight = |((p, x), slope): ((&f64, &f64), f64)| p * sigmoid(*x) / self.tail() + by_deviation * slope;
        p.iter().zip(&x).zip(costs.deviation_slope(p)).map(weight).collect()
    }

    /// With `b = dR/dD` as in the weights, in units of the deviation: `p_i (ds_i/(1 - level) + db y_i + b dy_i)`, where
    /// `s_i = g'(x_i)` changes by `s_i (1 - s_i) dx_i`, `dx_i = (dy_i - dt)/e`, t so that the sum of `p_i s_i` stays the same, and
    /// `db = -e/(1 - level) sum p_i x_i ds_i`.
    fn weights_change(&self, p: &[f64], j: &[f64], dj: &[f64]) -> Result<Vec<f64>, RiskError> {
        let costs = Standard::new(p, j);
        let dy = costs.change(self.name(), p, dj)?;
        if costs.is_flat() {
            return Ok(vec![0.0; p.len()]);
        }
        let (width, tail) = (self.smoothing, self.tail());
        let t = self.auxiliary(p, &costs.y, width);
        let x: Vec<f64> = costs.y.iter().map(|y| (y - t) / width).collect();
        let slope: Vec<f64> = x.iter().map(|x| sigmoid(*x) * sigmoid(-*x)).collect();
        let total: f64 = p.iter().zip(&slope).map(|(p, s)| p * s).sum();
        let moved: f64 = (0..p.len()).map(|i| p[i] * slope[i] * dy[i]).sum();
        // far from every kink nothing changes
        let dt = if total > 0.0 { moved / total } else { 0.0 };
        let ds: Vec<f64> = slope.iter().zip(&dy).map(|(s, dy)| s * (dy - dt) / width).collect();
        let b = width * p.iter().zip(&x).map(|(p, x)| p * (plus(*x) - x * sigmoid(*x))).sum::<f64>() / tail;
        let db = -width * (0..p.len()).map(|i| p[i] * x[i] * ds[i]).sum::<f64>() / tail;
        Ok((0..p.len()).map(|i| p[i] * (ds[i] / tail + db * costs.y[i] + b * dy[i])).collect())
    }

    fn exact(&self, p: &[f64], j: &[f64]) -> Option<f64> {
        Some(conditional_value_at_risk(p, j, self.level))
    }

    fn check(&self, p: &[f64]) -> Result<(), RiskError> {
        let (measure, value) = (self.name(), self.level);
        if !(value > 0.0 && value < 1.0) {
            let must = "must lie between 0 and 1, ends excluded (0 would be the mean, 1 the worst case)";
            return Err(RiskError::Parameter { measure, name: "level", value, must });
        }
        check_smoothing(measure, self.smoothing)?;
        check_signs(measure, p)
    }
}

/// The exact conditional value at risk of a discrete distribution, not smoothed: the mean of the worst `1 - level` of
/// the probability, the case on the border counted in part. The largest cost for `level = 1`.
pub fn conditional_value_at_risk(p: &[f64], j: &[f64], level: f64) -> f64 {
    let mut order: Vec<usize> = (0..j.len()).filter(|i| p[*i] > 0.0).collect();
    order.sort_by(|a, b| j[*b].total_cmp(&j[*a]));
    let tail = 1.0 - level;
    let (mut left, mut sum) = (tail, 0.0);
    for &i in &order {
        let share = p[i].min(left);
        sum += share * j[i];
        left -= share;
        if left <= 0.0 {
            break;
        }
    }
    if tail > left { sum / (tail - left) } else { order.first().map_or(f64::NAN, |i| j[*i]) }
}
