//! The derivative of motions with contact, along itself: by what drives the body, by the pose of an obstacle at every instant, by its
//! friction and stiffness, over histories in which samples touch, part, stick and slip.

#![allow(clippy::unwrap_used)] // helpers of tests

use crate::common;

use common::block::STRICT;
use common::motion::schemes_with_moving_supports;
use common::{Outcome, noise, regular};
use nastic_energy::{FiberTension, NeoHooke};
use nastic_fem::{
    Checkpoints, Contact, ContactLaw, Controls, Inertia, Recording, ReverseSweep, Scheme, Solid, State, StateError,
    StatePartials, StepTo, Trajectory, Workspace,
};
use nastic_mesh::CellKind;
use nastic_mesh::spatial::Obstacle;
use nastic_tensor::Vec3;

const H: f64 = 0.1;
const STEPS: usize = 24;

/// A plane strip on a floor, with a finger that comes down on it, drags it along, turns and leaves. A foot of it stands in a corner where no
/// quasi-static step would find it free.
fn strip(law: ContactLaw, friction: bool) -> Outcome<Solid> {
    let rub = |contact: Contact, mu: f64| if friction { contact.friction(mu, 0.01) } else { contact };
    let layer =
        |contact: Contact| contact.thickness(0.08).law(law).stiffness(if law == ContactLaw::Log { 0.3 } else { 3.0 });
    let floor = Obstacle::half_space([0.0, -0.06, 0.0], [0.05, 1.0, 0.0]);
    let finger = Obstacle::capsule([0.9, 1.42, 0.0], [1.7, 1.46, 0.0], 0.35);
    let solid = Solid::new(regular(CellKind::Quad4, [3.0, 1.0, 0.0], [6, 2, 1])?)?
        .material("body", NeoHooke::new(1.0, 2.0)?)?
        .actuate("body", "fibre", FiberTension::along(Vec3::x())?)?
        .body_force("body", Vec3::new(0.0, -0.02, 0.0))?
        .displace("x-", [Some(0.0), None, None])?
        .inertia(Inertia::new("body", 1.0))?
        .rayleigh_damping(0.0, 0.05)?
        .contact(rub(layer(Contact::of("floor", "y-", floor)), 0.3))?
        .contact(rub(layer(Contact::of("finger", "y+", finger)), 0.6))?;
    Ok(solid)
}

fn block(solid: &Solid, name: &str) -> usize {
    solid.model().controllable().iter().position(|known| known.name == name).unwrap()
}

/// At the n-th instant, with a change along a direction in every block.
fn controls(solid: &Solid, n: usize, change: f64, along: Option<&Controls>) -> Controls {
    let mut controls = solid.controls();
    let t = H * n as f64;
    controls.values_mut(block(solid, "fibre")).fill(0.2 * (2.0 * t).sin());
    let down = 0.16 * (1.5 * t).sin();
    let values = controls.values_mut(block(solid, "finger"));
    (values[0], values[1], values[5]) = (0.15 * t * t * (2.4 - t), -down, 0.1 * (3.0 * t).sin());
    if let Some(along) = along {
        for k in 0..controls.len() {
            let changed = controls.values_mut(k).iter_mut().zip(along.values(k));
            changed.for_each(|(value, d)| *value += change * d);
        }
    }
    controls
}

fn run(solid: &Solid, scheme: &Scheme, change: f64, along: Option<&[Controls]>) -> Outcome<Trajectory> {
    let of = |n: usize| controls(solid, n, change, along.map(|along| &along[n]));
    let mut begin = State { controls: of(0).into(), ..solid.rest() };
    if !scheme.is_quasi_static() {
        begin.velocity = Some(vec![0.0; begin.u.len()].into());
    }
    let mut trajectory = Trajectory::from_given(begin);
    let steps: Vec<StepTo> = (1..=STEPS).map(|n| StepTo { dt: H, controls: of(n) }).collect();
    solid.model().advance(&mut trajectory, scheme, &steps, &STRICT, &mut Workspace::default())?;
    Ok(trajectory)
}

