//! The way to an equilibrium: how long it is, what it depends on, and what is said where there is none.

#![allow(clippy::panic)] // helpers of tests

use crate::common;

use common::block::STRICT;
use common::{Outcome, distance, largest, regular};
use nastic_energy::{FiberTension, MooneyRivlin};
use nastic_fem::{
    Cause, Controls, ExcessTension, FemError, Solid, SolveOptions, SolveReport, State, StateError, Workspace,
};
use nastic_mesh::CellKind;
use nastic_tensor::Vec3;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// The fibre cantilever of docs/development/verification.md, `5 n x n x n` cells.
fn cantilever(kind: CellKind, n: usize) -> Outcome<Solid> {
    Ok(Solid::new(regular(kind, [1.0, 0.2, 0.2], [5 * n, n, n])?)?
        .material("body", MooneyRivlin::new(1e5, 2e4, 1e6)?)?
        .actuate("body", "tension", FiberTension::along(Vec3::x())?)?
        .clamp("x-")?)
}

/// `m(X) = top Z / 0.2`
fn tension(solid: &Solid, top: f64) -> Outcome<Controls> {
    let mut controls = solid.controls();
    let at = solid.discretization().points().positions(solid.mesh(), None);
    controls.set(0, 0, &at.iter().map(|x| top * x[2] / 0.2).collect::<Vec<_>>())?;
    Ok(controls)
}

/// Norm of the free residual relative to that of the absolute element forces and loads.
fn residual(solid: &Solid, state: &State) -> Outcome<f64> {
    let now = solid.body().evaluate(&state.u, &state.controls, true, true)?;
    let dead = solid.dead_load().iter().map(|d| state.load * d);
    let mut residual: Vec<f64> = now.force.iter().zip(dead.clone()).map(|(f, d)| f - d).collect();
    solid.supports().clear(&mut residual);
    let scale: f64 = now.force_scale.iter().zip(dead).map(|(s, d)| (s + d.abs()).powi(2)).sum();
    Ok((residual.iter().map(|r| r * r).sum::<f64>() / scale).sqrt())
}

/// Four equal steps of plain Newton take 27 (hex8) and 31 (hex27) iterations, and one step diverges without
/// globalisation (docs/development/verification.md).
#[test]
fn the_fiber_cantilever_is_reached_in_one_load_step_or_two() -> Outcome {
    for kind in [CellKind::Hex8, CellKind::Hex20, CellKind::Hex27, CellKind::Tet4, CellKind::Tet10] {
        let solid = cantilever(kind, 2)?;
        let state = solid.solve(&tension(&solid, -1.5e5)?, &SolveOptions::default())?;
        let SolveReport { load_steps, cuts, newton, residual, .. } = state.report;
        println!("{kind:6} {:?}", state.report);
        assert!(load_steps <= 2 && cuts <= 1, "{kind}: {load_steps} load steps, {cuts} cuts");
        assert!(newton <= 12, "{kind}: {newton} iterations");
        assert!(residual <= 1e-10, "{kind}: residual {residual:e}");
        assert_eq!((state.load, solid.negative_pivots(&state)?), (1.0, 0), "{kind}");
    }
    Ok(())
}

#[test]
fn a_state_says_truly_how_good_it_is() -> Outcome {
    let solid = cantilever(CellKind::Hex8, 2)?.traction("x+", Vec3::new(0.0, 0.0, 500.0))?;
    for accuracy in [1e-4, 1e-8, 1e-12] {
        let controls = tension(&solid, -1e5)?;
        let state = solid.solve(&controls, &SolveOptions { accuracy, ..SolveOptions::default() })?;
        let (found, claimed) = (residual(&solid, &state)?, state.report.residual);
        assert!(
            found <= accuracy && (found - claimed).abs() <= 1e-3 * found + 1e-15,
            "{claimed:e} said, {found:e} found"
        );
        let now = solid.body().evaluate(&state.u, &controls, false, true)?;
        let work: f64 = solid.dead_load().iter().zip(&*state.u).map(|(d, u)| d * u).sum();
        assert!((state.report.energy - (now.energy - work)).abs() < 1e-9 * now.energy, "{:?}", state.report);
        let least = solid.discretization().points().kinematics(&state.u)?.iter().map(|k| k.j()).fold(2.0, f64::min);
        assert!((state.report.min_j - least).abs() < 1e-14, "least J {} instead of {least}", state.report.min_j);
        assert_eq!(*state.controls, controls);
    }
    Ok(())
}

