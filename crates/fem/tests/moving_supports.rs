//! Surfaces that controls move in time: against closed forms, in every scheme, with the derivative by what moves them.

#![allow(clippy::unwrap_used)] // helpers of tests

use crate::common;

use common::block::STRICT;
use common::motion::schemes_with_moving_supports;
use common::{Outcome, regular};
use nastic_energy::NeoHooke;
use nastic_fem::{
    Controls, Inertia, MovingSupport, Scheme, Solid, SolveOptions, State, StepTo, TimeStepping, Tolerance, Trajectory,
    Workspace,
};
use nastic_mesh::CellKind;
use nastic_tensor::Vec3;
use std::sync::Arc;

/// Controls of the motion "base" alone.
fn base(solid: &Solid, values: [f64; 6]) -> Controls {
    let mut controls = solid.controls();
    controls.values_mut(block(solid, "base")).copy_from_slice(&values);
    controls
}

fn block(solid: &Solid, name: &str) -> usize {
    solid.model().controllable().iter().position(|known| known.name == name).unwrap()
}

fn advance(solid: &Solid, scheme: &Scheme, begin: Trajectory, steps: &[StepTo]) -> Outcome<Trajectory> {
    let mut run = begin;
    solid.model().advance(&mut run, scheme, steps, &STRICT, &mut Workspace::default())?;
    Ok(run)
}

/// Steps of one length from t = 0 with the base where `values` say.
fn steps(solid: &Solid, count: usize, h: f64, values: impl Fn(f64) -> [f64; 6]) -> Vec<StepTo> {
    (1..=count).map(|n| StepTo { dt: h, controls: base(solid, values(n as f64 * h)) }).collect()
}

fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).fold(0.0, |most, (a, b)| (a - b).abs().max(most))
}

// -- a mass on a spring that is driven at its base

const AMPLITUDE: f64 = 1e-6;
const SHAKEN: f64 = 1.3;
/// Young's modulus, density: a bar of unit length and area, in one cell.
const YOUNG: f64 = 6.0;
const RHO: f64 = 3.0;

/// Without Poisson's effect, so that the bar's far end is one unknown q:
/// `(m/3) (q'' + a0 q') + k (q + a1 q') = -(m/6) (b'' + a0 b') + k (b + a1 b')`, b the displacement of the base, `m = rho`, `k = E`.
fn mass_on_a_spring((a0, a1): (f64, f64)) -> Outcome<Solid> {
    let solid = Solid::new(regular(CellKind::Hex8, [1.0; 3], [1; 3])?)?
        .material("body", NeoHooke::new(0.5 * YOUNG, 0.0)?)?
        .motion(MovingSupport::of("base", "x-"))?
        .inertia(Inertia::new("body", RHO))?;
    Ok(if a0 + a1 > 0.0 { solid.rayleigh_damping(a0, a1)? } else { solid })
}

/// `b = A (1 - cos(w t))`, with its first and second derivative.
fn shaken(t: f64) -> [f64; 3] {
    let (sin, cos) = (SHAKEN * t).sin_cos();
    [AMPLITUDE * (1.0 - cos), AMPLITUDE * SHAKEN * sin, AMPLITUDE * SHAKEN * SHAKEN * cos]
}

