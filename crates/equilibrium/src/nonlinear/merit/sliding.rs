//! [`Sliding`]: the potential with friction whose normal forces are those where a step begins.

use super::energy::Energy;
use super::{Line, Merit};
use crate::nonlinear::equations::{Drive, Equations, Evaluated};
use crate::nonlinear::iterate::Iterate;
use nastic_body::error::Inadmissible;
use nastic_body::instant::{FrictionLag, TimeStep};
use std::sync::Arc;

/// `P(u) + D(u; u_0)`: the potential without friction and the dissipation potential of friction with the normal forces and tangent planes of the
/// displacement u_0 where the step of Newton's method begins. Its derivative at u_0 is the residual. It is another function in every iteration: what falls in each need
/// not fall over all of them. Source: Li et al., Incremental Potential Contact, ACM Trans. Graph. 39 (2020), section 5.4, where u_0 is that of the round before.
pub(crate) struct Sliding {
    energy: Energy,
    /// The time step with u_0.
    lagged: TimeStep,
    /// `D(u_0; u_0)`
    start: f64,
}

impl Sliding {
    /// The step in time of equations that friction alone keeps from having a potential.
    pub fn step<'e>(equations: &Equations<'e>) -> Option<&'e TimeStep> {
        match equations.drive {
            Drive::Held { time_step, .. } => time_step.filter(|_| equations.model.has_potential_without_friction()),
            Drive::Path { .. } => None,
        }
    }

    /// From an iterate of such a step.
    pub fn new(equations: &Equations, step: &TimeStep, here: &Iterate, energy: Energy) -> Result<Self, Inadmissible> {
        let (u, controls) = (equations.model.nodal(here.x).to_vec(), equations.prescribed_at(0.0).0);
        let lag = FrictionLag { u: Arc::new(u), controls: Arc::new(controls), smoothing: 1.0 };
        let lagged = TimeStep { lag: Some(lag), ..step.clone() };
        let start = equations.dissipation(&lagged, here.point, here.x)?;
        Ok(Sliding { energy, lagged, start })
    }
}

impl Merit for Sliding {
    fn line(&self) -> Line {
        let line = self.energy.line();
        Line { start: line.start + self.start, ..line }
    }

    fn value<'e>(
        &self,
        equations: &Equations<'e>,
        trial: &[f64],
        length: f64,
    ) -> Result<(f64, Evaluated<'e>), Inadmissible> {
        let (energy, now) = self.energy.value(equations, trial, length)?;
        Ok((energy + equations.dissipation(&self.lagged, &now.point, trial)?, now))
    }
}
