//! [`WithoutVolumeErrors`]: the potential less what errors of the volumes take.

use super::energy::Energy;
use super::{Line, Merit};
use crate::nonlinear::equations::{Equations, Evaluated};
use crate::nonlinear::predicted_pressures::PredictedPressures;
use nastic_body::error::Inadmissible;

/// Rounding of sums over the points.
const SUM_ROUNDING: f64 = 64.0 * f64::EPSILON;

/// `P(u(s)) - 1/2 sum_q w_q k_q e_q(s)^2`, `e(s)` the errors that the step makes of the volumes: to third order in these, what P would be with the volumes
/// `V + s B du` and, for the rest, the pressures that the step predicts.
pub(crate) struct WithoutVolumeErrors<'a> {
    pub energy: Energy,
    pub pressures: &'a PredictedPressures<'a>,
}

impl Merit for WithoutVolumeErrors<'_> {
    fn line(&self) -> Line {
        let (line, [start, slope]) = (self.energy.line(), self.pressures.beside_potential());
        let noise = line.noise + SUM_ROUNDING * start.abs();
        Line { start: line.start + start, slope: line.slope + slope, noise }
    }

    fn value<'e>(
        &self,
        equations: &Equations<'e>,
        trial: &[f64],
        length: f64,
    ) -> Result<(f64, Evaluated<'e>), Inadmissible> {
        let (energy, now) = self.energy.value(equations, trial, length)?;
        Ok((energy - self.pressures.energy_of_errors(now.point.displaced(trial), length)?, now))
    }
}