/// q and q' at an instant, from rest: the closed form without damping, with it the scalar equation in 20000 steps of Runge and Kutta.
fn driven((a0, a1): (f64, f64), end: f64) -> [f64; 2] {
    let (m, k) = (RHO, YOUNG);
    if a0 + a1 == 0.0 {
        let own = (3.0 * k / m).sqrt();
        let forced = -AMPLITUDE * (k + m * SHAKEN * SHAKEN / 6.0) / (k - m * SHAKEN * SHAKEN / 3.0);
        let free = -AMPLITUDE - forced;
        let (shake, swing) = ((SHAKEN * end).sin_cos(), (own * end).sin_cos());
        return [AMPLITUDE + forced * shake.1 + free * swing.1, -SHAKEN * forced * shake.0 - own * free * swing.0];
    }
    let rate = |t: f64, [q, v]: [f64; 2]| {
        let [b, db, ddb] = shaken(t);
        let load = -m / 6.0 * (ddb + a0 * db) + k * (b + a1 * db);
        [v, 3.0 / m * (load - k * (q + a1 * v)) - a0 * v]
    };
    let (h, mut y) = (end / 20_000.0, [0.0; 2]);
    let moved = |y: [f64; 2], d: [f64; 2], s: f64| [y[0] + s * d[0], y[1] + s * d[1]];
    for n in 0..20_000 {
        let t = h * f64::from(n);
        let a = rate(t, y);
        let b = rate(t + 0.5 * h, moved(y, a, 0.5 * h));
        let c = rate(t + 0.5 * h, moved(y, b, 0.5 * h));
        let d = rate(t + h, moved(y, c, h));
        y = [0, 1].map(|i| y[i] + h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]));
    }
    y
}

/// The order of every scheme. Those of several stages take the base to move at constant speed in a step, as the controls do: its speed at
/// the end is that of half a step before, and the velocity beside it of first order with it.
#[test]
fn a_mass_driven_at_its_base_moves_as_the_closed_form_says() -> Outcome {
    let end = 2.0;
    for damping in [(0.0, 0.0), (0.05, 0.1)] {
        let solid = mass_on_a_spring(damping)?;
        let far = solid.mesh().points().iter().position(|x| x[0] > 0.5).ok_or("no end")?;
        let [q, v] = driven(damping, end);
        for (scheme, order) in schemes_with_moving_supports()?.into_iter().filter(|(_, order)| *order > 0) {
            let error = |count: usize| -> Outcome<[f64; 2]> {
                let h = end / count as f64;
                let values = |t: f64| [shaken(t)[0], 0.0, 0.0, 0.0, 0.0, 0.0];
                let begin = Trajectory::from_given(solid.rest());
                let run = advance(&solid, &scheme, begin, &steps(&solid, count, h, values))?;
                let velocity = run.end().velocity.as_ref().ok_or("no velocity")?;
                Ok([(run.end().u[3 * far] - q).abs() / AMPLITUDE, (velocity[3 * far] - v).abs() / AMPLITUDE])
            };
            let (coarse, fine) = (error(160)?, error(320)?);
            let rates = [0, 1].map(|i| (coarse[i] / fine[i]).log2());
            println!(
                "{:<24} {damping:?}: errors of u and v {:.1e} {:.1e}, orders {rates:.2?}",
                scheme.name(),
                fine[0],
                fine[1]
            );
            let order = order as f64;
            assert!((rates[0] - order).abs() < 0.1, "{}, {damping:?}: {rates:?}", scheme.name());
            let of_velocity = if scheme.stages() > 1 { 1.0 } else { order };
            assert!((rates[1] - of_velocity).abs() < 0.1, "{}, {damping:?}: {rates:?}", scheme.name());
            assert!(fine[0] < if order > 1.0 { 3e-4 } else { 0.03 }, "{}, {damping:?}: {fine:?}", scheme.name());
        }
    }
    Ok(())
}

/// Steps of adaptive length, to errors of the size that was asked for.
#[test]
fn adaptive_steps_follow_a_base() -> Outcome {
    let solid = mass_on_a_spring((0.0, 0.0))?;
    let far = solid.mesh().points().iter().position(|x| x[0] > 0.5).ok_or("no end")?;
    let (end, q) = (6.0, driven((0.0, 0.0), 6.0)[0]);
    let run = |error: f64| -> Outcome<(f64, usize)> {
        let mut run = Trajectory::from_given(solid.rest());
        let tolerance = Tolerance { error: error * AMPLITUDE, first: None, longest: None };
        let controls = |t: f64| Ok(base(&solid, [shaken(t)[0], 0.0, 0.0, 0.0, 0.0, 0.0]));
        let report = solid.model().advance_adaptively(
            &mut run,
            &Scheme::tr_bdf2(),
            (&[end], tolerance),
            &controls,
            &STRICT,
            &mut Workspace::default(),
        )?;
        Ok(((run.end().u[3 * far] - q).abs() / AMPLITUDE, report.accepted))
    };
    let ((coarse, few), (fine, many)) = (run(1e-2)?, run(1e-3)?);
    println!("errors {coarse:.2e} in {few} steps, {fine:.2e} in {many} steps");
    assert!(coarse < 1e-2 * few as f64 && fine < 0.3 * coarse && many > few && many < 2000);
    Ok(())
}

