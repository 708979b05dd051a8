//! Constraints of reduced problems: derivatives against differences, and an obstacle that is in the way.

use nastic_control::{
    ControlNorm, CostLimit, IntoConstraint, Obstacle, ObstacleDistance, Reduced, Space, Target, Tracking,
};
use nastic_energy::{FiberTension, NeoHooke};
use nastic_ensemble::Ensemble;
use nastic_fem::Solid;
use nastic_mesh::{CellKind, box_mesh, rectangle};
use nastic_opt::{
    AugmentedLagrangian, AugmentedRun, Bounds, Constrained, Domain, Lbfgs, Objective, Options, Outcome, Problem,
    Reason, Saved, Stop, Taylor, Trial,
};
use nastic_tensor::Vec3;
use nastic_uncertainty::risk::{Mean, MeanDeviation};
use std::sync::Arc;

type Done<T = ()> = Result<T, Box<dyn std::error::Error>>;

/// A bar whose upper and lower halves contract: its end is to move up by `lift`, through what stands in the way.
fn bar(young: f64, lift: f64) -> Done<Reduced> {
    let body = Solid::new(box_mesh([1.0, 0.2, 0.1], [6, 2, 1], CellKind::Hex8)?)?
        .material("body", NeoHooke::from_young_poisson(young, 0.3)?)?
        .actuate("body", "tension", FiberTension::along(Vec3::x())?)?
        .clamp("x-")?;
    let lifted = Target::position(move |x| [x[0] - 0.02, x[1] + lift, x[2]]);
    Ok(Reduced::new(body).control("tension", Space::Cell)?.cost(Tracking::surface("x+", lifted).weight(100.0))?)
}

/// Touched by the upper side of the bent bar.
fn ball() -> Obstacle {
    Obstacle::sphere([0.75, 0.37, 0.05], 0.14)
}

fn set() -> Done<Bounds> {
    Ok(Bounds::new(-1.2e5, 1.2e5)?)
}

fn domain(problem: &impl Problem) -> Done<Domain> {
    Ok(Domain { set: Arc::new(set()?), metric: problem.inner_product()?, cancel: None })
}

fn optimizer() -> Lbfgs {
    let options = Options { tolerance: 1e-4, max_iterations: 300, ..Options::default() };
    Lbfgs { options, ..Lbfgs::default() }
}

fn begin<O: Constrained + Problem>(problem: O) -> Done<AugmentedRun<O>> {
    let start = vec![0.0; problem.inner_product()?.len()];
    let domain = domain(&problem)?;
    Ok(AugmentedLagrangian::default().start(&optimizer(), problem, domain, start)?)
}

/// First and second derivatives of the augmented Lagrangian where constraints are violated.
fn taylor<O: Constrained + Problem>(problem: O, what: &str) -> Done {
    let n = problem.inner_product()?.len();
    let mut run = begin(problem)?;
    while run.progress().counts.iterations < 4 {
        run.step(&mut ());
    }
    let violated = |run: &AugmentedRun<O>| run.constraints().violation;
    assert!(violated(&run) > 0.0, "{what}: nothing is violated");
    let m = run.m().to_vec();
    let test = Taylor { second: true, length: 0.02, ..Taylor::default() };
    let report = test.test(run.augmented(), &set()?, &m)?;
    assert!(report.passed() && report.second_verdict().is_some(), "{what}, {n} controls: {report}");
    Ok(())
}

