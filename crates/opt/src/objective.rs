//! What an optimiser asks of a problem.

use thiserror::Error;

/// A trial that could not be evaluated (a state solve that failed, say): an ordinary answer, which shortens the step.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("{why}")]
pub struct Failed {
    /// What failed, where, by how much.
    pub why: String,
}

impl Failed {
    /// A failure with its reason.
    pub fn new(why: impl Into<String>) -> Self {
        Self { why: why.into() }
    }
}

/// How a trial is to be evaluated.
#[derive(Debug)]
pub struct Request<'a, P> {
    /// An evaluated point to start from (warm start, factor to borrow): the last accepted one.
    pub near: Option<&'a P>,
    /// Relative accuracy wanted of the state solve.
    pub accuracy: f64,
    /// The continuation stage whose value is wanted, below [`Objective::stages`].
    pub stage: usize,
}

/// Relative accuracy of state solves unless told otherwise.
pub const DEFAULT_ACCURACY: f64 = 1e-8;

impl<P> Default for Request<'_, P> {
    fn default() -> Self {
        Self { near: None, accuracy: DEFAULT_ACCURACY, stage: 0 }
    }
}

impl<P> Clone for Request<'_, P> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<P> Copy for Request<'_, P> {}

/// Named numbers of one evaluated point (cost terms, true Hausdorff distance, counts): what a history line holds
/// beside the driver's own.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Report(pub Vec<(String, f64)>);

impl Report {
    /// The entry of that name.
    pub fn get(&self, name: &str) -> Option<f64> {
        self.0.iter().find(|(key, _)| key == name).map(|(_, value)| *value)
    }
}

/// A cost of a control vector m. A *point* is an evaluated trial; its derivative can be asked for later, and is asked
/// for only when the trial is accepted.
///
/// Every method is a function of its arguments: the objective holds no current point and no current stage.
pub trait Objective: Sync {
    /// An evaluated trial: the state, the value, what a derivative needs.
    type Point;

    /// Evaluates the cost of stage `how.stage` at `m`.
    ///
    /// # Errors
    /// [`Failed`] when there is no value there; the driver tries a shorter step.
    fn evaluate(&self, m: &[f64], how: &Request<'_, Self::Point>) -> Result<Self::Point, Failed>;

    /// The cost at an evaluated point.
    fn value(&self, point: &Self::Point) -> f64;

    /// The derivative dj/dm_i at an evaluated point: a dual vector, not yet a gradient (see
    /// [`InnerProduct::riesz`](crate::InnerProduct::riesz)).
    ///
    /// # Errors
    /// [`Failed`] when the adjoint cannot be had; the driver treats the trial as failed.
    fn derivative(&self, point: &Self::Point) -> Result<Vec<f64>, Failed>;

    /// The second derivative applied to a direction (a dual vector), if the objective has one.
    ///
    /// # Errors
    /// [`Failed`] when a solve fails.
    fn hessian_vector(&self, _point: &Self::Point, _direction: &[f64]) -> Result<Option<Vec<f64>>, Failed> {
        Ok(None)
    }

    /// Number of continuation stages (alpha, beta, gamma of a smoothed distance): same states, another value.
    fn stages(&self) -> usize {
        1
    }

    /// The same control and state, valued by another stage.
    ///
    /// # Errors
    /// [`Failed`] when that stage has no value there.
    fn restage(&self, stage: usize, point: &Self::Point) -> Result<Self::Point, Failed>;

    /// What a history line holds of this point.
    fn report(&self, _point: &Self::Point) -> Report {
        Report::default()
    }

    /// A point as bytes for a checkpoint. The default keeps nothing, and [`Objective::load`] evaluates anew.
    fn save(&self, _point: &Self::Point) -> Vec<u8> {
        Vec::new()
    }

    /// The point that [`Objective::save`] wrote. For a resumed run to go on to the bit, what follows must not depend
    /// on whether a point was computed or loaded. The default evaluates `m` without a warm start, which is to the bit
    /// only when values do not depend on the warm start.
    ///
    /// # Errors
    /// [`Failed`] when the bytes are not a point of this objective, or the evaluation fails.
    fn load(&self, m: &[f64], _bytes: &[u8], how: &Request<'_, Self::Point>) -> Result<Self::Point, Failed> {
        self.evaluate(m, how)
    }
}
