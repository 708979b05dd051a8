//! [`MovingAsymptotes`]: the strategy of [`Mma`](super::Mma).

use super::asymptotes::Asymptotes;
use super::dual::multipliers;
use super::subproblem::{Reach, Subproblem};
use crate::failed::Failed;
use crate::method::{Current, HessianProducts, Judgement, Memory, Method, Proposed, Tried};
use nastic_numeric::vector::sub;

/// First weight of a convex term, over the mean change of the function that a component makes over its range.
const FIRST_WEIGHT: f64 = 0.1;
/// Least weight, over the same.
const MIN_WEIGHT: f64 = 1e-5;
/// Least factor of a weight from one iteration to the next.
const MIN_WEIGHT_DECREASE: f64 = 0.1;
/// Largest factor of a weight from one trial to the next.
const MAX_WEIGHT_GROWTH: f64 = 10.0;
/// What a weight exceeds that by which the trial would have been no underestimate, as a factor.
const WEIGHT_MARGIN: f64 = 1.1;
/// Distances of asymptotes after an iteration that had to move them closer for its trials, over those with which it ended.
const MAX_LENGTH_RATIO: f64 = 4.0;
/// By how much of its scale a constraint may exceed its model: rounding, and the accuracy of states.
const VALUE_SLACK: f64 = 1e-9;

#[derive(Clone, Debug)]
pub(super) struct MovingAsymptotes {
    asymptotes: Asymptotes,
    /// s_j; empty until the first step of a stage.
    distances: Vec<f64>,
    /// The last step; empty as `distances`.
    last: Vec<f64>,
    /// c_i by the last iteration, the cost's first; empty until the first step of a stage.
    weights: Vec<f64>,
    /// c_i of the trials of this iteration.
    present: Vec<f64>,
}

impl MovingAsymptotes {
    pub fn new(asymptotes: Asymptotes) -> Self {
        Self { asymptotes, distances: Vec::new(), last: Vec::new(), weights: Vec::new(), present: Vec::new() }
    }

    /// The range of every component; one of no range gets a distance that nothing depends on.
    fn ranges(here: &Current<'_>) -> Vec<f64> {
        let positive = |range: f64| if range > 0.0 { range } else { 1.0 };
        here.set.extent(here.m).into_iter().map(positive).collect()
    }

    fn distances(&self, ranges: &[f64]) -> Vec<f64> {
        match self.distances.is_empty() {
            true => ranges.iter().map(|range| self.asymptotes.initial_distance * range).collect(),
            false => self.distances.clone(),
        }
    }

    /// The weights with which an iteration begins.
    fn first_weights(&self, here: &Current<'_>) -> Vec<f64> {
        let ranges = Self::ranges(here);
        let mean = |row: &[f64]| {
            let sum: f64 = row.iter().zip(&ranges).map(|(d, range)| d.abs() * range).sum();
            sum / ranges.len() as f64
        };
        let cost = if here.held.is_empty() { here.derivative } else { &here.held.cost_derivative };
        let means = std::iter::once(cost).chain(here.held.rows.iter().map(Vec::as_slice)).map(mean);
        match self.weights.len() == 1 + here.held.rows.len() {
            false => means.map(|mean| FIRST_WEIGHT * mean).collect(),
            true => means.zip(&self.weights).map(|(mean, c)| c.max(MIN_WEIGHT * mean)).collect(),
        }
    }

    /// The model at a control; a smaller fraction moves asymptotes and move limits closer.
    fn model(&self, here: &Current<'_>, weights: &[f64], fraction: f64) -> Subproblem {
        let ranges = Self::ranges(here);
        let distances = self.distances(&ranges).iter().map(|s| fraction * s).collect();
        let moves = ranges.iter().map(|range| fraction * self.asymptotes.move_limit * range).collect();
        Subproblem::new(here, Reach { distances, moves }, weights)
    }

    /// What the weights come down to after a step: those with which the model would just have been no underestimate there.
    fn learnt(&self, from: &Current<'_>, to: &Current<'_>, fraction: f64) -> Vec<f64> {
        let model = self.model(from, &self.present, fraction);
        let x = sub(to.m, from.m);
        let one = model.convex_term(&x);
        let cost = to.held.without_penalty(to.cost, &to.held.values);
        let found = std::iter::once(&cost).chain(&to.held.values);
        let of = |(i, (c, found)): (usize, (&f64, &f64))| {
            // What a short step shows of the curvature is lost in the rounding of values: it keeps no weight up.
            let rounding = if i == 0 { self.slack(*found) } else { VALUE_SLACK };
            let enough = WEIGHT_MARGIN * (c - (model.value(i, &x) - found + rounding) / one);
            enough.min(*c).max(MIN_WEIGHT_DECREASE * c)
        };
        self.present.iter().zip(found).enumerate().map(of).collect()
    }

