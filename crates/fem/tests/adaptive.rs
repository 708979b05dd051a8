//! Steps whose lengths follow an estimate of their error.

use crate::common;

use common::block::STRICT;
use common::motion::{oscillator, uniform};
use common::{Outcome, distance, largest, noise, regular};
use nastic_energy::{FiberTension, NeoHooke};
use nastic_fem::{
    Controls, Inertia, Scheme, Solid, SolveOptions, State, StatePartials, StepTo, TimeStepping, Tolerance, Trajectory,
    Workspace,
};
use nastic_mesh::CellKind;
use nastic_tensor::Vec3;

const SERIAL: SolveOptions = SolveOptions { parallel: false, ..STRICT };

fn tolerance(error: f64) -> Tolerance {
    Tolerance { error, first: None, longest: None }
}

/// A point mass on a spring from rest at 1: the sum of the steps' errors, and with it the error at the end, goes like the tolerance to the
/// power 2/3, the number of steps like -1/3.
#[test]
fn errors_follow_the_tolerance() -> Outcome {
    let (w, end) = (2.0, 10.0);
    let solid = oscillator(w, 0.0)?;
    let free = solid.supports().fixed().iter().position(|fixed| !fixed).ok_or("no free unknown")?;
    let run = |error: f64| -> Outcome<(f64, usize)> {
        let mut trajectory = Trajectory::from_given(uniform(&solid, 1.0, 0.0, None));
        let report = solid.model().advance_adaptively(
            &mut trajectory,
            &Scheme::tr_bdf2(),
            (&[3.0, end], tolerance(error)),
            &|_| Ok(solid.controls()),
            &SERIAL,
            &mut Workspace::default(),
        )?;
        assert_eq!(report.accepted, trajectory.states().len() - 1);
        assert!(trajectory.states().iter().any(|state| state.time == 3.0) && trajectory.end().time == end);
        assert!(report.rejected < report.accepted / 10 + 3, "{report:?}");
        Ok(((trajectory.end().u[free] - (w * end).cos()).abs(), report.accepted))
    };
    let (coarse, few) = run(1e-4)?;
    let (fine, many) = run(1e-6)?;
    println!("errors {coarse:.2e} in {few} steps, {fine:.2e} in {many} steps");
    assert!((coarse / fine / 21.5).ln().abs() < 0.5f64.ln().abs(), "{coarse:e} {fine:e}");
    assert!((many as f64 / few as f64 / 4.64 - 1.0).abs() < 0.3, "{few} {many}");
    // an error of the step's own size: h^3 w^3 / 24 at most 1e-4, about 25 steps per period
    assert!(coarse < few as f64 * 1e-4 && coarse > 1e-4, "{coarse:e}");
    Ok(())
}

fn bar() -> Outcome<Solid> {
    Ok(Solid::new(regular(CellKind::Hex8, [1.0, 0.2, 0.2], [4, 1, 1])?)?
        .material("body", NeoHooke::new(1e3, 2e3)?)?
        .actuate("body", "tension", FiberTension::along(Vec3::x())?)?
        .clamp("x-")?
        .inertia(Inertia::new("body", 1.0))?
        .rayleigh_damping(0.5, 1e-3)?)
}

fn pulled(solid: &Solid, tension: f64) -> Controls {
    let mut controls = solid.controls();
    controls.values_mut(0).fill(tension);
    controls
}

