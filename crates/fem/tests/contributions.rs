//! Contributions: the contract of every member of the catalogue and of some that only a test needs; problems in time and
//! without a potential, which prove that the model carries them.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use crate::common;

use common::block::STRICT;
use common::own_contributions::{Oscillators, PUSH, Swirl, bar, oscillating, swirling};
use common::{Outcome, largest, noise, regular};
use nastic_energy::{NeoHooke, Slot};
use nastic_fem::catalogue::CATALOGUE;
use nastic_fem::{
    Contribution, ContributionPoint, Controls, Demand, FemError, Inadmissible, Increment, Instant, Need, PathEnd,
    PathOptions, Scheme, SecondDerivativeError, SecondSensitivities, Sensitivities, Solid, SolveOptions, StateError,
    StatePartials, StepTo, Sums, TimeStepping, Trajectory, Workspace, check_contribution,
};
use nastic_linear::{NotCoupled, SparseMatrix};
use nastic_mesh::CellKind;

#[test]
fn every_contribution_keeps_its_contract() -> Outcome {
    for entry in CATALOGUE {
        let solid = (entry.example)()?;
        (0..3).try_for_each(|seed| check_contribution(solid.model(), entry.name, seed))?;
        let (model, u) = (solid.model(), solid.rest().u);
        let controls = model.controls();
        let second = model.second_vjp(&Instant::new(&u, &controls, 1.0), &u, &Increment { u: &u, controls: &controls });
        // what has no potential may give none: friction
        assert!(
            second.is_ok() || !model.properties().has_potential() || entry.name.contains("lagged"),
            "{}: {second:?}",
            entry.name
        );
    }
    check_contribution(oscillating()?.model(), "oscillators", 5)?;
    check_contribution(swirling()?.model(), "swirl", 5)?;
    assert!(check_contribution(bar()?.model(), "swirl", 5).is_err());
    Ok(())
}

/// Wrong on purpose, one line each; the contract test names it.
#[test]
fn a_broken_contract_is_told() -> Outcome {
    #[derive(Debug, Clone)]
    struct Broken(Oscillators, &'static str);
    impl Contribution for Broken {
        fn name(&self) -> &str {
            "broken"
        }

        fn slots(&self) -> &[Slot] {
            &PUSH
        }

        fn add_mass(&self, at: &Instant, mass: &mut SparseMatrix) -> Result<(), NotCoupled> {
            self.0.add_mass(at, mass)?;
            if self.1 == "mass" {
                mass.add_to_diagonal(1e-3);
            }
            Ok(())
        }

        fn at<'a>(&'a self, _: &Instant, _: Need) -> Result<Box<dyn ContributionPoint + 'a>, Inadmissible> {
            Ok(Box::new(self))
        }
    }

    impl ContributionPoint for Broken {
        fn add_residual(&self, at: &Instant, demand: Demand, sums: &mut Sums) -> Result<(), Inadmissible> {
            let others = sums.force.get(7).copied().unwrap_or_default();
            self.0.add_residual(at, demand, sums)?;
            match self.1 {
                "potential" => sums.energy += 0.1 * at.u[30],
                "forces of others" if demand.force => sums.force[7] -= others,
                "force_scale" => sums.force_scale.iter_mut().for_each(|s| *s = 0.0),
                _ => {}
            }
            Ok(())
        }

        fn add_tangent(&self, at: &Instant, tangent: &mut SparseMatrix) -> Result<(), Inadmissible> {
            self.0.add_tangent(at, tangent)?;
            if self.1 == "tangent" {
                tangent.add_to_diagonal(1e-3);
            }
            Ok(())
        }

        fn vjp(&self, at: &Instant, lambda: &[f64], into: &mut Sensitivities) -> Result<(), Inadmissible> {
            self.0.vjp(at, lambda, into)?;
            match self.1 {
                "controls" => into.add_control(at, 0, 1e-3 * lambda[0]),
                "velocity" => into.velocity.iter_mut().for_each(|v| *v *= 1.001),
                "acceleration" => into.acceleration.iter_mut().for_each(|a| *a *= 0.999),
                _ => {}
            }
            Ok(())
        }

        fn add_control_product(
            &self,
            at: &Instant,
            v: &Controls,
            out: &mut [f64],
        ) -> Result<(), SecondDerivativeError> {
            out[3] += if self.1 == "dr/dm v" { 1e-3 } else { 0.0 };
            self.0.add_control_product(at, v, out)
        }

        fn second_vjp(
            &self,
            at: &Instant,
            _: &[f64],
            along: &Increment,
            into: &mut SecondSensitivities,
        ) -> Result<(), SecondDerivativeError> {
            match self.1 {
                "change of K^T lambda" => into.u[5] += along.u[5],
                "change of the derivative" => into.add_control(at, 0, along.u[5]),
                _ => {}
            }
            Ok(())
        }
    }
    let right = Oscillators { mass: 0.3, damping: 0.2, stiffness: 1.5, spread: 0.0 };
    let first = ["potential", "forces of others", "force_scale", "tangent", "controls", "velocity", "acceleration"];
    let second = ["change of K^T lambda", "change of the derivative", "dr/dm v"];
    for wrong in first.into_iter().chain(second).chain(["mass"]) {
        let solid = bar()?.contribution(Broken(right.clone(), wrong))?;
        let why = check_contribution(solid.model(), "broken", 3).err().ok_or(format!("{wrong} passes"))?;
        assert!(why.contains(wrong), "{wrong}: {why}");
    }
    Ok(())
}

