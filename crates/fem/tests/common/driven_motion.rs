//! The derivative of a functional of a motion that controls drive, along itself: [`DrivenMotion`].

use super::block::STRICT;
use super::{Outcome, noise};
use nastic_fem::{Controls, Scheme, Solid, State, StatePartials, StepTo, TimeStepping, Trajectory, Workspace};

pub const H: f64 = 0.1;
pub const STEPS: usize = 24;

/// The number of the block of controls of a name.
#[allow(clippy::unwrap_used)]
pub fn block(solid: &Solid, name: &str) -> usize {
    solid.model().controllable().iter().position(|known| known.name == name).unwrap()
}

/// A part of the controls: a block, slots of it, and the size of the largest change of a value.
pub type Part = (&'static str, &'static [usize], f64);

/// What a derivative must keep to.
pub struct Wanted {
    /// Of differences of fourth order along the gradient, relative.
    pub error: f64,
    /// Of the Taylor remainder, at one of the steps: beside a place where second derivatives jump it is lower.
    pub order: f64,
    pub steps: &'static [f64],
}

/// A body whose controls are a function of time, with a functional of all displacements (and velocities).
pub struct DrivenMotion<'a> {
    pub solid: &'a Solid,
    /// At `t`.
    pub controls: fn(&Solid, f64) -> Controls,
    pub of_velocity: f64,
    /// The first instant whose controls are varied: 1 where the first controls hold the body at its begin.
    pub first: usize,
}

impl DrivenMotion<'_> {
    /// At the n-th instant, with a change along a direction in every block.
    pub fn controls_at(&self, n: usize, change: f64, along: Option<&Controls>) -> Controls {
        let mut controls = (self.controls)(self.solid, H * n as f64);
        if let Some(along) = along {
            for k in 0..controls.len() {
                let changed = controls.values_mut(k).iter_mut().zip(along.values(k));
                changed.for_each(|(value, d)| *value += change * d);
            }
        }
        controls
    }

    pub fn begin(&self, scheme: &Scheme, controls: Controls) -> State {
        let mut begin = State { controls: controls.into(), ..self.solid.rest() };
        if !scheme.is_quasi_static() {
            begin.velocity = Some(vec![0.0; begin.u.len()].into());
        }
        begin
    }

    pub fn run(&self, scheme: &Scheme, change: f64, along: Option<&[Controls]>) -> Outcome<Trajectory> {
        let of = |n: usize| self.controls_at(n, change, along.map(|along| &along[n]));
        let mut trajectory = Trajectory::from_given(self.begin(scheme, of(0)));
        let steps: Vec<StepTo> = (1..=STEPS).map(|n| StepTo { dt: H, controls: of(n) }).collect();
        self.solid.model().advance(&mut trajectory, scheme, &steps, &STRICT, &mut Workspace::default())?;
        Ok(trajectory)
    }

    /// The displacement, without multipliers.
    fn nodal<'u>(&self, u: &'u [f64]) -> &'u [f64] {
        &u[..self.solid.discretization().dofs()]
    }

    pub fn functional(&self, trajectory: &Trajectory) -> f64 {
        let mut sum = 0.0;
        for (n, state) in trajectory.states().iter().enumerate().skip(1) {
            let v = state.velocity.as_ref();
            for (i, u) in self.nodal(&state.u).iter().enumerate() {
                let by_v = self.of_velocity * noise(7 + 10 * n + i) * v.map_or(0.0, |v| v[i]);
                sum += H * (noise(77 + 100 * n + i) * u + 0.5 * u * u + by_v);
            }
        }
        sum
    }

    pub fn partials(&self, n: usize, state: &State) -> StatePartials {
        let padded = |values: Vec<f64>| {
            let mut values = values;
            values.resize(state.u.len(), 0.0);
            values
        };
        if n == 0 {
            return StatePartials::by_displacement(padded(Vec::new()));
        }
        let nodal = self.nodal(&state.u);
        let u = nodal.iter().enumerate().map(|(i, u)| H * (noise(77 + 100 * n + i) + u)).collect();
        let velocity = match state.velocity {
            Some(_) => padded((0..nodal.len()).map(|i| self.of_velocity * H * noise(7 + 10 * n + i)).collect()),
            None => Vec::new(),
        };
        StatePartials { u: padded(u), velocity, ..StatePartials::default() }
    }

    fn gradient(&self, trajectory: &Trajectory) -> Outcome<Vec<Controls>> {
        let states = trajectory.states().iter().enumerate();
        let partials: Vec<_> = states.map(|(n, state)| self.partials(n, state)).collect();
        let mut workspace = Workspace::default();
        Ok(self.solid.model().reverse_sweep(trajectory, &partials, &STRICT, &mut workspace)?.controls)
    }

    /// The gradient in a part of the controls, scaled to a size, zero elsewhere; and the slope along it.
    fn direction(&self, gradient: &[Controls], (name, slots, size): Part) -> (Vec<Controls>, f64) {
        let k = block(self.solid, name);
        let mut along: Vec<Controls> = gradient.iter().map(|_| self.solid.model().zero_controls()).collect();
        let mut largest = 0.0f64;
        for (to, from) in along.iter_mut().zip(gradient).skip(self.first) {
            let width = from.slots(k);
            for (entry, d) in from.values(k).iter().enumerate().filter(|(entry, _)| slots.contains(&(entry % width))) {
                to.values_mut(k)[entry] = *d;
                largest = largest.max(d.abs());
            }
        }
        let mut slope = 0.0;
        for (to, from) in along.iter_mut().zip(gradient) {
            to.values_mut(k).iter_mut().for_each(|d| *d *= size / largest);
            slope += to.values(k).iter().zip(from.values(k)).map(|(a, b)| a * b).sum::<f64>();
        }
        (along, slope)
    }

    /// Differences of fourth order along the gradient itself agree, and the Taylor remainder is of second order.
    pub fn check(&self, scheme: &Scheme, base: &Trajectory, parts: &[Part], wanted: &Wanted) -> Outcome {
        let what = scheme.name();
        let (value, found) = (self.functional(base), self.gradient(base)?);
        for part in parts {
            let (along, slope) = self.direction(&found, *part);
            let at = |t: f64| self.run(scheme, t, Some(&along)).map(|run| self.functional(&run));
            let odd = |t: f64| -> Outcome<f64> { Ok(at(t)? - at(-t)?) };
            // second derivatives jump where a sample begins to touch or to slip: shorter differences come nearer to such a place
            let mut error = f64::INFINITY;
            for h in [0.02, 0.002, 2e-4] {
                if error > wanted.error {
                    error = error.min((slope * 12.0 * h / (8.0 * odd(h)? - odd(2.0 * h)?) - 1.0).abs());
                }
            }
            let remainder = |t: f64| -> Outcome<f64> { Ok((at(t)? - value - t * slope).abs()) };
            // to one side at least: beside such a place both are mixed
            let mut order = f64::NEG_INFINITY;
            for h in wanted.steps.iter().flat_map(|h| [*h, -h]) {
                if order <= wanted.order {
                    order = order.max((remainder(h)? / remainder(0.25 * h)?).log(4.0));
                }
            }
            let right = error < wanted.error && order > wanted.order;
            assert!(right, "{what}, {part:?}: {slope:e}, error {error:e}, order {order}");
        }
        Ok(())
    }
}