/// A pulse within a long rest: long steps, short ones, long ones; and the derivative by the controls of these steps.
#[test]
fn steps_are_short_where_something_happens() -> Outcome {
    let solid = bar()?;
    let pulse = |t: f64| -400.0 * (-((t - 1.0) / 0.05).powi(2)).exp();
    let mut trajectory = Trajectory::from_given(State { controls: pulled(&solid, pulse(0.0)).into(), ..solid.rest() });
    let model = solid.model();
    let report = model.advance_adaptively(
        &mut trajectory,
        &Scheme::tr_bdf2(),
        (&[0.8, 3.0], Tolerance { error: 1e-5, first: Some(0.01), longest: Some(0.1) }),
        &|t| Ok(pulled(&solid, pulse(t))),
        &STRICT,
        &mut Workspace::default(),
    )?;
    let times: Vec<f64> = trajectory.states().iter().map(|state| state.time).collect();
    let longest = |from: f64, to: f64| -> f64 {
        let own = times.windows(2).filter(|pair| pair[0] >= from && pair[1] <= to);
        own.map(|pair| pair[1] - pair[0]).fold(0.0, f64::max)
    };
    let (before, within) = (longest(0.0, 0.8), longest(0.9, 1.1));
    println!("{report:?}: steps up to {before:.3} before, {within:.4} within");
    assert!(within > 0.0 && before > 5.0 * within && largest(&trajectory.end().u) < 0.05, "{before} {within}");

    // the same steps by `advance`: the same states, and a derivative that differences confirm
    let n = times.len() / 2;
    let run = |change: f64| -> Outcome<Trajectory> {
        let of = |k: usize| pulled(&solid, pulse(times[k]) + if k == n { change } else { 0.0 });
        let mut again = Trajectory::from_given(State { controls: of(0).into(), ..solid.rest() });
        let steps: Vec<StepTo> =
            (1..times.len()).map(|k| StepTo { dt: times[k] - times[k - 1], controls: of(k) }).collect();
        model.advance(&mut again, &Scheme::tr_bdf2(), &steps, &STRICT, &mut Workspace::default())?;
        Ok(again)
    };
    let gap = distance(&run(0.0)?.end().u, &trajectory.end().u);
    assert!(gap < 1e-9, "{gap:e}");
    let weights: Vec<f64> =
        (0..trajectory.end().u.len()).map(|i| if i % 3 == 0 { 1.0 } else { 0.1 * noise(i) }).collect();
    let mut partials = vec![StatePartials::default(); times.len()];
    partials[times.len() - 1] = StatePartials::by_displacement(weights.clone());
    let swept = model.reverse_sweep(&trajectory, &partials, &STRICT, &mut Workspace::default())?;
    let slope: f64 = swept.controls[n].values(0).iter().sum();
    let value =
        |change: f64| -> Outcome<f64> { Ok(run(change)?.end().u.iter().zip(&weights).map(|(u, w)| u * w).sum()) };
    let difference = |change: f64| -> Outcome<f64> { Ok(value(change)? - value(-change)?) };
    let expected = (8.0 * difference(20.0)? - difference(40.0)?) / 240.0;
    assert!((slope / expected - 1.0).abs() < 1e-4, "{slope:e} {expected:e}");
    Ok(())
}

#[test]
fn what_adaptive_steps_cannot_do_is_said() -> Outcome {
    let solid = bar()?;
    let try_with = |scheme: Scheme, instants: &[f64], tolerance: Tolerance| -> String {
        let mut trajectory = Trajectory::from_given(solid.rest());
        let controls = |t: f64| Ok(pulled(&solid, if t > 0.5 { 1e12 } else { 0.0 }));
        let found = solid.model().advance_adaptively(
            &mut trajectory,
            &scheme,
            (instants, tolerance),
            &controls,
            &STRICT,
            &mut Workspace::default(),
        );
        found.err().map_or_else(String::new, |error| error.to_string())
    };
    assert!(try_with(Scheme::bdf2(), &[1.0], tolerance(1e-3)).contains("take tr_bdf2"));
    assert!(try_with(Scheme::tr_bdf2(), &[1.0], tolerance(0.0)).contains("positive"));
    assert!(try_with(Scheme::tr_bdf2(), &[0.2, 0.1], tolerance(1e-3)).contains("increase"));
    let torn = try_with(Scheme::tr_bdf2(), &[1.0], tolerance(1e-3));
    assert!(torn.contains("out of reach") || torn.contains("in the time step"), "{torn}");
    Ok(())
}
