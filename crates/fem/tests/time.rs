//! Motions of bodies: observed orders, free fall, conserved quantities, a vibrating cantilever, what is refused.

use crate::common;

use common::beam::timoshenko;
use common::block::STRICT;
use common::motion::{motion, motion_by, oscillator, schemes, steps, uniform};
use common::{Outcome, distance, largest, nodal, noise, regular};
use nastic_energy::NeoHooke;
use nastic_fem::schemes::SCHEMES;
use nastic_fem::{
    Inertia, Scheme, Solid, SolveOptions, Solver, SolverFactory, State, StateError, StepTo, TimeStepping, Trajectory,
    Workspace,
};
use nastic_mesh::CellKind;
use nastic_tensor::Vec3;
use std::sync::Arc;

fn moving(solid: &Solid, velocity: Vec<f64>) -> State {
    State { velocity: Some(Arc::new(velocity)), ..solid.rest() }
}

fn velocity(state: &State) -> &[f64] {
    state.velocity.as_deref().map_or(&[], Vec::as_slice)
}

#[test]
fn names_of_schemes_are_those_of_their_rows() -> Outcome {
    for row in SCHEMES {
        assert_eq!((row.build)()?.name(), row.name);
        assert!(row.about.ends_with('.'));
    }
    Ok(())
}

/// A plane bar thrown so that it bends and stretches, elastic and with Rayleigh damping: differences of runs with h,
/// h/2 and h/4.
#[test]
fn every_scheme_has_its_order() -> Outcome {
    for damped in [false, true] {
        let mut solid = Solid::new(regular(CellKind::Quad4, [1.0, 0.5, 0.0], [2, 1, 1])?)?
            .material("body", NeoHooke::new(1.0, 2.0)?)?
            .clamp("x-")?
            .inertia(Inertia::new("body", 1.0))?;
        if damped {
            solid = solid.rayleigh_damping(0.1, 0.02)?;
        }
        let thrown = nodal(solid.mesh(), |x| 0.5 * Vec3::new(0.3 * x.x, x.x * x.x, 0.0));
        // two of the eight modes exactly, in the place of the ten that the catalogue has; and all of them
        let others = [(Scheme::siere(2)?, 1), (Scheme::siere(8)?, 2)];
        let general = schemes()?.into_iter().filter(|(scheme, order)| *order > 0 && scheme.exact_modes() == 0);
        for (scheme, order) in &general.chain(others).collect::<Vec<_>>() {
            let end = |count: usize| -> Outcome<Vec<f64>> {
                let run = motion(&solid, scheme, moving(&solid, thrown.clone()), count, 0.8 / count as f64)?;
                Ok(run.end().u.iter().chain(velocity(run.end())).copied().collect())
            };
            let count = if *order == 1 { 400 } else { 80 };
            let [coarse, middle, fine] = [end(count)?, end(2 * count)?, end(4 * count)?];
            assert!(largest(&fine) > 0.1);
            let observed = (distance(&coarse, &middle) / distance(&middle, &fine)).log2();
            println!("{:<24} damped: {damped:<5} order {observed:.3}", scheme.name());
            assert!((observed - *order as f64).abs() < 0.1, "{}, {damped}: {observed}", scheme.name());
        }
    }
    Ok(())
}

