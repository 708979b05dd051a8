//! Motions without inertia, and those of one linear system per step.

use crate::common;

use common::block::STRICT;
use common::motion::{motion, oscillator, steps, uniform};
use common::{Outcome, distance, largest, nodal, regular};
use nastic_energy::{FiberTension, KelvinVoigt, MaxwellBranch, NeoHooke};
use nastic_fem::{
    Controls, Inertia, Instant, Scheme, Solid, SolveOptions, State, StateError, StepTo, TimeStepping, Trajectory,
    Workspace,
};
use nastic_linear::LinearError;
use nastic_mesh::CellKind;
use nastic_tensor::Vec3;
use std::sync::Arc;

fn bar() -> Outcome<Solid> {
    Ok(Solid::new(regular(CellKind::Hex8, [1.0, 0.3, 0.3], [4, 1, 1])?)?
        .material("body", NeoHooke::new(1e3, 2e3)?)?
        .actuate("body", "fibre", FiberTension::along(Vec3::x())?)?
        .body_force("body", Vec3::new(0.0, 0.0, -30.0))?
        .clamp("x-")?)
}

fn pulled(solid: &Solid, tension: f64) -> Controls {
    let mut controls = solid.controls();
    let fibre = solid.model().controllable().iter().position(|known| known.name == "fibre").unwrap_or(usize::MAX);
    controls.values_mut(fibre).fill(tension);
    controls
}

fn run(solid: &Solid, scheme: &Scheme, steps: &[StepTo]) -> Outcome<Trajectory> {
    let first = pulled(solid, 0.0);
    let mut run = Trajectory::from(solid.solve(&first, &STRICT)?);
    solid.model().advance(&mut run, scheme, steps, &STRICT, &mut Workspace::default())?;
    Ok(run)
}

/// A body without a density: every state is the equilibrium under its controls, over steps of any length; long steps from rest lead to
/// the same.
#[test]
fn every_instant_is_an_equilibrium() -> Outcome {
    let solid = bar()?;
    let tension = |t: f64| -200.0 * (t + 0.3 * t * t);
    let all: Vec<StepTo> =
        [0.1, 0.5, 2.0].into_iter().map(|t| StepTo { dt: 10.0 * t, controls: pulled(&solid, tension(t)) }).collect();
    let still = run(&solid, &Scheme::quasi_static(), &all)?;
    let heavy = solid.clone().inertia(Inertia::new("body", 1.0))?;
    let slow: Vec<StepTo> = all.iter().map(|to| StepTo { dt: 1e6, ..to.clone() }).collect();
    let slow = run(&heavy, &Scheme::quasi_dynamic(), &slow)?;
    for (n, to) in all.iter().enumerate() {
        let expected = solid.solve(&to.controls, &STRICT)?;
        let found = &still.states()[n + 1];
        let gap = distance(&expected.u, &found.u) / largest(&expected.u);
        let from_rest = distance(&expected.u, &slow.states()[n + 1].u) / largest(&expected.u);
        assert!(gap < 1e-9 && from_rest < 1e-9, "instant {n}: {gap:e}, {from_rest:e}");
        let before = &still.states()[n].u;
        let velocity = found.velocity.as_ref().ok_or("no velocity")?;
        let rate = found.u.iter().zip(before.iter()).map(|(u, b)| (u - b) / to.dt);
        assert!(rate.zip(velocity.iter()).all(|(a, b)| (a - b).abs() < 1e-12) && found.acceleration.is_none());
    }
    // it goes on in another call, from the velocity of its own step
    let mut parts = run(&solid, &Scheme::quasi_static(), &all[..2])?;
    solid.model().advance(&mut parts, &Scheme::quasi_static(), &all[2..], &STRICT, &mut Workspace::default())?;
    assert!(distance(&parts.end().u, &still.end().u) < 1e-9 * largest(&still.end().u));
    // a mass on a spring is in its place of rest after one step
    let spring = oscillator(1.0, 0.0)?;
    let end = motion(&spring, &Scheme::quasi_static(), uniform(&spring, 0.1, 0.0, None), 1, 0.1)?;
    assert!(largest(&end.end().u) < 1e-12);
    Ok(())
}

/// Viscous laws and damping under tensions that change in time: the error is of first order in h.
#[test]
fn viscosity_without_inertia_is_of_first_order() -> Outcome {
    let maxwell = bar()?.viscosity("body", MaxwellBranch::new(800.0, 0.3)?)?;
    let kelvin = bar()?.viscosity("body", KelvinVoigt::new(200.0, 50.0)?)?;
    let rayleigh = bar()?.rayleigh_damping(0.0, 0.2)?;
    for (name, solid) in [("Maxwell", maxwell), ("Kelvin-Voigt", kelvin), ("Rayleigh", rayleigh)] {
        let end = |count: usize| -> Outcome<Vec<f64>> {
            let all = steps(count, 1.0 / count as f64, |t| pulled(&solid, -300.0 * (3.0 * t).sin()));
            Ok(run(&solid, &Scheme::quasi_static(), &all)?.end().u.to_vec())
        };
        let [coarse, middle, fine] = [end(40)?, end(80)?, end(160)?];
        let order = (distance(&coarse, &middle) / distance(&middle, &fine)).log2();
        let still = solid.solve(&pulled(&solid, -300.0 * 3f64.sin()), &STRICT)?;
        println!(
            "{name:<12} order {order:.3}, {:.3} of the static displacement away",
            distance(&still.u, &fine) / largest(&still.u)
        );
        assert!((order - 1.0).abs() < 0.1, "{name}: {order}");
        assert!(distance(&still.u, &fine) > 0.01 * largest(&still.u), "{name} hardly dissipates");
    }
    Ok(())
}

