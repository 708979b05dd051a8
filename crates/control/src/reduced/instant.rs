//! [`AtInstant`]: a state and the controls of its instant, found once for all costs and constraints there.

use super::Reduced;
use crate::constraint::ConstraintPoint;
use crate::cost::of_displacement::{beside_fields, displacement, wrapped};
use crate::cost::{Cost, CostContext, CostPoint, StepBegin};
use crate::time::Timeline;
use nastic_fem::State;
use nastic_fields::ControlError;
use std::borrow::Cow;
use std::cell::OnceCell;
use std::sync::Arc;

/// A state and the controls of its instant; of a static problem its only one.
pub(super) struct AtInstant<'a> {
    problem: &'a Reduced,
    /// The number of the instant.
    pub n: usize,
    pub state: &'a State,
    /// Its displacement.
    u: Cow<'a, [f64]>,
    /// The control vector of the problem, and the stage.
    at: (&'a [f64], usize),
    /// The control vector of the instant.
    pub m: Cow<'a, [f64]>,
    /// With what the step to it begins, once a cost has asked.
    begin: OnceCell<Option<StepBegin>>,
}

impl AtInstant<'_> {
    fn begin(&self) -> Result<Option<&StepBegin>, ControlError> {
        if let Some(known) = self.begin.get() {
            return Ok(known.as_ref());
        }
        let found = self.problem.step_begin(self.n, self.at.0)?;
        Ok(self.begin.get_or_init(|| found).as_ref())
    }

    fn context(&self, needs_step: bool, stage: usize) -> Result<CostContext<'_>, ControlError> {
        let step = if needs_step { self.begin()? } else { None };
        let context = self.problem.context(self.state, &self.m, stage);
        Ok(CostContext { step, ..beside_fields(context, &self.u) })
    }

    /// A cost there.
    pub fn cost(&self, cost: &dyn Cost) -> Result<Arc<dyn CostPoint>, ControlError> {
        let point = cost.at(&self.context(cost.needs_step(), self.at.1)?)?;
        Ok(wrapped(&self.problem.solid, point, |point| Arc::new(point)))
    }

    /// The k-th constraint there.
    pub fn constraint(&self, k: usize) -> Result<Arc<dyn ConstraintPoint>, ControlError> {
        let constraint = &self.problem.constraints[k];
        let point = constraint.at(&self.context(constraint.needs_step(), self.at.1)?)?;
        Ok(wrapped(&self.problem.solid, point, |point| Arc::new(point)))
    }
}

impl Reduced {
    /// The n-th instant under the control vector m in a stage, in its state.
    pub(super) fn at_state<'a>(
        &'a self,
        n: usize,
        state: &'a State,
        at: (&'a [f64], usize),
    ) -> Result<AtInstant<'a>, ControlError> {
        let t = self.motion.as_ref().map_or(state.time, |motion| motion.timeline.instants()[n]);
        let (m, u) = (self.at_instant(at.0, t)?, displacement(&self.solid, state));
        Ok(AtInstant { problem: self, n, state, u, at, m, begin: OnceCell::new() })
    }

    /// The instant that is nearest to the time of a state.
    pub(super) fn near_time<'a>(
        &'a self,
        state: &'a State,
        at: (&'a [f64], usize),
    ) -> Result<AtInstant<'a>, ControlError> {
        self.at_state(nearest(self.timeline().map_or(&[][..], Timeline::instants), state.time), state, at)
    }

    /// With what the step to the n-th instant of a motion begins; `None` where the motion does, and of a static problem.
    fn step_begin(&self, n: usize, m: &[f64]) -> Result<Option<StepBegin>, ControlError> {
        let (Some(motion), Some(before)) = (&self.motion, n.checked_sub(1)) else { return Ok(None) };
        let time = motion.timeline.instants()[before];
        let of_instant = self.layout.at(m, time)?;
        let controls = Arc::new(self.controls_at(motion, &of_instant, before)?);
        Ok(Some(StepBegin { time, controls, m: of_instant }))
    }
}

/// The number of the instant that is nearest to a time.
fn nearest(instants: &[f64], time: f64) -> usize {
    let after = instants.partition_point(|t| *t < time);
    let distance = |n: usize| instants.get(n).map_or(f64::INFINITY, |t| (t - time).abs());
    if after > 0 && distance(after - 1) < distance(after) { after - 1 } else { after }
}