#[test]
fn derivatives_of_the_augmented_lagrangian() -> Done {
    // All nodes of the end are inside: no kink comes in between.
    let wall = Obstacle::half_space([0.0, 0.3, 0.0], [0.0, 1.0, 0.0]);
    taylor(bar(3e5, 0.2)?.constrain(ObstacleDistance::surface("x+", wall))?, "half-space")?;
    let around = Obstacle::sphere([1.1, 0.1, 0.05], 0.7);
    taylor(bar(3e5, 0.2)?.constrain(ObstacleDistance::nodes("x+", around).clearance(0.1))?, "sphere")?;
    let capsule = Obstacle::capsule([1.0, -0.1, -1.0], [1.2, -0.1, 1.0], 0.8);
    taylor(bar(3e5, 0.2)?.constrain(ObstacleDistance::nodes("x+", capsule))?, "capsule")?;
    let brick = Obstacle::aligned_box([0.9, -0.9, -0.9], [2.0, -0.1, 2.0]);
    taylor(bar(3e5, 0.2)?.constrain(ObstacleDistance::nodes("x+", brick.clone()).clearance(0.5))?, "box")?;
    let meshed =
        box_mesh([1.1, 0.8, 2.9], [2, 1, 3], CellKind::Tet4)?.mapped(|x| [x[0] + 0.9, x[1] - 0.9, x[2] - 0.9])?;
    let meshed = Obstacle::solid(&meshed)?;
    for x in [[0.8, 0.1, 0.3], [1.2, -0.4, 0.1], [0.7, 0.05, -1.1]] {
        assert!((meshed.distance(&x) - brick.distance(&x)).abs() < 1e-14);
    }
    taylor(bar(3e5, 0.2)?.constrain(ObstacleDistance::nodes("x+", meshed.clone()).clearance(0.5))?, "mesh")?;
    let bent = box_mesh([1.1, 0.8, 2.9], [3, 1, 3], CellKind::Tet4)?
        .mapped(|x| [x[0] + 0.9, x[1] - 0.9 - 0.3 * x[0] * x[0], x[2] - 0.9])?;
    let on_grid = Obstacle::on_grid(&bent, 0.2, 1.0)?;
    taylor(bar(3e5, 0.2)?.constrain(ObstacleDistance::nodes("x+", on_grid.clone()).clearance(0.5))?, "grid")?;
    let beyond = bar(3e5, 0.2)?.constrain(ObstacleDistance::nodes("x+", on_grid).clearance(1.5));
    let message = beyond.err().ok_or("further than the grid")?.to_string();
    assert!(message.contains("the clearance 1.5 from an obstacle is more than the margin of its grid"), "{message}");
    let refused = ObstacleDistance::nodes("x+", Obstacle::solid(&rectangle([1.0; 2], [1, 1], CellKind::Quad4)?)?);
    let message = bar(3e5, 0.2)?.constrain(refused).err().ok_or("in the plane")?.to_string();
    assert!(message.contains("2 dimensions and the body 3"), "{message}");
    let still = || Tracking::surface("y+", Target::position(|x| x)).weight(10.0);
    taylor(bar(3e5, 0.2)?.constrain(CostLimit::at_most(still(), 1e-4).scale(1e-2))?, "tracking")?;
    let both = bar(3e5, 0.2)?
        .constrain(CostLimit::equal(ControlNorm::of("tension", 1e-10)?, 1e-3))?
        .constrain(CostLimit::at_most(still(), 1e-4).scale(1e-2))?;
    assert_eq!(both.constraints().len(), 2);
    taylor(both, "control norm and tracking")
}

#[test]
fn derivatives_over_an_ensemble() -> Done {
    let member = |young: f64| -> Done<Reduced> {
        let wall = Obstacle::half_space([0.0, 0.3, 0.0], [0.0, 1.0, 0.0]);
        Ok(bar(young, 0.2)?.constrain(ObstacleDistance::nodes("x+", wall))?)
    };
    let linear = Ensemble::new(Mean).scenario("soft", 0.4, member(2.5e5)?).scenario("stiff", 0.6, member(3.5e5)?);
    let linear = linear.build()?;
    let names: Vec<String> = linear.constraints().into_iter().map(|group| group.name).collect();
    assert_eq!(names, ["soft/obstacle", "stiff/obstacle"]);
    taylor(linear, "mean")?;
    let bent = Ensemble::new(MeanDeviation { lambda: 0.5 });
    let bent = bent.scenario("soft", 0.4, member(2.5e5)?).scenario("stiff", 0.6, member(3.5e5)?).build()?;
    let mut run = begin(bent)?;
    // Where no scenario differs the deviation has a kink: not at the start.
    while run.progress().counts.iterations < 3 {
        run.step(&mut ());
    }
    let m = run.m().to_vec();
    let report = Taylor { second: true, length: 0.02, ..Taylor::default() }.test(run.augmented(), &set()?, &m)?;
    assert!(report.passed() && report.second_verdict().is_some(), "{report}");
    Ok(())
}

/// The bar goes around the ball: feasible to 1e-8 of its length, multipliers at the nodes that touch it alone; saved and loaded it goes
/// on to the bit.
#[test]
fn a_bar_keeps_out_of_a_ball() -> Done {
    let keep_out = || ObstacleDistance::surface("y+", ball());
    let free = bar(3e5, 0.2)?.constrain(keep_out())?;
    let alone = nastic_opt::Optimizer::within(optimizer(), set()?).minimize(&free, 0.0)?;
    let entered = alone.point.constraints.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    assert!(entered > 5e-3, "the unconstrained optimum is to enter the ball: {entered:e}");

    let mut reasons = Vec::new();
    let mut run = begin(&free)?;
    let mut observe = |trial: &Trial<'_, _>| reasons.push((trial.reason.clone(), trial.summary.get("violation")));
    let stop = run.run(&mut observe);
    let found = run.finish(stop);
    assert!(found.best.stop.is_converged(), "{}", found.best.stop);
    let group = &found.constraints.groups[0];
    assert!(group.violation() <= 1e-8 * free.solid().mesh().diagonal(), "{:e}", group.violation());
    assert!(group.active() > 0 && group.active() < group.values.len());
    for (c, y) in group.values.iter().zip(&group.multipliers) {
        assert!(*y >= 0.0 && (*y == 0.0 || c.abs() <= 1e-8 * group.group.scale), "{c:e} {y:e}");
    }
    // What is forbidden costs, and touching is all it takes.
    assert!(found.best.cost > alone.cost);
    assert_eq!(found.best.cost, free.value(&found.best.point));
    assert!(reasons.iter().any(|(reason, _)| *reason == Reason::Multipliers));
    let whole = interrupted(&free, usize::MAX)?;
    let pieces = interrupted(&free, 1)?;
    assert_eq!(whole, pieces);
    Ok(())
}

