//! Reduced problems in time: a motion instead of an equilibrium.

use super::Reduced;
use crate::constraint::IntoConstraint;
use crate::cost::{Aim, IntoCost};
use crate::time::{
    FixedInTime, Instants, MotionFootprint, MotionMemory, RateLimit, Schedule, Timeline, TrajectoryCost, When,
};
use nastic_fem::{Begin, Checkpoints, Feature, FemError};
use nastic_fields::{ControlError, Knots, Layout, Space};
use nastic_opt::ConstraintGroup;

/// What a problem in time has beside a static one.
#[derive(Debug)]
pub(crate) struct Motion {
    pub timeline: Timeline,
    /// The control fields at one instant.
    pub layout: Layout,
    /// When each cost of states counts.
    pub schedules: Vec<Schedule>,
    /// Costs of the whole motion, behind those of states.
    pub costs: Vec<Box<dyn TrajectoryCost>>,
    /// The numbers of the instants at which each constraint holds, ascending.
    pub constrained_at: Vec<Vec<usize>>,
    pub rates: Vec<RateLimit>,
    /// Slots that follow given values.
    pub fixed: Vec<FixedInTime>,
}

impl Reduced {
    /// Makes it a problem in time: `j(y_0, .., y_N; m)` over a motion. To be called before controls, costs and constraints are added.
    /// [`control`](Self::control) adds fields that are constant in time (a design), [`control_in_time`](Self::control_in_time)
    /// those with knots; [`cost`](Self::cost) counts at the end, [`cost_when`](Self::cost_when) elsewhere,
    /// [`trajectory_cost`](Self::trajectory_cost) adds one of the whole motion.
    ///
    /// Value: one motion, which keeps its states, or as many as [`Timeline::keep`] says. Derivative: one reverse sweep over them, exact for
    /// the discrete motion.
    /// Every evaluation begins at t = 0 with an empty workspace: it depends on m alone. Source: docs/model/motion.md.
    ///
    /// # Errors
    /// A problem that has controls or costs already; an initial velocity of the wrong length; too little memory for a motion.
    pub fn in_time(mut self, timeline: Timeline) -> Result<Self, ControlError> {
        self.solid.model().ranks().refuse_ranks("a problem in time")?;
        self.solid.model().properties().refuse_further_fields(Feature::Motion, "a problem in time")?;
        self.refuse_projection("a problem in time")?;
        if !(self.layout.is_empty() && self.costs.is_empty() && self.constraints.is_empty()) {
            let what = "call in_time before controls, costs and constraints are added".to_owned();
            return Err(ControlError::Cost { what });
        }
        let dofs = self.solid.model().unknowns().len();
        if let Some(found) = timeline.initial_velocity().map(<[f64]>::len).filter(|found| *found != dofs) {
            let what = format!("the initial velocity has {found} entries where the body has {dofs} unknowns");
            return Err(ControlError::Cost { what });
        }
        let from_given = timeline.begin() == Begin::Given;
        if let Some((_, shape)) = self.solid.body().shape().filter(|_| from_given) {
            let why = "the displacement that it begins with would depend on the shape: begin at the equilibrium, \"start\": \"equilibrium\" in \"time\"";
            let (what, with) = ("a motion from rest".to_owned(), shape.name.clone());
            return Err(FemError::Unsupported { what, with, why: why.to_owned() }.into());
        }
        let layout = self.layout.clone();
        let (schedules, costs, constrained_at, rates, fixed) = (vec![], vec![], vec![], vec![], vec![]);
        self.motion = Some(Motion { timeline, layout, schedules, costs, constrained_at, rates, fixed });
        self.motion_footprint()?;
        Ok(self)
    }

    /// The instants of a problem in time.
    pub fn timeline(&self) -> Option<&Timeline> {
        self.motion.as_ref().map(|motion| &motion.timeline)
    }

    /// Adds a control field with a value at each knot in time.
    ///
    /// # Errors
    /// As [`control`](Self::control); a problem without time; knots that do not end with it.
    pub fn control_in_time(self, of: &str, space: Space, knots: Knots) -> Result<Self, ControlError> {
        self.check_knots(of, &knots)?;
        self.control(of, space)?.with_knots(knots)
    }

    /// Adds the amplitude of a vector along a fixed direction, with a value at each knot in time.
    ///
    /// # Errors
    /// As [`control_along`](Self::control_along) and [`control_in_time`](Self::control_in_time).
    pub fn control_along_in_time(
        self,
        of: &str,
        space: Space,
        direction: [f64; 3],
        knots: Knots,
    ) -> Result<Self, ControlError> {
        self.check_knots(of, &knots)?;
        self.control_along(of, space, direction)?.with_knots(knots)
    }

    fn check_knots(&self, of: &str, knots: &Knots) -> Result<(), ControlError> {
        let end = self.needs_time("a control in time")?.timeline.end();
        if (knots.end() - end).abs() <= 1e-9 * end {
            return Ok(());
        }
        let what = format!("the knots of control \"{of}\" end at {}, the motion at {end}: let them agree", knots.end());
        Err(ControlError::Cost { what })
    }