fn functional(trajectory: &Trajectory) -> f64 {
    let mut sum = 0.0;
    for (n, state) in trajectory.states().iter().enumerate().skip(1) {
        let v = state.velocity.as_ref();
        for (i, u) in state.u.iter().enumerate() {
            let z = noise(77 + 100 * n + i);
            sum += H * (z * u + 0.5 * u * u + 0.3 * noise(7 + 10 * n + i) * v.map_or(0.0, |v| v[i]));
        }
    }
    sum
}

fn partials(n: usize, state: &State) -> StatePartials {
    if n == 0 {
        return StatePartials::by_displacement(vec![0.0; state.u.len()]);
    }
    let u = state.u.iter().enumerate().map(|(i, u)| H * (noise(77 + 100 * n + i) + u)).collect();
    let velocity = match state.velocity {
        Some(_) => (0..state.u.len()).map(|i| 0.3 * H * noise(7 + 10 * n + i)).collect(),
        None => Vec::new(),
    };
    StatePartials { u, velocity }
}

fn gradient(solid: &Solid, trajectory: &Trajectory) -> Outcome<Vec<Controls>> {
    let partials: Vec<_> = trajectory.states().iter().enumerate().map(|(n, state)| partials(n, state)).collect();
    Ok(solid.model().reverse_sweep(trajectory, &partials, &STRICT, &mut Workspace::default())?.controls)
}

