//! [`Progress`]: what a motion has found while it runs, as a value and as bytes.

use super::in_time::Motion;
use crate::evaluated::StepError;
use crate::state_bytes::{read_report, read_whole_state, write_report, write_whole_state};
use crate::time::Schedule;
use nastic_fem::{Begin, Scheme, Solid, SolveReport, State, StepRecord, Trajectory};
use nastic_opt::SavedRunError;
use nastic_opt::bytes::{Reader, Writer};
use std::sync::Arc;

const MAGIC: &str = "nastic-motion-5";

/// What is known of a motion up to some state, beside its states.
pub(super) struct Progress {
    pub values: InstantValues,
    pub work: SolveReport,
    pub min_j: f64,
    pub error: Option<StepError>,
}

impl Progress {
    /// Of a motion without a state.
    pub fn new(motion: &Motion) -> Self {
        Progress { values: InstantValues::new(motion), work: SolveReport::default(), min_j: f64::INFINITY, error: None }
    }

    /// Its next state was found, the end of this part of it; with the estimated error of the step that led there.
    pub fn add(&mut self, part: &Trajectory, error: Option<f64>) {
        let State { time, report, .. } = part.end();
        self.work.add_work(report);
        self.min_j = self.min_j.min(report.min_j);
        let largest = self.error.map_or(0.0, |largest| largest.error);
        if let Some(error) = error.filter(|error| *error > largest || self.error.is_none()) {
            self.error = Some(StepError { error, time: *time });
        }
    }

    /// With what the motion goes on from the end of a part of it.
    pub fn to_bytes(&self, part: &Trajectory, scheme: &Scheme) -> Vec<u8> {
        let part = part.tail(scheme);
        let mut out = Writer::new(MAGIC);
        out.bytes(scheme.name().as_bytes());
        self.values.values.iter().chain(&self.values.constraints).for_each(|values| out.floats(values));
        write_report(&self.work, &mut out);
        out.float(self.min_j);
        out.count(usize::from(self.error.is_some()));
        if let Some(StepError { error, time }) = self.error {
            out.float(error);
            out.float(time);
        }
        out.count(usize::from(part.begin() == Begin::Given));
        out.count(part.first());
        out.count(part.states().len());
        part.states().iter().for_each(|state| write_whole_state(state, &mut out));
        // a part without the step before it takes none
        let step = part.last_step(scheme);
        out.count(usize::from(step.is_some()));
        if let Some(StepRecord { dt, starts, parts, stages, started }) = step {
            out.float(dt);
            out.count(usize::from(starts));
            out.count(parts);
            out.count(stages.len());
            stages.iter().for_each(|stage| out.floats(stage));
            out.count(usize::from(started.is_some()));
            started.iter().for_each(|acceleration| out.floats(acceleration));
        }
        out.finish()
    }

    /// What [`to_bytes`](Self::to_bytes) wrote.
    ///
    /// `lens`: the values of each constraint at one instant.
    pub fn from_bytes(
        bytes: &[u8],
        motion: &Motion,
        solid: &Solid,
        lens: &[usize],
    ) -> Result<(Self, Trajectory), SavedRunError> {
        let mut input = Reader::new(bytes, MAGIC)?;
        if input.text()? != motion.timeline.scheme().name() {
            return Err(input.damaged("a motion by another time scheme"));
        }
        let mut values = InstantValues::new(motion);
        for own in &mut values.values {
            let read = input.floats()?;
            if read.len() != own.len() {
                return Err(input.damaged("costs at other instants"));
            }
            *own = read;
        }
        for own in &mut values.constraints {
            *own = input.floats()?;
        }
        let (work, min_j) = (read_report(&mut input)?, input.float()?);
        let error = match input.flag()? {
            true => Some(StepError { error: input.float()?, time: input.float()? }),
            false => None,
        };
        let begin = if input.flag()? { Begin::Given } else { Begin::Equilibrium };
        let (first, count, like) = (input.number()?, input.count(8)?, solid.rest());
        let states = (0..count).map(|_| read_whole_state(&mut input, &like)).collect::<Result<Vec<_>, _>>()?;
        let step = match input.flag()? {
            true => {
                let (dt, starts, parts) = (input.float()?, input.flag()?, input.number()?);
                let stages = (0..input.count(8)?).map(|_| input.floats().map(Arc::new)).collect::<Result<_, _>>()?;
                let started = if input.flag()? { Some(Arc::new(input.floats()?)) } else { None };
                Some(StepRecord { dt, starts, parts, stages, started })
            }
            false => None,
        };
        input.finish()?;
        let part = Trajectory::from_end(begin, first, states, step, motion.timeline.scheme());
        let part = part.map_err(|_| input.damaged("states and a step that do not fit each other"))?;
        let states = part.first().saturating_add(part.states().len());
        if states > motion.timeline.instants().len() {
            return Err(input.damaged("a state behind the end of the motion"));
        }
        for ((instants, len), own) in motion.constrained_at.iter().zip(lens).zip(&values.constraints) {
            if own.len() != len * instants.iter().filter(|n| **n < states).count() {
                return Err(input.damaged("constraints at other instants or nodes"));
            }
        }
        Ok((Progress { values, work, min_j, error }, part))
    }
}

/// For each instant the costs that count there, each with its place among the instants of that cost.
pub(super) fn counting(motion: &Motion) -> Vec<Vec<(usize, usize)>> {
    let mut counting = vec![Vec::new(); motion.timeline.instants().len()];
    for (k, schedule) in motion.schedules.iter().enumerate() {
        schedule.weights.iter().enumerate().for_each(|(place, (n, _))| counting[*n].push((k, place)));
    }
    counting
}

/// Values of the costs of states, by cost and place, and of constraints.
pub(super) struct InstantValues {
    pub counting: Vec<Vec<(usize, usize)>>,
    pub values: Vec<Vec<f64>>,
    /// Of each constraint those of the instants so far, one behind the other.
    pub constraints: Vec<Vec<f64>>,
}

impl InstantValues {
    pub fn new(motion: &Motion) -> Self {
        let values = motion.schedules.iter().map(|schedule| vec![0.0; schedule.weights.len()]).collect();
        InstantValues { counting: counting(motion), values, constraints: vec![Vec::new(); motion.constrained_at.len()] }
    }

    /// Their sums over the motion.
    pub fn terms(&self, motion: &Motion) -> Vec<f64> {
        let sum = |(schedule, values): (&Schedule, &Vec<f64>)| {
            schedule.weights.iter().zip(values).fold(0.0, |sum, ((_, weight), j)| sum + weight * schedule.shape(*j).0)
        };
        motion.schedules.iter().zip(&self.values).map(sum).collect()
    }
}
