//! The dual of a [`Subproblem`]: its multipliers.

use super::subproblem::Subproblem;
use nalgebra::{DMatrix, DVector};
use nastic_numeric::vector::dot;

/// Newton steps, and sweeps of coordinates in between, at most.
const MAX_STEPS: usize = 200;
/// Residual, relative to the constraints' scales, at which multipliers are found.
const MAX_RESIDUAL: f64 = 1e-13;
/// Halvings of a Newton step.
const MAX_HALVINGS: usize = 30;
/// Halvings of the interval of a multiplier: to its last bit.
const MAX_BISECTIONS: usize = 200;
/// Share of the slope that a step must win.
const MIN_GAIN: f64 = 1e-4;
/// Rounding of the dual function, relative to the sizes of its parts.
const ROUNDING: f64 = 1e-14;
/// Added to the diagonal of the second derivative, relative to it.
const RIDGE: f64 = 1e-12;

/// Multipliers l_k between 0 and r that maximise the concave function `phi(l) = min_x F_0 + sum_k l_k F_k`, whose derivatives are the F_k of the
/// minimising step. Newton's method on those that are not held at 0 or r, with Armijo's test; where it wins nothing, exact maximisation along one
/// multiplier after the other, which always does. The second derivative is minus the sum over free components of `F_i,j F_k,j / L,jj`. An
/// evaluation costs O(n K), a step O(n K^2).
pub(super) fn multipliers(problem: &Subproblem) -> Vec<f64> {
    let count = problem.functions.len() - 1;
    let mut at = Dual::at(problem, vec![0.0; count]);
    if count == 0 || problem.penalty == 0.0 {
        return at.l;
    }
    for _ in 0..MAX_STEPS {
        let residual = at.residual(problem);
        if residual <= MAX_RESIDUAL {
            break;
        }
        match newton(problem, &at) {
            Some(next) => at = next,
            None => {
                let next = sweep(problem, at.l.clone());
                if next.residual(problem) >= residual {
                    break;
                }
                at = next;
            }
        }
    }
    at.l
}

/// The dual at some multipliers.
struct Dual {
    l: Vec<f64>,
    /// The minimising step.
    x: Vec<f64>,
    /// F_k of it.
    slopes: Vec<f64>,
    /// phi less F_0 of no step.
    value: f64,
    /// Sum of the sizes of what it is a sum of.
    size: f64,
}

impl Dual {
    fn at(problem: &Subproblem, l: Vec<f64>) -> Self {
        let x = problem.step(&l);
        let slopes: Vec<f64> = (1..problem.functions.len()).map(|i| problem.value(i, &x)).collect();
        let change = problem.change(0, &x);
        let value = change + dot(&l, &slopes);
        let size = change.abs() + l.iter().zip(&slopes).map(|(l, slope)| (l * slope).abs()).sum::<f64>();
        Self { l, x, slopes, value, size }
    }

    /// Whether a multiplier is held at 0 or r.
    fn is_held(&self, problem: &Subproblem, k: usize) -> bool {
        self.l[k] <= 0.0 && self.slopes[k] <= 0.0 || self.l[k] >= problem.penalty && self.slopes[k] >= 0.0
    }

    /// The largest slope of those that are not.
    fn residual(&self, problem: &Subproblem) -> f64 {
        let free = (0..self.l.len()).filter(|k| !self.is_held(problem, *k));
        free.map(|k| self.slopes[k].abs()).fold(0.0, f64::max)
    }
}

/// A Newton step that gains, if there is one.
fn newton(problem: &Subproblem, at: &Dual) -> Option<Dual> {
    let free: Vec<usize> = (0..at.l.len()).filter(|k| !at.is_held(problem, *k)).collect();
    let mut matrix = DMatrix::<f64>::zeros(free.len(), free.len());
    for (j, x) in at.x.iter().enumerate().filter(|(j, x)| problem.is_free(*j, **x)) {
        let curvature = problem.curvature(&at.l, j, *x);
        let slopes: Vec<f64> = free.iter().map(|k| problem.slope(k + 1, j, *x)).collect();
        for (p, a) in slopes.iter().enumerate() {
            slopes[..=p].iter().enumerate().for_each(|(q, b)| matrix[(p, q)] += a * b / curvature);
        }
    }
    for p in 0..free.len() {
        let diagonal = matrix[(p, p)];
        // No component answers to it.
        if diagonal <= 0.0 {
            return None;
        }
        matrix[(p, p)] = diagonal * (1.0 + RIDGE);
        (0..p).for_each(|q| matrix[(q, p)] = matrix[(p, q)]);
    }
    let slopes = DVector::from_iterator(free.len(), free.iter().map(|k| at.slopes[*k]));
    let step = matrix.cholesky()?.solve(&slopes);
    let residual = at.residual(problem);
    let mut share = 1.0;
    for _ in 0..MAX_HALVINGS {
        let mut l = at.l.clone();
        free.iter().zip(step.iter()).for_each(|(k, d)| l[*k] = (l[*k] + share * d).max(0.0).min(problem.penalty));
        let promised: f64 = l.iter().zip(&at.l).zip(&at.slopes).map(|((a, b), slope)| (a - b) * slope).sum();
        if l == at.l || promised.is_nan() {
            return None;
        }
        let next = Dual::at(problem, l);
        // Near the maximum gains are lost in rounding, slopes are not.
        let gain = next.value - at.value;
        let closer = next.residual(problem) <= 0.5 * residual && gain >= -ROUNDING * (at.size + next.size);
        if gain > 0.0 && gain >= MIN_GAIN * promised || closer {
            return Some(next);
        }
        share *= 0.5;
    }
    None
}

/// Maximises along one multiplier after the other: its slope falls as it grows.
fn sweep(problem: &Subproblem, mut l: Vec<f64>) -> Dual {
    for k in 0..l.len() {
        let slope = |l: &mut Vec<f64>, value: f64| {
            l[k] = value;
            problem.value(k + 1, &problem.step(l))
        };
        let (mut low, mut high) = (0.0, problem.penalty);
        l[k] = if slope(&mut l, high) >= 0.0 {
            high
        } else if slope(&mut l, low) <= 0.0 {
            low
        } else {
            for _ in 0..MAX_BISECTIONS {
                let middle = 0.5 * (low + high);
                if middle <= low || middle >= high {
                    break;
                }
                *(if slope(&mut l, middle) > 0.0 { &mut low } else { &mut high }) = middle;
            }
            // The side on which the constraint is met.
            high
        };
    }
    Dual::at(problem, l)
}
