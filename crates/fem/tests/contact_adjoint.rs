//! The derivative of motions with contact, along itself: by what drives the body, by the pose of an obstacle at every instant, by its
//! friction and stiffness, over histories in which samples touch, part, stick and slip.

#![allow(clippy::unwrap_used)] // helpers of tests

use crate::common;

use common::block::STRICT;
use common::driven_motion::{DrivenMotion, H, Part, STEPS, Wanted, block};
use common::motion::schemes_with_moving_supports;
use common::{Outcome, regular};
use nastic_energy::{FiberTension, NeoHooke};
use nastic_fem::{
    Checkpoints, Contact, ContactLaw, Controls, Inertia, Recording, ReverseSweep, Scheme, Solid, StateError, StepTo,
    Trajectory, Workspace,
};
use nastic_mesh::spatial::Obstacle;
use nastic_mesh::{CellKind, rectangle};
use nastic_tensor::Vec3;

/// A plane strip on a floor, with a finger that comes down on it, drags it along, turns and leaves. A foot of it stands in a corner where no
/// quasi-static step would find it free.
fn strip(law: ContactLaw, friction: bool) -> Outcome<Solid> {
    strip_with(law, |contact, mu| if friction { contact.friction(mu, 0.01) } else { contact })
}

/// The same whose friction takes the normal forces of the instant before.
fn lagged_strip(law: ContactLaw) -> Outcome<Solid> {
    strip_with(law, |contact, mu| contact.friction(mu, 0.01).lagged())
}

fn strip_with(law: ContactLaw, rub: impl Fn(Contact, f64) -> Contact) -> Outcome<Solid> {
    strip_below(Obstacle::capsule([0.9, 1.42, 0.0], [1.7, 1.46, 0.0], 0.35), law, rub)
}

/// A finger from a mesh, arched, whose distance is on a grid: its gradient is no unit vector.
fn arched_finger() -> Outcome<Obstacle> {
    let arched = |x: [f64; 3]| [x[0] + 0.55, x[1] + 1.09 + 0.05 * (5.0 * x[0]).sin(), 0.0];
    let finger = rectangle([1.5, 0.6], [8, 2], CellKind::Quad4)?.mapped(arched)?;
    Ok(Obstacle::on_grid(&finger, 0.15, 0.0)?)
}

