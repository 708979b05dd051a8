//! [`Augmented`]: the objective with its constraints as a penalty.

use super::multipliers::Multipliers;
use crate::constrained::Constrained;
use crate::failed::Failed;
use crate::held::Held;
use crate::hessian::Hessian;
use crate::objective::{Objective, Request};
use crate::summary::Summary;

/// The augmented Lagrangian `j(m) + psi(c(m))` of a constrained objective, for the present multipliers and penalty: what the
/// driver of an [`AugmentedRun`](super::AugmentedRun) minimises. Its points are those of the objective. Of a method that
/// [holds constraints itself](crate::Optimizer::holds_constraints) it is the exact penalty `j(m) + r sum_k max(0, c_k(m)/s_k)`, whose `derivative` is that of j:
/// the method is given the constraints by [`Objective::held`].
#[derive(Debug)]
pub struct Augmented<O> {
    pub(super) objective: O,
    pub(super) multipliers: Multipliers,
    /// States are never asked for more coarsely than this.
    accuracy: f64,
    /// Whether the method holds the constraints itself.
    pub(super) held: bool,
}

impl<O: Constrained> Augmented<O> {
    /// Without a penalty yet.
    pub(super) fn new(objective: O, accuracy: f64, held: bool) -> Self {
        let multipliers = Multipliers::none(objective.constraints());
        Self { objective, multipliers, accuracy, held }
    }

    /// The objective without its constraints.
    pub fn objective(&self) -> &O {
        &self.objective
    }

    /// The penalty, in the unit of the cost: see [`AugmentedLagrangian`](super::AugmentedLagrangian). Zero without constraints.
    pub fn penalty(&self) -> f64 {
        self.multipliers.penalty
    }

    /// A missing value, or one that is no number, would pass as a constraint that is met.
    fn check(&self, c: &[f64]) -> Result<(), Failed> {
        let expected = self.multipliers.values.len();
        if c.len() != expected {
            return Err(Failed::because(format!("{} values of {expected} constraints", c.len())));
        }
        match c.iter().position(|c| !c.is_finite()) {
            Some(k) => Err(Failed::because(format!("value {k} of the constraints is {}", c[k]))),
            None => Ok(()),
        }
    }

    fn is_constrained(&self) -> bool {
        !self.multipliers.values.is_empty()
    }
}

impl<O: Constrained> Objective for Augmented<O> {
    type Point = O::Point;
    type Workspace = O::Workspace;

    fn evaluate(
        &self,
        m: &[f64],
        how: &Request<'_, O::Point>,
        workspace: &mut O::Workspace,
    ) -> Result<O::Point, Failed> {
        let accuracy = if self.is_constrained() { how.accuracy.min(self.accuracy) } else { how.accuracy };
        let point = self.objective.evaluate(m, &Request { accuracy, ..*how }, workspace)?;
        self.check(&self.objective.constraint_values(&point))?;
        Ok(point)
    }

    fn value(&self, point: &O::Point) -> f64 {
        let cost = self.objective.value(point);
        if !self.is_constrained() {
            return cost;
        }
        let c = self.objective.constraint_values(point);
        cost + if self.held { self.multipliers.exact_penalty(&c) } else { self.multipliers.value(&c) }
    }

    fn derivative(&self, point: &mut O::Point, workspace: &mut O::Workspace) -> Result<Vec<f64>, Failed> {
        if self.held || !self.is_constrained() {
            return self.objective.derivative(point, workspace);
        }
        let y = self.multipliers.slopes(&self.objective.constraint_values(point));
        self.objective.lagrangian_derivative(point, &y, workspace)
    }

    fn hessian_vector(
        &self,
        point: &O::Point,
        v: &[f64],
        which: Hessian,
        workspace: &mut O::Workspace,
    ) -> Result<Vec<f64>, Failed> {
        if self.held || !self.is_constrained() {
            return self.objective.hessian_vector(point, v, which, workspace);
        }
        let c = self.objective.constraint_values(point);
        let (y, w) = (self.multipliers.slopes(&c), self.multipliers.curvatures(&c));
        self.objective.lagrangian_hessian_vector(point, [&y, &w], (v, which), workspace)
    }

    fn held_values(&self, point: &O::Point) -> Vec<f64> {
        match self.held {
            true => self.multipliers.relative(&self.objective.constraint_values(point)),
            false => Vec::new(),
        }
    }

    /// None as long as there is no penalty.
    fn held(&self, point: &mut O::Point, workspace: &mut O::Workspace) -> Result<Option<Held>, Failed> {
        if !self.held || self.multipliers.penalty == 0.0 {
            return Ok(None);
        }
        let mut rows = self.objective.constraint_derivatives(point, workspace)?;
        let values = self.held_values(point);
        if rows.len() != values.len() {
            return Err(Failed::because(format!("{} derivatives of {} constraints", rows.len(), values.len())));
        }
        self.multipliers.scale(&mut rows);
        let cost_derivative = self.objective.derivative(point, workspace)?;
        let (multipliers, penalty) = (Vec::new(), self.multipliers.penalty);
        Ok(Some(Held { values, rows, cost_derivative, multipliers, penalty }))
    }

    fn jump(&self, from: &O::Point, to: &O::Point, workspace: &mut O::Workspace) -> Option<Failed> {
        self.objective.jump(from, to, workspace)
    }

    fn stages(&self) -> usize {
        self.objective.stages()
    }

    fn restage(&self, stage: usize, point: &O::Point) -> Result<O::Point, Failed> {
        self.objective.restage(stage, point)
    }

    /// That of the objective; with constraints also `objective`, the cost without the penalty, `violation`, the largest relative to
    /// the scales, and `penalty`.
    fn summary(&self, point: &O::Point) -> Summary {
        let mut out = self.objective.summary(point);
        if self.is_constrained() {
            let c = self.objective.constraint_values(point);
            out.0.push(("objective".into(), self.objective.value(point)));
            out.0.push(("violation".into(), self.multipliers.violation(&c)));
            out.0.push(("penalty".into(), self.multipliers.penalty));
        }
        out
    }

    fn figures(&self, point: &O::Point) -> Summary {
        self.objective.figures(point)
    }

    fn any(&self, here: bool) -> Result<bool, Failed> {
        self.objective.any(here)
    }

    fn save(&self, point: &O::Point) -> Vec<u8> {
        self.objective.save(point)
    }

    fn load(&self, m: &[f64], bytes: &[u8], how: &Request<'_, O::Point>) -> Result<O::Point, Failed> {
        self.objective.load(m, bytes, how)
    }
}