/// A free body: velocity g t in every scheme, the place g t^2/2 in those of second order, that of both Euler schemes g h t/2
/// further.
#[test]
fn a_free_body_falls() -> Outcome {
    let (g, h, rho, count) = (9.81, 0.05, 3.0, 20);
    let solid = Solid::new(regular(CellKind::Hex8, [1.0; 3], [1; 3])?)?
        .material("body", NeoHooke::new(1e3, 2e3)?)?
        .inertia(Inertia::new("body", rho))?
        .body_force("body", Vec3::new(0.0, 0.0, -rho * g))?;
    for (scheme, order) in schemes()?.iter().filter(|(_, order)| *order > 0) {
        let run = motion(&solid, scheme, solid.rest(), count, h)?;
        for state in &run.states()[1..] {
            let t = state.time;
            let offset = if scheme.name().ends_with("euler") { 0.5 * g * h * t } else { 0.0 };
            let (u, v) = (-0.5 * g * t * t - offset, -g * t);
            let error = |found: &[f64], expected: f64| -> f64 {
                let wanted = |i: usize| if i % 3 == 2 { expected } else { 0.0 };
                found.iter().enumerate().map(|(i, f)| (f - wanted(i)).abs()).fold(0.0, f64::max) / expected.abs()
            };
            let (of_u, of_v) = (error(&state.u, u), error(velocity(state), v));
            assert!(of_u < 1e-10 && of_v < 1e-10, "{} ({order}), t = {t}: {of_u:e} {of_v:e}", scheme.name());
        }
    }
    Ok(())
}

/// `sum_ab M_ab x_a x v_b` of a free body that turns and vibrates, and its linear momentum.
#[test]
fn the_midpoint_rule_keeps_momenta() -> Outcome {
    let solid = Solid::new(regular(CellKind::Hex8, [1.0, 0.4, 0.3], [2, 1, 1])?)?
        .material("body", NeoHooke::new(10.0, 20.0)?)?
        .inertia(Inertia::new("body", 1.0))?;
    let mass = solid.model().energies().mass()?;
    let momenta = |state: &State| -> [Vec3; 2] {
        let mut p = vec![0.0; state.u.len()];
        mass.multiply(velocity(state), &mut p);
        let (mut linear, mut angular) = (Vec3::zeros(), Vec3::zeros());
        for (a, x) in solid.mesh().points().iter().enumerate() {
            let at = |v: &[f64]| Vec3::new(v[3 * a], v[3 * a + 1], v[3 * a + 2]);
            linear += at(&p);
            angular += (Vec3::from(*x) + at(&state.u)).cross(&at(&p));
        }
        [linear, angular]
    };
    let turn = nodal(solid.mesh(), |x| Vec3::new(0.5, 1.0, 2.0).cross(&x));
    let thrown: Vec<f64> = turn.iter().enumerate().map(|(i, v)| v + 0.5 * noise(i)).collect();
    let drift = |scheme: &Scheme| -> Outcome<f64> {
        let run = motion(&solid, scheme, moving(&solid, thrown.clone()), 120, 0.04)?;
        let [linear, angular] = momenta(&run.states()[0]);
        assert!(run.states()[1..].iter().any(|s| largest(&s.u) > 1.0), "it hardly turns");
        let of = |state: &State| {
            let [p, l] = momenta(state);
            ((p - linear).norm() / linear.norm(), (l - angular).norm() / angular.norm())
        };
        let worst = run.states().iter().map(of).fold((0.0, 0.0), |a: (f64, f64), b| (a.0.max(b.0), a.1.max(b.1)));
        println!("{:<24} linear {:.2e}, angular {:.2e}", scheme.name(), worst.0, worst.1);
        assert!(worst.0 < 1e-12);
        Ok(worst.1)
    };
    assert!(drift(&Scheme::implicit_midpoint())? < 1e-12);
    // others lose it: the test can fail
    assert!(drift(&Scheme::backward_euler())? > 1e-3);
    assert!(drift(&Scheme::trapezoidal())? > 1e-6);
    Ok(())
}

