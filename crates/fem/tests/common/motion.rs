//! Motions that several tests make.

use super::{Outcome, regular};
use nastic_energy::NeoHooke;
use nastic_fem::schemes::SCHEMES;
use nastic_fem::{Scheme, Solid, SolveOptions, State, StepTo, TimeStepping, Trajectory, Workspace};
use nastic_mesh::CellKind;
use std::sync::Arc;

use super::block::STRICT;
use super::own_contributions::Oscillators;

/// Every scheme of the catalogue, with its order.
pub fn schemes() -> Outcome<Vec<(Scheme, usize)>> {
    SCHEMES.iter().map(|row| Ok(((row.build)()?, row.order))).collect()
}

/// Those that go with supports that move: all but `siere`.
#[allow(dead_code)] // not every test has such
pub fn schemes_with_moving_supports() -> Outcome<Vec<(Scheme, usize)>> {
    Ok(schemes()?.into_iter().filter(|(scheme, _)| scheme.exact_modes() == 0).collect())
}

/// Steps of one length under controls that are a function of time.
pub fn steps(count: usize, h: f64, controls: impl Fn(f64) -> nastic_fem::Controls) -> Vec<StepTo> {
    (1..=count).map(|n| StepTo { dt: h, controls: controls(n as f64 * h) }).collect()
}

/// A motion without controls from given displacement and velocity.
pub fn motion(solid: &Solid, scheme: &Scheme, begin: State, count: usize, h: f64) -> Outcome<Trajectory> {
    motion_by(solid, scheme, begin, count, h, &STRICT)
}

pub fn motion_by(
    solid: &Solid,
    scheme: &Scheme,
    begin: State,
    count: usize,
    h: f64,
    how: &SolveOptions,
) -> Outcome<Trajectory> {
    let mut trajectory = Trajectory::from_given(begin);
    let steps = steps(count, h, |_| solid.controls());
    solid.model().advance(&mut trajectory, scheme, &steps, how, &mut Workspace::default())?;
    Ok(trajectory)
}

/// Point masses of 1 on linear springs to the ground with `k = w^2` and dampers, one per unknown, in a body without
/// stiffness.
pub fn oscillator(w: f64, damping: f64) -> Outcome<Solid> {
    oscillators(Oscillators { mass: 1.0, damping, stiffness: w * w, spread: 0.0 })
}

/// Others.
pub fn oscillators(those: Oscillators) -> Outcome<Solid> {
    Ok(Solid::new(regular(CellKind::Hex8, [1.0; 3], [1; 3])?)?
        .material("body", NeoHooke::new(1e-30, 0.0)?)?
        .clamp("x-")?
        .contribution(those)?)
}

/// A state with the free unknowns all at the same displacement, velocity and, if given, acceleration.
pub fn uniform(solid: &Solid, u: f64, v: f64, a: Option<f64>) -> State {
    let free = |value: f64| -> Arc<Vec<f64>> {
        Arc::new(solid.supports().fixed().iter().map(|&fixed| if fixed { 0.0 } else { value }).collect())
    };
    State { u: free(u), velocity: Some(free(v)), acceleration: a.map(free), ..solid.rest() }
}