// -- the body in the frame of its base

/// A base that rises with constant acceleration is weight, to any deformation: in the frame of the base the midpoint rule makes the same
/// motion.
#[test]
fn a_base_that_rises_faster_and_faster_is_weight() -> Outcome {
    let (h, a) = (0.05, 9.81);
    let body = || -> Outcome<Solid> {
        Ok(Solid::new(regular(CellKind::Quad9, [1.0, 0.1, 0.0], [5, 1, 1])?)?
            .material("body", NeoHooke::new(2e5, 3e5)?)?
            .inertia(Inertia::new("body", 1e3))?)
    };
    let (lifted, held) = (body()?.motion(MovingSupport::of("base", "x-"))?, body()?.clamp("x-")?);
    let held = held.body_force("body", Vec3::new(0.0, -1e3 * a, 0.0))?;
    let values = |t: f64| [0.0, 0.5 * a * t * t, 0.0, 0.0, 0.0, 0.0];
    let scheme = Scheme::implicit_midpoint();
    let lifted = advance(&lifted, &scheme, Trajectory::from_given(lifted.rest()), &steps(&lifted, 12, h, values))?;
    let still: Vec<StepTo> = (0..12).map(|_| StepTo { dt: h, controls: held.controls() }).collect();
    let held = advance(&held, &scheme, Trajectory::from_given(held.rest()), &still)?;
    let mut lowest: f64 = 0.0;
    for (n, (lifted, held)) in lifted.states().iter().zip(held.states()).enumerate() {
        let rise = [0.0, values(h * n as f64)[1]];
        let expected: Vec<f64> = held.u.iter().enumerate().map(|(i, u)| u + rise[i % 2]).collect();
        let gap = largest_difference(&expected, &lifted.u);
        assert!(gap < 1e-9, "instant {n}: {gap:e}");
        lowest = held.u.iter().copied().fold(lowest, f64::min);
    }
    println!("the bar hangs down by up to {:.3} of its length", -lowest);
    assert!(lowest < -0.25);
    Ok(())
}

/// A step that Newton's method does not find at once is found in parts, along the way of the controls: the end is the same.
#[test]
fn a_step_of_a_base_may_be_found_in_parts() -> Outcome {
    let solid = bar()?;
    let far = [StepTo { dt: 2.0, controls: base(&solid, [0.4, 0.9, 0.0, 0.0, 0.0, 2.4]) }];
    for (scheme, _) in schemes_with_moving_supports()?.into_iter().filter(|(scheme, _)| !scheme.is_linearised()) {
        let end = |max_newton: usize| -> Outcome<State> {
            let (mut run, how) = (Trajectory::from_given(solid.rest()), SolveOptions { max_newton, ..STRICT });
            solid.model().advance(&mut run, &scheme, &far, &how, &mut Workspace::default())?;
            Ok(run.end().clone())
        };
        let (full, in_parts) = (end(60)?, end(4)?);
        let gap = largest_difference(&full.u, &in_parts.u);
        println!("{:<24} {} cuts, {gap:.1e}", scheme.name(), in_parts.report.cuts);
        let found_in_parts = in_parts.report.cuts > 0 || scheme.name() == "implicit_midpoint";
        assert!(found_in_parts, "{}", scheme.name());
        assert!(gap < 1e-11, "{}: {gap:e}", scheme.name());
    }
    Ok(())
}

