//! Friction between surfaces of bodies: balance, common rigid motions, a block on a block, a disc that pads carry, derivatives of a motion.

#![allow(clippy::unwrap_used)] // helpers of tests

use crate::common;

use crate::surface_contact::blocks;
use common::block::STRICT;
use common::{Outcome, cut, noise, regular};
use nastic_energy::NeoHooke;
use nastic_fem::schemes::SCHEMES;
use nastic_fem::{
    Contact, Controls, Demand, Inertia, Instant, MovingSupport, Scheme, Solid, State, StepTo, TimeStep, TimeStepping,
    Touch, Trajectory, Workspace,
};
use nastic_mesh::spatial::Obstacle;
use nastic_mesh::{CellKind, Mesh};
use nastic_tensor::Vec3;

pub(crate) fn scheme(name: &str) -> Scheme {
    (SCHEMES.iter().find(|row| row.name == name).unwrap().build)().unwrap()
}

fn pressed_blocks(kind: CellKind, refine: usize) -> Outcome<Solid> {
    let contact = Contact::between("between", "lower", "upper").thickness(0.009).refine(refine);
    Ok(Solid::new(blocks(kind, 1.7)?)?
        .material("body", NeoHooke::new(4e4, 6e4)?)?
        .clamp("z-")?
        .contact(contact.friction(0.7, 0.3))?)
}

/// A step that ends at a displacement with a velocity.
fn step(solid: &Solid, u: Vec<f64>, velocity: Vec<f64>) -> (State, TimeStep) {
    let before = solid.rest();
    let end = State { u: u.into(), velocity: Some(velocity.into()), time: before.time + 0.1, ..solid.rest() };
    let step = TimeStep::between(&before, &end);
    (end, step)
}

fn touch_at(solid: &Solid, at: &Instant, name: &str) -> Touch {
    solid.model().contacts().touches(at).into_iter().find(|(own, _)| own == name).unwrap().1
}

/// Forces and moments of friction cancel, and what is reported is what the first surface is pushed with.
#[test]
fn forces_and_moments_of_friction_balance() -> Outcome {
    for (kind, refine) in [(CellKind::Hex8, 2), (CellKind::Hex27, 1), (CellKind::Tet10, 2)] {
        let solid = pressed_blocks(kind, refine)?;
        let n = solid.rest().u.len();
        let of = |scale: f64, seed: usize| -> Vec<f64> { (0..n).map(|i| scale * noise(seed + i)).collect() };
        let (end, step) = step(&solid, of(0.006, 0), of(0.5, 7));
        let controls = solid.controls();
        let with = |factor: f64| -> Outcome<(Vec<f64>, Vec<f64>)> {
            let mut own = controls.clone();
            own.values_mut(0)[0] *= factor;
            let at = Instant::new(&end.u, &own, 1.0).in_step(&step);
            let sums = solid.model().evaluate(&at, Demand { energy: false, force: true })?;
            Ok((sums.force, sums.force_scale))
        };
        // what changes with the stiffness is the contact's alone
        let ((two, scales), (one, _)) = (with(2.0)?, with(1.0)?);
        let own: Vec<f64> = two.iter().zip(&one).map(|(two, one)| two - one).collect();
        let lower = solid.mesh().nodes_of_facets(&solid.mesh().facets_of(&"lower".into())?);
        let (mut force, mut moment, mut on_lower, mut turns, mut scale) =
            (Vec3::zeros(), Vec3::zeros(), Vec3::zeros(), Vec3::zeros(), 0.0);
        for (node, x) in solid.mesh().points().iter().enumerate() {
            let of = |v: &[f64]| Vec3::from_column_slice(&v[3 * node..][..3]);
            let (place, here) = (Vec3::from(*x) + of(&end.u), of(&own));
            (force, moment, scale) = (force + here, moment + place.cross(&here), scale + of(&scales).norm());
            if lower.contains(&(node as u32)) {
                (on_lower, turns) = (on_lower - here, turns - place.cross(&here));
            }
        }
        assert!(force.norm() < 1e-12 * scale && moment.norm() < 1e-12 * scale, "{kind}: {force:?} {moment:?} {scale}");
        let at = Instant::new(&end.u, &controls, 1.0).in_step(&step);
        let message = touch_at(&solid, &at, "between");
        assert!((Vec3::from(message.force) - on_lower).norm() < 1e-9 * scale, "{kind}: {message:?} {on_lower:?}");
        assert!((Vec3::from(message.moment) - turns).norm() < 1e-9 * scale, "{kind}: {message:?} {turns:?}");
        let without = touch_at(&solid, &Instant::new(&end.u, &controls, 1.0), "between");
        let rubs = (Vec3::from(message.force) - Vec3::from(without.force)).norm();
        assert!(rubs > 0.03 * message.pressing, "{rubs} of {}", message.pressing);
    }
    Ok(())
}

