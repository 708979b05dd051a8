//! The reduced derivative against other codes and against Taylor's theorem.

use nastic_control::{
    ControlError, ControlNorm, ControlSmoothness, Evaluated, Metric, Reduced, ReducedWorkspace, SmoothedHausdorff,
    Space, Target, Tracking,
};
use nastic_energy::{FiberTension, MooneyRivlin, TransverseMooneyRivlin};
use nastic_ensemble::EnsembleError;
use nastic_fem::{Formulation, Solid, StateError};
use nastic_linear::{FactorError, LinearError};
use nastic_mesh::{CellKind, box_mesh};
use nastic_opt::{Bounds, Failed, Objective, Problem, Request, Taylor, Verdict};
use nastic_tensor::Vec3;

type Outcome<T = ()> = Result<T, Box<dyn std::error::Error>>;

fn cantilever(kind: CellKind, n: usize) -> Outcome<Solid> {
    Ok(Solid::new(box_mesh([1.0, 0.2, 0.2], [5 * n, n, n], kind)?)?
        .material("body", MooneyRivlin::new(1e5, 2e4, 1e6)?)?
        .actuate("body", "tension", FiberTension::along(Vec3::x())?)?
        .clamp("x-")?)
}

/// The end face turned by 0.55 rad and lifted.
fn lifted_face() -> Target {
    Target::position(|x| {
        let r = x[2] - 0.1;
        [0.90 - 0.55f64.sin() * r, x[1], 0.35 + 0.55f64.cos() * r]
    })
}

fn tracked(kind: CellKind, n: usize) -> Outcome<Reduced> {
    Ok(Reduced::new(cantilever(kind, n)?)
        .control("tension", Space::Node)?
        .cost(Tracking::surface("x+", lifted_face()))?)
}

/// Five independent codes agree on both numbers.
#[test]
fn value_and_derivative_of_the_check_case_agree_with_five_codes() -> Outcome {
    let problem = tracked(CellKind::Hex8, 2)?;
    let at_rest = problem.at(&vec![0.0; problem.layout().len()])?;
    assert!((at_rest.cost() / 0.0014696633970587 - 1.0).abs() < 1e-12, "{:e}", at_rest.cost());

    let m: Vec<f64> = problem.layout().blocks()[0].basis.positions().iter().map(|x| -1.5e5 * x[2] / 0.2).collect();
    let mut point = problem.at(&m)?;
    assert!((point.cost() / 1.85521855017e-5 - 1.0).abs() < 1e-9, "{:e}", point.cost());
    let derivative = problem.derivative(&mut point, &mut ReducedWorkspace::default())?;
    let norm = derivative.iter().map(|d| d * d).sum::<f64>().sqrt();
    assert!((norm / 2.0357999826e-10 - 1.0).abs() < 1e-9, "{norm:e}");
    Ok(())
}

/// A face integral of the rest position does not know the mesh.
#[test]
fn tracking_at_rest_is_the_same_on_every_element() -> Outcome {
    for kind in [CellKind::Hex8, CellKind::Hex20, CellKind::Hex27, CellKind::Tet4, CellKind::Tet10] {
        let problem = tracked(kind, 1)?;
        let point = problem.at(&vec![0.0; problem.layout().len()])?;
        assert!((point.cost() / 0.0014696633970587 - 1.0).abs() < 1e-12, "{kind}: {:e}", point.cost());
    }
    Ok(())
}

/// A bent target for the Hausdorff costs, on another mesh.
fn bent() -> Outcome<nastic_mesh::Mesh> {
    let bend = |x: [f64; 3]| {
        let (s, c) = (0.8 * x[0]).sin_cos();
        [(1.25 - x[2]) * s, x[1], 1.25 - (1.25 - x[2]) * c]
    };
    Ok(box_mesh([1.0, 0.2, 0.2], [7, 2, 1], CellKind::Hex20)?.mapped(bend)?)
}

fn assert_taylor(problem: &Reduced, what: &str) -> Outcome {
    problem.check()?;
    let m: Vec<f64> = (0..problem.layout().len()).map(|i| -4e4 - 2e4 * ((i * 37 % 11) as f64 / 11.0)).collect();
    let set = Bounds::new(-4e5, 1.9e5)?;
    for stage in 0..problem.stages() {
        let report = Taylor { stage, ..Taylor::default() }.test(problem, &set, &m)?;
        for direction in &report.directions {
            assert!(matches!(direction.verdict, Verdict::Right), "{what}, stage {stage}: {report}");
        }
    }
    Ok(())
}