// -- rigid motions

fn bar() -> Outcome<Solid> {
    Ok(Solid::new(regular(CellKind::Hex8, [2.0, 0.5, 0.5], [4, 1, 1])?)?
        .material("body", NeoHooke::new(40.0, 60.0)?)?
        .motion(MovingSupport::of("base", "x-").about([0.3, -0.2, 0.1]))?
        .inertia(Inertia::new("body", 1.0))?)
}

/// A body that moves with its base at constant velocity from the beginning: no scheme sees a force.
#[test]
fn a_body_moves_along_with_its_base() -> Outcome {
    let (solid, h) = (bar()?, 0.05);
    let v = [0.3, -0.2, 0.7];
    for (scheme, _) in schemes_with_moving_supports()?.into_iter().filter(|(_, order)| *order > 0) {
        let velocity = Some(Arc::new(v.repeat(solid.mesh().points().len())));
        let begin = Trajectory::from_given(State { velocity, ..solid.rest() });
        let values = |t: f64| [v[0] * t, v[1] * t, v[2] * t, 0.0, 0.0, 0.0];
        let run = advance(&solid, &scheme, begin, &steps(&solid, 10, h, values))?;
        for (n, state) in run.states().iter().enumerate() {
            let moved = v.map(|v| v * h * n as f64).repeat(solid.mesh().points().len());
            let gap = largest_difference(&state.u, &moved);
            assert!(gap < 1e-12, "{}, instant {n}: {gap:e}", scheme.name());
        }
    }
    Ok(())
}

/// Without inertia a body goes with a base that turns, without strain, to far from small angles.
#[test]
fn a_body_turns_with_its_base() -> Outcome {
    let solid = bar()?;
    let values = |t: f64| [0.1 * t, -0.2 * t, 0.05 * t, 1.1 * t, 0.5 * t, -0.8 * t];
    let begin = Trajectory::from(solid.solve(&solid.controls(), &STRICT)?);
    let run = advance(&solid, &Scheme::quasi_static(), begin, &steps(&solid, 8, 0.25, values))?;
    for (n, state) in run.states().iter().enumerate() {
        let at = values(0.25 * n as f64);
        let [shift, theta] = [Vec3::new(at[0], at[1], at[2]), Vec3::new(at[3], at[4], at[5])];
        let centre = Vec3::new(0.3, -0.2, 0.1);
        for (node, x) in solid.mesh().points().iter().enumerate() {
            let arm = Vec3::from(*x) - centre;
            let expected = shift + turned(arm, theta) - arm;
            let found = Vec3::new(state.u[3 * node], state.u[3 * node + 1], state.u[3 * node + 2]);
            assert!((found - expected).norm() < 1e-11, "instant {n}, node {node}: {:e}", (found - expected).norm());
        }
    }
    Ok(())
}

/// By the quaternion of the rotation vector.
fn turned(x: Vec3, theta: Vec3) -> Vec3 {
    let angle = theta.norm();
    if angle == 0.0 {
        return x;
    }
    let (q, w) = ((0.5 * angle).sin() / angle * theta, (0.5 * angle).cos());
    x + 2.0 * q.cross(&(q.cross(&x) + w * x))
}