/// Twelve steps with checkpoints every third; the run is loaded from every `every`-th of them.
fn interrupted(problem: &Reduced, every: usize) -> Done<(Vec<f64>, Vec<f64>, f64)> {
    let mut run = begin(problem)?;
    for step in 0..12 {
        if step % 3 == 0 {
            let bytes = run.checkpoint().to_bytes();
            if (step / 3) % every == 0 && every != usize::MAX {
                let state = nastic_opt::AugmentedState::from_bytes(&bytes)?;
                run = AugmentedLagrangian::default().load(&optimizer(), problem, domain(&problem)?, &state)?;
            }
        }
        if let Outcome::Stopped(_) = run.step(&mut ()) {
            break;
        }
    }
    let end = run.finish(Stop::Cancelled);
    let multipliers = end.constraints.groups[0].multipliers.clone();
    Ok((end.best.m, multipliers, end.best.cost))
}

#[test]
fn distances_of_obstacles() {
    let sphere = Obstacle::sphere([1.0, 2.0, 3.0], 0.5);
    assert!((sphere.distance(&[1.0, 2.0, 5.0]) - 1.5).abs() < 1e-15);
    assert!((sphere.distance(&[1.0, 2.0, 3.0]) + 0.5).abs() < 1e-15);
    let floor = Obstacle::half_space([0.0, 0.0, 1.0], [0.0, 0.0, 2.0]);
    assert!((floor.distance(&[7.0, -3.0, 1.25]) - 0.25).abs() < 1e-15 && floor.distance(&[0.0; 3]) == -1.0);
    let rod = Obstacle::capsule([0.0; 3], [0.0, 0.0, 2.0], 0.1);
    assert!((rod.distance(&[0.3, 0.4, 1.0]) - 0.4).abs() < 1e-15);
    assert!((rod.distance(&[0.0, 3.0, 6.0]) - 4.9).abs() < 1e-15);
    assert!((rod.distance(&[0.0, 0.0, -1.0]) - 0.9).abs() < 1e-15);
    let brick = Obstacle::aligned_box([0.0; 3], [2.0, 3.0, 4.0]);
    // inside, before a face, beside an edge, off a corner
    for (x, d) in [([1.0, 1.5, 3.6], -0.4), ([1.0, -0.7, 2.0], 0.7), ([2.3, 3.4, 1.0], 0.5), ([-2.0, 4.0, 6.0], 3.0)] {
        assert!((brick.distance(&x) - d).abs() < 1e-15, "{x:?}: {}", brick.distance(&x));
    }
}

#[test]
fn constraints_that_make_no_sense_are_refused() -> Done {
    let body = bar(3e5, 0.2)?;
    let solid = body.solid();
    let refused =
        |what: &str, constraint: Result<Box<dyn nastic_control::Constraint>, nastic_control::ControlError>| {
            let error = constraint.map(|_| ()).expect_err(what).to_string();
            assert!(error.contains(what), "{error}");
        };
    let rest = || Tracking::surface("y+", Target::position(|x| x));
    refused("needs a scale", CostLimit::at_most(rest(), 0.0).bind(solid));
    refused("bound", CostLimit::at_most(rest(), f64::NAN).bind(solid));
    refused("radius -1", ObstacleDistance::surface("y+", Obstacle::sphere([0.0; 3], -1.0)).bind(solid));
    refused("normal", ObstacleDistance::surface("y+", Obstacle::half_space([0.0; 3], [0.0; 3])).bind(solid));
    let long = Obstacle::HalfSpace { point: [0.0; 3], normal: [0.0, 2.0, 0.0] };
    refused("has the length 2", ObstacleDistance::surface("y+", long).bind(solid));
    refused("clearance NaN", ObstacleDistance::surface("y+", ball()).clearance(f64::NAN).bind(solid));
    let empty = Obstacle::aligned_box([0.0; 3], [1.0, 0.0, 1.0]);
    refused("is empty", ObstacleDistance::surface("y+", empty).bind(solid));
    refused("top", ObstacleDistance::surface("top", ball()).bind(solid));
    Ok(())
}
