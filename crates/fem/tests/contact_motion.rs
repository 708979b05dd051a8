//! Contact in motion: a point mass that bounces, a block that falls, rests and slides, a body held between pads.

#![allow(clippy::unwrap_used)] // helpers of tests

use crate::common;

use common::block::STRICT;
use common::{Outcome, regular};
use nastic_energy::NeoHooke;
use nastic_fem::schemes::SCHEMES;
use nastic_fem::{
    Contact, Controls, Inertia, Instant, Scheme, Solid, State, StepTo, TimeStep, TimeStepping, Trajectory, Workspace,
};
use nastic_mesh::CellKind;
use nastic_mesh::spatial::Obstacle;
use nastic_tensor::Vec3;

fn scheme(name: &str) -> Scheme {
    (SCHEMES.iter().find(|row| row.name == name).unwrap().build)().unwrap()
}

fn advance(solid: &Solid, from: Trajectory, scheme: &Scheme, steps: &[StepTo]) -> Outcome<Trajectory> {
    let mut trajectory = from;
    solid.model().advance(&mut trajectory, scheme, steps, &STRICT, &mut Workspace::default())?;
    Ok(trajectory)
}

fn quantity(solid: &Solid, trajectory: &Trajectory, name: &str) -> f64 {
    let state = trajectory.end();
    let all = solid.model().quantities(&Instant::of(state)).unwrap();
    all.into_iter().find(|(_, own, _)| *own == name).unwrap().2
}

/// A block of mass 1 that moves as a point: a floor below its bottom and one as far below its top push all nodes alike. Of its speed it
/// keeps what was computed by hand for a point mass on the cubic law with `kappa = k w / (3 delta^2) = 1000`, duration T of a contact.
#[test]
fn a_point_mass_bounces_as_computed() -> Outcome {
    const T: f64 = 0.222_582_5;
    const DELTA: f64 = 0.1;
    // by T/h = 5, 10, 20, 40
    let table = [
        ("backward_euler", [0.376224, 0.575071, 0.745259, 0.859574]),
        ("trapezoidal", [0.995907, 0.999561, 0.999966, 0.999998]),
        ("tr_bdf2", [0.994230, 0.999280, 0.999915, 0.999990]),
    ];
    let floor = |name: &str, side: &str, height: f64| {
        let obstacle = Obstacle::half_space([0.0, 0.0, height - DELTA], [0.0, 0.0, 1.0]);
        Contact::of(name, side, obstacle).thickness(DELTA).stiffness(3.0 * DELTA * DELTA * 1000.0 / 2.0)
    };
    let solid = Solid::new(regular(CellKind::Hex8, [1.0; 3], [1; 3])?)?
        .material("body", NeoHooke::new(1.0, 1.0)?)?
        .inertia(Inertia::new("body", 1.0))?
        .contact(floor("bottom", "z-", 0.0))?
        .contact(floor("top", "z+", 1.0))?;
    for (name, kept) in table {
        for (k, kept) in kept.into_iter().enumerate() {
            let per_contact = 5 << k;
            let mut begin = solid.rest();
            let fall: Vec<f64> = (0..begin.u.len()).map(|dof| if dof % 3 == 2 { -1.0 } else { 0.0 }).collect();
            begin.velocity = Some(fall.into());
            let to = StepTo { dt: T / per_contact as f64, controls: solid.controls() };
            let mut trajectory = Trajectory::from_given(begin);
            for _ in 0..3 * per_contact {
                trajectory = advance(&solid, trajectory, &scheme(name), std::slice::from_ref(&to))?;
                if trajectory.end().u[2] >= 0.0 {
                    break;
                }
            }
            let speed = trajectory.end().velocity.as_ref().unwrap()[2];
            // the duration of the table has seven digits
            assert!((speed - kept).abs() < 2e-6, "{name}, {per_contact} steps: {speed} for {kept}");
        }
    }
    Ok(())
}