/// The surface is where the controls hold it at every instant of every scheme, however long the motion.
#[test]
fn the_surface_is_in_its_place_at_every_instant() -> Outcome {
    let (solid, h, count) = (bar()?, 0.05, 60);
    let values = |t: f64| {
        let wave = |w: f64| (w * t).sin() * t / (1.0 + t);
        [0.1 * wave(3.0), -0.2 * wave(2.0), 0.1 * wave(5.0), 0.3 * wave(2.0), 0.2 * wave(3.0), -0.5 * wave(1.0)]
    };
    let held: Vec<usize> =
        (0..).zip(solid.mesh().points()).filter(|(_, x)| x[0] < 1e-9).map(|(node, _)| node).collect();
    for (scheme, _) in schemes_with_moving_supports()? {
        let begin = Trajectory::from_given(solid.rest());
        let run = advance(&solid, &scheme, begin, &steps(&solid, count, h, values))?;
        for (n, state) in run.states().iter().enumerate() {
            let at = values(h * n as f64);
            for &node in &held {
                let arm = Vec3::from(solid.mesh().points()[node]) - Vec3::new(0.3, -0.2, 0.1);
                let expected = Vec3::new(at[0], at[1], at[2]) + turned(arm, Vec3::new(at[3], at[4], at[5])) - arm;
                let found = Vec3::new(state.u[3 * node], state.u[3 * node + 1], state.u[3 * node + 2]);
                let gap = (found - expected).norm();
                assert!(gap < 1e-13, "{}, instant {n}: {gap:e}", scheme.name());
            }
        }
    }
    Ok(())
}

/// Of a base with constant acceleration `tr_bdf2` sees the mean speed of a step, and at its end -5 times the acceleration.
#[test]
fn tr_bdf2_takes_a_base_to_move_at_constant_speed_in_a_step() -> Outcome {
    let (solid, h, a) = (mass_on_a_spring((0.0, 0.0))?, 0.1, 1e-6);
    let values = |t: f64| [0.5 * a * t * t, 0.0, 0.0, 0.0, 0.0, 0.0];
    let run = advance(&solid, &Scheme::tr_bdf2(), Trajectory::from_given(solid.rest()), &steps(&solid, 4, h, values))?;
    let foot = solid.mesh().points().iter().position(|x| x[0] < 0.5).ok_or("no base")?;
    let (Some(v), Some(found)) = (&run.end().velocity, &run.end().acceleration) else { return Err("no rates".into()) };
    assert!((v[3 * foot] / (3.5 * h * a) - 1.0).abs() < 1e-9, "{:e}", v[3 * foot]);
    assert!((found[3 * foot] / (-5.0 * a) - 1.0).abs() < 1e-9, "{:e}", found[3 * foot]);
    Ok(())
}

/// What supports prescribe, and a body at rest has not, is there from the end of the first step on.
#[test]
fn prescribed_displacements_are_there_after_one_step() -> Outcome {
    let solid = Solid::new(regular(CellKind::Quad4, [2.0, 0.5, 0.0], [4, 1, 1])?)?
        .material("body", NeoHooke::new(40.0, 60.0)?)?
        .displace("x-", [Some(0.1), Some(0.0), None])?
        .inertia(Inertia::new("body", 1.0))?;
    let still: Vec<StepTo> = (0..5).map(|_| StepTo { dt: 0.05, controls: solid.controls() }).collect();
    for (scheme, _) in schemes_with_moving_supports()? {
        let run = advance(&solid, &scheme, Trajectory::from_given(solid.rest()), &still)?;
        for state in &run.states()[1..] {
            let held = solid.supports().fixed().iter().zip(solid.supports().values()).zip(state.u.iter());
            let gap = held.filter(|((fixed, _), _)| **fixed).fold(0.0, |most, ((_, v), u)| (u - v).abs().max(most));
            assert!(gap < 1e-15, "{} at t = {}: {gap:e}", scheme.name(), state.time);
        }
    }
    Ok(())
}

#[test]
fn a_base_that_is_elsewhere_at_the_beginning_is_refused() -> Outcome {
    let solid = bar()?;
    let at = |x: f64| base(&solid, [x, 0.0, 0.0, 0.0, 0.0, 0.0]);
    let begin = Trajectory::from_given(State { controls: Arc::new(at(0.01)), ..solid.rest() });
    let to = [StepTo { dt: 0.1, controls: at(0.02) }];
    let refused = advance(&solid, &Scheme::tr_bdf2(), begin, &to).err().ok_or("no error")?.to_string();
    assert!(
        refused.contains("\"base\"") && refused.contains("1.000e-2") && refused.contains("equilibrium"),
        "{refused}"
    );
    Ok(())
}
