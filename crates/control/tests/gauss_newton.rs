//! Gauss-Newton's products, and the trust-region methods on bodies.

use nastic_control::{ControlNorm, Reduced, ReducedWorkspace, Space, Target, Tracking};
use nastic_energy::{FiberTension, Magnet, MooneyRivlin};
use nastic_ensemble::Ensemble;
use nastic_fem::Solid;
use nastic_mesh::{CellKind, box_mesh};
use nastic_opt::{Admissible, Ball, Bounds, NewtonCg, Optimizer, Options, Product, Sphere};
use nastic_tensor::Vec3;
use nastic_uncertainty::risk::Cvar;

type Outcome<T = ()> = Result<T, Box<dyn std::error::Error>>;

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn noise(n: usize, seed: f64) -> Vec<f64> {
    (0..n).map(|i| ((i as f64 + seed) * 12.9898).sin()).collect()
}

fn muscle(kind: CellKind) -> Outcome<Solid> {
    Ok(Solid::new(box_mesh([1.0, 0.2, 0.2], [4, 1, 2], kind)?)?
        .material("body", MooneyRivlin::new(1e5, 2e4, 1e6)?)?
        .actuate("body", "tension", FiberTension::along(Vec3::x())?)?
        .clamp("x-")?)
}

/// A bar that should take the shape which the tension `m` gives it, and the tensions.
fn inverse(kind: CellKind) -> Outcome<(Reduced, Vec<f64>)> {
    let problem = Reduced::new(muscle(kind)?).control("tension", Space::Cell)?;
    let m: Vec<f64> = noise(problem.layout().len(), 0.3).iter().map(|r| -6e4 * (1.0 + 0.5 * r)).collect();
    let u = problem.at(&m)?.state().u.to_vec();
    Ok((problem.cost(Tracking::surface("x+", Target::Displacement(u)))?, m))
}

/// At a shape that is met to rounding the residual of least squares vanishes, and with it all that Gauss and Newton leave out.
#[test]
fn without_a_residual_it_is_the_second_derivative() -> Outcome {
    for kind in [CellKind::Hex8, CellKind::Hex20, CellKind::Hex27] {
        let (problem, m) = inverse(kind)?;
        let mut workspace = ReducedWorkspace::default();
        let point = problem.at(&m)?;
        let v: Vec<f64> = noise(m.len(), 5.0).iter().map(|r| 1e4 * r).collect();
        let exact = problem.hessian_vector(&point, &v, &mut workspace)?;
        let linearised = problem.gauss_newton_vector(&point, &v, &mut workspace)?;
        // the second and the third time, with the matrix and the factor that the workspace keeps
        let again = problem.gauss_newton_vector(&point, &v, &mut workspace)?;
        let size = dot(&exact, &exact).sqrt();
        for other in [&linearised, &again, &problem.gauss_newton_vector(&point, &v, &mut workspace)?] {
            let off: Vec<f64> = exact.iter().zip(other).map(|(a, b)| a - b).collect();
            assert!(dot(&off, &off).sqrt() < 1e-6 * size, "{kind:?}: {:e} of {size:e}", dot(&off, &off).sqrt());
        }
        // elsewhere it is another one
        let elsewhere = problem.at(&vec![0.0; m.len()])?;
        let (exact, linearised) = (
            problem.hessian_vector(&elsewhere, &v, &mut workspace)?,
            problem.gauss_newton_vector(&elsewhere, &v, &mut workspace)?,
        );
        assert!((dot(&exact, &v) - dot(&linearised, &v)).abs() > 1e-2 * dot(&linearised, &v), "{kind:?}");
    }
    Ok(())
}

#[test]
fn it_is_symmetric_and_not_negative_with_risk_too() -> Outcome {
    let mut ensemble = Ensemble::new(Cvar { level: 0.3, ..Cvar::default() });
    for (name, weight) in [("soft", 1.0), ("stiff", 0.7)] {
        let (problem, _) = inverse(CellKind::Hex8)?;
        ensemble = ensemble.scenario(name, 0.5, problem.cost(ControlNorm::of("tension", 1e-12 * weight)?)?);
    }
    let ensemble = ensemble.build()?;
    let n = ensemble.len();
    let (m, mut workspace) = (vec![-2e4; n], Default::default());
    let point = ensemble.at(&m)?;
    let (v, w) = (noise(n, 1.0), noise(n, 9.0));
    let of_v = ensemble.gauss_newton_vector(&point, &v, &mut workspace)?;
    let of_w = ensemble.gauss_newton_vector(&point, &w, &mut workspace)?;
    assert!(dot(&of_v, &v) > 0.0 && dot(&of_w, &w) > 0.0);
    let size = (dot(&of_v, &v) * dot(&of_w, &w)).sqrt();
    assert!((dot(&of_v, &w) - dot(&of_w, &v)).abs() < 1e-7 * size);
    Ok(())
}