    /// Gives those to the field that was added last.
    fn with_knots(mut self, knots: Knots) -> Result<Self, ControlError> {
        let targets = self.layout.blocks().last().map_or(&[][..], |block| &block.targets);
        targets.iter().try_for_each(|target| self.refuse_mass_in_time(target.actuation))?;
        self.layout.in_time(knots);
        self.update_layout();
        Ok(self)
    }

    /// Refuses controls in time of a shape, and of what drives a mass.
    fn refuse_mass_in_time(&self, actuation: usize) -> Result<(), ControlError> {
        let model = self.solid.model();
        let Some(name) = model.controllable().get(actuation).map(|driven| driven.name) else { return Ok(()) };
        if self.solid.body().shape().is_some_and(|(shape, _)| shape == actuation) {
            let what =
                format!("\"{name}\" is the shape of the body, which does not change in time: what grows is a growth");
            return Err(ControlError::Cost { what });
        }
        match model.contribution(name).is_some_and(|driven| driven.0.mass_follows_controls()) {
            true => {
                let what = format!("\"{name}\" is a mass, which does not change in time: let its fill be constant");
                Err(ControlError::Cost { what })
            }
            false => Ok(()),
        }
    }

    /// Adds a cost of states that counts at some part of the motion.
    ///
    /// # Errors
    /// As [`cost`](Self::cost); a problem without time; instants that the steps do not lead through.
    pub fn cost_when(mut self, when: When, cost: impl IntoCost) -> Result<Self, ControlError> {
        let motion = self.needs_time("a cost at instants")?;
        let cost = cost.bind(&self.solid)?;
        let at_start = Schedule::new(when.clone(), &motion.timeline)?.weights.iter().any(|(n, _)| *n == 0);
        cost.check_in_motion(&self.solid, &motion.timeline, at_start)?;
        self.costs.push(cost);
        self.schedule_cost(when)?;
        Ok(self)
    }

    /// Adds a cost of states that changes in time: a target that moves along a path, say. `cost(t)` is made for every instant
    /// that counts.
    ///
    /// # Errors
    /// As [`cost_when`](Self::cost_when).
    pub fn cost_along<C: IntoCost>(
        mut self,
        when: When,
        cost: impl Fn(f64) -> Result<C, ControlError>,
    ) -> Result<Self, ControlError> {
        let motion = self.needs_time("a cost along a path")?;
        let mut schedule = Schedule::new(when, &motion.timeline)?;
        let instants = motion.timeline.instants();
        let bound = |t: f64| cost(t)?.bind(&self.solid);
        schedule.own = schedule.weights.iter().map(|(n, _)| bound(instants[*n])).collect::<Result<_, _>>()?;
        let last = bound(motion.timeline.end())?;
        last.check_in_motion(&self.solid, &motion.timeline, schedule.weights.iter().any(|(n, _)| *n == 0))?;
        self.costs.push(last);
        if let Some(motion) = &mut self.motion {
            motion.schedules.push(schedule);
        }
        Ok(self)
    }

    /// Adds a cost of the whole motion.
    ///
    /// # Errors
    /// A problem without time; what the cost does not find; one that looks at states where few are kept.
    pub fn trajectory_cost(mut self, cost: impl TrajectoryCost + 'static) -> Result<Self, ControlError> {
        let motion = self.needs_time("a cost of a motion")?;
        cost.check(&self.layout, &motion.timeline)?;
        if cost.needs_states() && self.checkpoints(motion)?.most().is_some() {
            let what = format!("\"{}\" looks at all states of a motion, which keeps few: keep all", cost.name());
            return Err(ControlError::Cost { what });
        }
        if let Some(motion) = &mut self.motion {
            motion.costs.push(Box::new(cost));
        }
        Ok(self)
    }

    /// Adds a constraint that holds at some instants of the motion, with a value, or its values, for each of them.
    ///
    /// # Errors
    /// As [`constrain`](Self::constrain); a problem without time; instants that the steps do not lead through.
    pub fn constrain_when(mut self, instants: Instants, constraint: impl IntoConstraint) -> Result<Self, ControlError> {
        let timeline = &self.needs_time("a constraint at instants")?.timeline;
        let (numbers, constraint) = (instants.numbers(timeline)?, constraint.bind(&self.solid)?);
        constraint.check_in_motion(&self.solid, timeline, numbers.contains(&0))?;
        self.constraints.push(constraint);
        if let Some(motion) = &mut self.motion {
            motion.constrained_at.push(numbers);
        }
        Ok(self)
    }

    /// Adds a bound on the rate of a control, as constraints.
    ///
    /// # Errors
    /// A problem without time; a control that is unknown or constant in time.
    pub fn limit_rate(mut self, limit: RateLimit) -> Result<Self, ControlError> {
        self.needs_time("a limited rate")?;
        limit.check(&self.layout)?;
        if let Some(motion) = &mut self.motion {
            motion.rates.push(limit);
        }
        Ok(self)
    }

