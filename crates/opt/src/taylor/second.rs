//! [`SecondOrder`]: the remainders of Taylor's formula with the second derivative.

use super::report::{TaylorDirection, Verdict};
use super::{Taylor, order, windows};
use nastic_numeric::vector::dot;
use std::fmt;

/// What the test found of the second derivative along a direction.
#[derive(Clone, Debug, PartialEq)]
pub struct SecondOrder {
    /// d.Hd.
    pub curvature: f64,
    /// r2 by row, see [`Taylor`]; NaN where there is no cost.
    pub remainders: Vec<f64>,
    /// Rows that the fitted order rests on.
    pub used: Vec<usize>,
    /// Fitted order of r2; NaN when too few remainders are clear of the noise.
    pub order: f64,
    /// What it says.
    pub verdict: Verdict,
}

impl fmt::Display for SecondOrder {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "second derivative: d.Hd = {:.9e}, order {:.3}: {}", self.curvature, self.order, self.verdict)
    }
}

/// Largest difference of an order between neighbouring steps from the fitted one, where fewer than [`Taylor::MAX_ROWS`] are left.
const MAX_ORDER_SCATTER: f64 = 0.2;

/// Order from which the remainder has a power that few functions have (4 where the third derivative vanishes, for example by symmetry), or
/// is noise: the order must be the same between all steps.
const MAX_LIKELY_ORDER: f64 = 3.5;

/// `|change - dj.(moved - m) - quadratic|`: the difference of controls is the one that j has seen, rounding included.
pub(super) fn remainder(change: f64, derivative: &[f64], m: &[f64], moved: &[f64], quadratic: Option<f64>) -> f64 {
    let step: Vec<f64> = moved.iter().zip(m).map(|(a, b)| a - b).collect();
    (change - dot(derivative, &step) - quadratic.unwrap_or_default()).abs()
}

/// As the first derivative is judged: the smallest steps that stand clear of the noise, larger ones where those cannot decide. Errors
/// of the first derivative, of 1e-9 say, are above the noise of j where r2 is small, so that few remainders may be left between them
/// and the higher powers of t: three or four serve if the order is the same between all of them.
pub(super) fn judge(first: &TaylorDirection, curvature: f64, remainders: Vec<f64>, least: f64) -> SecondOrder {
    let (rows, noise) = (&first.rows, first.noise);
    let clear: Vec<usize> = (0..rows.len()).filter(|k| remainders[*k] > Taylor::MIN_NOISE_RATIO * noise).collect();
    let point = |k: &usize| (rows[*k].t, remainders[*k]);
    let fit = |window: &[usize]| order(window.iter().map(point));
    let even = |window: &[usize]| window.windows(2).all(|pair| (fit(pair) - fit(window)).abs() < MAX_ORDER_SCATTER);
    let quadratic = |window: &[usize]| {
        let ratios = window.iter().map(point).map(|(t, r)| r / (t * t));
        let (low, high) = ratios.fold((f64::INFINITY, 0.0f64), |(low, high), r| (low.min(r), high.max(r)));
        (fit(window) - 2.0).abs() < 0.2 && high < 2.0 * low
    };
    let judged = windows(&clear).find_map(|window| {
        let fewer = (Taylor::MIN_ROWS..window.len()).rev().map(|n| &window[window.len() - n..]);
        let likely = |window: &[usize]| fit(window) < MAX_LIKELY_ORDER && window.len() == Taylor::MAX_ROWS;
        let right = |window: &&[usize]| fit(window) >= least && (likely(window) || even(window));
        match std::iter::once(window).chain(fewer).find(right) {
            _ if quadratic(window) && window.len() == Taylor::MAX_ROWS.min(clear.len()) => {
                Some((window, Verdict::Wrong))
            }
            Some(window) => Some((window, Verdict::Right)),
            None => None,
        }
    });
    let undecided = windows(&clear).next().map(|window| (window, Verdict::Undecided));
    let (used, mut verdict) = judged.or(undecided).unwrap_or((&[], Verdict::Undecided));
    if clear.is_empty() && rows.iter().any(|row| row.r0.max(row.r1) > 1e6 * noise) {
        verdict = Verdict::Quadratic;
    }
    let (used, order) = (used.to_vec(), if used.is_empty() { f64::NAN } else { fit(used) });
    SecondOrder { curvature, remainders, used, order, verdict }
}
