//! Cavities of given volume and tendons that cannot stretch in motions, in ramps and along paths, in modes, under deflation and descent,
//! and beside forces without a potential.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use crate::common;

use common::block::STRICT;
use common::motion;
use common::own_contributions::Swirl;
use common::shells::shell;
use common::{Outcome, largest, noise, regular};
use nalgebra::DMatrix;
use nastic_energy::{MooneyRivlin, NeoHooke};
use nastic_fem::{
    Cavity, Controls, FemError, Inertia, Instant, PathEnd, PathOptions, Scheme, Solid, SolveOptions, State, StateError,
    StatePartials, StepTo, Tendon, TimeStepping, Trajectory, Workspace,
};
use nastic_mesh::{CellKind, rectangle};
use nastic_numeric::vector::{dot, norm, sub};

const H: f64 = 0.1;
const YOUNG: f64 = 1e5;

/// An octant of a thick sphere whose room is driven by its volume or its pressure.
fn sphere(by_volume: bool) -> Outcome<Solid> {
    let room = Cavity::new("air", "inner").symmetry("x-").symmetry("y-").symmetry("z-");
    Ok(Solid::new(shell(CellKind::Hex8, 2)?)?
        .material("body", MooneyRivlin::new(1.0, 0.0, 10.0)?)?
        .displace("x-", [Some(0.0), None, None])?
        .displace("y-", [None, Some(0.0), None])?
        .displace("z-", [None, None, Some(0.0)])?
        .inertia(Inertia::new("body", 1.0))?
        .cavity(if by_volume { room.by_volume() } else { room })?)
}

/// A plane strip with two tendons that cannot stretch.
fn strip() -> Outcome<Solid> {
    let along = |name: &str, y: f64| {
        Tendon::through(name, [[0.0, y, 0.0], [1.5, y + 0.05, 0.0], [3.0, y, 0.0]]).spacing(0.5).inextensible()
    };
    Ok(Solid::new(regular(CellKind::Quad4, [3.0, 1.0, 0.0], [6, 2, 1])?)?
        .material("body", NeoHooke::new(1.0, 2.0)?)?
        .clamp("x-")?
        .inertia(Inertia::new("body", 1.0))?
        .tendon(along("low", 0.2))?
        .tendon(along("high", 0.8))?)
}

fn with(solid: &Solid, values: &[f64]) -> Controls {
    let mut controls = solid.controls();
    values.iter().enumerate().for_each(|(k, value)| controls.values_mut(k).fill(*value));
    controls
}

/// What drives a body at the n-th instant.
type Drive = fn(f64) -> Vec<f64>;

fn volume(t: f64) -> Vec<f64> {
    vec![0.1 + 0.3 * t + 0.05 * (4.0 * t).sin()]
}

/// One that is taut, drawn in from rest, and one that is let out.
fn pulls(t: f64) -> Vec<f64> {
    vec![0.15 + 0.02 * t * t, -0.5]
}

fn run(solid: &Solid, scheme: &Scheme, drive: Drive, change: impl Fn(usize) -> f64) -> Outcome<Trajectory> {
    let of = |n: usize| {
        let values: Vec<f64> = drive(H * n as f64).iter().map(|value| value + change(n)).collect();
        with(solid, &values)
    };
    let mut trajectory = Trajectory::from(solid.solve(&of(0), &STRICT)?);
    let steps: Vec<StepTo> = (1..=6).map(|n| StepTo { dt: H, controls: of(n) }).collect();
    solid.model().advance(&mut trajectory, scheme, &steps, &STRICT, &mut Workspace::default())?;
    Ok(trajectory)
}

/// Those of the catalogue that go with constraints.
fn schemes() -> Outcome<Vec<Scheme>> {
    let held = sphere(true)?;
    let goes = |scheme: &Scheme| held.model().supports_motion(scheme).is_ok();
    Ok(motion::schemes()?.into_iter().map(|(scheme, _)| scheme).filter(goes).collect())
}

