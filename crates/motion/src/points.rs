//! [`Points`]: what is known at the instants that a step combines.

use crate::scheme::{Quantity, Scheme, Term, TermInstant};
use nastic_body::controls::Controls;
use nastic_body::instant::{ExtrapolatedEnd, TimeStep};
use nastic_body::state::State;
use nastic_numeric::vector::axpy;
use std::sync::Arc;

/// u, v and a at one instant; what is missing is zero.
#[derive(Debug, Clone, Default)]
pub(crate) struct InstantValues {
    pub u: Option<Arc<Vec<f64>>>,
    pub velocity: Option<Arc<Vec<f64>>>,
    pub acceleration: Option<Arc<Vec<f64>>>,
}

impl InstantValues {
    fn of(state: &State) -> Self {
        let State { u, velocity, acceleration, .. } = state;
        InstantValues { u: Some(u.clone()), velocity: velocity.clone(), acceleration: acceleration.clone() }
    }

    fn get(&self, of: Quantity) -> Option<&Arc<Vec<f64>>> {
        match of {
            Quantity::Displacement => self.u.as_ref(),
            Quantity::Velocity => self.velocity.as_ref(),
            Quantity::Acceleration => self.acceleration.as_ref(),
        }
    }
}

/// The states that a step begins at, and its stages so far.
pub(crate) struct Points<'a> {
    scheme: &'a Scheme,
    h: f64,
    begin: &'a State,
    now: InstantValues,
    before: InstantValues,
    stages: Vec<InstantValues>,
    /// Number of displacement components; the multipliers behind them have neither velocity nor acceleration.
    dofs: usize,
}

impl<'a> Points<'a> {
    /// Of a step of length h; `started` is the acceleration at its beginning where the state does not carry it.
    pub fn new(
        scheme: &'a Scheme,
        h: f64,
        begin: &'a State,
        before: Option<&State>,
        started: Option<&Arc<Vec<f64>>>,
        dofs: usize,
    ) -> Self {
        let mut now = InstantValues::of(begin);
        now.acceleration = started.cloned().or(now.acceleration);
        let before = before.map(InstantValues::of).unwrap_or_default();
        Points { scheme, h, begin, now, before, stages: Vec::new(), dofs }
    }

    /// Velocity and acceleration of the next stage as functions of its displacement, in a step to these controls.
    pub fn next(&self, to: &Controls) -> TimeStep {
        let k = self.stages.len();
        let stage = &self.scheme.stages[k];
        let (c_v, c_a) = stage.own(k, self.h);
        let own = |term: &&Term| term.at != TermInstant::Stage(k);
        let b_v = self.combine(Quantity::Velocity, stage.velocity.iter().filter(own));
        let mut b_a = self.combine(Quantity::Acceleration, stage.acceleration.iter().filter(own));
        for term in stage.acceleration.iter().filter(|term| term.is(Quantity::Velocity, k)) {
            axpy(term.scaled(Quantity::Acceleration, self.h), &b_v, &mut b_a);
        }
        let end = self.scheme.extrapolation(k).map(|(alpha, rest)| {
            let rest = self.combine(Quantity::Displacement, rest.iter());
            ExtrapolatedEnd { alpha, rest, controls: to.clone() }
        });
        let (before, history) = (self.begin.clone(), Arc::default());
        let elapsed = stage.time * self.h;
        TimeStep {
            dt: self.h,
            velocity: (c_v, b_v),
            acceleration: (c_a, b_a),
            elapsed,
            lag: None,
            before,
            history,
            end,
        }
    }

    /// Where the next stage is if its acceleration is the last one known, else zero, with the multipliers of a state; `None` of a stage
    /// without inertia.
    pub fn predict(&self, step: &TimeStep, here: &State) -> Option<Vec<f64>> {
        let (c, b) = &step.acceleration;
        if *c == 0.0 {
            return None;
        }
        let last = self.stages.last().unwrap_or(&self.now).acceleration.as_deref();
        let displacement = b[..self.dofs].iter().enumerate().map(|(i, b)| (last.map_or(0.0, |a| a[i]) - b) / c);
        Some(displacement.chain(here.u[self.dofs..].iter().copied()).collect())
    }

    /// Where the next stage is if the velocity at the beginning stays; `None` where that is not known.
    pub fn coast(&self, step: &TimeStep) -> Option<Vec<f64>> {
        let velocity = self.now.velocity.as_deref()?;
        Some(self.begin.u.iter().zip(velocity).map(|(u, v)| u + step.elapsed * v).collect())
    }

    /// The next stage was found there.
    pub fn found(&mut self, u: Arc<Vec<f64>>, step: &TimeStep) {
        let of_displacement = |mut rate: Vec<f64>| {
            rate[self.dofs..].fill(0.0);
            Some(Arc::new(rate))
        };
        let velocity = of_displacement(step.velocity_at(&u));
        let acceleration = of_displacement(step.acceleration_at(&u));
        self.stages.push(InstantValues { u: Some(u), velocity, acceleration });
    }

    /// u, v and a at the end of the step, all stages found; of an acceleration that is not known there `None`.
    pub fn end(&self) -> InstantValues {
        let [u, velocity, acceleration] = self.scheme.end.combinations().map(|(of, terms)| match terms {
            [] => None,
            // shared, not copied
            [Term { factor: 1.0, of: source, at: TermInstant::Stage(k) }] if *source == of => {
                self.stages[*k].get(of).cloned()
            }
            terms => Some(Arc::new(self.combine(of, terms.iter()))),
        });
        InstantValues { u, velocity, acceleration }
    }

    /// The estimated error of u, all stages found; nothing of a scheme without an estimate.
    pub fn error(&self) -> Option<Vec<f64>> {
        self.scheme.estimates_error().then(|| self.combine(Quantity::Displacement, self.scheme.error.iter()))
    }

    fn combine<'t>(&self, of: Quantity, terms: impl Iterator<Item = &'t Term>) -> Vec<f64> {
        let mut sum = vec![0.0; self.begin.u.len()];
        for term in terms {
            let values = match term.at {
                TermInstant::Now => &self.now,
                TermInstant::Before => &self.before,
                TermInstant::Stage(k) => &self.stages[k],
            };
            if let Some(values) = values.get(term.of) {
                axpy(term.scaled(of, self.h), values, &mut sum);
            }
        }
        sum
    }
}
