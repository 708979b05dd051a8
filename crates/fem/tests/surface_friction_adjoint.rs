//! The derivative of motions with friction between two bodies, along itself: by what drives either body, by friction and stiffness of the
//! contact, over a history in which samples touch, part, stick and slip.

#![allow(clippy::unwrap_used)] // helpers of tests

use crate::common;

use common::block::STRICT;
use common::{Outcome, cut, noise, regular};
use nastic_energy::{FiberTension, NeoHooke};
use nastic_fem::time::catalogue::SCHEMES;
use nastic_fem::{
    Controls, Inertia, Instant, MovingSupport, Scheme, Solid, State, StatePartials, StepTo, SurfaceContact, TimeStep,
    Trajectory, Workspace,
};
use nastic_mesh::CellKind;
use nastic_tensor::Vec3;

const H: f64 = 0.1;
const STEPS: usize = 24;

/// A strip that is held below, in plane strain, and a finger that comes down on it, drags it along, turns and leaves.
fn bodies() -> Outcome<Solid> {
    let full = regular(CellKind::Quad4, [3.0, 2.5, 0.0], [6, 5, 0])?;
    let finger = |x: Vec3| Vec3::new(0.9 * x.x + 0.113, x.y - 0.35, 0.0);
    let on = |y: f64| move |x: Vec3| (x.y - y).abs() < 1e-9;
    let mesh = cut(
        &full,
        |x| x.y < 1.0 || x.y > 1.5 && x.x > 0.5 && x.x < 1.5,
        |x| if x.y > 1.2 { finger(x) } else { x },
        &[("bottom", &on(0.0)), ("strip", &on(1.0)), ("finger", &on(1.5)), ("held", &on(2.5))],
    )?;
    let contact = SurfaceContact::between("rub", "finger", "strip").thickness(0.05).stiffness(3.0);
    Ok(Solid::new(mesh)?
        .material("body", NeoHooke::new(1.0, 2.0)?)?
        .actuate("body", "fibre", FiberTension::along(Vec3::x())?)?
        .clamp("bottom")?
        .inertia(Inertia::new("body", 1.0))?
        .rayleigh_damping(0.0, 0.05)?
        .motion(MovingSupport::of("motion", "held"))?
        .surface_contact(contact.friction(0.12, 0.02))?)
}

fn block(solid: &Solid, name: &str) -> usize {
    solid.model().controllable().iter().position(|known| known.name == name).unwrap()
}

/// At the n-th instant, with a change along a direction in every block.
fn controls(solid: &Solid, n: usize, change: f64, along: Option<&Controls>) -> Controls {
    let mut controls = solid.controls();
    let t = H * n as f64;
    controls.values_mut(block(solid, "fibre")).fill(0.1 * (2.0 * t).sin());
    let values = controls.values_mut(block(solid, "motion"));
    (values[0], values[1], values[5]) = (0.1 * t * t * (2.4 - t), -0.14 * (1.4 * t).sin(), 0.03 * (3.0 * t).sin());
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
        sum += state.u.iter().enumerate().map(|(i, u)| H * (noise(77 + 100 * n + i) * u + 0.5 * u * u)).sum::<f64>();
    }
    sum
}

fn gradient(solid: &Solid, trajectory: &Trajectory) -> Outcome<Vec<Controls>> {
    let partials = |(n, state): (usize, &State)| {
        let of = |(i, u): (usize, &f64)| if n == 0 { 0.0 } else { H * (noise(77 + 100 * n + i) + u) };
        StatePartials::by_displacement(state.u.iter().enumerate().map(of).collect())
    };
    let partials: Vec<_> = trajectory.states().iter().enumerate().map(partials).collect();
    Ok(solid.model().reverse_sweep(trajectory, &partials, &STRICT, &mut Workspace::default())?.controls)
}

