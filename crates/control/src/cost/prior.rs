//! [`Prior`]: what is known of a control beside what its cost measures.

use super::{Cost, CostContext, CostPoint, Partials, check_weight};
use nastic_fields::ControlError;
use std::sync::Arc;

/// `j = weight sum_i (x_i - mean)^2 / (2 s^2)` over the unknowns x_i of a scalar control: minus the logarithm of a normal density of independent values with this mean and
/// deviation; of a control whose unknowns are [logarithms](crate::Layout::by_logarithm) one of them, with the mean `ln(mean)` and the deviation `s/mean`.
///
/// Derivatives: `dj/dx_i = weight (x_i - mean)/s^2`, `d2j/dx_i^2 = weight/s^2`. Units: none times the weight's. Source: docs/identify.md.
#[derive(Clone, Debug)]
pub struct Prior {
    of: String,
    mean: f64,
    deviation: f64,
    weight: f64,
}

impl Prior {
    /// Of the named control.
    ///
    /// # Errors
    /// A deviation that is not positive, a mean that is not finite.
    pub fn of(control: &str, mean: f64, deviation: f64) -> Result<Self, ControlError> {
        if !(mean.is_finite() && deviation.is_finite() && deviation > 0.0) {
            let what = format!(
                "the prior of {control} has the mean {mean} and the deviation {deviation}: numbers, the second positive"
            );
            return Err(ControlError::Cost { what });
        }
        Ok(Prior { of: control.to_owned(), mean, deviation, weight: 1.0 })
    }

    /// Multiplies the cost.
    ///
    /// # Errors
    /// A weight that is not positive.
    pub fn weight(self, weight: f64) -> Result<Self, ControlError> {
        Ok(Prior { weight: check_weight("prior", weight)?, ..self })
    }
}

impl Cost for Prior {
    fn name(&self) -> &str {
        "prior"
    }

    fn at(&self, at: &CostContext) -> Result<Arc<dyn CostPoint>, ControlError> {
        let block = at.layout.block(&self.of)?;
        let refuse = |what: String| Err(ControlError::Cost { what });
        if block.components != 1 {
            return refuse(format!("a prior is of a scalar, and {} is a vector: give it a direction", self.of));
        }
        if block.log && self.mean <= 0.0 {
            return refuse(format!(
                "the prior of {} has the mean {}, and its logarithm is the unknown",
                self.of, self.mean
            ));
        }
        let (mean, deviation) =
            if block.log { (self.mean.ln(), self.deviation / self.mean) } else { (self.mean, self.deviation) };
        let gaps = block.of(at.m).iter().map(|x| x - mean).collect();
        Ok(Arc::new(EvaluatedCost { first: block.first, factor: self.weight / (deviation * deviation), gaps }))
    }
}

/// The cost evaluated.
#[derive(Debug)]
struct EvaluatedCost {
    /// Where the control begins in the control vector.
    first: usize,
    /// `weight / s^2`.
    factor: f64,
    /// `x_i - mean`.
    gaps: Vec<f64>,
}

impl EvaluatedCost {
    fn add(&self, of: &[f64], out: &mut [f64]) {
        out[self.first..].iter_mut().zip(of).for_each(|(out, x)| *out += self.factor * x);
    }
}

impl CostPoint for EvaluatedCost {
    fn value(&self) -> f64 {
        0.5 * self.factor * self.gaps.iter().map(|gap| gap * gap).sum::<f64>()
    }

    fn add_partials(&self, out: &mut Partials) -> Result<(), ControlError> {
        self.add(&self.gaps, &mut out.m);
        Ok(())
    }

    fn add_second_partials(&self, along: &Partials, out: &mut Partials) -> Result<(), ControlError> {
        self.add(&along.m[self.first..self.first + self.gaps.len()], &mut out.m);
        Ok(())
    }
}