/// Bodies that turn together, however far and fast, do not slide on each other, although they stand apart.
#[test]
fn a_common_rigid_motion_is_no_sliding() -> Outcome {
    for kind in [CellKind::Hex8, CellKind::Tet10] {
        let solid = pressed_blocks(kind, 2)?;
        let (axis, angle) = (Vec3::new(0.48, -0.6, 0.64), 1.1);
        let turn = nalgebra::Rotation3::from_axis_angle(&nalgebra::Unit::new_normalize(axis), angle);
        let (centre, spin, speed) = (Vec3::new(3.0, -2.0, 1.0), 5.0 * axis, Vec3::new(0.4, 2.0, -3.0));
        // the upper one is lowered into the layer first, a little askew
        let lowered = |x: Vec3| if x.z > 1.005 { x - Vec3::new(0.0, 0.0, 0.004 + 0.001 * x.x) } else { x };
        let place = |x: Vec3| centre + turn * (lowered(x) - centre);
        let u = common::nodal(solid.mesh(), |x| place(x) - x);
        let velocity = common::nodal(solid.mesh(), |x| speed + spin.cross(&place(x)));
        let (end, step) = step(&solid, u, velocity);
        let controls = solid.controls();
        let message = touch_at(&solid, &Instant::new(&end.u, &controls, 1.0).in_step(&step), "between");
        let sliding = message.sliding.unwrap();
        assert!(
            message.pressing > 100.0 && sliding.speed < 1e-11 && sliding.sticking > 1.0 - 1e-12,
            "{kind}: {message:?}"
        );
    }
    Ok(())
}

/// A stiff block of 1 x 0.5 m on a wide one in plane strain, under weight and a share of it sideways.
fn stacked(sideways: f64, mu: f64) -> Outcome<Solid> {
    let full = regular(CellKind::Quad4, [3.0, 1.25, 0.0], [12, 5, 0])?;
    let upper = |x: Vec3| x + Vec3::new(0.1, -0.25 + 2.2e-3, 0.0);
    let on = |y: f64| move |x: Vec3| (x.y - y).abs() < 1e-9;
    let mesh = cut(
        &full,
        |x| x.y < 0.5 || x.y > 0.75 && x.x > 1.0 && x.x < 2.0,
        |x| if x.y > 0.7 { upper(x) } else { x },
        &[("bottom", &on(0.0)), ("lower", &on(0.5)), ("upper", &on(0.75))],
    )?;
    let contact = Contact::between("between", "upper", "lower").thickness(1e-3).stiffness(4e5);
    Ok(Solid::new(mesh)?
        .material("body", NeoHooke::new(4e9, 4e9)?)?
        .body_force("body", 1000.0 * 9.81 * Vec3::new(sideways, -1.0, 0.0))?
        .inertia(Inertia::new("body", 1000.0))?
        .clamp("bottom")?
        .rayleigh_damping(2.0, 0.0)?
        .contact(contact.friction(mu, 1e-3))?)
}

fn at_rest(solid: &Solid) -> State {
    let begin = solid.rest();
    State { velocity: Some(vec![0.0; begin.u.len()].into()), ..begin }
}

/// The contact at the end of a motion, with the velocities of its last step.
fn last_touch(solid: &Solid, run: &Trajectory, name: &str) -> Touch {
    let states = run.states();
    let step = TimeStep::between(&states[states.len() - 2], run.end());
    touch_at(solid, &Instant::of(run.end()).in_step(&step), name)
}

