//! The Taylor test: does the derivative belong to the cost? And the second derivative?

mod report;
mod second;

pub use report::{Row, TaylorDirection, TaylorReport, Verdict};
pub use second::SecondOrder;

use crate::admissible::{Admissible, Outside};
use crate::failed::Failed;
use crate::hessian::Hessian;
use crate::objective::{Objective, Request};
use nastic_numeric::Random;
use nastic_numeric::vector::{dot, max_abs};
use std::ops::Range;
use thiserror::Error;

/// The Taylor test at a control m: along admissible curves m(t) with m'(0) = d (inward at a bound, retracted on a
/// sphere), for t over eight decades, the remainders
///
/// r0(t) = |j(m(t)) - j(m)| and r1(t) = |j(m(t)) - j(m) - t dj.d|
///
/// decrease as t and t^2 if dj is the derivative. Orders are fitted to the smallest steps whose r1 exceeds the noise
/// of j, which is estimated from the scatter of j(m(t)) at the smallest steps, without use of the derivative.
/// Remainders at round-off are not judged: where the order at these steps is neither that of a right derivative nor that of a
/// remainder linear in t, larger steps are used.
///
/// With [`second`](Self::second), the remainder r2(t) = |j(m(t)) - j(m) - dj.(m(t) - m) - t^2/2 d.Hd| decreases as t^3 if H is the
/// second derivative, on curved paths too: their curvature is in the linear term, and changes the quadratic one by t^3.
#[derive(Clone, Debug, PartialEq)]
pub struct Taylor {
    /// Number of random directions.
    pub directions: usize,
    /// Seed of the first; the others follow.
    pub seed: u64,
    /// Length of d, as a share of the set's extent, component by component (of the largest |m_i| where the set has no
    /// extent).
    pub length: f64,
    /// Size of a control where neither the set nor m determines it.
    pub size: Option<f64>,
    /// Only these components vary (a control block); all if none are given.
    pub components: Option<Range<usize>>,
    /// Relative accuracy asked of state solves.
    pub accuracy: f64,
    /// The continuation stage whose cost is tested.
    pub stage: usize,
    /// Smallest order of r1 that passes; r2 has to have one more.
    pub order: f64,
    /// Whether the second derivative is tested too.
    pub second: bool,
}

impl Default for Taylor {
    fn default() -> Self {
        Self {
            directions: 3,
            seed: 1,
            length: 0.1,
            size: None,
            components: None,
            accuracy: 1e-12,
            stage: 0,
            order: 1.95,
            second: false,
        }
    }
}

