//! [`Progress`]: what a motion has found while it runs, as a value and as bytes.

use super::in_time::Motion;
use crate::evaluated::StepError;
use crate::time::Schedule;
use nastic_fem::{Begin, Scheme, Solid, SolveReport, State, StepRecord, Trajectory};
use nastic_opt::{Saved, SavedError};
use serde::{Deserialize, Serialize};

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
        let saved = SavedProgress {
            scheme: scheme.name().to_owned(),
            values: self.values.values.clone(),
            constraints: self.values.constraints.clone(),
            work: self.work,
            min_j: self.min_j,
            error: self.error,
            begin: part.begin(),
            first: part.first(),
            states: part.states().to_vec(),
            step: part.last_step(scheme),
        };
        saved.to_bytes()
    }

    /// What [`to_bytes`](Self::to_bytes) wrote.
    ///
    /// `lens`: the values of each constraint at one instant.
    pub fn from_bytes(
        bytes: &[u8],
        motion: &Motion,
        solid: &Solid,
        lens: &[usize],
    ) -> Result<(Self, Trajectory), SavedError> {
        let SavedProgress { scheme, values, constraints, work, min_j, error, begin, first, states, step } =
            Saved::from_bytes(bytes)?;
        let unless = |what: &'static str, fits: bool| if fits { Ok(()) } else { Err(SavedError::Unfit(what)) };
        let counting = InstantValues::new(motion);
        let own_scheme = motion.timeline.scheme();
        unless("a motion by another time scheme", scheme == own_scheme.name())?;
        let lengths = |values: &[Vec<f64>]| values.iter().map(Vec::len).collect::<Vec<_>>();
        unless("costs at other instants", lengths(&values) == lengths(&counting.values))?;
        let like = solid.rest();
        unless("a state of another body", states.iter().all(|state| state.fits(&like)))?;
        let part = Trajectory::from_end(begin, first, states, step, own_scheme);
        let part = part.map_err(|_| SavedError::Unfit("states and a step that do not fit each other"))?;
        let states = part.first().saturating_add(part.states().len());
        unless("a state behind the end of the motion", states <= motion.timeline.instants().len())?;
        let constrained = motion.constrained_at.iter().zip(lens);
        let expected = constrained.map(|(instants, len)| len * instants.iter().filter(|n| **n < states).count());
        unless("constraints at other instants or nodes", lengths(&constraints).into_iter().eq(expected))?;
        let values = InstantValues { values, constraints, ..counting };
        Ok((Progress { values, work, min_j, error }, part))
    }
}

/// What is saved of it, with the end of the motion so far.
#[derive(Serialize, Deserialize)]
struct SavedProgress {
    scheme: String,
    values: Vec<Vec<f64>>,
    constraints: Vec<Vec<f64>>,
    work: SolveReport,
    min_j: f64,
    error: Option<StepError>,
    begin: Begin,
    first: usize,
    states: Vec<State>,
    step: Option<StepRecord>,
}

impl Saved for SavedProgress {
    const KIND: &'static str = "nastic-motion-6";
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