    /// Lets a slot that is not controlled follow given values: `values(t)` at the points at an instant. They are asked for once at every
    /// instant of the timeline, and beyond those where [steps are found](Self::adaptive_steps).
    ///
    /// # Errors
    /// A problem without time; what `values` returns; values of the wrong length, or that are not finite.
    pub fn fix_in_time(
        mut self,
        actuation: usize,
        slot: usize,
        values: impl Fn(f64) -> Result<Vec<f64>, ControlError> + Send + Sync + 'static,
    ) -> Result<Self, ControlError> {
        self.refuse_mass_in_time(actuation)?;
        let instants = self.needs_time("values in time")?.timeline.instants();
        let fixed = FixedInTime::new(actuation, slot, values, instants)?;
        let mut controls = self.solid.controls();
        (0..instants.len()).try_for_each(|n| fixed.put(n, &mut controls))?;
        if let Some(motion) = &mut self.motion {
            motion.fixed.push(fixed);
        }
        Ok(self)
    }

    /// Whether it has a cost, of states or of a motion.
    pub fn has_costs(&self) -> bool {
        !self.costs.is_empty() || self.motion.as_ref().is_some_and(|motion| !motion.costs.is_empty())
    }

    /// When each cost of states counts, in a problem in time.
    pub fn schedules(&self) -> Vec<&When> {
        self.motion.iter().flat_map(|motion| motion.schedules.iter().map(|schedule| &schedule.when)).collect()
    }

    /// What the costs of states aim at, with their names, at the n-th instant of a motion in displacement u: of costs that look at a place.
    /// A target that moves is there at the instants at which it counts.
    pub fn aims(&self, n: usize, u: &[f64]) -> Vec<(&str, Aim)> {
        let schedules = self.motion.iter().flat_map(|motion| &motion.schedules);
        let mut aims = Vec::new();
        for (cost, schedule) in self.costs.iter().zip(schedules) {
            let place = schedule.weights.iter().position(|(own, _)| *own == n);
            let now = place.and_then(|place| schedule.own.get(place));
            let Some(mut aim) = now.unwrap_or(cost).aim(&self.solid, u) else { continue };
            if now.is_none() && !schedule.own.is_empty() {
                aim.target = [None; 3];
            }
            aims.push((cost.name(), aim));
        }
        aims
    }

    /// What one motion takes: memory of its states, and steps that its derivative computes again; nothing of a static problem.
    ///
    /// A derivative of a point that is shared ([`derivative_of_term`](Self::derivative_of_term), members of ensembles) leaves the
    /// point its checkpoints and takes as many once more.
    ///
    /// # Errors
    /// Less memory than a motion takes with one checkpoint.
    pub fn motion_footprint(&self) -> Result<Option<MotionFootprint>, ControlError> {
        let Some(motion) = &self.motion else { return Ok(None) };
        let (plan, scheme) = (self.checkpoints(motion)?, motion.timeline.scheme());
        Ok(Some(MotionFootprint {
            states: plan.states(scheme),
            bytes: plan.bytes(self.solid.model(), scheme),
            checkpoints: plan.most(),
            steps: plan.steps(),
            recomputed_steps: plan.recomputed_steps(),
        }))
    }

    /// Which states of a motion are kept.
    pub(super) fn checkpoints(&self, motion: &Motion) -> Result<Checkpoints, ControlError> {
        let timeline = &motion.timeline;
        let (steps, segment) = (timeline.steps(), timeline.segment());
        Ok(match timeline.memory() {
            MotionMemory::All => Checkpoints::all(steps, segment)?,
            MotionMemory::Checkpoints(most) => Checkpoints::at_most(most, steps, segment)?,
            MotionMemory::AtMost { bytes } => {
                Checkpoints::within(bytes, steps, segment, self.solid.model(), timeline.scheme())?
            }
        })
    }

    fn needs_time(&self, what: &str) -> Result<&Motion, ControlError> {
        self.motion.as_ref().ok_or_else(|| {
            let what = format!("{what} needs a problem in time: call in_time first");
            ControlError::Cost { what }
        })
    }

    pub(super) fn refuse_motion(&self, what: &'static str) -> Result<(), ControlError> {
        if self.motion.is_some() { Err(ControlError::InTime { what }) } else { Ok(()) }
    }

    /// Puts the cost that was added last into the motion, if there is one.
    pub(super) fn schedule_cost(&mut self, when: When) -> Result<(), ControlError> {
        if let Some(motion) = &mut self.motion {
            motion.schedules.push(Schedule::new(when, &motion.timeline)?);
        }
        Ok(())
    }

    pub(super) fn update_layout(&mut self) {
        let stages = Some(self.layout.stages()).filter(|stages| *stages > 1).unwrap_or(0);
        self.staged = (0..stages).map(|stage| self.layout.in_stage(stage)).collect();
        if let Some(motion) = &mut self.motion {
            motion.layout = self.layout.of_instant();
        }
    }

    pub(super) fn rate_groups(&self) -> Vec<ConstraintGroup> {
        let rates = self.motion.iter().flat_map(|motion| &motion.rates);
        rates.filter_map(|rate| rate.group(&self.layout).ok()).collect()
    }
}
