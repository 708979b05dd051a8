//! [`Subproblem`]: the separable convex model of cost and constraints at a control.

use crate::method::Current;

/// Share of a slope that bends the other way too, so that every component's model is strictly convex.
const OPPOSITE_SHARE: f64 = 1e-3;
/// Largest step, as a share of the distance of an asymptote.
const MAX_SHARE_OF_DISTANCE: f64 = 0.9;

/// One function of the model.
pub(super) struct Approximation {
    /// f_i at the control.
    pub value: f64,
    /// a_ij.
    above: Vec<f64>,
    /// b_ij.
    below: Vec<f64>,
}

/// The model at a control, as a function of the step x.
pub(super) struct Subproblem {
    /// s_j.
    distances: Vec<f64>,
    /// Bounds of x_j: those of the set, the move limit, 0.9 s_j.
    low: Vec<f64>,
    high: Vec<f64>,
    /// The cost's, then the constraints'.
    pub functions: Vec<Approximation>,
    /// The largest multiplier.
    pub penalty: f64,
}

/// How far a step may go.
pub(super) struct Reach {
    /// s_j.
    pub distances: Vec<f64>,
    /// Largest step of each component.
    pub moves: Vec<f64>,
}

impl Subproblem {
    /// The model at a control with these weights c_i of its convex terms, one for the cost and one for each constraint.
    pub fn new(here: &Current<'_>, reach: Reach, weights: &[f64]) -> Self {
        let Reach { distances, moves } = reach;
        let intervals = here.set.intervals(here.m.len()).unwrap_or_default();
        let bound = |j: usize| (MAX_SHARE_OF_DISTANCE * distances[j]).min(moves[j]);
        let room = intervals.lower.iter().zip(&intervals.upper).zip(here.m).enumerate();
        let (low, high) =
            room.map(|(j, ((lower, upper), m))| ((lower - m).max(-bound(j)), (upper - m).min(bound(j)))).unzip();
        let held = here.held;
        let cost = if held.is_empty() { here.derivative } else { &held.cost_derivative };
        let value = held.without_penalty(here.cost, &held.values);
        let rows =
            std::iter::once((value, cost)).chain(held.values.iter().copied().zip(held.rows.iter().map(Vec::as_slice)));
        let functions =
            rows.zip(weights).map(|((value, row), c)| Approximation::new(value, row, &distances, *c)).collect();
        Self { distances, low, high, functions, penalty: held.penalty }
    }

    /// The minimiser of the Lagrangian `F_0 + sum_k l_k F_k` over the steps.
    pub fn step(&self, l: &[f64]) -> Vec<f64> {
        let of = |j: usize| {
            let (a, b) = self.slopes(l, j);
            let x = match b >= a {
                // Ratios, so that other units give the same bits.
                true if b > 0.0 => {
                    let r = (a / b).sqrt();
                    (1.0 - r) / (1.0 + r)
                }
                true => 0.0,
                false => {
                    let r = (b / a).sqrt();
                    (r - 1.0) / (r + 1.0)
                }
            };
            (self.distances[j] * x).max(self.low[j]).min(self.high[j])
        };
        (0..self.distances.len()).map(of).collect()
    }

    /// `sum_i l_i a_ij` and the same of b, with l_0 = 1.
    fn slopes(&self, l: &[f64], j: usize) -> (f64, f64) {
        let mut sums = (self.functions[0].above[j], self.functions[0].below[j]);
        for (function, l) in self.functions[1..].iter().zip(l) {
            sums.0 += l * function.above[j];
            sums.1 += l * function.below[j];
        }
        sums
    }

    /// F_i of a step.
    pub fn value(&self, i: usize, x: &[f64]) -> f64 {
        self.functions[i].value + self.change(i, x)
    }

    /// F_i of a step less F_i of none.
    pub fn change(&self, i: usize, x: &[f64]) -> f64 {
        let Approximation { above, below, .. } = &self.functions[i];
        let of = |j: usize| {
            let (s, x) = (self.distances[j], x[j]);
            s * x * (above[j] / (s - x) - below[j] / (s + x))
        };
        (0..x.len()).map(of).sum()
    }

    /// `dF_i/dx_j` of a step.
    pub fn slope(&self, i: usize, j: usize, x: f64) -> f64 {
        let (s, Approximation { above, below, .. }) = (self.distances[j], &self.functions[i]);
        above[j] * (s / (s - x)).powi(2) - below[j] * (s / (s + x)).powi(2)
    }

    /// The second derivative of the Lagrangian by x_j.
    pub fn curvature(&self, l: &[f64], j: usize, x: f64) -> f64 {
        let (s, (a, b)) = (self.distances[j], self.slopes(l, j));
        2.0 / s * (a * (s / (s - x)).powi(3) + b * (s / (s + x)).powi(3))
    }

    /// Whether a component of a step is at none of its bounds.
    pub fn is_free(&self, j: usize, x: f64) -> bool {
        self.low[j] < x && x < self.high[j]
    }

    /// `F_0 + r sum_k max(0, F_k)` of a step less that of none.
    pub fn merit_change(&self, x: &[f64]) -> f64 {
        let penalised = |i: usize| {
            let (before, after) = (self.functions[i].value, self.value(i, x));
            self.penalty * (after.max(0.0) - before.max(0.0))
        };
        self.change(0, x) + (1..self.functions.len()).map(penalised).sum::<f64>()
    }

    /// `sum_j x_j^2 / (2 (s_j^2 - x_j^2))`: what a convex term of weight one adds.
    pub fn convex_term(&self, x: &[f64]) -> f64 {
        self.distances.iter().zip(x).map(|(s, x)| 0.5 * x * x / ((s - x) * (s + x))).sum()
    }
}

impl Approximation {
    fn new(value: f64, derivative: &[f64], distances: &[f64], weight: f64) -> Self {
        let half = |sign: f64| {
            let of = |(d, s): (&f64, &f64)| {
                let d = sign * d;
                (1.0 + OPPOSITE_SHARE) * d.max(0.0) + OPPOSITE_SHARE * (-d).max(0.0) + weight / (4.0 * s)
            };
            derivative.iter().zip(distances).map(of).collect()
        };
        Self { value, above: half(1.0), below: half(-1.0) }
    }
}