#[test]
fn schemes_without_damping_keep_the_energy_of_linear_problems() -> Outcome {
    for scheme in [Scheme::implicit_midpoint(), Scheme::trapezoidal(), Scheme::generalized_alpha(1.0)?] {
        for w in [0.1, 1.0, 10.0] {
            let solid = oscillator(w, 0.0)?;
            let run = motion(&solid, &scheme, uniform(&solid, 1e-2, 2e-2, None), 200, 1.0)?;
            let free = solid.supports().fixed().iter().position(|fixed| !fixed).ok_or("nothing is free")?;
            let energy = |s: &State| 0.5 * velocity(s)[free].powi(2) + 0.5 * (w * s.u[free]).powi(2);
            let first = energy(&run.states()[0]);
            let worst = run.states().iter().map(|s| (energy(s) / first - 1.0).abs()).fold(0.0, f64::max);
            println!("{:<24} w = {w}: {worst:.2e}", scheme.name());
            assert!(worst < 1e-12, "{}, w = {w}: {worst:e}", scheme.name());
        }
    }
    Ok(())
}

/// A cantilever of slenderness 10: its lowest frequency with the lumped and with the consistent mass, and as it
/// vibrates.
#[test]
fn a_cantilever_vibrates_like_a_timoshenko_beam() -> Outcome {
    let (young, poisson, rho, thick, wide) = (1e6, 0.3, 1000.0, 0.1, 0.12);
    let bare = Solid::new(regular(CellKind::Hex20, [1.0, wide, thick], [8, 1, 1])?)?
        .material("body", NeoHooke::from_young_poisson(young, poisson)?)?
        .clamp("x-")?;
    let lumped = bare.clone().inertia(Inertia::new("body", rho).lumped())?;
    let consistent = bare.inertia(Inertia::new("body", rho))?;
    let lowest = |solid: &Solid| -> Outcome<(f64, Vec<f64>)> {
        let mode = solid.model().vibration_modes(&solid.rest(), 1, &STRICT)?.swap_remove(0);
        Ok((mode.square.sqrt(), mode.shape))
    };
    let ((w, shape), (w_consistent, _)) = (lowest(&lumped)?, lowest(&consistent)?);
    let rest = lumped.rest();
    let (area, inertia) = (wide * thick, wide * thick.powi(3) / 12.0);
    let shear = young / (2.0 * (1.0 + poisson));
    let kappa = 10.0 * (1.0 + poisson) / (12.0 + 11.0 * poisson);
    let b = timoshenko(inertia / area, young * inertia / (kappa * shear * area), 1);
    assert!((timoshenko(1e-12, 1e-12, 1) - 3.5160153).abs() < 1e-6);
    assert!((timoshenko(1e-12, 1e-12, 2) - 22.034492).abs() < 1e-5);
    let expected = b * (young * inertia / (rho * area)).sqrt();
    println!("Timoshenko {expected:.5}, lumped {w:.5}, consistent {w_consistent:.5} rad/s");
    assert!((w / expected - 1.0).abs() < 0.02 && (w_consistent / expected - 1.0).abs() < 0.02);

    // u_{n+1} + u_{n-1} = 2 cos(theta) u_n and w = 2/h tan(theta/2), the trapezoidal rule's own frequency
    let h = std::f64::consts::TAU / w / 50.0;
    let small = State { u: Arc::new(shape.iter().map(|s| 1e-7 * s).collect()), ..rest };
    let run = motion(&lumped, &Scheme::trapezoidal(), small, 20, h)?;
    let tip: Vec<f64> = run.states().iter().map(|s| s.u.iter().zip(&shape).map(|(u, s)| u * s).sum()).collect();
    let cosine = (tip[20] + tip[18]) / (2.0 * tip[19]);
    let seen = 2.0 / h * (0.5 * cosine.acos()).tan();
    println!("seen in motion {seen:.6}, eigenvalue {w:.6} rad/s");
    assert!((seen / w - 1.0).abs() < 1e-5);
    Ok(())
}

/// Long steps of the quasi-dynamic scheme are static.
#[test]
fn long_steps_from_rest_are_equilibria() -> Outcome {
    let solid = Solid::new(regular(CellKind::Hex8, [1.0, 0.3, 0.3], [3, 1, 1])?)?
        .material("body", NeoHooke::new(1e3, 2e3)?)?
        .clamp("x-")?
        .inertia(Inertia::new("body", 1.0))?
        .body_force("body", Vec3::new(0.0, 0.0, -30.0))?;
    let still = solid.solve(&solid.controls(), &STRICT)?;
    let run = motion(&solid, &Scheme::quasi_dynamic(), solid.rest(), 1, 1e6)?;
    assert!(largest(&still.u) > 0.01 && distance(&still.u, &run.end().u) < 1e-9 * largest(&still.u));
    Ok(())
}

