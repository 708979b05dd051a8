//! [`RateLimit`]: a bound on how fast a control changes.

use super::control_rate::{check_in_time, intervals};
use nastic_fields::{ControlError, Layout};
use nastic_opt::{ConstraintGroup, Sense};

/// `|dm/dt| <= rate` for every entry of a control in time (every vector of one of vectors): between neighbouring knots
///
/// ```text
/// c = |m_{k+1} - m_k|^2 / (rate dt)^2 - 1 <= 0
/// ```
///
/// Held by [`nastic_opt::AugmentedLagrangian`]. The rate in the control's unit per second.
#[derive(Debug, Clone)]
pub struct RateLimit {
    of: String,
    rate: f64,
}

impl RateLimit {
    /// Of the named control.
    ///
    /// # Errors
    /// A rate that is not positive.
    pub fn of(control: &str, rate: f64) -> Result<Self, ControlError> {
        if !(rate.is_finite() && rate > 0.0) {
            let what = format!("the rate of \"{control}\" is limited to {rate}: take a positive one");
            return Err(ControlError::Cost { what });
        }
        Ok(RateLimit { of: control.to_owned(), rate })
    }

    pub(crate) fn check(&self, layout: &Layout) -> Result<(), ControlError> {
        check_in_time("the limited rate", &self.of, layout)
    }

    pub(crate) fn group(&self, layout: &Layout) -> Result<ConstraintGroup, ControlError> {
        let block = layout.block(&self.of)?;
        let len = intervals(block).len() * block.basis.len();
        Ok(ConstraintGroup { name: format!("rate_{}", self.of), sense: Sense::AtMost, len, scale: 1.0 })
    }

    pub(crate) fn values(&self, layout: &Layout, m: &[f64]) -> Result<Vec<f64>, ControlError> {
        let mut values = Vec::new();
        self.for_each(layout, m, |change, _, _, _| values.push(change.iter().map(|d| d * d).sum::<f64>() - 1.0))?;
        Ok(values)
    }

    /// Adds `sum_k y_k dc_k/dm`.
    pub(crate) fn add_partials(
        &self,
        layout: &Layout,
        m: &[f64],
        y: &[f64],
        out: &mut [f64],
    ) -> Result<(), ControlError> {
        let mut weights = y.iter();
        self.for_each(layout, m, |change, here, there, factor| {
            let y = weights.next().copied().unwrap_or_default();
            for (c, d) in change.iter().enumerate() {
                out[here + c] -= 2.0 * y * d * factor;
                out[there + c] += 2.0 * y * d * factor;
            }
        })
    }

    /// Calls back with each vector's change over `rate dt`, its places in the control vector before and behind, and
    /// `1 / (rate dt)`.
    fn for_each(
        &self,
        layout: &Layout,
        m: &[f64],
        mut each: impl FnMut(&[f64], usize, usize, f64),
    ) -> Result<(), ControlError> {
        let block = layout.block(&self.of)?;
        let (size, n) = (block.size(), block.components);
        for (k, dt) in intervals(block).into_iter().enumerate() {
            let factor = 1.0 / (self.rate * dt);
            for unknown in 0..block.basis.len() {
                let here = block.first + k * size + unknown * n;
                let change: Vec<f64> = (here..here + n).map(|i| (m[i + size] - m[i]) * factor).collect();
                each(&change, here, here + size, factor);
            }
        }
        Ok(())
    }
}