/// `sum_n h (w_n . (u, p)_n + |u_n|^2 / 2)` by the discrete adjoint, against the remainder of Taylor's formula.
#[test]
fn motions_under_constraints_have_exact_adjoints() -> Outcome {
    let bodies: [(&str, Solid, Drive); 2] = [("volume", sphere(true)?, volume), ("pull", strip()?, pulls)];
    for (name, solid, drive) in &bodies {
        let dofs = solid.discretization().dofs();
        let weight = |n: usize, i: usize| noise(77 + 100 * n + i);
        let value = |trajectory: &Trajectory| -> f64 {
            let of = |(n, state): (usize, &State)| {
                let u = solid.model().nodal(&state.u);
                let linear = state.u.iter().enumerate().map(|(i, u)| weight(n, i) * u).sum::<f64>();
                H * (linear + 0.5 * dot(u, u))
            };
            trajectory.states().iter().enumerate().map(of).sum()
        };
        for scheme in schemes()? {
            let trajectory = run(solid, &scheme, *drive, |_| 0.0)?;
            let partials: Vec<StatePartials> = trajectory
                .states()
                .iter()
                .enumerate()
                .map(|(n, state)| {
                    let by = |(i, u): (usize, &f64)| H * (weight(n, i) + if i < dofs { *u } else { 0.0 });
                    StatePartials::by_displacement(state.u.iter().enumerate().map(by).collect())
                })
                .collect();
            let swept = solid.model().reverse_sweep(&trajectory, &partials, &STRICT, &mut Workspace::default())?;
            let along = |n: usize| 0.5 + 0.1 * (0.5 * n as f64).sin();
            let blocks = swept.controls[0].len();
            let of = |(n, by): (usize, &Controls)| {
                along(n) * (0..blocks).map(|k| by.values(k).iter().sum::<f64>()).sum::<f64>()
            };
            let slope: f64 = swept.controls.iter().enumerate().map(of).sum();
            let base = value(&trajectory);
            let remainder = |t: f64| -> Outcome<f64> {
                Ok((value(&run(solid, &scheme, *drive, |n| t * along(n))?) - base - t * slope).abs())
            };
            let order = (remainder(4e-3)? / remainder(1e-3)?).log2() / 2.0;
            println!("{name} by {}: Taylor order {order:.4}, slope {slope:.4}", scheme.name());
            assert!(order > 1.95 && order < 2.05, "{name} by {}: Taylor order {order}", scheme.name());
        }
    }
    Ok(())
}

/// Of backward Euler the pressures found at the ends of steps, given, make the same motion; multipliers do not move.
#[test]
fn a_motion_under_a_volume_is_that_under_its_pressures() -> Outcome {
    let (held, driven) = (sphere(true)?, sphere(false)?);
    let dofs = held.discretization().dofs();
    let scheme = Scheme::backward_euler();
    let trajectory = run(&held, &scheme, volume, |_| 0.0)?;
    let pressures: Vec<f64> = trajectory.states().iter().map(|state| state.u[dofs]).collect();
    let mut same = Trajectory::from(driven.solve(&with(&driven, &pressures[..1]), &STRICT)?);
    let steps: Vec<StepTo> = pressures[1..].iter().map(|p| StepTo { dt: H, controls: with(&driven, &[*p]) }).collect();
    driven.model().advance(&mut same, &scheme, &steps, &STRICT, &mut Workspace::default())?;
    for (a, b) in trajectory.states().iter().zip(same.states()) {
        let apart = norm(&sub(&a.u[..dofs], &b.u)) / norm(&b.u);
        assert!(apart < 1e-9, "at {}: {apart:e}", a.time);
    }
    let end = trajectory.end();
    assert!(end.velocity.as_ref().unwrap()[dofs] == 0.0 && end.acceleration.as_ref().unwrap()[dofs] == 0.0);
    assert!(pressures.windows(2).all(|pair| (pair[1] - pair[0]).abs() > 1e-4), "{pressures:?}");
    Ok(())
}