/// A trajectory that goes on in another call is that of one call; the bits are the same for any number of threads.
#[test]
fn a_motion_may_be_interrupted() -> Outcome {
    let solid = Solid::new(regular(CellKind::Quad4, [1.0, 0.5, 0.0], [4, 2, 1])?)?
        .material("body", NeoHooke::new(1.0, 2.0)?)?
        .clamp("x-")?
        .inertia(Inertia::new("body", 1.0))?;
    let begin = moving(&solid, nodal(solid.mesh(), |x| 0.5 * Vec3::new(0.0, x.x, 0.0)));
    let serial = SolveOptions { parallel: false, ..STRICT };
    // what moves at the beginning does not go on without inertia
    for (scheme, _) in schemes()?.into_iter().filter(|(scheme, _)| !scheme.is_quasi_static()) {
        let whole = motion(&solid, &scheme, begin.clone(), 6, 0.1)?;
        let again = motion_by(&solid, &scheme, begin.clone(), 6, 0.1, &serial)?;
        assert_eq!(whole.end().u, again.end().u, "{}", scheme.name());
        let mut parts = motion(&solid, &scheme, begin.clone(), 3, 0.1)?;
        let rest = steps(3, 0.1, |_| solid.controls());
        solid.model().advance(&mut parts, &scheme, &rest, &STRICT, &mut Workspace::default())?;
        let gap = distance(&whole.end().u, &parts.end().u);
        assert!(gap < 1e-11, "{}: {gap:e}", scheme.name());
    }
    Ok(())
}

/// Multigrid in the place of a factor, held and free.
#[test]
fn multigrid_moves_bodies_too() -> Outcome {
    let free = Solid::new(regular(CellKind::Hex8, [1.0, 0.4, 0.4], [6, 3, 3])?)?
        .material("body", NeoHooke::new(1.0, 2.0)?)?
        .inertia(Inertia::new("body", 1.0))?;
    let thrown = nodal(free.mesh(), |x| Vec3::new(-x.x * x.z, 0.0, x.x));
    let held = free.clone().clamp("x-")?;
    let schemes = [Scheme::tr_bdf2(), Scheme::linearly_implicit_euler()];
    for (solid, scheme) in [free, held].iter().flat_map(|solid| schemes.iter().map(move |scheme| (solid, scheme))) {
        let of = |solver: &dyn SolverFactory| -> Outcome<Vec<f64>> {
            let how = SolveOptions { solver: Some(solver), ..SolveOptions::default() };
            let run = motion_by(solid, scheme, moving(solid, thrown.clone()), 8, 0.2, &how)?;
            assert_eq!(run.end().report.solver, solver.name());
            Ok(run.end().u.to_vec())
        };
        let (direct, multigrid) = (of(Solver::DIRECT)?, of(Solver::MULTIGRID)?);
        assert!(largest(&direct) > 0.2);
        let gap = distance(&direct, &multigrid) / largest(&direct);
        assert!(gap < 1e-7, "{}: {gap:e}", scheme.name());
    }
    Ok(())
}