/// Below the cone it creeps at `v = e (1 - sqrt(1 - r))`, r the share of the cone that it takes; above it slides, and is braked by mu N.
#[test]
fn a_block_on_a_block_holds_below_its_cone_and_slides_above() -> Outcome {
    let steps = |solid: &Solid| vec![StepTo { dt: 0.01, controls: solid.controls() }; 60];
    for (sideways, holds) in [(0.45, true), (0.55, false)] {
        let solid = stacked(sideways, 0.5)?;
        let mut run = Trajectory::from_given(at_rest(&solid));
        solid.model().advance(
            &mut run,
            &scheme("backward_euler"),
            &steps(&solid),
            &STRICT,
            &mut Workspace::default(),
        )?;
        let (touch, weight) = (last_touch(&solid, &run, "between"), 1000.0 * 9.81 * 0.5);
        let ([along, up, _], sliding) = (touch.force, touch.sliding.unwrap());
        assert!((up / weight - 1.0).abs() < 2e-3, "{up} for {weight}");
        if holds {
            let expected = 1e-3 * (1.0 - (1.0f64 - 0.9).sqrt());
            assert!(sliding.sticking == 1.0 && (sliding.speed / expected - 1.0).abs() < 2e-2, "{sliding:?} {expected}");
            assert!((along / (-sideways * weight) - 1.0).abs() < 2e-3, "{along}");
        } else {
            assert!(sliding.sticking == 0.0 && sliding.speed > 0.05, "{sliding:?}");
            // the layer lets the block tilt a little, so that neither part alone is along an axis
            let (whole, cone) = (along.hypot(up), 1.25f64.sqrt() * touch.pressing);
            assert!(along < 0.0 && (whole / cone - 1.0).abs() < 1e-6, "{along}, {whole} for {cone}");
        }
    }
    Ok(())
}

/// A disc of radius 0.1 m ("ball") between two pads with the outer sides "left" and "right" and the "inner" ones.
pub(crate) fn disc_and_pads() -> Outcome<Mesh> {
    let full = regular(CellKind::Quad4, [3.0, 1.0, 0.0], [24, 8, 0])?;
    // the square [1, 2] x [0, 1] becomes a disc of radius 0.1 about (0, 0.1)
    let disc = |x: Vec3| {
        let (a, b) = (2.0 * x.x - 3.0, 2.0 * x.y - 1.0);
        Vec3::new(0.1 * a * (1.0 - 0.5 * b * b).sqrt(), 0.1 + 0.1 * b * (1.0 - 0.5 * a * a).sqrt(), 0.0)
    };
    let pad = |x: Vec3| {
        let side = if x.x < 1.0 { -1.0 } else { 1.0 };
        Vec3::new(side * (0.103 + 0.2 * (side * (x.x - 1.5) - 1.0)), 0.02 + 0.17 * x.y, 0.0)
    };
    let names: [(&str, &dyn Fn(Vec3) -> bool); 5] = [
        ("ball", &|x| x.x > 0.99 && x.x < 2.01),
        ("inner", &|x| (x.x - 0.5).abs() < 1e-9 || (x.x - 2.5).abs() < 1e-9),
        ("left", &|x| x.x < 1e-9),
        ("right", &|x| x.x > 3.0 - 1e-9),
        ("pads", &|x| x.x < 0.51 || x.x > 2.49),
    ];
    let keep = |x: Vec3| x.x < 0.5 || x.x > 2.5 || x.x > 1.0 && x.x < 2.0;
    cut(&full, keep, |x| if x.x < 0.9 || x.x > 2.1 { pad(x) } else { disc(x) }, &names)
}

/// The disc and the pads above a floor, in plane strain, each pad held at its outer side.
pub(crate) fn gripper(mu: f64) -> Outcome<Solid> {
    Ok(Solid::new(disc_and_pads()?)?
        .material("body", NeoHooke::new(4e4, 6e4)?)?
        .body_force("body", Vec3::new(0.0, -9810.0, 0.0))?
        .inertia(Inertia::new("body", 1000.0))?
        .motion(MovingSupport::of("left pad", "left"))?
        .motion(MovingSupport::of("right pad", "right"))?
        .contact(Contact::of("floor", "ball", Obstacle::half_space([0.0, -1e-4, 0.0], [0.0, 1.0, 0.0])))?
        .contact(Contact::between("grip", "ball", "inner").friction(mu, 1e-3))?)
}

