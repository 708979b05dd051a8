//! [`Reduced::adaptive_steps`]: steps of a motion that follow the estimate of their error.

use super::Reduced;
use crate::workspace::ReducedWorkspace;
use nastic_fem::{AdaptiveReport, Controls, FemError, TimeStepping, Tolerance};
use nastic_fields::{ControlError, Interpolation};
use serde::{Deserialize, Serialize};

/// The length of the first step, and of the first one behind a jump of a control, as a share of the whole time.
const FIRST: f64 = 1e-3;
/// Jumps closer to an instant than this share of the whole time are there.
const SAME: f64 = 1e-9;

/// Steps that were found for one control vector.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct AdaptiveSteps {
    /// All instants, 0 and the end included: what [`Timeline::through`](crate::Timeline::through) takes.
    pub instants: Vec<f64>,
    /// What it took.
    pub report: AdaptiveReport,
}

impl AdaptiveSteps {
    /// The shortest and the longest step.
    pub fn range(&self) -> (f64, f64) {
        let lengths = self.instants.windows(2).map(|pair| pair[1] - pair[0]);
        lengths.fold((f64::INFINITY, 0.0), |(least, most), h| (h.min(least), h.max(most)))
    }
}

impl Reduced {
    /// The steps by which the motion under m leads through all instants of the timeline with at most the allowed estimated error
    /// each; `None` of a problem that is not one in time. The motion runs once, the memory holds two of its states. `first` of the
    /// tolerance, by default a thousandth of the whole time, is also the length of the first step behind a knot at which a control jumps.
    ///
    /// A problem built anew on [`Timeline::through`](crate::Timeline::through) these instants has them for every m: its cost is one smooth function, and its
    /// derivative exact. How well they suit another m is reported by [`SolvedStates::error`](crate::SolvedStates::error).
    ///
    /// # Errors
    /// A scheme without an estimate; a motion that fails; a tolerance out of reach.
    pub fn adaptive_steps(
        &self,
        m: &[f64],
        accuracy: f64,
        tolerance: Tolerance,
    ) -> Result<Option<AdaptiveSteps>, ControlError> {
        let Some(motion) = &self.motion else { return Ok(None) };
        self.layout.check(m)?;
        let (timeline, options) = (&motion.timeline, self.solve_options(accuracy));
        let mut workspace = ReducedWorkspace::default();
        let mut trajectory = self.beginning(motion, m, &options, &mut workspace)?;
        let controls = |t: f64| -> Result<Controls, ControlError> {
            let mut fixed = self.layout.fixed().clone();
            motion.fixed.iter().try_for_each(|values| values.put_at(t, &mut fixed))?;
            motion.layout.to_points_over(fixed, &self.layout.at(m, t)?)
        };
        let controls = |t: f64| controls(t).map_err(|error| FemError::Meaningless { what: error.to_string() });
        let tolerance = Tolerance { first: Some(tolerance.first.unwrap_or(FIRST * timeline.end())), ..tolerance };
        let mut found = AdaptiveSteps { instants: vec![0.0], report: AdaptiveReport::default() };
        let goals = &timeline.instants()[1..];
        let jumps = self.jumps();
        let is_jump = |t: &f64| jumps.iter().any(|jump| (jump - t).abs() <= SAME * timeline.end());
        for goals in goals.split_inclusive(is_jump) {
            let (instants, report) = self.solid.model().find_steps(
                &mut trajectory,
                timeline.scheme(),
                (goals, tolerance),
                &controls,
                &options,
                &mut workspace.solve,
            )?;
            found.instants.extend(instants);
            found.report.accepted += report.accepted;
            found.report.rejected += report.rejected;
            found.report.failed += report.failed;
        }
        Ok(Some(found))
    }

    /// Where controls that are constant between knots jump.
    fn jumps(&self) -> Vec<f64> {
        let knots = self.layout.blocks().iter().filter_map(|block| block.knots.as_ref());
        knots
            .filter(|knots| knots.interpolation() == Interpolation::Constant)
            .flat_map(|knots| knots.times())
            .copied()
            .collect()
    }
}