fn strip_below(finger: Obstacle, law: ContactLaw, rub: impl Fn(Contact, f64) -> Contact) -> Outcome<Solid> {
    let layer =
        |contact: Contact| contact.thickness(0.08).law(law).stiffness(if law == ContactLaw::Log { 0.3 } else { 3.0 });
    let floor = Obstacle::half_space([0.0, -0.06, 0.0], [0.05, 1.0, 0.0]);
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

/// At `t`: the fibre works, the finger comes down, drags, turns.
fn controls(solid: &Solid, t: f64) -> Controls {
    let mut controls = solid.controls();
    controls.values_mut(block(solid, "fibre")).fill(0.2 * (2.0 * t).sin());
    let down = 0.16 * (1.5 * t).sin();
    let values = controls.values_mut(block(solid, "finger"));
    (values[0], values[1], values[5]) = (0.15 * t * t * (2.4 - t), -down, 0.1 * (3.0 * t).sin());
    controls
}

fn driven(solid: &Solid) -> DrivenMotion<'_> {
    DrivenMotion { solid, controls, of_velocity: 0.3, first: 0 }
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

const PARTS: [Part; 5] = [
    ("fibre", &[0], 1e-2),
    ("finger", &[0, 1], 1e-3),
    ("finger", &[5], 1e-3),
    ("finger", &[6], 1e-2),
    ("floor", &[7], 1e-2),
];

// jumps of second derivatives within the interval lower the order by some hundredths
const WANTED: Wanted = Wanted { error: 1e-7, order: 1.9, steps: &[0.4, 0.2, 0.1, 0.05] };

/// Of lagged friction: more steps, as each jump of a pressure's second derivative meets its instant and the one behind it.
const OF_LAGGED: Wanted = Wanted { error: 1e-7, order: 1.95, steps: &[0.4, 0.2, 0.1, 0.05, 0.02] };

fn check(solid: &Solid, scheme: &Scheme, friction: bool) -> Outcome {
    check_to(solid, scheme, friction, &WANTED)
}

fn check_to(solid: &Solid, scheme: &Scheme, friction: bool, wanted: &Wanted) -> Outcome {
    let motion = driven(solid);
    let base = motion.run(scheme, 0.0, None).map_err(|error| format!("{}: {error}", scheme.name()))?;
    assert!(changes(solid, &base), "{}: nothing touches and parts", scheme.name());
    motion.check(scheme, &base, &PARTS[..if friction { 5 } else { 4 }], wanted)
}

fn goes_with(scheme: &Scheme, friction: bool) -> bool {
    scheme.has_adjoint() && !scheme.extrapolates() && !(friction && scheme.is_linearised())
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

#[test]
fn the_gradient_with_lagged_friction_is_exact() -> Outcome {
    let solid = lagged_strip(ContactLaw::Cubic)?;
    for (scheme, _) in schemes_with_moving_supports()?.iter().filter(|(scheme, _)| goes_with(scheme, true)) {
        check_to(&solid, scheme, true, &OF_LAGGED)?;
    }
    check_to(&lagged_strip(ContactLaw::Log)?, &Scheme::backward_euler(), true, &OF_LAGGED)
}

/// Of a distance on a grid.
#[test]
fn the_gradient_by_an_obstacle_on_a_grid_is_exact() -> Outcome {
    let all = schemes_with_moving_supports()?;
    let plain = strip_below(arched_finger()?, ContactLaw::Cubic, |contact, _| contact)?;
    let rough = strip_below(arched_finger()?, ContactLaw::Cubic, |contact, mu| contact.friction(mu, 0.01))?;
    let lagged = strip_below(arched_finger()?, ContactLaw::Cubic, |contact, mu| contact.friction(mu, 0.01).lagged())?;
    let log = strip_below(arched_finger()?, ContactLaw::Log, |contact, mu| contact.friction(mu, 0.01))?;
    check(&plain, &Scheme::backward_euler(), false)?;
    check(&log, &Scheme::backward_euler(), true)?;
    for (scheme, _) in all.iter().filter(|(scheme, _)| goes_with(scheme, true)).take(4) {
        check(&rough, scheme, true)?;
        check_to(&lagged, scheme, true, &OF_LAGGED)?;
    }
    Ok(())
}

/// From states that are computed again, the same bits.
#[test]
fn few_states_give_the_same_derivative() -> Outcome {
    of_few_states(&strip(ContactLaw::Cubic, true)?)?;
    of_few_states(&lagged_strip(ContactLaw::Cubic)?)
}

fn of_few_states(solid: &Solid) -> Outcome {
    let motion = driven(solid);
    let to = |n: usize| StepTo { dt: H, controls: motion.controls_at(n, 0.0, None) };
    let derivative = |plan: Checkpoints| -> Outcome<Vec<u64>> {
        let (model, mut workspace, scheme) = (solid.model(), Workspace::default(), Scheme::backward_euler());
        let begin = motion.begin(&scheme, to(0).controls);
        let mut recording = Recording::new(Trajectory::from_given(begin), scheme, plan);
        for n in 1..=plan.steps() {
            recording.advance(model, &to(n), &STRICT, &mut workspace)?;
        }
        let mut sweep = ReverseSweep::new(model, &STRICT, &mut workspace);
        let mut all = Vec::new();
        recording.backwards(model, &mut |n| Ok::<_, StateError>(to(n)), &STRICT, &mut |part, k| {
            let n = part.first() + k + 1;
            let by = sweep.step(part, k, motion.partials(n, &part.states()[k + 1]))?.controls;
            all.extend((0..by.len()).flat_map(|k| by.values(k).to_vec()).map(f64::to_bits));
            Ok(())
        })?;
        Ok(all)
    };
    let kept = derivative(Checkpoints::all(18, 4)?)?;
    assert!(kept == derivative(Checkpoints::at_most(2, 18, 4)?)? && kept.iter().any(|bits| *bits != 0));
    Ok(())
}