/// A stiff block of 1 x 1 x 0.25 m and 250 kg on an incline of `tan = 1/2`: the gravity turns, not the floor.
fn incline(mu: f64, slip_speed: f64) -> Outcome<Solid> {
    let (sine, cosine) = (0.2f64.sqrt(), 0.8f64.sqrt());
    Ok(Solid::new(regular(CellKind::Hex8, [1.0, 1.0, 0.25], [2, 2, 1])?)?
        .material("body", NeoHooke::new(4e9, 4e9)?)?
        .body_force("body", 1000.0 * 9.81 * Vec3::new(sine, 0.0, -cosine))?
        .inertia(Inertia::new("body", 1000.0))?
        .contact(
            Contact::of("floor", "z-", Obstacle::half_space([0.0; 3], [0.0, 0.0, 1.0]))
                .thickness(1e-3)
                .stiffness(4e5)
                .friction(mu, slip_speed),
        )?)
}

/// In the layer that carries it, at rest: `p = w / A`, `d = delta (1 - sqrt(p/k))`, all samples alike for a rigid block.
fn resting(solid: &Solid) -> State {
    let pressure = 1000.0 * 9.81 * 0.25 * 0.8f64.sqrt();
    let gap = 1e-3 * (1.0 - (pressure / 4e5).sqrt());
    let mut begin = solid.rest();
    let u: Vec<f64> = (0..begin.u.len()).map(|dof| if dof % 3 == 2 { gap } else { 0.0 }).collect();
    begin.velocity = Some(vec![0.0; u.len()].into());
    begin.u = u.into();
    begin
}

fn mean(solid: &Solid, values: &[f64], axis: usize) -> f64 {
    let n = solid.mesh().points().len();
    (0..n).map(|node| values[3 * node + axis]).sum::<f64>() / n as f64
}

/// It slides for `mu < tan`, `a = g (sin - mu cos)`, as backward Euler sums it; for `mu > tan` it creeps at the velocity where the
/// smoothed friction carries the weight, `v = e (1 - sqrt(1 - tan/mu))`.
#[test]
fn a_block_slides_down_an_incline_or_creeps() -> Outcome {
    let (h, count) = (0.025, 40);
    let (sine, cosine) = (0.2f64.sqrt(), 0.8f64.sqrt());
    let sliding = incline(0.49, 1e-5)?;
    let steps = vec![StepTo { dt: h, controls: sliding.controls() }; count];
    let end = advance(&sliding, Trajectory::from_given(resting(&sliding)), &scheme("backward_euler"), &steps)?;
    let (a, n) = (9.81 * (sine - 0.49 * cosine), count as f64);
    let expected = a * h * h * n * (n + 1.0) / 2.0;
    let slid = mean(&sliding, &end.end().u, 0);
    assert!((slid / expected - 1.0).abs() < 1e-4, "{slid} for {expected}");
    let speed = mean(&sliding, end.end().velocity.as_ref().unwrap(), 0);
    assert!((speed / (a * h * n) - 1.0).abs() < 1e-4, "{speed}");
    let sticking = incline(0.55, 1e-3)?;
    let steps = vec![StepTo { dt: h, controls: sticking.controls() }; count];
    let end = advance(&sticking, Trajectory::from_given(resting(&sticking)), &scheme("backward_euler"), &steps)?;
    let creep = mean(&sticking, end.end().velocity.as_ref().unwrap(), 0);
    let expected = 1e-3 * (1.0 - (1.0f64 - 0.5 / 0.55).sqrt());
    assert!((creep / expected - 1.0).abs() < 1e-3, "{creep} for {expected}");
    Ok(())
}