/// The gradient in one block, scaled to a size, zero elsewhere; with its square length over that scale, the slope along it.
fn direction(solid: &Solid, gradient: &[Controls], name: &str, slots: &[usize], size: f64) -> (Vec<Controls>, f64) {
    let k = block(solid, name);
    let mut along: Vec<Controls> = gradient.iter().map(|_| solid.model().zero_controls()).collect();
    let mut largest = 0.0f64;
    for (to, from) in along.iter_mut().zip(gradient) {
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

/// Whether samples touch at some instants and not at others.
fn changes(solid: &Solid, trajectory: &Trajectory) -> bool {
    let areas = |n: usize| -> Vec<f64> {
        let state = &trajectory.states()[n];
        let all = solid.model().quantities(&nastic_fem::Instant::of(state)).unwrap();
        all.into_iter().filter(|(_, name, _)| *name == "area").map(|(.., area)| area).collect()
    };
    let all: Vec<Vec<f64>> = (1..=STEPS).map(areas).collect();
    let spread = |k: usize| {
        let of = all.iter().map(|areas| areas[k]);
        of.clone().fold(0.0, f64::max) - of.fold(f64::INFINITY, f64::min)
    };
    // an edge of a third of a metre
    spread(0).max(spread(1)) > 0.3
}

const PARTS: [(&str, &[usize], f64); 5] = [
    ("fibre", &[0], 1e-2),
    ("finger", &[0, 1], 1e-3),
    ("finger", &[5], 1e-3),
    ("finger", &[6], 1e-2),
    ("floor", &[7], 1e-2),
];

/// Differences of fourth order along the gradient itself agree to 1e-7, and the Taylor remainder is of second order.
fn check(solid: &Solid, scheme: &Scheme, friction: bool) -> Outcome {
    let what = format!("{}, friction {friction}", scheme.name());
    let base = run(solid, scheme, 0.0, None).map_err(|error| format!("{what}: {error}"))?;
    assert!(changes(solid, &base), "{what}: nothing touches and parts");
    let (value, found) = (functional(&base), gradient(solid, &base)?);
    for (name, slots, size) in PARTS.into_iter().filter(|part| friction || part.1 != [7]) {
        let (along, slope) = direction(solid, &found, name, slots, size);
        let at = |t: f64| run(solid, scheme, t, Some(&along)).map(|run| functional(&run));
        let odd = |t: f64| -> Outcome<f64> { Ok(at(t)? - at(-t)?) };
        // second derivatives jump where a sample begins to touch or to slip: shorter differences come nearer to such a place
        let mut error = f64::INFINITY;
        for h in [0.02, 0.002, 2e-4] {
            if error > 1e-7 {
                error = error.min((slope * 12.0 * h / (8.0 * odd(h)? - odd(2.0 * h)?) - 1.0).abs());
            }
        }
        let remainder = |t: f64| -> Outcome<f64> { Ok((at(t)? - value - t * slope).abs()) };
        // to one side at least: beside such a place both are mixed
        let mut order = f64::NEG_INFINITY;
        for h in [0.4, 0.2, 0.1, 0.05, -0.4, -0.2, -0.1, -0.05] {
            if order <= 1.95 {
                order = order.max((remainder(h)? / remainder(0.25 * h)?).log(4.0));
            }
        }
        assert!(error < 1e-7, "{what}, {name} {slots:?}: {slope:e}, error {error:e}");
        // jumps of second derivatives within the interval lower it by some hundredths
        assert!(order > 1.9, "{what}, {name} {slots:?}: order {order}, error {error:e}");
    }
    Ok(())
}

fn goes_with(scheme: &Scheme, friction: bool) -> bool {
    scheme.has_adjoint() && !(friction && scheme.is_linearised())
}

#[test]
fn the_gradient_without_friction_is_exact() -> Outcome {
    let solid = strip(ContactLaw::Cubic, false)?;
    let all = schemes_with_moving_supports()?;
    all.iter().filter(|(scheme, _)| goes_with(scheme, false)).try_for_each(|(scheme, _)| check(&solid, scheme, false))
}

#[test]
fn the_gradient_with_friction_is_exact() -> Outcome {
    let solid = strip(ContactLaw::Cubic, true)?;
    let all = schemes_with_moving_supports()?;
    all.iter().filter(|(scheme, _)| goes_with(scheme, true)).try_for_each(|(scheme, _)| check(&solid, scheme, true))
}

#[test]
fn the_gradient_of_the_log_law_is_exact() -> Outcome {
    for friction in [false, true] {
        check(&strip(ContactLaw::Log, friction)?, &Scheme::backward_euler(), friction)?;
    }
    Ok(())
}

/// From states that are computed again, the same bits.
#[test]
fn few_states_give_the_same_derivative() -> Outcome {
    let solid = strip(ContactLaw::Cubic, true)?;
    let to = |n: usize| StepTo { dt: H, controls: controls(&solid, n, 0.0, None) };
    let derivative = |plan: Checkpoints| -> Outcome<Vec<u64>> {
        let (model, mut workspace) = (solid.model(), Workspace::default());
        let mut begin = State { controls: to(0).controls.into(), ..solid.rest() };
        begin.velocity = Some(vec![0.0; begin.u.len()].into());
        let mut motion = Recording::new(Trajectory::from_given(begin), Scheme::backward_euler(), plan);
        for n in 1..=plan.steps() {
            motion.advance(model, &to(n), &STRICT, &mut workspace)?;
        }
        let mut sweep = ReverseSweep::new(model, &STRICT, &mut workspace);
        let mut all = Vec::new();
        motion.backwards(model, &mut |n| Ok::<_, StateError>(to(n)), &STRICT, &mut |part, k| {
            let n = part.first() + k + 1;
            let by = sweep.step(part, k, partials(n, &part.states()[k + 1]))?.controls;
            all.extend((0..by.len()).flat_map(|k| by.values(k).to_vec()).map(f64::to_bits));
            Ok(())
        })?;
        Ok(all)
    };
    let kept = derivative(Checkpoints::all(18, 4)?)?;
    assert!(kept == derivative(Checkpoints::at_most(2, 18, 4)?)? && kept.iter().any(|bits| *bits != 0));
    Ok(())
}
