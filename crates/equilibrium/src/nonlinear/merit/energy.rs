//! [`Energy`]: the potential.

use super::{Line, Merit};
use crate::nonlinear::direction::Step;
use crate::nonlinear::equations::{Equations, Evaluated};
use crate::nonlinear::iterate::Iterate;
use nastic_body::error::Inadmissible;

/// Rounding of the potential, as a share of the sum of its absolute terms.
const ENERGY_ROUNDING: f64 = 64.0 * f64::EPSILON;

/// The potential `P(u)`; of a model of which some contributions have none that of the others and the work of those,
/// `P(u) + f(u_0) . u`, with their forces f where the step begins.
pub(crate) struct Energy {
    line: Line,
    /// `f(u_0)`
    lagged: Option<Vec<f64>>,
}

impl Energy {
    /// Along a step; `scale` is what the rounding of the potential is measured against.
    pub fn new(equations: &Equations, here: &Iterate, dx: &[f64], scale: f64) -> Self {
        let slope = equations.model.unknowns().dot_in_order(here.residual, dx);
        Energy { line: Line { start: here.now.energy, slope, noise: ENERGY_ROUNDING * scale }, lagged: None }
    }

    /// With the work of the contributions that have no potential.
    pub fn lagged(equations: &Equations, here: &Iterate, step: &Step) -> Result<Self, Inadmissible> {
        let mut energy = Energy::new(equations, here, &step.dx, step.scale);
        let others = equations.without_potential(here.point, here.x)?;
        let work = equations.model.unknowns().dot(&others.force, here.x);
        energy.line.start += work - others.energy;
        energy.line.noise += ENERGY_ROUNDING * (work.abs() + others.energy_scale);
        energy.lagged = Some(others.force);
        Ok(energy)
    }
}

impl Merit for Energy {
    fn line(&self) -> Line {
        self.line
    }

    fn value<'e>(
        &self,
        equations: &Equations<'e>,
        trial: &[f64],
        _length: f64,
    ) -> Result<(f64, Evaluated<'e>), Inadmissible> {
        let now = equations.evaluate(trial)?;
        let work = match &self.lagged {
            None => 0.0,
            Some(force) => {
                equations.model.unknowns().dot(force, trial) - equations.without_potential(&now.point, trial)?.energy
            }
        };
        Ok((now.sums.energy + work, now))
    }
}