#[test]
fn the_bits_do_not_depend_on_the_threads() -> Outcome {
    // more cells than are computed at a time
    let solid = cantilever(CellKind::Hex8, 4)?;
    let controls = tension(&solid, -1.5e5)?;
    let work = |threads: usize, parallel: bool| -> Outcome<_> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build()?;
        let rhs = vec![1.0; solid.rest().u.len()];
        let solve = || -> Result<_, StateError> {
            let how = SolveOptions { parallel, ..SolveOptions::default() };
            let mut workspace = Workspace::default();
            let state = solid.solve_with(&controls, &how, &mut workspace)?;
            let lambda = solid.adjoint_with(&state, &[&rhs], &how, &mut workspace)?.lambda.remove(0);
            Ok((state, lambda))
        };
        let (state, lambda) = pool.install(solve)?;
        let pulled = solid.body().control_vjp(&state.u, &controls, &lambda, parallel)?;
        Ok((state, lambda, pulled))
    };
    let (state, lambda, pulled) = work(1, true)?;
    for (threads, parallel) in [(2, true), (3, true), (2, false)] {
        let (other, other_lambda, other_pulled) = work(threads, parallel)?;
        assert!(state.u == other.u, "{threads} threads: u differs by {:e}", distance(&state.u, &other.u));
        assert_eq!(state.report, other.report, "{threads} threads, parallel {parallel}");
        assert!(lambda == other_lambda && pulled == other_pulled, "{threads} threads, parallel {parallel}");
    }
    Ok(())
}

#[test]
fn a_warm_start_arrives_where_a_cold_one_does() -> Outcome {
    let solid = cantilever(CellKind::Hex8, 2)?.traction("x+", Vec3::new(0.0, 100.0, 0.0))?;
    let cold = solid.solve(&tension(&solid, -1.5e5)?, &STRICT)?;
    let mut workspace = Workspace::default();
    let near = solid.solve_with(&tension(&solid, -1.45e5)?, &SolveOptions::default(), &mut workspace)?;
    let how = SolveOptions { near: Some(&near), ..STRICT };
    let warm = solid.solve_with(&tension(&solid, -1.5e5)?, &how, &mut workspace)?;
    assert!(distance(&cold.u, &warm.u) < 1e-11, "{:e}", distance(&cold.u, &warm.u));
    assert!(warm.report.newton < cold.report.newton, "{:?}, {:?}", warm.report, cold.report);
    assert!(warm.report.reused > 0, "the factor handed in was not used: {:?}", warm.report);
    // at the answer there is nothing left to do
    let again =
        solid.solve(&tension(&solid, -1.5e5)?, &SolveOptions { near: Some(&cold), ..SolveOptions::default() })?;
    assert!(again.report.newton == 0 && again.u == cold.u, "{:?}", again.report);
    Ok(())
}

/// A start that leads nowhere is left for the way from rest; one that is inverted, and one of another body, are refused.
#[test]
fn a_useless_warm_start_does_no_harm() -> Outcome {
    let solid = cantilever(CellKind::Hex8, 2)?;
    let controls = tension(&solid, -1.5e5)?;
    let good = solid.solve(&controls, &STRICT)?;
    let displaced = |amount: f64| {
        let u: Vec<f64> = good.u.iter().enumerate().map(|(n, u)| u + amount * common::noise(n)).collect();
        State { u: u.into(), ..good.clone() }
    };
    let state = solid.solve(&controls, &SolveOptions { near: Some(&displaced(0.02)), ..STRICT })?;
    assert!(distance(&state.u, &good.u) < 1e-11);
    let refused = solid.solve(&controls, &SolveOptions { near: Some(&displaced(0.5)), ..STRICT });
    assert!(matches!(refused, Err(StateError::Start { .. })), "{refused:?}");
    let other = cantilever(CellKind::Hex8, 1)?;
    let refused = solid.solve(&controls, &SolveOptions { near: Some(&other.rest()), ..STRICT });
    assert!(matches!(refused, Err(StateError::Problem(FemError::Length { .. }))), "{refused:?}");
    Ok(())
}