#[test]
fn names_are_taken_once() -> Outcome {
    let error =
        swirling()?.contribution(Swirl { nodes: vec![1], rate: 0.0 }).err().ok_or("two contributions of one name")?;
    assert!(error.to_string().contains("swirl"), "{error}");
    Ok(())
}

/// Without a potential: solved, with an adjoint that is that of the transposed tangent.
#[test]
fn a_force_without_a_potential_is_solved_and_differentiated() -> Outcome {
    let solid = swirling()?;
    let mut controls = solid.controls();
    let block = controls.len() - 1;
    controls.values_mut(block)[0] = 6.0;
    controls.values_mut(0).fill(-100.0);
    let state = solid.solve(&controls, &STRICT)?;
    assert!(largest(&state.u) > 0.02, "it hardly moves: {:e}", largest(&state.u));
    let sums = solid.model().evaluate(&Instant::new(&state.u, &controls, 1.0), Demand { energy: true, force: true })?;
    let mut residual = sums.force;
    solid.supports().clear(&mut residual);
    assert!(largest(&residual) < 1e-10, "{:e}", largest(&residual));

    let mut wish: Vec<f64> = (0..state.u.len()).map(noise).collect();
    solid.supports().clear(&mut wish);
    let partials = StatePartials { u: wish.clone(), ..StatePartials::default() };
    let trajectory = Trajectory::from(state.clone());
    let swept = solid.model().reverse_sweep(&trajectory, &[partials], &STRICT, &mut Workspace::default())?;
    let value = |t: f64| -> Outcome<f64> {
        let mut moved = controls.clone();
        moved.values_mut(block)[0] += t;
        let u = solid.solve(&moved, &SolveOptions { near: Some(&state), ..STRICT })?.u;
        Ok(u.iter().zip(&wish).map(|(u, c)| u * c).sum())
    };
    let difference = |s: f64| -> Outcome<f64> { Ok(value(0.05 * s)? - value(-0.05 * s)?) };
    let expected = (45.0 * difference(1.0)? - 9.0 * difference(2.0)? + difference(3.0)?) / (60.0 * 0.05);
    let found = swept.controls[0].values(block)[0];
    assert!((found / expected - 1.0).abs() < 1e-8, "{found} where differences give {expected}");
    Ok(())
}

/// A path goes on without an inertia; what needs a symmetric tangent or a potential says so.
#[test]
fn a_force_without_a_potential_has_a_path_and_no_modes() -> Outcome {
    let solid = swirling()?;
    let mut controls = solid.controls();
    let block = controls.len() - 1;
    controls.values_mut(block)[0] = 6.0;
    controls.values_mut(0).fill(-100.0);
    let (model, workspace) = (solid.model(), &mut Workspace::default());
    let path = model.stability().path(
        &solid.rest(),
        (&controls, 1.0),
        &PathOptions::default(),
        &STRICT,
        workspace,
        &mut |_| (),
    )?;
    assert!(matches!(path.end, PathEnd::Left) && path.events.is_empty());
    assert!(path.points.iter().all(|point| point.negative.is_none()));
    let (end, state) = (&path.points[path.points.len() - 1].state, solid.solve(&controls, &STRICT)?);
    assert!(common::distance(&end.u, &state.u) < 1e-8);
    let modes = solid.modes(&state, 1, &STRICT);
    assert!(matches!(modes, Err(StateError::Problem(FemError::Unsupported { .. }))), "{modes:?}");
    let several = model.stability().equilibria(&state, 2, &STRICT, workspace, &mut |_| ());
    assert!(matches!(several, Err(StateError::Problem(FemError::Unsupported { .. }))), "{several:?}");
    assert!(matches!(model.stability().descend(&state, &STRICT, workspace), Err(StateError::Problem(_))));
    Ok(())
}

/// Masses on a soft bar, pushed step by step.
fn pushed(solid: &Solid, pushes: &[f64], begin: &Trajectory) -> Outcome<Trajectory> {
    let mut trajectory = begin.clone();
    let steps: Vec<StepTo> = pushes
        .iter()
        .enumerate()
        .map(|(n, &push)| {
            let mut controls = solid.controls();
            controls.values_mut(1)[0] = push;
            controls.values_mut(0).fill(-50.0 * push);
            StepTo { dt: 0.1 + 0.02 * n as f64, controls }
        })
        .collect();
    solid.model().advance(&mut trajectory, &Scheme::backward_euler(), &steps, &STRICT, &mut Workspace::default())?;
    Ok(trajectory)
}

