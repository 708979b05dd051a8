//! Steps of a body in contact that have no solution at once and are made as several shorter ones.

#![allow(clippy::unwrap_used)] // helpers of tests

use crate::common;

use common::block::STRICT;
use common::{Outcome, noise, regular};
use nastic_energy::NeoHooke;
use nastic_fem::{
    Contact, Controls, Inertia, Scheme, Solid, SolveOptions, State, StatePartials, StepTo, TimeStepping, Trajectory,
    Workspace,
};
use nastic_mesh::CellKind;
use nastic_mesh::spatial::Obstacle;

const STEPS: usize = 2;
/// Speed at which it falls where the scheme is `bdf2`.
const BDF2_SPEED: f64 = 2.8;
/// So few iterations that the impact is not found at once, and found in shorter steps.
fn few_iterations(scheme: &Scheme) -> SolveOptions<'static> {
    SolveOptions { max_newton: if *scheme == Scheme::backward_euler() { 8 } else { 7 }, ..STRICT }
}

/// A soft block that falls on a rough floor.
fn block() -> Outcome<Solid> {
    Ok(Solid::new(regular(CellKind::Tet4, [0.17, 0.17, 0.057], [4, 4, 2])?)?
        .material("body", NeoHooke::new(357.0, 1429.0)?)?
        .inertia(Inertia::new("body", 800.0))?
        .rayleigh_damping(0.0, 0.01)?
        .contact(
            Contact::of("floor", "skin", Obstacle::half_space([0.0, 0.0, -0.003], [0.02, 0.01, 1.0]))
                .friction(1.15, 1e-3),
        )?)
}

/// Before the impact, at a speed (m/s) at which one of the steps has no solution as a whole.
fn above(solid: &Solid, speed: f64, controls: Controls) -> Trajectory {
    let mut begin = State { controls: controls.into(), ..solid.rest() };
    begin.velocity = Some((0..begin.u.len()).map(|dof| [0.3, 0.0, -speed][dof % 3]).collect::<Vec<f64>>().into());
    Trajectory::from_given(begin)
}

fn fall(solid: &Solid, scheme: &Scheme, speed: f64, controls: impl Fn(usize) -> Controls) -> Outcome<Trajectory> {
    let mut trajectory = above(solid, speed, controls(0));
    let steps: Vec<StepTo> = (1..=STEPS).map(|n| StepTo { dt: 0.01, controls: controls(n) }).collect();
    solid.model().advance(&mut trajectory, scheme, &steps, &few_iterations(scheme), &mut Workspace::default())?;
    Ok(trajectory)
}

/// How many stages each step has.
fn stages(trajectory: &Trajectory) -> Vec<usize> {
    (1..trajectory.states().len()).map(|n| trajectory.scheme(n).unwrap().stages()).collect()
}

fn value(trajectory: &Trajectory) -> f64 {
    let of = |(n, state): (usize, &State)| -> f64 {
        state.u.iter().enumerate().map(|(i, u)| noise(77 + 100 * n + i) * u).sum()
    };
    trajectory.states().iter().enumerate().skip(1).map(of).sum()
}

#[test]
fn a_cut_step_has_its_own_exact_adjoint() -> Outcome {
    let solid = block()?;
    for (scheme, speed, slots) in [(Scheme::backward_euler(), 1.8, &[6][..]), (Scheme::bdf2(), BDF2_SPEED, &[2])] {
        let rest = fall(&solid, &scheme, speed, |_| solid.controls())?;
        let whole = scheme.start().unwrap_or(&scheme).stages();
        let cut = (0..STEPS).any(|n| stages(&rest)[n] > whole && rest.states()[n + 1].report.cuts > 0);
        assert!(cut, "{}: {:?}", scheme.name(), stages(&rest));
        let partials: Vec<StatePartials> = (0..=STEPS)
            .map(|n| {
                let by_u = (0..rest.end().u.len()).map(|i| if n == 0 { 0.0 } else { noise(77 + 100 * n + i) });
                StatePartials::by_displacement(by_u.collect())
            })
            .collect();
        let by = solid
            .model()
            .reverse_sweep(&rest, &partials, &few_iterations(&scheme), &mut Workspace::default())?
            .controls;
        // translations of the floor, and its stiffness
        for &slot in slots {
            let size = [1e-7, 1e-7, 1e-8, 0.0, 0.0, 0.0, 1.0, 1e-4][slot];
            let steepest = by.iter().map(|by| by.values(0)[slot].abs()).fold(0.0, f64::max);
            let along: Vec<f64> = by.iter().map(|by| by.values(0)[slot] / steepest).collect();
            let slope: f64 = by.iter().zip(&along).map(|(by, along)| by.values(0)[slot] * along).sum();
            let at = |s: f64| -> Outcome<f64> {
                let moved = fall(&solid, &scheme, speed, |n| {
                    let mut controls = solid.controls();
                    controls.values_mut(0)[slot] += s * along[n];
                    controls
                })?;
                assert_eq!(stages(&moved), stages(&rest));
                Ok(value(&moved))
            };
            let found = (8.0 * (at(size)? - at(-size)?) - (at(2.0 * size)? - at(-2.0 * size)?)) / (12.0 * size);
            let error = (found - slope).abs() / slope.abs();
            assert!(error < 1e-7, "{}, control {slot}: {slope:e} by the adjoint, {found:e}", scheme.name());
        }
    }
    Ok(())
}

/// The last step of a motion that was written down, in parts.
#[test]
fn a_cut_step_is_written_down() -> Outcome {
    let solid = block()?;
    let scheme = Scheme::bdf2();
    let mut trajectory = above(&solid, BDF2_SPEED, solid.controls());
    let step = StepTo { dt: 0.01, controls: solid.controls() };
    let go_on = |trajectory: &mut Trajectory| {
        solid.model().advance(
            trajectory,
            &scheme,
            std::slice::from_ref(&step),
            &few_iterations(&scheme),
            &mut Workspace::default(),
        )
    };
    go_on(&mut trajectory)?;
    let record = trajectory.last_step(&scheme).unwrap();
    assert!(record.starts && record.parts > 1 && record.stages.len() == 2 * record.parts, "{} parts", record.parts);
    let mut other =
        Trajectory::from_end(trajectory.begin(), 0, trajectory.states().to_vec(), Some(record.clone()), &scheme)?;
    go_on(&mut trajectory)?;
    go_on(&mut other)?;
    assert_eq!(trajectory.end().u, other.end().u);
    let unknown = nastic_fem::StepRecord { parts: 3, ..record };
    assert!(
        Trajectory::from_end(trajectory.begin(), 0, trajectory.states()[..2].to_vec(), Some(unknown), &scheme).is_err()
    );
    Ok(())
}