/// Schemes under which no constraint would hold at the end of a step, or its multiplier would grow.
#[test]
fn what_schemes_do_not_go_with_constraints_says_the_model() -> Outcome {
    let (held, driven) = (sphere(true)?, sphere(false)?);
    let all: Vec<Scheme> = motion::schemes()?.into_iter().map(|(scheme, _)| scheme).collect();
    let (mut goes, mut refused) = (Vec::new(), vec![Scheme::newmark(0.25, 0.5)?]);
    for scheme in all {
        // a mode that no step resolves loses at least a thousandth in one
        let damps = |scheme: &Scheme| scheme.amplification(1e6, 0.0).is_ok_and(|factor| factor.modulus < 0.999);
        let holds = !scheme.extrapolates() && !scheme.is_linearised() && (scheme.is_quasi_static() || damps(&scheme));
        if holds { goes.push(scheme) } else { refused.push(scheme) }
    }
    for scheme in &goes {
        held.model().supports_motion_adjoint(scheme)?;
    }
    for (of, name) in [(&goes, "bdf2"), (&goes, "quasi_static"), (&refused, "trapezoidal"), (&refused, "siere")] {
        assert!(of.iter().any(|scheme| scheme.name() == name), "{name}");
    }
    for scheme in &refused {
        driven.model().supports_motion(scheme)?;
        let error = held.model().supports_motion(scheme).err().ok_or("it goes")?;
        assert!(matches!(error, FemError::Unsupported { .. }) && error.to_string().contains("\"air\""), "{error}");
        let steps = [StepTo { dt: H, controls: held.controls() }];
        let mut trajectory = Trajectory::from_given(held.rest());
        let message = held.model().advance(&mut trajectory, scheme, &steps, &STRICT, &mut Workspace::default()).err();
        assert!(matches!(message, Some(StateError::Problem(FemError::Unsupported { .. }))), "{message:?}");
    }
    Ok(())
}

/// Along the volume, past the largest pressure; and along the pull, from a tendon that is let out to one that is taut.
#[test]
fn paths_and_ramps_go_along_constraints() -> Outcome {
    let bodies =
        [("volume", sphere(true)?, vec![0.0], vec![5.0]), ("pull", strip()?, vec![-0.05, -0.5], vec![0.2, -0.5])];
    for (name, solid, from, to) in &bodies {
        let (model, dofs) = (solid.model(), solid.discretization().dofs());
        let (from, to) = (with(solid, from), with(solid, to));
        let start = solid.solve(&from, &STRICT)?;
        let options = PathOptions { step: 0.2, ..PathOptions::default() };
        let path =
            model.stability().path(&start, (&to, 1.0), &options, &STRICT, &mut Workspace::default(), &mut |_| ())?;
        assert!(matches!(path.end, PathEnd::Left), "{name}: {:?}", path.end);
        let last = &path.points[path.points.len() - 1];
        let state = solid.solve(&to, &STRICT)?;
        let apart = norm(&sub(&last.state.u, &state.u)) / norm(&state.u);
        println!("{name}: {} points, apart {apart:.1e}, multiplier {:.5}", path.points.len(), state.u[dofs]);
        assert!(apart < 1e-8 && last.s == 1.0, "{name}: {apart:e} at {}", last.s);
        assert!(path.points.iter().all(|point| point.negative == Some(0)), "{name}");
        let multipliers: Vec<f64> = path.points.iter().map(|point| point.state.u[dofs]).collect();
        if *name == "pull" {
            let taut = |s: f64| -0.05 + 0.25 * s > 1e-9;
            let fits = path.points.iter().zip(&multipliers).all(|(point, p)| (*p > 0.0) == taut(point.s));
            assert!(fits && multipliers.iter().all(|p| *p >= 0.0), "{multipliers:?}");
        }
        let ramp = model.stability().ramp(&from, &to, 5, &STRICT, &mut Workspace::default(), &mut |_| ())?;
        assert!(ramp.failure.is_none() && ramp.critical.is_empty(), "{name}: {:?}", ramp.failure);
        let apart = norm(&sub(&ramp.points[4].state.u, &state.u)) / norm(&state.u);
        assert!(apart < 1e-8, "{name}: {apart:e}");
    }
    Ok(())
}

