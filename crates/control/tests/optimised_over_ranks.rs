//! Smoothed Hausdorff distances of one body over ranks, which are threads here, and whole optimisations.

use crate::ranks::{Outcome, apart, bar, on, part, valued};
use nastic_control::{ControlNorm, ControlSmoothness, Metric, Reduced, SmoothedHausdorff, Space, Target, Tracking};
use nastic_energy::{FiberTension, MooneyRivlin};
use nastic_fem::Solid;
use nastic_mesh::{CellKind, Mesh, box_mesh};
use nastic_opt::{Bounds, Lbfgs, Objective, Optimizer, ProjectedGradient, Spectral, Start};
use nastic_tensor::Vec3;

const RANKS: [(usize, bool); 4] = [(1, false), (2, false), (3, true), (5, false)];

fn body(solid: Solid) -> Outcome<Reduced> {
    let solid = solid
        .material("body", MooneyRivlin::new(1e5, 2e4, 1e6)?)?
        .actuate("body", "tension", FiberTension::along(Vec3::x())?)?
        .clamp("x-")?;
    Ok(Reduced::new(solid).sequential())
}

/// The bar bent upwards, on a mesh of its own.
fn bent() -> Outcome<Mesh> {
    let bend = |x: [f64; 3]| {
        let (s, c) = (0.5 * x[0]).sin_cos();
        [(2.0 - x[2]) * s, x[1], 2.0 - (2.0 - x[2]) * c]
    };
    Ok(box_mesh([1.0, 0.2, 0.2], [5, 1, 1], CellKind::Hex20)?.mapped(bend)?)
}

fn shaped(solid: Solid, region: Option<&str>) -> Outcome<Reduced> {
    let distance = SmoothedHausdorff::to(bent()?).stages([(2.0, 4.0, 4.0), (4.0, 8.0, 4.0)]);
    let distance = region.into_iter().fold(distance, |distance, region| distance.region(region));
    Ok(body(solid)?.control("tension", Space::Node)?.cost(distance)?)
}

fn tracked(solid: Solid) -> Outcome<Reduced> {
    let lifted = Target::position(|x| [0.96 * x[0], x[1], x[2] + 0.25 * x[0] * x[0]]);
    Ok(body(solid)?
        .control("tension", Space::Cell)?
        .cost(Tracking::surface(["x+", "z-"], lifted))?
        .cost(ControlNorm::of("tension", 1e-15)?)?
        .cost(ControlSmoothness::of("tension", 1e-15)?)?)
}

/// `m = -(1 to 3) 1e4 Pa`, more where the bar is thicker in z.
fn control(problem: &Reduced) -> Vec<f64> {
    problem.layout().blocks()[0].basis.positions().iter().map(|x| -1e4 * (1.0 + 10.0 * x[2])).collect()
}

#[test]
fn smoothed_distances_and_their_derivatives_are_those_of_one_process() -> Outcome {
    let mesh = bar(CellKind::Hex8, 2)?;
    for region in [None, Some("far")] {
        let serial = shaped(Solid::new(mesh.clone())?, region)?;
        let m = control(&serial);
        let (cost, derivative) = valued(&serial, &m)?;
        for (ranks, scattered) in RANKS {
            let found = on(ranks, |rank| {
                let problem = shaped(part(&mesh, &rank, scattered)?, region)?;
                assert_eq!(problem.costs()[0].size(), serial.costs()[0].size());
                valued(&problem, &m)
            });
            let (own, own_derivative) = found[0].clone()?;
            assert!(found.iter().all(|other| *other == found[0]), "{region:?} on {ranks}: not the same bits");
            assert!((own - cost).abs() < 1e-9 * cost, "{region:?} on {ranks}: {own:e} {cost:e}");
            let off = apart(&own_derivative, &derivative);
            assert!(off < 1e-8, "{region:?} on {ranks}: the derivative is off by {off:e}");
        }
    }
    Ok(())
}

#[test]
fn derivatives_of_smoothed_distances_are_those_of_differences() -> Outcome {
    let mesh = bar(CellKind::Hex8, 2)?;
    let along =
        |m: &[f64], h: f64| -> Vec<f64> { (0..m.len()).map(|k| m[k] + 2e4 * h * (1.0 + k as f64).sin()).collect() };
    let found = on(3, |rank| {
        let problem = shaped(part(&mesh, &rank, true)?, None)?;
        let m = control(&problem);
        let (cost, derivative) = valued(&problem, &m)?;
        let slope: f64 = along(&m, 1.0).iter().zip(&m).zip(&derivative).map(|((a, b), d)| (a - b) * d).sum();
        let remainder = |h: f64| -> Outcome<f64> { Ok(problem.at(&along(&m, h))?.cost() - cost - h * slope) };
        Ok((remainder(0.2)? / remainder(0.1)?).log2())
    });
    for order in found {
        let order = order?;
        assert!(order > 1.95, "Taylor remainders: {order}");
    }
    Ok(())
}

/// Cost, control and iterations at the end of a run of so many iterations.
fn optimised(problem: &Reduced, method: impl Optimizer, iterations: usize) -> Outcome<(f64, Vec<f64>, usize)> {
    let start = Start::from(problem.at(&control(problem))?);
    let best = method.within(Bounds::new(-2e5, 0.0)?).max_iterations(iterations).minimize(problem, start)?;
    Ok((best.cost, best.m, best.counts.iterations))
}

fn assert_same_optimum(
    make: impl Fn(Solid) -> Outcome<Reduced> + Sync,
    method: impl Optimizer + Clone,
    iterations: usize,
) -> Outcome {
    let mesh = bar(CellKind::Hex8, 2)?;
    let serial = make(Solid::new(mesh.clone())?)?;
    let start = serial.at(&control(&serial))?.cost();
    let (cost, _, taken) = optimised(&serial, method.clone(), iterations)?;
    assert!(taken > 5 && cost < 0.9 * start, "{taken} iterations: {start} to {cost}");
    for (ranks, scattered) in RANKS {
        let found = on(ranks, |rank| optimised(&make(part(&mesh, &rank, scattered)?)?, method.clone(), iterations));
        let (own, ..) = found[0].clone()?;
        assert!(found.iter().all(|other| *other == found[0]), "on {ranks}: not the same bits");
        assert!((own - cost).abs() < 1e-6 * cost, "on {ranks}: {own:e} {cost:e}");
    }
    Ok(())
}

#[test]
fn a_tracking_problem_ends_at_the_optimum_of_one_process() -> Outcome {
    assert_same_optimum(tracked, Lbfgs::default(), 10)?;
    assert_same_optimum(tracked, ProjectedGradient::default(), 8)?;
    assert_same_optimum(tracked, Spectral::default(), 8)?;
    let smooth = |solid: Solid| -> Outcome<Reduced> { Ok(tracked(solid)?.metric(Metric::H1 { length: 0.05 })) };
    assert_same_optimum(smooth, Lbfgs::default(), 8)
}

#[test]
fn a_hausdorff_problem_ends_at_the_optimum_of_one_process_through_its_stages() -> Outcome {
    let whole = |solid: Solid| shaped(solid, None);
    assert_eq!(whole(Solid::new(bar(CellKind::Hex8, 2)?)?)?.stages(), 2);
    assert_same_optimum(whole, Lbfgs::default(), 12)
}