/// A free bar that turns by 0.7 rad in a step: Newton's steps turn with it (straight ones take up to three times as
/// many). Linearised steps swell it so that they fail.
#[test]
fn a_free_body_turns_in_long_steps() -> Outcome {
    let solid = Solid::new(regular(CellKind::Hex8, [1.0, 0.1, 0.1], [10, 1, 1])?)?
        .material("body", NeoHooke::new(100.0, 200.0)?)?
        .inertia(Inertia::new("body", 1.0))?;
    let turning = nodal(solid.mesh(), |x| Vec3::new(0.05 - x.y, x.x - 0.5, 0.0));
    for (scheme, _) in schemes()?.iter().filter(|(scheme, order)| *order > 0 && !scheme.is_linearised()) {
        let how = SolveOptions::default();
        let run = motion_by(&solid, scheme, moving(&solid, turning.clone()), 20, 0.7, &how)?;
        let [newton, restarts, cuts] = run.states()[1..]
            .iter()
            .fold([0; 3], |[n, r, c], s| [n + s.report.newton, r + s.report.restarts, c + s.report.cuts]);
        let min_j = run.states()[1..].iter().map(|s| s.report.min_j).fold(f64::INFINITY, f64::min);
        let most = if scheme.extrapolates() { 300 } else { 200 * scheme.stages() };
        assert!(newton <= most && restarts == 0 && cuts == 0, "{}: {newton} iterations", scheme.name());
        println!(
            "{:<24} {newton} Newton iterations, {restarts} restarts, {cuts} cuts, min J {min_j:.3}",
            scheme.name()
        );
    }
    let linearised = Scheme::linearly_implicit_euler();
    let failed = motion_by(&solid, &linearised, moving(&solid, turning), 20, 0.7, &SolveOptions::default());
    let message = failed.err().ok_or("a linearised step")?.to_string();
    assert!(message.contains("shorter steps may help"), "{message}");
    Ok(())
}

#[test]
fn what_cannot_move_is_refused() -> Outcome {
    let bare = Solid::new(regular(CellKind::Hex8, [1.0; 3], [1; 3])?)?
        .material("body", NeoHooke::new(1e3, 2e3)?)?
        .clamp("x-")?;
    let refused = motion(&bare, &Scheme::trapezoidal(), bare.rest(), 1, 0.1).err().ok_or("no mass, no acceleration")?;
    assert!(refused.to_string().contains("no mass"), "{refused}");
    let refused = motion(&bare, &Scheme::backward_euler(), bare.rest(), 1, -0.1).err().ok_or("a negative step")?;
    assert!(refused.to_string().contains("not positive"), "{refused}");
    assert!(Scheme::newmark(0.1, 0.5).is_err() && Scheme::newmark(0.5, 0.4).is_err());
    assert!(Scheme::generalized_alpha(1.1).is_err() && Scheme::generalized_alpha(f64::NAN).is_err());

    let solid = bare.inertia(Inertia::new("body", 1e6))?;
    // a step that one iteration does not solve
    let thrown = moving(&solid, nodal(solid.mesh(), |x| Vec3::new(0.0, x.x, 0.0)));
    let hasty = SolveOptions { max_newton: 1, ..STRICT };
    let failed = motion_by(&solid, &Scheme::backward_euler(), thrown, 1, 1.0, &hasty).err().ok_or("one iteration")?;
    let message = failed.downcast_ref::<StateError>().ok_or("another error")?;
    assert!(matches!(message, StateError::InStep { dt: 1.0, .. }) && message.code() == "no_convergence", "{message}");
    assert!(message.to_string().contains("shorter steps"), "{message}");

    // squeezed so fast that its middle is admissible and its end is not
    let squeezed = moving(&solid, nodal(solid.mesh(), |x| Vec3::new(-1.2 * x.x, 0.0, 0.0)));
    let mut run = Trajectory::from_given(squeezed);
    let step = [StepTo { dt: 1.0, controls: solid.controls() }];
    let failed =
        solid.model().advance(&mut run, &Scheme::implicit_midpoint(), &step, &STRICT, &mut Workspace::default());
    let Err(error @ StateError::EndOfStep { .. }) = failed else { return Err(format!("{failed:?}").into()) };
    assert!(error.code() == "inverted" && error.to_string().contains("shorter steps"), "{error}");
    assert_eq!(run.states().len(), 1);
    Ok(())
}
