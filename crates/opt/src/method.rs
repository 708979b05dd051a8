//! [`Method`]: the strategy of an optimiser, which proposes the next trial.

use crate::admissible::Admissible;
use crate::failed::Failed;
use crate::held::Held;
use crate::hessian::Hessian;
use crate::inner_product::InnerProduct;
use nastic_numeric::vector::dot;
use serde::{Deserialize, Serialize};
use std::fmt::Debug;

/// An accepted control with what is known there.
#[derive(Clone, Copy, Debug)]
pub struct Current<'a> {
    /// The admissible set.
    pub set: &'a dyn Admissible,
    /// The inner product of the control space.
    pub metric: &'a dyn InnerProduct,
    /// The control.
    pub m: &'a [f64],
    /// The cost there.
    pub cost: f64,
    /// Its derivative there (dual), tangential part; that of the Lagrangian where the method holds constraints itself.
    pub derivative: &'a [f64],
    /// The constraints that the method holds itself; without values of all other methods.
    pub held: &'a Held,
}

/// A trial that a method has proposed.
#[derive(Clone, Copy, Debug)]
pub struct Proposed<'a> {
    /// The trial control.
    pub m: &'a [f64],
    /// Of which fraction of the step.
    pub fraction: f64,
    /// The change of cost that the derivative predicts.
    pub linear: f64,
}

/// A proposed trial with what its evaluation found.
#[derive(Clone, Copy, Debug)]
pub struct Tried<'a> {
    /// The trial.
    pub of: Proposed<'a>,
    /// Its cost, with the penalty of the constraints that the method holds.
    pub cost: f64,
    /// The values of these constraints, relative to their scales.
    pub values: &'a [f64],
    /// What rounding may add to the cost.
    pub slack: f64,
}

/// What a method says of an evaluated trial.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Judgement {
    /// Armijo's test decides.
    Armijo,
    /// It is taken.
    Taken,
    /// The model underestimates the cost, or a constraint that matters; [`Method::refused`] makes it more conservative.
    Underestimated {
        /// Which of the constraints; none of the cost.
        constraint: Option<usize>,
        /// What the model says.
        model: f64,
        /// What was found.
        found: f64,
    },
}

/// Products with the second derivative of the cost at an accepted control, through the curvature of the set too.
pub trait HessianProducts {
    /// `H v`, a dual vector, for a v of the set's tangent space there.
    ///
    /// # Errors
    /// As [`Objective::hessian_vector`](crate::Objective::hessian_vector).
    fn product(&mut self, v: &[f64], which: Hessian) -> Result<Vec<f64>, Failed>;
}

/// The change of derivative between two controls in the tangent space of the second: what secant methods learn from.
#[derive(Clone, Debug, PartialEq)]
pub struct Secant {
    /// The step s.
    pub s: Vec<f64>,
    /// The change of derivative y (dual).
    pub y: Vec<f64>,
    /// (s, s).
    pub ss: f64,
    /// s . y.
    pub sy: f64,
    /// Squared dual norm of y.
    pub yy: f64,
}

impl Secant {
    /// Smallest cosine between s and the Riesz image of y that still counts as positive curvature.
    const MIN_COSINE: f64 = 1e-9;

    /// From one control to another.
    pub fn between(from: &Current<'_>, to: &Current<'_>) -> Self {
        let mut s: Vec<f64> = to.m.iter().zip(from.m).map(|(a, b)| a - b).collect();
        to.set.tangent(to.m, &mut s);
        let mut carried = from.derivative.to_vec();
        to.set.transport(from.m, to.m, &mut carried);
        let y: Vec<f64> = to.derivative.iter().zip(&carried).map(|(a, b)| a - b).collect();
        let (ss, sy, yy) = (to.metric.inner(&s, &s), dot(&s, &y), dot(&to.metric.riesz(&y), &y));
        Self { s, y, ss, sy, yy }
    }

    /// Whether the cost curves upward along s, beyond rounding.
    pub fn is_convex(&self) -> bool {
        self.sy > 0.0 && self.sy * self.sy > Self::MIN_COSINE * Self::MIN_COSINE * self.ss * self.yy
    }
}

/// A method's memory as plain numbers: what a checkpoint keeps of it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Memory {
    /// Scalars, in the method's order.
    pub numbers: Vec<f64>,
    /// Vectors, in the method's order.
    pub vectors: Vec<Vec<f64>>,
}

/// The strategy of an optimiser, driven by [`Run`](crate::Run): `restart` once per stage, then for every iteration
/// `prepare`, some calls of `trial` with fractions that do not grow, and `accepted`.
///
/// A method that [holds constraints itself](crate::Optimizer::holds_constraints) is given their values and derivatives in [`Current::held`], and says
/// with `promise`, `judge`, `refused` and `multipliers` what it makes of them.
pub trait Method: Debug + Send {
    /// Begins a stage: forget what belongs to another cost; `step` is a sensible length t of a first step -t gradient.
    fn restart(&mut self, step: f64, cost: f64);

    /// Chooses a direction (or a length) at a control; `hessian` costs as much as it is asked for.
    ///
    /// # Errors
    /// Second derivatives that the method needs and cannot have.
    fn prepare(&mut self, here: &Current<'_>, hessian: &mut dyn HessianProducts) -> Result<(), Failed>;

    /// The trial control at a fraction (1 first) of the chosen step: admissible.
    fn trial(&self, here: &Current<'_>, fraction: f64) -> Vec<f64>;

    /// The step length to report for a fraction.
    fn step(&self, fraction: f64) -> f64;

    /// What the method's model says a trial changes the cost by: the derivative's prediction, where it has no model of its own.
    fn promise(&self, _here: &Current<'_>, trial: &Proposed<'_>) -> f64 {
        trial.linear
    }

    /// Whether an evaluated trial is taken.
    fn judge(&self, _here: &Current<'_>, _trial: &Tried<'_>) -> Judgement {
        Judgement::Armijo
    }

    /// Learns from a trial that it has judged underestimated: the next one is shorter at the same fraction.
    fn refused(&mut self, _here: &Current<'_>, _trial: &Tried<'_>) {}

    /// Multipliers of the constraints that the method holds itself, by its model at a control; none of a method that holds none.
    fn multipliers(&self, _here: &Current<'_>) -> Vec<f64> {
        Vec::new()
    }

    /// The cost that a trial is compared with; more than the present one in a non-monotone method.
    fn reference(&self, cost: f64) -> f64 {
        cost
    }

    /// What rounding may add to a cost without its being refused.
    fn slack(&self, cost: f64) -> f64 {
        10.0 * f64::EPSILON * cost.abs()
    }

    /// Learns from an accepted step, found at the `trials`-th trial.
    fn accepted(&mut self, from: &Current<'_>, to: &Current<'_>, fraction: f64, trials: usize);

    /// After a search that found nothing: whether there is another direction to try from the same control.
    fn recover(&mut self) -> bool {
        false
    }

    /// The memory, for a checkpoint.
    fn save(&self) -> Memory;

    /// Takes up a saved memory; false if it is not one of this method.
    fn load(&mut self, memory: &Memory) -> bool;
}