/// Single costs: `costs.rs`.
#[test]
fn taylor_order_of_a_sum_of_costs_on_two_meshes() -> Outcome {
    for (kind, n) in [(CellKind::Hex8, 2), (CellKind::Tet10, 1)] {
        let mixed = Reduced::new(cantilever(kind, n)?)
            .control("tension", Space::Cell)?
            .cost(Tracking::surface("x+", lifted_face()).weight(2.0))?
            .cost(SmoothedHausdorff::to(bent()?).exponential(0.1).weight(0.1))?
            .cost(ControlNorm::of("tension", 1e-10)?)?
            .cost(ControlSmoothness::of("tension", 1e-11)?)?;
        assert_taylor(&mixed, "mixed costs")?;
    }
    Ok(())
}

#[test]
fn taylor_orders_of_every_space() -> Outcome {
    for space in [Space::Uniform, Space::Region, Space::Cell, Space::Node] {
        let problem = Reduced::new(cantilever(CellKind::Hex20, 1)?)
            .control("tension", space)?
            .cost(Tracking::surface("x+", lifted_face()))?
            .cost(ControlNorm::of("tension", 1e-10)?)?
            .cost(ControlSmoothness::of("tension", 1e-11)?)?;
        assert_taylor(&problem, space.name())?;
    }
    Ok(())
}

/// With F projected, of a stiff volume: two meshes of every formulation under fibre tensions, second derivatives too.
#[test]
fn taylor_orders_of_every_formulation() -> Outcome {
    for formulation in Formulation::ALL.into_iter().filter(|formulation| *formulation != Formulation::Standard) {
        let kinds = formulation.kinds().iter().filter(|kind| kind.dim() == 3);
        for (&kind, n) in kinds.flat_map(|kind| {
            if kind.order() > 1 {
                [(kind, [5, 1, 1]), (kind, [7, 2, 1])]
            } else {
                [(kind, [10, 2, 2]), (kind, [14, 3, 3])]
            }
        }) {
            let solid = Solid::new(box_mesh([1.0, 0.2, 0.2], n, kind)?)?
                .material("body", MooneyRivlin::new(1e5, 2e4, 5e7)?)?
                .formulation("body", formulation)?
                .actuate("body", "tension", FiberTension::along(Vec3::new(0.8, 0.0, 0.6))?)?
                .clamp("x-")?;
            let problem =
                Reduced::new(solid).control("tension", Space::Cell)?.cost(Tracking::surface("x+", lifted_face()))?;
            assert_taylor(&problem, &format!("{formulation}, {kind} {n:?}"))?;
            let m: Vec<f64> = (0..problem.layout().len()).map(|i| -2e4 - 1e4 * ((i * 37 % 11) as f64 / 11.0)).collect();
            let taylor = Taylor { second: true, directions: 1, ..Taylor::default() };
            let report = taylor.test(&problem, &Bounds::new(-4e5, 1.9e5)?, &m)?;
            assert!(matches!(report.second_verdict(), Some(Verdict::Right)), "{formulation}, {kind} {n:?}: {report}");
        }
    }
    Ok(())
}

/// Shear appears under tension in the anisotropic law, in three dimensions.
#[test]
fn taylor_order_in_the_transverse_law() -> Outcome {
    let fiber = Vec3::new(1.0, 1.0, 0.0).normalize();
    let solid = Solid::new(box_mesh([1.0, 0.2, 0.2], [4, 1, 1], CellKind::Hex27)?)?
        .material("body", TransverseMooneyRivlin::new(1e5, 0.2e5, 3e5, 10e5, fiber)?)?
        .actuate("body", "tension", FiberTension::along(Vec3::x())?)?
        .clamp("x-")?;
    assert_taylor(
        &Reduced::new(solid).control("tension", Space::Cell)?.cost(Tracking::surface("x+", lifted_face()))?,
        "transverse law",
    )
}