/// Near rest the energy is lost in the rounding of its terms; the way there is still one linear step.
#[test]
fn small_loads_take_few_iterations() -> Outcome {
    for kind in [CellKind::Tri3, CellKind::Quad9, CellKind::Hex8] {
        for size in [1e-3, 1e-5, 1e-7, 1e-9, 1e-11] {
            let solid = Solid::new(regular(kind, [1.0; 3], [2; 3])?)?
                .material("body", MooneyRivlin::new(1.0, 0.2, 5.0)?)?
                .clamp("x-")?
                .traction("x+", Vec3::new(size, size, 0.0))?;
            let report = solid.solve(&solid.controls(), &STRICT)?.report;
            assert!(report.newton <= 6 && report.cuts == 0, "{kind}, load {size:e}: {report:?}");
        }
    }
    Ok(())
}

/// The same body in other units takes the same way: nothing inside knows a metre or a pascal.
#[test]
fn units_do_not_matter() -> Outcome {
    let solve = |length: f64, pressure: f64| -> Outcome<State> {
        let mesh = regular(CellKind::Hex8, [1.0, 0.2, 0.2], [10, 2, 2])?.scaled(length)?;
        let solid = Solid::new(mesh)?
            .material("body", MooneyRivlin::new(1e5 * pressure, 2e4 * pressure, 1e6 * pressure)?)?
            .actuate("body", "tension", FiberTension::along(Vec3::x())?)?
            .clamp("x-")?
            .displace("x+", [None, Some(0.05 * length), None])?
            .traction("x+", Vec3::new(0.0, 0.0, -300.0 * pressure))?
            .body_force("body", Vec3::new(0.0, 0.0, -500.0 * pressure / length))?;
        let mut controls = tension(&solid, -1.5e5 * pressure)?;
        controls.values_mut(0).iter_mut().for_each(|m| *m /= length);
        Ok(solid.solve(&controls, &SolveOptions::default())?)
    };
    let metres = solve(1.0, 1.0)?;
    for (length, pressure) in [(1e3, 1e-6), (1e-3, 1.0), (1e6, 1e9), (1e-6, 1e-12)] {
        let other = solve(length, pressure)?;
        let u: Vec<f64> = other.u.iter().map(|u| u / length).collect();
        let what = format!("lengths times {length:e}, pressures times {pressure:e}");
        assert!(distance(&u, &metres.u) < 1e-9, "{what}: u differs by {:e}", distance(&u, &metres.u));
        let (found, expected) = (other.report, metres.report);
        assert_eq!(
            (found.newton, found.load_steps, found.cuts),
            (expected.newton, expected.load_steps, expected.cuts),
            "{what}"
        );
        let energy = found.energy / (length.powi(3) * pressure);
        assert!((energy - expected.energy).abs() < 1e-9 * expected.energy.abs(), "{what}: energy {energy}");
    }
    Ok(())
}

/// The last equilibrium on the way: short of the load asked for, but a true one.
fn assert_last_good(solid: &Solid, error: &StateError, controls: &Controls) -> Outcome {
    let (load, last) = match error {
        StateError::Inadmissible { load, last, .. } | StateError::NoConvergence { load, last, .. } => (*load, last),
        other => panic!("{other}"),
    };
    assert!((0.0..1.0).contains(&last.load) && last.load <= load && load <= 1.0, "{} of {load}", last.load);
    assert!(last.load > 0.0, "nothing was reached: {error}");
    assert_eq!(*last.controls, solid.controls().blend(controls, last.load));
    assert!(residual(solid, last)? <= 1e-9, "{:e}", residual(solid, last)?);
    assert!(last.report.min_j > 0.0);
    Ok(())
}

/// Beyond `2 mu1` the energy of a free fibre has no lower bound.
#[test]
fn a_tension_beyond_the_bound_ends_in_a_typed_error() -> Outcome {
    let solid = cantilever(CellKind::Hex8, 1)?;
    let mut controls = solid.controls();
    controls.values_mut(0).fill(2e6);
    let error =
        solid.solve(&controls, &SolveOptions::default()).err().ok_or("an unbounded energy found its minimum")?;
    assert_last_good(&solid, &error, &controls)?;
    let StateError::NoConvergence { newton, cause: Cause::Convexity(excess), .. } = &error else { panic!("{error}") };
    let ExcessTension { actuation, tension, limit, beside } = excess;
    assert_eq!((actuation.as_str(), *tension, beside.len()), ("tension", 2e6, 0));
    assert!((*limit - 2e5).abs() < 1.0 && *newton < 600, "{newton} iterations, limit {limit}");
    Ok(())
}

