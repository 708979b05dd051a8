//! [`Timeline`]: the instants of a motion and how it goes from one to the next.

use super::memory::MotionMemory;
use nastic_fem::{Begin, Scheme};
use nastic_fields::{ControlError, Interpolation, Knots};

/// A time scheme, the lengths of its steps, and how the motion begins: by default at the equilibrium under the controls and
/// loads at t = 0, at rest.
#[derive(Debug, Clone)]
pub struct Timeline {
    scheme: Scheme,
    /// From 0 on.
    instants: Vec<f64>,
    begin: Begin,
    velocity: Option<Vec<f64>>,
    memory: MotionMemory,
    segment: usize,
}

/// Steps of a segment, after which the workspace is cleared: this costs 1 to 5 % more factorisations.
const STEPS_PER_SEGMENT: usize = 16;

impl Timeline {
    /// So many equal steps from 0 to the end.
    ///
    /// # Errors
    /// An end that is not positive, no step, or more than ten million.
    pub fn uniform(scheme: Scheme, end: f64, steps: usize) -> Result<Self, ControlError> {
        if !(end.is_finite() && end > 0.0 && (1..=10_000_000).contains(&steps)) {
            let what = format!("{steps} time steps until {end}: the end is positive, and there are 1 to 1e7 steps");
            return Err(ControlError::Cost { what });
        }
        let instants = (0..=steps).map(|n| end * n as f64 / steps as f64).collect();
        Ok(Self::new(scheme, instants))
    }

    /// Through given instants, from 0 on.
    ///
    /// # Errors
    /// As [`Knots::at`].
    pub fn through(scheme: Scheme, instants: Vec<f64>) -> Result<Self, ControlError> {
        Knots::at(instants.clone(), Interpolation::Linear)?;
        Ok(Self::new(scheme, instants))
    }

    fn new(scheme: Scheme, instants: Vec<f64>) -> Self {
        let (begin, memory) = (Begin::Equilibrium, MotionMemory::All);
        Timeline { scheme, instants, begin, velocity: None, memory, segment: STEPS_PER_SEGMENT }
    }

    /// Begins undeformed, whatever loads and controls do from t = 0 on.
    #[must_use]
    pub fn from_rest(self) -> Self {
        Timeline { begin: Begin::Given, ..self }
    }

    /// Begins with a velocity, flat like the displacement.
    #[must_use]
    pub fn velocity(self, velocity: Vec<f64>) -> Self {
        Timeline { velocity: Some(velocity), ..self }
    }

    /// What is kept of a motion for its derivative; by default all states.
    #[must_use]
    pub fn keep(self, memory: MotionMemory) -> Self {
        Timeline { memory, ..self }
    }

    /// Steps of a segment (by default 16), after which solves begin without factors of earlier ones; checkpoints of a reverse sweep are at the beginnings of segments.
    /// Where steps take many Newton iterations they do so in between too. Results depend on it within the accuracy of the solves.
    #[must_use]
    pub fn segments_of(self, steps: usize) -> Self {
        Timeline { segment: steps, ..self }
    }

    /// What is kept of a motion.
    pub fn memory(&self) -> MotionMemory {
        self.memory
    }

    /// Steps of a segment.
    pub fn segment(&self) -> usize {
        self.segment
    }

    /// The scheme.
    pub fn scheme(&self) -> &Scheme {
        &self.scheme
    }

    /// All instants, 0 and the end included.
    pub fn instants(&self) -> &[f64] {
        &self.instants
    }

    /// The last instant.
    pub fn end(&self) -> f64 {
        self.instants[self.instants.len() - 1]
    }

    /// Number of steps.
    pub fn steps(&self) -> usize {
        self.instants.len() - 1
    }

    /// The length of the longest step.
    pub fn longest_step(&self) -> f64 {
        self.instants.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max)
    }

    /// What the first state is.
    pub fn begin(&self) -> Begin {
        self.begin
    }

    /// The velocity it begins with, where it is not zero.
    pub fn initial_velocity(&self) -> Option<&[f64]> {
        self.velocity.as_deref()
    }

    /// The trapezoidal rule's weights of the instants.
    pub(crate) fn weights(&self) -> Vec<f64> {
        let mut weights = vec![0.0; self.instants.len()];
        for (n, pair) in self.instants.windows(2).enumerate() {
            weights[n] += 0.5 * (pair[1] - pair[0]);
            weights[n + 1] += 0.5 * (pair[1] - pair[0]);
        }
        weights
    }

    /// The instant of the timeline at a time.
    ///
    /// # Errors
    /// A time between two of its instants, or beyond its ends.
    pub(crate) fn index(&self, t: f64) -> Result<usize, ControlError> {
        let gap = |n: &usize| (self.instants[*n] - t).abs();
        let nearest = (0..self.instants.len()).min_by(|a, b| gap(a).total_cmp(&gap(b))).unwrap_or(0);
        if gap(&nearest) <= 1e-9 * self.end() {
            return Ok(nearest);
        }
        if t > self.end() {
            let what = format!("t = {t} is after the end of the motion, {}", self.end());
            return Err(ControlError::Cost { what });
        }
        let what = format!(
            "t = {t} is no instant of the motion; the nearest one is {}: choose steps that lead through it, or that instant",
            self.instants[nearest]
        );
        Err(ControlError::Cost { what })
    }
}