/// Why a Taylor test could not be made.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum TaylorError {
    /// The control is not admissible.
    #[error("no Taylor test at a control that is not admissible: {0}")]
    Outside(#[from] Outside),
    /// No cost or no derivative at the control.
    #[error("no Taylor test where the cost or its derivative fails: {0}")]
    Base(#[from] Failed),
    /// A direction is zero or without a scale.
    #[error("no direction to vary the control along: the set has no extent here and the control is zero; give a size")]
    NoDirection,
    /// Components beyond the end of the control.
    #[error("components {start}..{end} of a control that has {len}")]
    Components {
        /// First component.
        start: usize,
        /// End of the range.
        end: usize,
        /// Components there are.
        len: usize,
    },
}

impl Taylor {
    /// Steps per decade.
    const STEPS_PER_DECADE: usize = 2;
    /// Decades of step sizes.
    const DECADES: usize = 8;
    /// Least number of rows that an order is fitted to.
    const MIN_ROWS: usize = 3;
    /// Largest number of rows that an order is fitted to.
    const MAX_ROWS: usize = 5;
    /// Ratio of a remainder to the noise above which it counts.
    const MIN_NOISE_RATIO: f64 = 30.0;
    /// Largest error of the derivative, as a share of the slope, that noise and curvature may hide where the verdict is right.
    const MAX_HIDDEN_ERROR: f64 = 1e-3;

    /// Tests the derivative of `objective` at an admissible control.
    ///
    /// # Errors
    /// A control that is not admissible or cannot be evaluated, or for which nothing says how to vary it; an objective without second
    /// derivatives where they are asked for.
    pub fn test<O: Objective>(
        &self,
        objective: &O,
        set: &dyn Admissible,
        m: &[f64],
    ) -> Result<TaylorReport, TaylorError> {
        set.check(m)?;
        let how = Request { near: None, accuracy: self.accuracy, stage: self.stage, ..Request::default() };
        let mut workspace = O::Workspace::default();
        let mut point = objective.evaluate(m, &how, &mut workspace)?;
        let derivative = objective.derivative(&mut point, &mut workspace)?;
        let cost = objective.value(&point);
        let base = Base { objective, set, m, point, derivative, cost };
        let seeds = (0..self.directions as u64).map(|k| self.seed.wrapping_add(k));
        let directions = seeds.map(|seed| self.along(&base, seed, &mut workspace));
        Ok(TaylorReport { cost, directions: directions.collect::<Result<_, _>>()? })
    }

    fn along<O: Objective>(
        &self,
        base: &Base<'_, O>,
        seed: u64,
        workspace: &mut O::Workspace,
    ) -> Result<TaylorDirection, TaylorError> {
        let direction = self.direction(base.set, base.m, seed)?;
        let slope = dot(&base.derivative, &direction);
        let curvature = match self.second {
            true => Some(dot(
                &base.objective.hessian_vector(&base.point, &direction, Hessian::Exact, workspace)?,
                &direction,
            )),
            false => None,
        };
        let how = Request { near: Some(&base.point), accuracy: self.accuracy, stage: self.stage, ..Request::default() };
        let mut m = base.m.to_vec();
        let mut rows = Vec::with_capacity(Self::STEPS_PER_DECADE * Self::DECADES + 1);
        let mut remainders = Vec::with_capacity(Self::STEPS_PER_DECADE * Self::DECADES + 1);
        for k in 0..=Self::STEPS_PER_DECADE * Self::DECADES {
            let t = 10f64.powf(-(k as f64) / Self::STEPS_PER_DECADE as f64);
            base.set.retract(base.m, &direction, t, &mut m);
            let evaluated = match base.objective.evaluate(&m, &how, workspace) {
                Err(failed) if failed.is_fatal() => return Err(failed.into()),
                evaluated => evaluated.ok(),
            };
            let cost = evaluated.map(|point| base.objective.value(&point)).filter(|cost| cost.is_finite());
            let change = cost.map_or(f64::NAN, |cost| cost - base.cost);
            rows.push(Row { t, cost, r0: change.abs(), r1: (change - t * slope).abs(), used: false });
            remainders.push(second::remainder(
                change,
                &base.derivative,
                base.m,
                &m,
                curvature.map(|c| 0.5 * t * t * c),
            ));
        }
        let mut judged = self.judge(seed, direction, slope, base.cost, rows);
        judged.second = curvature.map(|curvature| second::judge(&judged, curvature, remainders, self.order + 1.0));
        Ok(judged)
    }

    /// Random, of the size asked for, admissible.
    fn direction(&self, set: &dyn Admissible, m: &[f64], seed: u64) -> Result<Vec<f64>, TaylorError> {
        let components = self.components.clone().unwrap_or(0..m.len());
        if components.end > m.len() || components.is_empty() {
            return Err(TaylorError::Components { start: components.start, end: components.end, len: m.len() });
        }
        let fallback = self.size.unwrap_or_else(|| max_abs(m));
        let mut random = Random::new(seed);
        let mut d: Vec<f64> = set.extent(m);
        for (i, d) in d.iter_mut().enumerate() {
            let size = if *d > 0.0 { *d } else { fallback };
            *d = if components.contains(&i) { self.length * size * random.symmetric() } else { 0.0 };
        }
        set.inward(m, &mut d);
        if max_abs(&d) > 0.0 { Ok(d) } else { Err(TaylorError::NoDirection) }
    }

    fn judge(&self, seed: u64, direction: Vec<f64>, slope: f64, cost: f64, mut rows: Vec<Row>) -> TaylorDirection {
        let (scatter, observed) = noise_and_slope(&rows, cost);
        let noise = scatter.max(2.0 * f64::EPSILON * cost.abs());
        let clear: Vec<usize> = (0..rows.len()).filter(|k| rows[*k].r1 > Self::MIN_NOISE_RATIO * noise).collect();
        let linear = clear.is_empty() && rows.iter().any(|row| row.r0 > 1e6 * noise);
        let hidden = hidden_error(&rows, slope);
        let fit = |window: &[usize], r: fn(&Row) -> f64| order(window.iter().map(|k| (rows[*k].t, r(&rows[*k]))));
        let judged = windows(&clear).find_map(|window| {
            let order1 = fit(window, |row| row.r1);
            let verdict = match () {
                () if order1 >= self.order && hidden <= Self::MAX_HIDDEN_ERROR => Verdict::Right,
                () if order1 >= self.order => Verdict::Undecided,
                () if is_linear(window, &rows, order1) && persists(window, &rows) => Verdict::Wrong,
                () => return None, // round-off, or between the two: ask steps that stand clearer of it
            };
            Some((window.to_vec(), verdict))
        });
        let first = windows(&clear).next().map(|window| (window.to_vec(), Verdict::Undecided));
        let (window, verdict) = judged.or(first).unwrap_or((vec![], Verdict::Undecided));
        let (order0, order1) = match window.len() {
            0 => (f64::NAN, f64::NAN),
            _ => (fit(&window, |row| row.r0), fit(&window, |row| row.r1)),
        };
        window.iter().for_each(|k| rows[*k].used = true);
        let verdict = if linear { Verdict::Linear } else { verdict };
        TaylorDirection { seed, direction, slope, observed, noise, rows, order0, order1, verdict, second: None }
    }
}

/// Share of a linear part that remains at small steps in spite of noise.
const MIN_PERSISTENT_SHARE: f64 = 0.3;

/// The arguments that are the same for all directions.
struct Base<'a, O: Objective> {
    objective: &'a O,
    set: &'a dyn Admissible,
    m: &'a [f64],
    point: O::Point,
    derivative: Vec<f64>,
    cost: f64,
}