    /// The functions that a trial finds underestimated, with what they should have been: those that keep it from being accepted.
    fn underestimated(model: &Subproblem, x: &[f64], here: &Current<'_>, trial: &Tried<'_>) -> Vec<(usize, [f64; 2])> {
        let cost = here.held.without_penalty(trial.cost, trial.values);
        let of_cost = Some((0, [model.value(0, x), cost])).filter(|(_, [says, found])| *found > says + trial.slack);
        let of = |(k, found): (usize, &f64)| {
            let says = model.value(k + 1, x);
            (*found > says.max(0.0) + VALUE_SLACK).then_some((k + 1, [says, *found]))
        };
        of_cost.into_iter().chain(trial.values.iter().enumerate().filter_map(of)).collect()
    }
}

impl Method for MovingAsymptotes {
    fn restart(&mut self, _step: f64, _cost: f64) {
        *self = Self::new(self.asymptotes);
    }

    fn prepare(&mut self, here: &Current<'_>, _: &mut dyn HessianProducts) -> Result<(), Failed> {
        self.present = self.first_weights(here);
        Ok(())
    }

    fn trial(&self, here: &Current<'_>, fraction: f64) -> Vec<f64> {
        let model = self.model(here, &self.present, fraction);
        let step = model.step(&multipliers(&model));
        let mut out = here.m.to_vec();
        here.set.retract(here.m, &step, 1.0, &mut out);
        out
    }

    fn step(&self, fraction: f64) -> f64 {
        fraction
    }

    fn promise(&self, here: &Current<'_>, trial: &Proposed<'_>) -> f64 {
        self.model(here, &self.present, trial.fraction).merit_change(&sub(trial.m, here.m))
    }

    fn judge(&self, here: &Current<'_>, trial: &Tried<'_>) -> Judgement {
        let model = self.model(here, &self.present, trial.of.fraction);
        match Self::underestimated(&model, &sub(trial.of.m, here.m), here, trial).first() {
            Some((i, [model, found])) => {
                Judgement::Underestimated { constraint: i.checked_sub(1), model: *model, found: *found }
            }
            None => Judgement::Taken,
        }
    }

    fn refused(&mut self, here: &Current<'_>, trial: &Tried<'_>) {
        let model = self.model(here, &self.present, trial.of.fraction);
        let x = sub(trial.of.m, here.m);
        let one = model.convex_term(&x);
        for (i, [says, found]) in Self::underestimated(&model, &x, here, trial) {
            let (known, wanted) = (self.present[i], WEIGHT_MARGIN * (self.present[i] + (found - says) / one));
            self.present[i] = if known > 0.0 { wanted.min(MAX_WEIGHT_GROWTH * known) } else { wanted };
        }
    }

    fn multipliers(&self, here: &Current<'_>) -> Vec<f64> {
        multipliers(&self.model(here, &self.first_weights(here), 1.0))
    }

    fn accepted(&mut self, from: &Current<'_>, to: &Current<'_>, fraction: f64, _trials: usize) {
        self.weights = self.learnt(from, to, fraction);
        let Asymptotes { decrease, increase, min_distance, max_distance, .. } = self.asymptotes;
        let (ranges, step) = (Self::ranges(from), sub(to.m, from.m));
        let mut distances = self.distances(&ranges);
        for (j, s) in distances.iter_mut().enumerate() {
            *s *= (MAX_LENGTH_RATIO * fraction).min(1.0);
            match self.last.get(j).map_or(0.0, |last| last * step[j]) {
                turn if turn < 0.0 => *s = (decrease * *s).max(s.min(min_distance * ranges[j])),
                turn if turn > 0.0 => *s = (increase * *s).min(max_distance * ranges[j]),
                _ => {}
            }
        }
        (self.distances, self.last) = (distances, step);
    }

    fn save(&self) -> Memory {
        let vectors =
            if self.distances.is_empty() { Vec::new() } else { vec![self.distances.clone(), self.last.clone()] };
        Memory { numbers: self.weights.clone(), vectors }
    }

    fn load(&mut self, memory: &Memory) -> bool {
        let (distances, last) = match &memory.vectors[..] {
            [] => (Vec::new(), Vec::new()),
            [distances, last] if distances.iter().all(|s| *s > 0.0) => (distances.clone(), last.clone()),
            _ => return false,
        };
        if memory.numbers.is_empty() != distances.is_empty() || !memory.numbers.iter().all(|c| *c >= 0.0) {
            return false;
        }
        *self = Self { distances, last, weights: memory.numbers.clone(), ..Self::new(self.asymptotes) };
        true
    }
}