/// `u_n + (M/h^2 + C/h + K)^-1 (M v_n/h - r(u_n))` by a solve of its own, at the end of a step of a bar far from rest.
#[test]
fn a_linearised_step_is_one_linear_system() -> Outcome {
    let solid = bar()?.inertia(Inertia::new("body", 1.0))?.rayleigh_damping(0.1, 0.02)?;
    let (h, model) = (0.02, solid.model());
    let begin = State {
        u: Arc::new(nodal(solid.mesh(), |x| Vec3::new(0.05 * x.x, 0.0, 0.1 * x.x * x.x))),
        velocity: Some(Arc::new(nodal(solid.mesh(), |x| Vec3::new(0.0, 0.5 * x.x, -x.x)))),
        controls: Arc::new(pulled(&solid, 0.0)),
        ..solid.rest()
    };
    let to = StepTo { dt: h, controls: pulled(&solid, -100.0) };
    let mut run = Trajectory::from_given(begin.clone());
    model.advance(
        &mut run,
        &Scheme::linearly_implicit_euler(),
        std::slice::from_ref(&to),
        &STRICT,
        &mut Workspace::default(),
    )?;

    // residual and tangent of backward Euler at u_n, a dense elimination
    let step = nastic_fem::TimeStep::backward_euler(&begin, h);
    let at = Instant::new(&begin.u, &to.controls, 1.0).in_step(&step);
    let force = model.evaluate(&at, nastic_fem::Demand { energy: false, force: true })?.force;
    let mut tangent = model.matrix();
    model.add_tangent(&at, &mut tangent)?;
    let free: Vec<usize> = (0..force.len()).filter(|&i| !solid.supports().fixed()[i]).collect();
    let column = |j: usize| {
        let mut unit = vec![0.0; force.len()];
        unit[j] = 1.0;
        let mut image = vec![0.0; force.len()];
        tangent.multiply(&unit, &mut image);
        image
    };
    let columns: Vec<Vec<f64>> = free.iter().map(|&j| column(j)).collect();
    let dense = nalgebra::DMatrix::from_fn(free.len(), free.len(), |i, j| columns[j][free[i]]);
    let rhs = nalgebra::DVector::from_fn(free.len(), |i, _| -force[free[i]]);
    let change = dense.lu().solve(&rhs).ok_or("singular")?;
    let mut expected = begin.u.to_vec();
    free.iter().zip(change.iter()).for_each(|(&i, d)| expected[i] += d);
    let gap = distance(&run.end().u, &expected) / change.norm();
    assert!(gap < 1e-10, "{gap:e}");
    // and not a solution: forces are not balanced
    let report = run.end().report;
    assert!(report.newton == 1 && report.residual > 1e-6, "{report:?}");
    Ok(())
}

#[test]
fn what_goes_wrong_without_a_search_is_said() -> Outcome {
    let solid = bar()?.inertia(Inertia::new("body", 1.0))?;
    let scheme = Scheme::linearly_implicit_euler();
    let moving = |v: Vec<f64>| State { velocity: Some(Arc::new(v)), ..solid.rest() };
    let fail = |begin: State, h: f64| -> Outcome<StateError> {
        let mut run = Trajectory::from_given(begin);
        let to = [StepTo { dt: h, controls: solid.controls() }];
        let failed = solid.model().advance(&mut run, &scheme, &to, &STRICT, &mut Workspace::default());
        Ok(failed.err().ok_or("a step")?)
    };
    // pushed through itself in one step
    let error = fail(moving(nodal(solid.mesh(), |x| Vec3::new(-300.0 * x.x, 0.0, 0.0))), 0.01)?;
    assert!(matches!(error, StateError::InStep { .. }) && error.code() == "inverted", "{error}");
    // squeezed to a fifth, where the tangent has negative eigenvalues, over a step that inertia does not help
    let squeezed = State { u: Arc::new(nodal(solid.mesh(), |x| Vec3::new(-0.8 * x.x, 0.0, 0.0))), ..solid.rest() };
    let error = fail(squeezed, 1e3)?;
    let StateError::InStep { source, .. } = &error else { return Err(error.to_string().into()) };
    assert!(matches!(**source, StateError::Linear(LinearError::Indefinite { .. })), "{error}");
    assert!(error.to_string().contains("shorter steps may help"), "{error}");

    let refused = |solid: &Solid, begin: State| -> Outcome<String> {
        let mut run = Trajectory::from_given(begin);
        let to = [StepTo { dt: 0.1, controls: solid.controls() }];
        let how = SolveOptions::default();
        let failed = solid.model().advance(&mut run, &Scheme::quasi_static(), &to, &how, &mut Workspace::default());
        Ok(failed.err().ok_or("a step")?.to_string())
    };
    let message = refused(&solid, moving(nodal(solid.mesh(), |x| Vec3::new(x.x, 0.0, 0.0))))?;
    assert!(message.contains("begin at rest"), "{message}");
    let free = Solid::new(regular(CellKind::Hex8, [1.0; 3], [1; 3])?)?.material("body", NeoHooke::new(1e3, 2e3)?)?;
    let message = refused(&free, free.rest())?;
    assert!(message.contains("rigid"), "{message}");
    Ok(())
}