/// One mass on springs alone: backward Euler's own recurrence.
#[test]
fn steps_are_those_of_backward_euler() -> Outcome {
    let (mass, damping, stiffness) = (0.3, 0.2, 1.5);
    let solid = Solid::new(regular(CellKind::Hex8, [1.0; 3], [1; 3])?)?
        .material("body", NeoHooke::new(1e-9, 0.0)?)?
        .clamp("x-")?
        .contribution(Oscillators { mass, damping, stiffness, spread: 0.0 })?;
    let mut trajectory = Trajectory::from_given(solid.rest());
    let mut controls = solid.controls();
    controls.values_mut(0)[0] = 0.01;
    let steps = vec![StepTo { dt: 0.1, controls }; 5];
    solid.model().advance(&mut trajectory, &Scheme::backward_euler(), &steps, &STRICT, &mut Workspace::default())?;
    let (mut u, mut v, h) = (0.0, 0.0, 0.1);
    let free = solid.supports().fixed().iter().position(|fixed| !fixed).ok_or("nothing is free")?;
    for state in &trajectory.states()[1..] {
        v = (v + h / mass * (0.01 - stiffness * u)) / (1.0 + h * damping / mass + h * h * stiffness / mass);
        u += h * v;
        assert!((state.u[free] - u).abs() < 1e-8 * u.abs(), "{} instead of {u}", state.u[free]);
        let velocity = state.velocity.as_ref().ok_or("a step without a velocity")?[free];
        assert!((velocity - v).abs() < 1e-8 * v.abs(), "{velocity} instead of {v}");
    }
    assert!((trajectory.end().time - 0.5).abs() < 1e-15);
    Ok(())
}

/// The derivative by the control of every instant, the first equilibrium's included, against differences of whole runs.
#[test]
fn the_reverse_sweep_is_the_derivative_of_the_run() -> Outcome {
    let solid = oscillating()?;
    let pushes = [0.3, -0.2, 0.5, 0.1, -0.4];
    let dofs = solid.rest().u.len();
    let weights: Vec<Vec<f64>> =
        (0..=2 * pushes.len() + 1).map(|k| (0..dofs).map(|i| noise(i + 1000 * k)).collect()).collect();
    for (name, given) in [("a given state", true), ("an equilibrium", false)] {
        let run = |first: f64, pushes: &[f64]| -> Outcome<Trajectory> {
            let begin = match given {
                true => Trajectory::from_given(solid.rest()),
                false => {
                    let mut controls = solid.controls();
                    controls.values_mut(1)[0] = first;
                    Trajectory::from(solid.solve(&controls, &STRICT)?)
                }
            };
            pushed(&solid, pushes, &begin)
        };
        let value = |trajectory: &Trajectory| -> f64 {
            let of = |(n, state): (usize, &nastic_fem::State)| {
                let dot = |w: &[f64], v: &[f64]| w.iter().zip(v).map(|(w, v)| w * v).sum::<f64>();
                let v = state.velocity.as_ref().map_or(0.0, |v| dot(&weights[2 * n + 1], v));
                dot(&weights[2 * n], &state.u) + 0.1 * v
            };
            trajectory.states().iter().enumerate().map(of).sum()
        };
        let base = run(0.2, &pushes)?;
        let partials: Vec<StatePartials> = (0..=pushes.len())
            .map(|n| StatePartials {
                u: weights[2 * n].clone(),
                velocity: if n == 0 { vec![] } else { weights[2 * n + 1].iter().map(|w| 0.1 * w).collect() },
                ..StatePartials::default()
            })
            .collect();
        let swept = solid.model().reverse_sweep(&base, &partials, &STRICT, &mut Workspace::default())?;
        for n in usize::from(given)..=pushes.len() {
            let moved = |t: f64| -> Outcome<f64> {
                let mut pushes = pushes;
                match n {
                    0 => return Ok(value(&run(0.2 + t, &pushes)?)),
                    n => pushes[n - 1] += t,
                }
                Ok(value(&run(0.2, &pushes)?))
            };
            const H: f64 = 1e-2;
            let difference = |s: f64| -> Outcome<f64> { Ok(moved(s * H)? - moved(-s * H)?) };
            let expected = (45.0 * difference(1.0)? - 9.0 * difference(2.0)? + difference(3.0)?) / (60.0 * H);
            let by = &swept.controls[n];
            let fibre = if n == 0 { 0.0 } else { -50.0 * by.values(0).iter().sum::<f64>() };
            let found = by.values(1)[0] + fibre;
            assert!(
                (found - expected).abs() < 1e-7 * expected.abs().max(1.0),
                "{name}, instant {n}: {found}, {expected}"
            );
        }
    }
    Ok(())
}
