//! [`When`]: at which instants of a motion a cost of states counts.

use super::timeline::Timeline;
use crate::cost::Cost;
use nastic_fields::ControlError;

/// The part of a motion over which a cost j(u, m) of states is taken.
#[derive(Debug, Clone, PartialEq)]
pub enum When {
    /// `j(u(T), m(T))`, at the end.
    End,
    /// `int_0^T j dt`, by the trapezoidal rule over the steps; in units of the cost times time.
    Integral,
    /// `sum_i j(t_i)` at instants that the steps lead through.
    At(Vec<f64>),
    /// `int_0^T j / (j + scale) dt`: about the time that passes with `j > scale`, and with `scale -> 0` that until a cost
    /// which stays zero from then on vanishes. In units of time.
    TimeAbove {
        /// The value of j that counts half, > 0.
        scale: f64,
    },
}

/// Where a cost stands in a motion: the factors of its values at the instants, zero ones left out.
#[derive(Debug)]
pub(crate) struct Schedule {
    pub when: When,
    pub weights: Vec<(usize, f64)>,
    /// One for each of the weights, of a cost that changes in time; else it is the same at all.
    pub own: Vec<Box<dyn Cost>>,
}

impl Schedule {
    pub fn new(when: When, timeline: &Timeline) -> Result<Self, ControlError> {
        let all = || timeline.weights().into_iter().enumerate().collect();
        let weights = match &when {
            When::End => vec![(timeline.steps(), 1.0)],
            When::Integral => all(),
            When::At(times) if times.is_empty() => {
                return Err(ControlError::Cost { what: "a cost at no instant: name one or more".to_owned() });
            }
            When::At(times) => {
                times.iter().map(|t| Ok((timeline.index(*t)?, 1.0))).collect::<Result<_, ControlError>>()?
            }
            When::TimeAbove { scale } if scale.is_finite() && *scale > 0.0 => all(),
            When::TimeAbove { scale } => {
                let what = format!("the time above a scale of {scale}: take a positive value of the cost");
                return Err(ControlError::Cost { what });
            }
        };
        Ok(Schedule { when, weights, own: Vec::new() })
    }

    /// Its share of the sum at a value of the cost, and the derivative by that.
    pub fn shape(&self, j: f64) -> (f64, f64) {
        match self.when {
            When::TimeAbove { scale } => (j / (j + scale), scale / (j + scale).powi(2)),
            _ => (j, 1.0),
        }
    }
}
