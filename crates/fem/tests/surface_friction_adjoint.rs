//! The derivative of motions with friction between two bodies, along itself: by what drives either body, by friction and stiffness of the
//! contact, over a history in which samples touch, part, stick and slip.

#![allow(clippy::unwrap_used)] // helpers of tests

use crate::common;

use common::driven_motion::{DrivenMotion, Part, Wanted, block};
use common::{Outcome, cut, regular};
use nastic_energy::{FiberTension, NeoHooke};
use nastic_fem::schemes::SCHEMES;
use nastic_fem::{Contact, Controls, Inertia, Instant, MovingSupport, Solid, State, TimeStep, Trajectory};
use nastic_mesh::CellKind;
use nastic_tensor::Vec3;

/// A strip that is held below, in plane strain, and a finger that comes down on it, drags it along, turns and leaves.
fn bodies(of_friction: fn(Contact) -> Contact) -> Outcome<Solid> {
    let full = regular(CellKind::Quad4, [3.0, 2.5, 0.0], [6, 5, 0])?;
    let finger = |x: Vec3| Vec3::new(0.9 * x.x + 0.113, x.y - 0.35, 0.0);
    let on = |y: f64| move |x: Vec3| (x.y - y).abs() < 1e-9;
    let mesh = cut(
        &full,
        |x| x.y < 1.0 || x.y > 1.5 && x.x > 0.5 && x.x < 1.5,
        |x| if x.y > 1.2 { finger(x) } else { x },
        &[("bottom", &on(0.0)), ("strip", &on(1.0)), ("finger", &on(1.5)), ("held", &on(2.5))],
    )?;
    let contact = Contact::between("rub", "finger", "strip").thickness(0.05).stiffness(3.0);
    Ok(Solid::new(mesh)?
        .material("body", NeoHooke::new(1.0, 2.0)?)?
        .actuate("body", "fibre", FiberTension::along(Vec3::x())?)?
        .clamp("bottom")?
        .inertia(Inertia::new("body", 1.0))?
        .rayleigh_damping(0.0, 0.05)?
        .motion(MovingSupport::of("motion", "held"))?
        .contact(of_friction(contact.friction(0.12, 0.02)))?)
}

/// At `t`: the fibre works, the finger comes down, drags, turns.
fn controls(solid: &Solid, t: f64) -> Controls {
    let mut controls = solid.controls();
    controls.values_mut(block(solid, "fibre")).fill(0.1 * (2.0 * t).sin());
    let values = controls.values_mut(block(solid, "motion"));
    (values[0], values[1], values[5]) = (0.1 * t * t * (2.4 - t), -0.14 * (1.4 * t).sin(), 0.03 * (3.0 * t).sin());
    controls
}

const PARTS: [Part; 5] = [
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
        let (_, touch) = solid.model().contacts().touches(&Instant::of(&pair[1]).in_step(&step)).remove(0);
        (touch.area, touch.sliding.unwrap().sticking)
    };
    let all: Vec<(f64, f64)> = pairs.map(of_pair).collect();
    let areas = || all.iter().map(|(area, _)| *area);
    let spread = areas().fold(0.0, f64::max) - areas().fold(f64::INFINITY, f64::min);
    let count = |of: &dyn Fn(f64) -> bool| all.iter().filter(|(area, sticking)| *area > 0.0 && of(*sticking)).count();
    spread > 0.5 && count(&|sticking| sticking > 0.4) > 2 && count(&|sticking| sticking == 0.0) > 5
}

// tangents jump where a nearest point goes from a face to a corner: short steps of the remainder too
const WANTED: Wanted = Wanted { error: 1e-7, order: 1.95, steps: &[0.4, 0.2, 0.1, 0.05, 0.02] };

#[test]
fn the_gradient_of_motions_that_stick_and_slip_is_exact() -> Outcome {
    check(&bodies(|contact| contact)?)
}

#[test]
fn the_gradient_with_lagged_friction_is_exact() -> Outcome {
    check(&bodies(Contact::lagged)?)
}

/// Of samples between nodes, whose own nodes are among the corners around them.
#[test]
fn the_gradient_of_samples_between_nodes_is_exact() -> Outcome {
    check_by(&["quasi_static"], &bodies(|contact| contact.refine(2))?)
}

fn check(solid: &Solid) -> Outcome {
    check_by(&["quasi_static", "backward_euler", "tr_bdf2"], solid)
}

fn check_by(schemes: &[&str], solid: &Solid) -> Outcome {
    let motion = DrivenMotion { solid, controls, of_velocity: 0.0, first: 1 };
    for name in schemes.iter().copied() {
        let scheme = (SCHEMES.iter().find(|row| row.name == name).unwrap().build)()?;
        let base = motion.run(&scheme, 0.0, None).map_err(|error| format!("{name}: {error}"))?;
        assert!(changes(solid, &base), "{name}: nothing touches and parts, sticks and slips");
        motion.check(&scheme, &base, &PARTS, &WANTED)?;
    }
    Ok(())
}