/// Inverse problems without a residual, with bounds that act: Newton's methods meet a tight tolerance in few iterations.
#[test]
fn few_iterations_within_bounds() -> Outcome {
    // where rounding ends the descent depends on the widest instructions of the processor: below 1e-7 on some, at 3e-6 on others
    let options = Options { tolerance: 1e-5, max_iterations: 30, ..Options::default() };
    for method in [NewtonCg::gauss_newton(), NewtonCg::exact()] {
        let (problem, wanted) = inverse(CellKind::Hex20)?;
        let set = Bounds::new(-7e4, 0.0)?;
        assert!(wanted.iter().any(|m| *m < -7e4));
        let name = method.name();
        let best = method.within(set).options(options).minimize(&problem, 0.0)?;
        assert!(best.stop.is_converged() && best.counts.iterations <= 25, "{name}: {}, {:?}", best.stop, best.counts);
        assert!(best.active > 0 && best.counts.products > 0);
    }
    Ok(())
}

/// A magnetisation of given length by cells and a field in a ball, on their way to a shape that others of them make.
#[test]
fn few_iterations_on_spheres_and_in_balls() -> Outcome {
    let solid = Solid::new(box_mesh([1.0, 0.2, 0.05], [4, 2, 1], CellKind::Hex20)?)?
        .material("body", MooneyRivlin::new(5e4, 5e4, 2e5)?)?
        .actuate("body", "magnet", Magnet::new())?
        .clamp("x-")?;
    let problem = Reduced::new(solid)
        .control("magnet.remanence", Space::Cell)?
        .control("magnet.field", Space::Uniform)?
        .weigh("magnet.remanence", 1.0 / (0.1 * 0.1))?
        .weigh("magnet.field", 1.0 / (20e-3 * 20e-3))?;
    let cells = problem.layout().blocks()[0].basis.len();
    let sphere = Sphere::new(3, 0.1)?;
    let set = Product::new().block(3 * cells, sphere.clone()).block(3, Ball::new(3, 20e-3)?);
    let begin = |towards: [f64; 3], field: [f64; 3]| {
        let mut m: Vec<f64> = (0..cells).flat_map(|_| towards).collect();
        m.extend(field);
        set.project(&mut m);
        m
    };
    let u = problem.at(&begin([1.0, 0.2, 0.3], [0.0, 0.0, 9e-3]))?.state().u.to_vec();
    let problem = problem.cost(Tracking::surface("x+", Target::Displacement(u)))?;
    let options = Options { tolerance: 1e-6, max_iterations: 60, ..Options::default() };
    for method in [NewtonCg::gauss_newton(), NewtonCg::exact()] {
        let name = method.name();
        let start = begin([1.0, 0.0, 0.0], [-1e-3, 2e-3, 4e-3]);
        let best = method.within(set.clone()).options(options).minimize(&problem, &start)?;
        let fall = best.cost / problem.at(&start)?.cost();
        assert!(best.stop.is_converged() && best.counts.iterations <= 30, "{name}: {}, {:?}", best.stop, best.counts);
        assert!(fall < 1e-6, "{name}: {fall:e}");
        set.check(&best.m)?;
    }
    Ok(())
}

/// Between two iterations the workspace may hold a tangent: a run that goes on from a checkpoint gives the same bits.
#[test]
fn a_run_taken_up_gives_the_same_bits() -> Outcome {
    let options = Options { tolerance: 1e-7, max_iterations: 6, ..Options::default() };
    let (problem, _) = inverse(CellKind::Hex8)?;
    let within =
        || NewtonCg::gauss_newton().within(Bounds::new(-7e4, 0.0).unwrap_or_else(|_| Bounds::none())).options(options);
    let mut run = within().start(&problem, 0.0)?;
    run.step(&mut ());
    run.step(&mut ());
    let state = run.checkpoint();
    let whole = run.minimize(&mut ());
    let again = within().resume(&problem, &state)?.minimize(&mut ());
    assert_eq!((whole.m, whole.cost), (again.m, again.cost));
    assert!(whole.counts == again.counts && whole.counts.products > 2, "{:?}", whole.counts);
    Ok(())
}
