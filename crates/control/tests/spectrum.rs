//! The spectrum of the reduced Hessian of a body: residuals, differences of the cost, threads.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use nastic_control::{Evaluated, Metric, Reduced, ReducedWorkspace, Space, Target, Tracking};
use nastic_energy::{FiberTension, MooneyRivlin};
use nastic_fem::Solid;
use nastic_mesh::{CellKind, box_mesh};
use nastic_numeric::vector::{axpy, dot};
use nastic_opt::{
    Admissible, Best, Bounds, Domain, NewtonCg, Objective, Optimizer, Options, Problem, Spectrum, SpectrumOptions,
};
use nastic_tensor::Vec3;
use std::sync::Arc;

type Outcome<T = ()> = Result<T, Box<dyn std::error::Error>>;

/// A bar that should take the shape which tensions beyond its bound would give it, by cells or by nodes in H1, at its optimum.
fn optimum(space: Space, length: f64) -> Outcome<(Reduced, Best<Evaluated>)> {
    let solid = Solid::new(box_mesh([1.0, 0.2, 0.2], [5, 2, 2], CellKind::Hex8)?)?
        .material("body", MooneyRivlin::new(1e5, 2e4, 1e6)?)?
        .actuate("body", "tension", FiberTension::along(Vec3::x())?)?
        .clamp("x-")?;
    let problem = Reduced::new(solid).control("tension", space)?;
    let problem = if length > 0.0 { problem.metric(Metric::H1 { length }) } else { problem };
    let n = problem.layout().len();
    let wanted: Vec<f64> = (0..n).map(|i| -5e4 * (1.0 + 0.5 * (12.9898 * i as f64).sin())).collect();
    let u = problem.at(&wanted)?.state().u.to_vec();
    let problem = problem.cost(Tracking::region("body", Target::Displacement(u)))?;
    let options = Options { tolerance: 1e-9, max_iterations: 60, ..Options::default() };
    let best = NewtonCg::exact().within(bounds()).options(options).minimize(&problem, 0.0)?;
    assert!(best.active > 0 && best.active < n);
    Ok((problem, best))
}

fn bounds() -> Bounds {
    Bounds::new(-7e4, 0.0).unwrap()
}

fn spectrum(problem: &Reduced, best: &Best<Evaluated>, count: usize) -> Outcome<Spectrum> {
    let domain = Domain { set: Arc::new(bounds()), metric: problem.inner_product()?, cancel: None };
    let mut workspace = ReducedWorkspace::default();
    let at = (best.m.as_slice(), &mut best.point.clone());
    Ok(Spectrum::at(problem, at.0, at.1, &domain, &SpectrumOptions::leading(count), &mut workspace)?)
}

#[test]
fn eigenpairs_of_a_body() -> Outcome {
    for (space, length) in [(Space::Cell, 0.0), (Space::Node, 0.3)] {
        let (problem, best) = optimum(space, length)?;
        let found = spectrum(&problem, &best, 5)?;
        assert_eq!((found.values.len(), found.negative), (5, 0));
        assert_eq!(found.free, best.m.len() - best.active);
        assert!(found.residuals.iter().all(|residual| *residual < 1e-6), "{:?}", found.residuals);
        let metric = problem.inner_product()?;
        let face = bounds().face(&best.m, &vec![0.0; best.m.len()], &best.derivative);
        for (k, v) in found.vectors.iter().enumerate() {
            for (l, other) in found.vectors.iter().enumerate() {
                assert!((metric.inner(v, other) - f64::from(k == l)).abs() < 1e-9);
            }
            assert_eq!(face.projected(v), *v);
            // Differences of derivatives far from the identity: (dj(m + s v) - dj(m - s v)) . v / 2 s, s of the size of the control.
            let size = v.iter().fold(0.0f64, |most, v| most.max(v.abs()));
            let slope = |s: f64| -> Outcome<f64> {
                let mut m = best.m.clone();
                axpy(s, v, &mut m);
                let mut point = problem.at(&m)?;
                Ok(dot(&problem.derivative(&mut point, &mut ReducedWorkspace::default())?, v))
            };
            let s = 50.0 / size;
            let difference = (slope(s)? - slope(-s)?) / (2.0 * s);
            assert!((difference - found.values[k]).abs() < 1e-5 * found.values[0], "{k}: {difference:e}");
        }
    }
    Ok(())
}

#[test]
fn the_same_bits_for_one_and_three_threads() -> Outcome {
    let (problem, best) = optimum(Space::Cell, 0.0)?;
    let on = |threads: usize| -> Outcome<Spectrum> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build()?;
        pool.install(|| spectrum(&problem, &best, 4).map_err(|error| error.to_string())).map_err(Into::into)
    };
    assert_eq!(on(1)?, on(3)?);
    Ok(())
}