/// A block that falls on the floor comes to rest: the floor carries its weight and the moment of it, to rounding.
#[test]
fn a_fallen_block_is_carried() -> Outcome {
    let solid = Solid::new(regular(CellKind::Hex8, [1.0, 0.6, 0.5], [3, 2, 2])?)?
        .material("body", NeoHooke::new(4e4, 6e4)?)?
        .body_force("body", Vec3::new(0.0, 0.0, -9810.0))?
        .inertia(Inertia::new("body", 1000.0))?
        .rayleigh_damping(0.0, 0.02)?
        .contact(
            Contact::of("floor", "z-", Obstacle::half_space([0.0, 0.0, -0.02], [0.0, 0.0, 1.0])).friction(0.5, 1e-2),
        )?;
    let steps = vec![StepTo { dt: 0.02, controls: solid.controls() }; 200];
    let mut begin = solid.rest();
    begin.velocity = Some(vec![0.0; begin.u.len()].into());
    let end = advance(&solid, Trajectory::from_given(begin), &scheme("backward_euler"), &steps)?;
    let weight = 9810.0 * 0.3;
    let force = quantity(&solid, &end, "force_z");
    assert!((force / weight - 1.0).abs() < 1e-5, "{force} for {weight}");
    assert!(quantity(&solid, &end, "smallest_gap") > 0.0);
    // about the floor's point at the origin: the weight acts at (1/2, 0.3)
    let moment = quantity(&solid, &end, "moment_y");
    assert!((moment / (-0.5 * weight) - 1.0).abs() < 1e-3, "{moment}");
    Ok(())
}

/// Pads lift a block by friction alone, each pressing with N: its weight is carried with `mu N` to spare.
#[test]
fn pads_lift_a_block() -> Outcome {
    let pad = |side: &str, x: f64, outwards: f64| {
        let face = Obstacle::half_space([x, 0.1, 0.1], [-outwards, 0.0, 0.0]);
        Contact::of(side, if outwards > 0.0 { "x+" } else { "x-" }, face).friction(0.8, 1e-2)
    };
    let solid = Solid::new(regular(CellKind::Hex8, [0.2; 3], [2; 3])?)?
        .material("body", NeoHooke::new(4e4, 6e4)?)?
        .body_force("body", Vec3::new(0.0, 0.0, -9810.0))?
        .inertia(Inertia::new("body", 1000.0))?
        .rayleigh_damping(0.0, 0.02)?
        .contact(Contact::of("floor", "z-", Obstacle::half_space([0.0, 0.0, -1e-4], [0.0, 0.0, 1.0])))?
        .contact(pad("left", -1e-3, -1.0))?
        .contact(pad("right", 0.201, 1.0))?;
    let at = |t: f64| -> Controls {
        let mut controls = solid.controls();
        for (block, inwards) in [(1, 1.0), (2, -1.0)] {
            let values = controls.values_mut(block);
            values[0] = inwards * 0.012 * (t / 0.5).min(1.0);
            values[2] = 0.1 * (t - 0.5).max(0.0);
        }
        controls
    };
    let steps: Vec<StepTo> = (1..=150).map(|n| StepTo { dt: 0.01, controls: at(0.01 * f64::from(n)) }).collect();
    let mut begin = solid.rest();
    begin.velocity = Some(vec![0.0; begin.u.len()].into());
    let end = advance(&solid, Trajectory::from_given(begin), &scheme("backward_euler"), &steps)?;
    let lifted = mean(&solid, &end.end().u, 2);
    assert!(lifted > 0.09 && lifted < 0.1, "{lifted}");
    // the step that ended there knows the velocities, on which friction depends
    let states = end.states();
    let step = TimeStep::between(&states[states.len() - 2], end.end());
    let all = solid.model().quantities(&Instant::of(end.end()).in_step(&step))?;
    let of = |name: &str, quantity: &str| all.iter().find(|(n, q, _)| n == name && *q == quantity).unwrap().2;
    let (left, right) = (of("left", "force_x"), of("right", "force_x"));
    assert!(left > 0.0 && (left + right).abs() < 1e-6 * left, "{left} {right}");
    let (lift, weight) = (of("left", "force_z") + of("right", "force_z"), 9810.0 * 0.008);
    assert!((lift / weight - 1.0).abs() < 1e-3, "{lift} for {weight}");
    assert!(of("left", "sticking") == 1.0 && of("left", "sliding_speed") < 1e-2);
    let newton: usize = end.states().iter().skip(1).map(|state| state.report.newton).sum();
    assert!(newton < 6 * 150, "{newton} Newton iterations");
    Ok(())
}