/// `derivative` is dual, `gradient` is its Riesz image: (gradient, v) = derivative . v in either product.
#[test]
fn gradients_represent_the_derivative_in_their_product() -> Outcome {
    for metric in [Metric::L2, Metric::H1 { length: 0.15 }] {
        for space in [Space::Node, Space::Cell] {
            let problem = Reduced::new(cantilever(CellKind::Hex8, 2)?)
                .control("tension", space)?
                .cost(Tracking::surface("x+", lifted_face()))?
                .metric(metric);
            let m = vec![-3e4; problem.layout().len()];
            let derivative = problem.derivative(&mut problem.at(&m)?, &mut ReducedWorkspace::default())?;
            let product = problem.inner_product()?;
            let gradient = product.riesz(&derivative);
            let v: Vec<f64> = (0..m.len()).map(|i| (i as f64 * 0.7).sin()).collect();
            let (a, b) = (product.inner(&gradient, &v), derivative.iter().zip(&v).map(|(d, v)| d * v).sum::<f64>());
            assert!((a / b - 1.0).abs() < 1e-10, "{metric:?}: {a:e} and {b:e}");
            // The weight of all ones is the volume, in L2 and in H1: constants have no gradient.
            let ones = vec![1.0; m.len()];
            assert!((product.inner(&ones, &ones) / 0.04 - 1.0).abs() < 1e-10);
        }
    }
    Ok(())
}

/// Three points on a line show where the state of a fourth is, nearly; a step across the line gets no guess.
#[test]
fn accepted_points_predict_the_next_state() -> Outcome {
    let problem = tracked(CellKind::Hex8, 2)?;
    let along = |t: f64| -> Vec<f64> {
        problem.layout().blocks()[0].basis.positions().iter().map(|x| -1e5 * t * x[2] / 0.2).collect()
    };
    let evaluate = |m: &[f64], near: Option<&Evaluated>, workspace: &mut ReducedWorkspace| {
        problem.evaluate(m, &Request { near, accuracy: 1e-6, stage: 0, ..Request::default() }, workspace)
    };
    // The same three points, then a fourth; or the third alone, which knows of no others.
    let fourth = |m: &[f64]| -> Outcome<[Evaluated; 2]> {
        let (mut run, mut alone) = (ReducedWorkspace::default(), ReducedWorkspace::default());
        let first = evaluate(&along(1.0), None, &mut run)?;
        let second = evaluate(&along(1.1), Some(&first), &mut run)?;
        let third = evaluate(&along(1.2), Some(&second), &mut run)?;
        Ok([evaluate(m, Some(&third), &mut run)?, evaluate(m, Some(&third), &mut alone)?])
    };
    let [with, without] = fourth(&along(1.3))?;
    assert!(with.work.newton < without.work.newton, "{:?}, {:?}", with.work, without.work);
    assert!((with.cost() / without.cost() - 1.0).abs() < 1e-6, "{:e}, {:e}", with.cost(), without.cost());

    let across: Vec<f64> = along(1.2).iter().enumerate().map(|(i, m)| m - 1e4 * (i as f64).sin()).collect();
    let [turned, alone] = fourth(&across)?;
    assert!((turned.cost() / alone.cost() - 1.0).abs() < 1e-6, "{:e}, {:e}", turned.cost(), alone.cost());
    Ok(())
}

/// A lack of memory says nothing about the control, so that an optimisation does not shorten its step for it.
#[test]
fn a_lack_of_memory_is_fatal_and_other_failures_are_not() {
    let failed = |error: LinearError| {
        let error = ControlError::from(StateError::from(error));
        let member = EnsembleError::Member { who: "soft".to_owned(), source: Box::new(error.clone()) };
        [Failed::from(error), Failed::from(member)].map(|failed| failed.is_fatal())
    };
    let lacking = FactorError::Memory { what: "a factor", needed: 2 << 30, available: 1 << 30 };
    assert_eq!(failed(lacking.clone().into()), [true; 2]);
    assert_eq!(failed(LinearError::TooLarge { source: Box::new(lacking.into()), gib: 9.0 }), [true; 2]);
    assert_eq!(failed(FactorError::Singular { node: 3, component: 0 }.into()), [false; 2]);
    assert_eq!(failed(LinearError::Singular { residual: 1e-3, wanted: 1e-11 }), [false; 2]);
}