/// How far the disc was lifted, and what the grip carries at the end.
fn lift(solid: &Solid) -> Outcome<(f64, Touch, [usize; 3])> {
    let at = |t: f64| -> Controls {
        let mut controls = solid.controls();
        for (block, inwards) in [(0, 1.0), (1, -1.0)] {
            let values = controls.values_mut(block);
            (values[0], values[1]) = (inwards * 0.02 * (t / 0.5).min(1.0), 0.02 * (t - 0.5).clamp(0.0, 2.0));
        }
        controls
    };
    let steps: Vec<StepTo> = (1..=150).map(|n| StepTo { dt: 0.02, controls: at(0.02 * f64::from(n)) }).collect();
    let mut run = Trajectory::from_given(solid.rest());
    solid.model().advance(&mut run, &scheme("quasi_dynamic"), &steps, &STRICT, &mut Workspace::default())?;
    let centre = common::node_at(solid.mesh(), [0.0, 0.1, 0.0]).unwrap();
    let mut work = [0; 3];
    for report in run.states().iter().skip(1).map(|state| state.report) {
        let own = [report.newton, report.factorisations, report.back_substitutions];
        work.iter_mut().zip(own).for_each(|(sum, own)| *sum += own);
    }
    Ok((run.end().u[2 * centre + 1], last_touch(solid, &run, "grip"), work))
}

/// Each side presses with N, and `quasi_dynamic` adds a tenth to what a lift at constant speed takes: a disc of weight w is carried where `2 mu N > w`, and falls where it is not.
#[test]
fn pads_carry_a_disc_or_drop_it() -> Outcome {
    let solid = gripper(0.8)?;
    let (lifted, touch, [newton, factorisations, substitutions]) = lift(&solid)?;
    let area = solid.model().energies().mass()?;
    let mut image = vec![0.0; solid.rest().u.len()];
    area.multiply(
        &common::nodal(solid.mesh(), |x| Vec3::new(0.0, f64::from(u8::from(x.x.abs() < 0.101)), 0.0)),
        &mut image,
    );
    let weight = 9.81 * image.iter().sum::<f64>();
    assert!(lifted > 0.02 && lifted < 0.04, "{lifted}");
    assert!((touch.force[1] / weight - 1.0).abs() < 1e-3, "{} for {weight}", touch.force[1]);
    assert!(touch.force[0].abs() < 1e-6 * touch.pressing && touch.sliding.unwrap().sticking == 1.0, "{touch:?}");
    assert!(newton < 150 * 6, "{newton} Newton iterations");
    // 16 to 17 a system, by how rounding falls: factors are kept for long, until a step is given up
    assert!(
        factorisations <= 60 && substitutions < 18 * newton,
        "{newton} iterations, {factorisations} factors, {substitutions} substitutions"
    );
    let needed = weight / touch.pressing;
    let (held, ..) = lift(&gripper(1.3 * needed)?)?;
    let (dropped, ..) = lift(&gripper(0.9 * needed)?)?;
    assert!(held > 0.02 && dropped < 0.002, "{held} and {dropped}, of {needed}");
    Ok(())
}

#[test]
fn friction_of_surfaces_has_no_static_equilibrium() -> Outcome {
    let solid = stacked(0.1, 0.5)?;
    let message = solid.solve(&solid.controls(), &STRICT).err().ok_or("not refused")?;
    assert!(message.to_string().contains("quasi_static for slow loads"), "{message}");
    let refused = |coefficient: f64, speed: f64| -> Outcome<String> {
        let contact = Contact::between("between", "lower", "upper").friction(coefficient, speed);
        let body: Mesh = blocks(CellKind::Hex8, 1.0)?;
        let body = Solid::new(body)?.material("body", NeoHooke::new(4e4, 6e4)?)?;
        Ok(body.contact(contact).err().ok_or("not refused")?.to_string())
    };
    assert!(refused(-0.1, 1.0)?.contains("\"between\": its friction coefficient is -0.1"));
    assert!(refused(0.1, 0.0)?.contains("\"between\": its slip speed is 0"));
    Ok(())
}