/// The gradient in some slots of one block, scaled to a size, zero elsewhere; and the slope along it.
fn direction(solid: &Solid, gradient: &[Controls], (name, slots, size): (&str, &[usize], f64)) -> (Vec<Controls>, f64) {
    let k = block(solid, name);
    let mut along: Vec<Controls> = gradient.iter().map(|_| solid.model().zero_controls()).collect();
    let mut largest = 0.0f64;
    // the body begins where the first controls hold it
    for (to, from) in along.iter_mut().zip(gradient).skip(1) {
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

const PARTS: [(&str, &[usize], f64); 5] = [
    ("fibre", &[0], 1e-2),
    ("motion", &[0, 1], 1e-3),
    ("motion", &[5], 1e-3),
    ("rub", &[0], 1e-2),
    ("rub", &[1], 1e-2),
];

/// Whether samples touch and do not, stick and slip.
fn changes(solid: &Solid, trajectory: &Trajectory) -> bool {
    let pairs = trajectory.states().windows(2);
    let of_pair = |pair: &[State]| {
        let step = TimeStep::between(&pair[0], &pair[1]);
        let (_, touch) = solid.model().touches(&Instant::of(&pair[1]).in_step(&step)).remove(0);
        (touch.area, touch.sliding.unwrap().sticking)
    };
    let all: Vec<(f64, f64)> = pairs.map(of_pair).collect();
    let areas = || all.iter().map(|(area, _)| *area);
    let spread = areas().fold(0.0, f64::max) - areas().fold(f64::INFINITY, f64::min);
    let count = |of: &dyn Fn(f64) -> bool| all.iter().filter(|(area, sticking)| *area > 0.0 && of(*sticking)).count();
    spread > 0.5 && count(&|sticking| sticking > 0.4) > 2 && count(&|sticking| sticking == 0.0) > 5
}

/// Differences of fourth order along the gradient itself agree to 1e-7, and the Taylor remainder is of second order.
fn check(solid: &Solid, scheme: &Scheme) -> Outcome {
    let what = scheme.name();
    let base = run(solid, scheme, 0.0, None).map_err(|error| format!("{what}: {error}"))?;
    assert!(changes(solid, &base), "{what}: nothing touches and parts, sticks and slips");
    let (value, found) = (functional(&base), gradient(solid, &base)?);
    for part in PARTS {
        let (along, slope) = direction(solid, &found, part);
        let at = |t: f64| run(solid, scheme, t, Some(&along)).map(|run| functional(&run));
        let odd = |t: f64| -> Outcome<f64> { Ok(at(t)? - at(-t)?) };
        // tangents jump where a nearest point goes from a face to a corner: shorter differences come nearer to such a place
        let mut error = f64::INFINITY;
        for h in [0.02, 0.002, 2e-4] {
            if error > 1e-7 {
                error = error.min((slope * 12.0 * h / (8.0 * odd(h)? - odd(2.0 * h)?) - 1.0).abs());
            }
        }
        let remainder = |t: f64| -> Outcome<f64> { Ok((at(t)? - value - t * slope).abs()) };
        let mut order = f64::NEG_INFINITY;
        for h in [0.4, 0.2, 0.1, 0.05, 0.02, -0.4, -0.2, -0.1, -0.05, -0.02] {
            if order <= 1.95 {
                order = order.max((remainder(h)? / remainder(0.25 * h)?).log(4.0));
            }
        }
        assert!(error < 1e-7, "{what}, {part:?}: {slope:e}, error {error:e}, order {order}");
        assert!(order > 1.95, "{what}, {part:?}: order {order}, error {error:e}");
    }
    Ok(())
}

#[test]
fn the_gradient_of_motions_that_stick_and_slip_is_exact() -> Outcome {
    let solid = bodies()?;
    for name in ["quasi_static", "backward_euler", "tr_bdf2"] {
        let scheme = (SCHEMES.iter().find(|row| row.name == name).unwrap().build)()?;
        check(&solid, &scheme)?;
    }
    Ok(())
}