/// `K phi + B q = lambda M phi`, `B . phi = 0`: against all eigenvalues of the dense matrices on the null space of B.
#[test]
fn modes_keep_the_volume() -> Outcome {
    let solid = sphere(true)?;
    let (model, disc) = (solid.model(), solid.discretization());
    let state = solid.solve(&with(&solid, &[1.0]), &STRICT)?;
    let dofs = disc.dofs();
    let at = Instant::new(&state.u, &state.controls, 1.0);
    let free: Vec<usize> = (0..dofs).filter(|&i| !solid.supports().fixed()[i]).collect();
    let product = |k: usize| -> Outcome<Vec<f64>> {
        let (mut unit, mut out) = (vec![0.0; dofs + 1], vec![0.0; dofs + 1]);
        unit[k] = 1.0;
        assert!(model.tangents().tangent_product(&at, &unit, &mut out)?);
        Ok(out)
    };
    let volumes: Vec<f64> = disc.nodal_volumes().iter().flat_map(|v| [*v; 3]).collect();
    let scaled = |i: usize| volumes[free[i]].sqrt();
    let border = product(dofs)?;
    let b: Vec<f64> = free.iter().enumerate().map(|(i, &dof)| border[dof] / scaled(i)).collect();
    let b: Vec<f64> = b.iter().map(|x| x / norm(&b)).collect();
    let columns = free.iter().map(|&dof| product(dof)).collect::<Outcome<Vec<_>>>()?;
    let n = free.len();
    let matrix = DMatrix::from_fn(n, n, |i, k| columns[k][free[i]] / (scaled(i) * scaled(k)));
    let projection = DMatrix::from_fn(n, n, |i, k| f64::from(u8::from(i == k)) - b[i] * b[k]);
    let largest_entry = matrix.amax() * n as f64;
    let beyond = DMatrix::from_fn(n, n, |i, k| largest_entry * b[i] * b[k]);
    let projected = &projection * matrix.clone() * &projection + beyond;
    let mut expected: Vec<f64> = projected.symmetric_eigenvalues().iter().copied().collect();
    let mut free_values: Vec<f64> = matrix.symmetric_eigenvalues().iter().copied().collect();
    expected.sort_by(f64::total_cmp);
    free_values.sort_by(f64::total_cmp);
    let modes = solid.modes(&state, 6, &STRICT)?;
    println!("{:?}\n{:?}\nfree {:?}", modes.eigenvalues, &expected[..6], &free_values[..6]);
    for (k, (found, expected)) in modes.eigenvalues.iter().zip(&expected).enumerate() {
        assert!((found / expected - 1.0).abs() < 1e-8, "mode {k}: {found} instead of {expected}");
        let change = dot(&border[..dofs], &modes.shapes[k]);
        assert!(change.abs() < 1e-9 * norm(&border), "mode {k} changes the volume by {change:e}");
    }
    // the breathing mode is gone
    assert!((free_values[0] / expected[0] - 1.0).abs() > 1e-3);
    let vibrations = solid.model().vibration_modes(&state, 3, &STRICT)?;
    assert!(vibrations.iter().all(|mode| dot(&border[..dofs], &mode.shape).abs() < 1e-9 * norm(&border)));
    Ok(())
}