/// Noise and slope of j by its values at the smallest steps, without any derivative.
///
/// Windows of consecutive steps are moved upward from the smallest until j is smooth in one; the noise is the largest
/// scatter in these windows. (A solver that returns its warm start unchanged gives no change at the smallest steps, which
/// is not the absence of noise.)
fn noise_and_slope(rows: &[Row], cost: f64) -> (f64, f64) {
    const WINDOW: usize = 6;
    let values: Vec<(f64, f64)> = rows.iter().rev().filter_map(|row| row.cost.map(|c| (row.t, c - cost))).collect();
    if values.len() < WINDOW {
        return (f64::INFINITY, f64::NAN);
    }
    let mut noise: f64 = 0.0;
    let mut slope = 0.0;
    for window in values.windows(WINDOW) {
        let scatter;
        (scatter, slope) = fit(window);
        noise = noise.max(scatter);
        let top = window[WINDOW - 1].1.abs();
        if window.iter().all(|(_, y)| *y != 0.0) && scatter < 0.01 * top {
            break;
        }
    }
    (noise, slope)
}

/// Least-squares parabola b t + c t^2: three times the root mean square of its residual, and b.
fn fit(values: &[(f64, f64)]) -> (f64, f64) {
    let longest = values.iter().fold(0.0, |most: f64, (t, _)| most.max(*t));
    let powers = |p: i32| values.iter().map(|(t, _)| (t / longest).powi(p)).sum::<f64>();
    let moments = |p: i32| values.iter().map(|(t, y)| (t / longest).powi(p) * y).sum::<f64>();
    let (s2, s3, s4) = (powers(2), powers(3), powers(4));
    let (y1, y2) = (moments(1), moments(2));
    let determinant = s2 * s4 - s3 * s3;
    let b = (y1 * s4 - y2 * s3) / determinant;
    let c = (y2 * s2 - y1 * s3) / determinant;
    let residual = |(t, y): &(f64, f64)| y - b * (t / longest) - c * (t / longest).powi(2);
    let squares: f64 = values.iter().map(|v| residual(v).powi(2)).sum();
    (3.0 * (squares / (values.len() - 2) as f64).sqrt(), b / longest)
}

/// Rows to fit orders to: the smallest ones above the noise first, then without the smallest of them, and so on.
fn windows(clear: &[usize]) -> impl Iterator<Item = &[usize]> {
    let ends = (Taylor::MIN_ROWS..=clear.len()).rev();
    ends.map(|end| &clear[end.saturating_sub(Taylor::MAX_ROWS)..end])
}

/// Whether the remainders are those of a wrong derivative: proportional to t.
fn is_linear(window: &[usize], rows: &[Row], order: f64) -> bool {
    let ratios = window.iter().map(|k| rows[*k].r1 / rows[*k].t);
    let (low, high) = ratios.fold((f64::INFINITY, 0.0f64), |(low, high), r| (low.min(r), high.max(r)));
    (order - 1.0).abs() < 0.2 && high < 2.0 * low
}

/// Whether the linear part of the remainders of a window is present at the smallest steps too, like the error of a derivative: else it is the effect
/// of an event along the curve, such as the beginning of a contact.
fn persists(window: &[usize], rows: &[Row]) -> bool {
    let rate = |row: &Row| if row.r0 > 0.0 { row.r1 / row.t } else { f64::INFINITY };
    let largest = |rows: &[Row]| rows.iter().map(rate).fold(0.0, f64::max);
    let least = rows.windows(3).map(largest).filter(|rate| !rate.is_nan()).fold(f64::INFINITY, f64::min);
    let low = window.iter().map(|k| rate(&rows[*k])).fold(f64::INFINITY, f64::min);
    least >= MIN_PERSISTENT_SHARE * low
}

/// Upper bound of the derivative's error that the remainders allow, as a share of the slope: the least r1 / (t |slope|) that
/// three neighbouring steps stay below. Noise makes remainders larger, and rarely smaller at three consecutive steps.
fn hidden_error(rows: &[Row], slope: f64) -> f64 {
    let share = |row: &Row| if row.r0 > 0.0 { row.r1 / (row.t * slope.abs()) } else { f64::INFINITY };
    let largest = |rows: &[Row]| rows.iter().map(share).fold(0.0, f64::max);
    rows.windows(3).map(largest).filter(|share| !share.is_nan()).fold(f64::INFINITY, f64::min)
}

/// Least-squares slope of log r over log t.
fn order(points: impl Iterator<Item = (f64, f64)>) -> f64 {
    let logs: Vec<(f64, f64)> = points.map(|(t, r)| (t.ln(), r.ln())).collect();
    let n = logs.len() as f64;
    let (x, y) = (logs.iter().map(|l| l.0).sum::<f64>() / n, logs.iter().map(|l| l.1).sum::<f64>() / n);
    let above: f64 = logs.iter().map(|l| (l.0 - x) * (l.1 - y)).sum();
    let below: f64 = logs.iter().map(|l| (l.0 - x).powi(2)).sum();
    above / below
}
