//! [`Direction`]: what finds the steps of an iteration.

mod active_set;
pub(crate) mod arc;
pub(crate) mod bordered;
pub(crate) mod deflated;
pub(crate) mod linearised;
pub(crate) mod plain;
pub(crate) mod point_strains;
pub(crate) mod rigid;

use crate::nonlinear::iterate::{Iterate, Stop};
use crate::nonlinear::predicted_pressures::PredictedPressures;
use nastic_body::state::SolveReport;
use nastic_linear::Space;
use nastic_linear::solver::Curvature;

/// A step.
pub(crate) struct Step {
    /// Of all unknowns.
    pub dx: Vec<f64>,
    /// What the tangent turned out to be.
    pub curvature: Curvature,
    /// Largest component of the displacement's.
    pub size: f64,
    /// What the rounding of the potential is measured against.
    pub scale: f64,
    pub take: Take,
}

/// How far a step is to go.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Take {
    /// The whole of it, or it fails with what inverts there.
    Once,
    /// As far as is admissible, at least a share of it, or it fails.
    Longest { least: f64 },
    /// All of it, which is this share of a step and admissible.
    Checked { length: f64 },
    /// As far as a merit falls.
    Search,
}

impl Step {
    /// One that is taken whole or not at all.
    pub fn whole(dx: Vec<f64>, curvature: Curvature, space: &Space) -> Self {
        let size = space.max_abs(&dx[..space.nodal()]);
        Step { dx, curvature, size, scale: 0.0, take: Take::Longest { least: 1.0 } }
    }
}

/// A linear problem that gives a step at every iterate.
pub(crate) trait Direction {
    /// Whether a step is due whatever the residual: prescribed components are not in their place yet.
    fn is_pending(&self) -> bool {
        false
    }

    /// The step at an iterate.
    ///
    /// # Errors
    /// Why there is none.
    fn find(&mut self, here: &Iterate, report: &mut SolveReport) -> Result<Step, Stop>;

    /// A descent direction of the merit at the same iterate, where the first may be none.
    ///
    /// # Errors
    /// Why there is none.
    fn downhill(&mut self, here: &Iterate, _report: &mut SolveReport) -> Result<Vec<f64>, Stop> {
        Err(Stop::Slow { residual: here.relative })
    }

    /// The pressures that its steps predict, if they do.
    fn pressures(&self) -> Option<&PredictedPressures<'_>> {
        None
    }

    /// Notes which share of the last step was taken.
    fn took(&mut self, _share: f64) {}
}