/// A column that a tendon draws together, beyond its critical length: straight it is a saddle, buckled to either side a minimum.
#[test]
fn a_drawn_column_has_three_equilibria() -> Outcome {
    let axis = Tendon::through("axis", [[0.0, 0.5, 0.0], [20.0, 0.5, 0.0]]).inextensible();
    let solid = Solid::new(rectangle([20.0, 1.0], [20, 2], CellKind::Quad9)?)?
        .material("body", NeoHooke::new(0.5 * YOUNG, 0.0)?)?
        .clamp("x-")?
        .tendon(axis)?;
    let pull = 2.0 * std::f64::consts::PI.powi(2) / 12.0 / 20.0;
    let straight = solid.solve(&with(&solid, &[pull]), &STRICT)?;
    let (how, mut workspace) = (SolveOptions::default(), Workspace::default());
    assert_eq!(solid.negative_pivots(&straight)?, 1);
    assert_eq!(solid.modes(&straight, 1, &how)?.negative, 1);
    let all = solid.model().stability().equilibria(&straight, 3, &how, &mut workspace, &mut |_| ())?;
    let negative: Vec<_> = all.found.iter().map(|found| found.negative).collect();
    println!("{negative:?} from {} starts, {} Newton", all.starts, all.newton);
    assert_eq!(negative, [Some(1), Some(0), Some(0)]);
    let dofs = solid.discretization().dofs();
    let [_, up, down] = &all.found[..] else { panic!("three") };
    assert!((up.state.u[dofs] / down.state.u[dofs] - 1.0).abs() < 1e-8, "mirror images have one tension");
    let descent = solid.model().stability().descend(&straight, &how, &mut workspace)?;
    assert!(descent.saddles == 1 && descent.state.report.energy < straight.report.energy);
    let same = |found: &State| largest(&sub(&found.u[..dofs], &descent.state.u[..dofs])) < 1e-6;
    assert!(same(&up.state) || same(&down.state));
    Ok(())
}

/// Forces that turn with the nodes, `f (1 + s u_y, -s u_x, 0)`, beside a tendon that cannot stretch: the tension found, given, leads to the same
/// state, and the adjoint of the transposed tangent is that of the solutions.
#[test]
fn constraints_go_without_a_potential() -> Outcome {
    let body = |tendon: Tendon| -> Outcome<Solid> {
        Ok(Solid::new(regular(CellKind::Hex8, [2.0, 0.5, 0.5], [6, 2, 2])?)?
            .material("body", NeoHooke::new(40.0, 50.0)?)?
            .clamp("x-")?
            .tendon(tendon)?
            .contribution(Swirl { nodes: vec![62, 60, 41], rate: 1.5 })?)
    };
    let way = || Tendon::through("cable", [[0.0, 0.45, 0.05], [1.0, 0.47, 0.04], [2.0, 0.45, 0.05]]).spacing(0.25);
    let (held, driven) = (body(way().inextensible())?, body(way())?);
    let (at, dofs) = ([0.1, 0.4], held.discretization().dofs());
    let state = held.solve(&with(&held, &at), &STRICT)?;
    let tension = state.u[dofs];
    let same = driven.solve(&with(&driven, &[tension, at[1]]), &STRICT)?;
    let apart = norm(&sub(&state.u[..dofs], &same.u)) / norm(&same.u);
    println!("tension {tension:.4}, apart {apart:.1e}, moved {:.3}", largest(&same.u));
    assert!(tension > 0.1 && apart < 1e-9 && largest(&same.u) > 0.02, "{tension}, {apart:e}");
    let mut cost: Vec<f64> = (0..state.u.len()).map(noise).collect();
    held.supports().clear(&mut cost);
    let minus: Vec<f64> = cost.iter().map(|c| -c).collect();
    let lambda = held.adjoint(&state, &[&minus], &STRICT)?.lambda.remove(0);
    let slopes = held.model().vjp(&Instant::new(&state.u, &state.controls, 1.0), &lambda)?.controls;
    let value = |m: [f64; 2]| -> Outcome<f64> {
        let u = held.solve(&with(&held, &m), &SolveOptions { near: Some(&state), ..STRICT })?.u;
        Ok(dot(&u, &cost))
    };
    let direction = [0.7, -1.0];
    let slope = direction[0] * slopes.values(0)[0] + direction[1] * slopes.values(1)[0];
    let base = value(at)?;
    let remainder = |t: f64| -> Outcome<f64> {
        Ok((value([at[0] + t * direction[0], at[1] + t * direction[1]])? - base - t * slope).abs())
    };
    let order = (remainder(4e-3)? / remainder(1e-3)?).log2() / 2.0;
    println!("Taylor order {order:.4}, slope {slope:.4}");
    assert!(order > 1.95 && order < 2.05, "Taylor order {order}");
    let error = held.modes(&state, 1, &STRICT).err();
    assert!(matches!(error, Some(StateError::Problem(FemError::Unsupported { .. }))), "{error:?}");
    Ok(())
}