/// The far end is to pass through the near one.
#[test]
fn a_displacement_through_itself_ends_in_a_typed_error() -> Outcome {
    let solid = cantilever(CellKind::Hex8, 1)?.displace("x+", [Some(-1.5), Some(0.0), Some(0.0)])?;
    let controls = solid.controls();
    let error = solid.solve(&controls, &SolveOptions::default()).err().ok_or("the body passed through itself")?;
    assert_last_good(&solid, &error, &controls)
}

#[test]
fn a_cancelled_solve_stops_at_once() -> Outcome {
    let solid = cantilever(CellKind::Hex8, 2)?;
    let controls = tension(&solid, -1.5e5)?;
    let (flag, count) = (AtomicBool::new(true), AtomicUsize::new(0));
    let watch = |_: &nastic_fem::Progress| {
        if count.fetch_add(1, Ordering::Relaxed) == 1 {
            flag.store(true, Ordering::Relaxed);
        }
    };
    let how = SolveOptions { cancel: Some(&flag), watch: Some(&watch), ..SolveOptions::default() };
    let error = solid.solve(&controls, &how).err();
    assert!(matches!(error, Some(StateError::Cancelled)), "{error:?}");
    assert_eq!(count.load(Ordering::Relaxed), 0);
    // later, and on the way from a state, which must not be taken for a bad start
    flag.store(false, Ordering::Relaxed);
    let near = solid.solve(&tension(&solid, -0.5e5)?, &SolveOptions::default())?;
    let error = solid.solve(&controls, &SolveOptions { near: Some(&near), ..how }).err();
    assert!(matches!(error, Some(StateError::Cancelled)), "{error:?}");
    assert_eq!(count.load(Ordering::Relaxed), 2);
    Ok(())
}

#[test]
fn progress_is_told_after_every_iteration() -> Outcome {
    let solid = cantilever(CellKind::Hex8, 1)?;
    let seen = std::sync::Mutex::new(Vec::new());
    let watch = |p: &nastic_fem::Progress| {
        if let Ok(mut seen) = seen.lock() {
            seen.push(*p);
        }
    };
    let how = SolveOptions { watch: Some(&watch), ..SolveOptions::default() };
    let state = solid.solve(&tension(&solid, -1.5e5)?, &how)?;
    let seen = seen.into_inner()?;
    assert_eq!(seen.iter().map(|p| p.newton).collect::<Vec<_>>(), (1..=state.report.newton).collect::<Vec<_>>());
    let last = seen.last().ok_or("nothing was told")?;
    assert_eq!((last.load, last.residual, last.energy), (1.0, state.report.residual, state.report.energy));
    assert!(largest(&state.u) > 0.1);
    Ok(())
}

/// A guess shortens the way and decides nothing else; a bad one costs a little work.
#[test]
fn a_guess_shortens_the_way_and_a_bad_one_does_no_harm() -> Outcome {
    let solid = cantilever(CellKind::Hex8, 2)?;
    let near = solid.solve(&tension(&solid, -1.2e5)?, &SolveOptions::default())?;
    let controls = tension(&solid, -1.5e5)?;
    let without = solid.solve(&controls, &SolveOptions::near(&near))?;
    let from = |guess: &[f64]| -> Outcome<State> {
        Ok(solid.solve(&controls, &SolveOptions { guess: Some(guess), ..SolveOptions::near(&near) })?)
    };
    let size = largest(&without.u);

    let exact = from(&without.u)?;
    assert_eq!((exact.report.newton, exact.report.factorisations), (0, 0), "{:?}", exact.report);
    let close: Vec<f64> = without.u.iter().zip(near.u.iter()).map(|(u, v)| u + 0.01 * (v - u)).collect();
    let found = from(&close)?;
    assert!(found.report.newton < without.report.newton, "{:?}, {:?}", found.report, without.report);
    assert!(distance(&found.u, &without.u) <= 1e-9 * size);
    let alone = solid.solve(&controls, &SolveOptions { guess: Some(&close), ..SolveOptions::default() })?;
    assert_eq!((alone.report.newton, alone.load), (found.report.newton, 1.0));

    assert!(matches!(
        from(&close[..5]).unwrap_err().downcast_ref(),
        Some(StateError::Problem(FemError::Length { .. }))
    ));
    // inside out, not a number: as without
    let inside_out: Vec<f64> = without.u.iter().map(|u| -20.0 * u).collect();
    let no_number = vec![f64::NAN; without.u.len()];
    for bad in [&inside_out, &no_number] {
        let found = from(bad)?;
        assert!(distance(&found.u, &without.u) <= 1e-9 * size);
        assert_eq!(found.load, 1.0);
    }
    Ok(())
}