/// A plate that is swept through a strip within one step does not pass it: the strip is pushed along.
#[test]
fn a_fast_obstacle_crosses_nothing() -> Outcome {
    for friction in [false, true] {
        let bar = Obstacle::capsule([1.0, 1.06, -2.0], [1.0, 1.06, 2.0], 0.05);
        let contact = Contact::of("bar", "y+", bar).thickness(0.01).stiffness(1e5);
        let solid = Solid::new(regular(CellKind::Quad4, [2.0, 1.0, 0.0], [8, 4, 1])?)?
            .material("body", NeoHooke::new(4e4, 6e4)?)?
            .clamp("y-")?
            .inertia(Inertia::new("body", 1000.0))?
            .contact(if friction { contact.friction(0.3, 0.1) } else { contact })?;
        let mut controls = solid.controls();
        // three times its width
        controls.values_mut(0)[1] = -0.3;
        let mut begin = solid.rest();
        begin.velocity = Some(vec![0.0; begin.u.len()].into());
        let to = [StepTo { dt: 0.5, controls }];
        let end = advance(&solid, Trajectory::from_given(begin), &scheme("backward_euler"), &to)?;
        assert!(quantity(&solid, &end, "smallest_gap") > -0.01);
        assert!(quantity(&solid, &end, "force_y") < -1.0);
    }
    Ok(())
}

/// A finger, and its mirror image, grips half of a soft block in plane strain and carries it upwards, at speeds that change at every fifth of a
/// second.
#[test]
fn a_finger_carries_a_block_at_changing_speed() -> Outcome {
    const PATH: [[f64; 2]; 6] =
        [[0.0, 0.0], [-5.114, -5.563], [-8.606, -2.181], [-8.089, 6.658], [-8.123, 13.388], [-8.615, 34.545]];
    let mm = 1e-3;
    let ball = Obstacle::Sphere { center: [28.0 * mm, 15.0 * mm, 0.0], radius: 8.0 * mm };
    let floor = Obstacle::half_space([0.0, -0.1 * mm, 0.0], [0.0, 1.0, 0.0]);
    let solid = Solid::new(regular(CellKind::Quad9, [15.0 * mm, 30.0 * mm, 0.0], [4, 8, 0])?)?
        .material("body", NeoHooke::from_young_poisson(5e4, 0.4)?)?
        .displace("x-", [Some(0.0), None, None])?
        .body_force("body", Vec3::new(0.0, -9.81 * 1070.0, 0.0))?
        .inertia(Inertia::new("body", 1070.0))?
        .contact(Contact::of("floor", "y-", floor))?
        .contact(Contact::of("grip", "x+", ball).friction(0.6, 2.0 * mm))?;
    let at = |t: f64| -> Controls {
        let (k, share) = ((t / 0.2 + 1e-9).floor().min(4.0), t / 0.2);
        let [a, b] = [PATH[k as usize], PATH[k as usize + 1]];
        let mut controls = solid.controls();
        let values = controls.values_mut(1);
        (0..2).for_each(|i| values[i] = mm * (a[i] + (share - k) * (b[i] - a[i])));
        controls
    };
    let steps: Vec<StepTo> = (1..=100).map(|n| StepTo { dt: 0.01, controls: at(0.01 * f64::from(n)) }).collect();
    let mut begin = solid.rest();
    begin.velocity = Some(vec![0.0; begin.u.len()].into());
    let end = advance(&solid, Trajectory::from_given(begin), &scheme("backward_euler"), &steps)?;
    let newton: usize = end.states().iter().skip(1).map(|state| state.report.newton).sum();
    assert!(newton < 1000, "{newton} Newton iterations");
    Ok(())
}
