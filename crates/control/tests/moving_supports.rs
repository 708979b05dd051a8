//! Surfaces that move in time, as controls of motions and beside them.

use nastic_control::{
    ActuationWork, ControlRate, Interpolation, KineticEnergy, Knots, MeanPosition, MotionMemory, RateLimit, Reduced,
    Space, Target, Timeline, Tracking, When,
};
use nastic_energy::{FiberTension, MaxwellBranch, NeoHooke};
use nastic_fem::{Inertia, MovingSupport, Scheme, Solid};
use nastic_mesh::{CellKind, box_mesh, rectangle};
use nastic_opt::{Bounds, Lbfgs, Objective, Optimizer, Product, Taylor, Verdict};
use nastic_tensor::Vec3;
use std::sync::Arc;

type Done<T = ()> = Result<T, Box<dyn std::error::Error>>;

const END: f64 = 0.4;

/// A soft arm of 0.5 m on a gripper.
fn arm() -> Done<Solid> {
    Ok(Solid::new(box_mesh([0.5, 0.05, 0.05], [4, 1, 2], CellKind::Hex8)?)?
        .material("body", NeoHooke::from_young_poisson(1e5, 0.3)?)?
        .actuate("body", "tension", FiberTension::along(Vec3::x())?)?
        .motion(MovingSupport::of("gripper", "x-"))?
        .inertia(Inertia::new("body", 1000.0))?
        .rayleigh_damping(0.5, 1e-3)?)
}

fn knots() -> Done<Knots> {
    Ok(Knots::every(0.1, END, Interpolation::Linear)?)
}

fn driven(solid: Solid, scheme: Scheme, memory: MotionMemory) -> Done<Reduced> {
    let raised = Target::position(|x| [x[0], x[1] + 0.02, x[2] + 0.1]);
    Ok(Reduced::new(solid)
        .in_time(Timeline::uniform(scheme, END, 16)?.segments_of(4).keep(memory))?
        .control_in_time("gripper.translation", Space::Uniform, knots()?)?
        .control_along_in_time("gripper.rotation", Space::Uniform, [0.0, 1.0, 0.0], knots()?)?
        .control("tension", Space::Cell)?
        .cost(Tracking::surface("x+", raised))?
        .cost_when(When::Integral, MeanPosition::surface("x-", [None, None, Some(0.03)]))?
        .limit_rate(RateLimit::of("gripper.translation", 1.0)?)?)
}

fn wave(problem: &Reduced) -> Vec<f64> {
    let size = |unit: &str| if unit == "Pa" { 1e3 } else { 0.05 };
    let blocks = problem.layout().blocks().iter();
    blocks.flat_map(|b| (0..b.len()).map(|i| size(b.unit) * (0.3 + (i * 37 % 11) as f64 / 11.0))).collect()
}

/// By translation and rotation in time, and by a constant tension beside them, of motions that begin at the equilibrium under the first.
#[test]
fn derivatives_by_a_gripper_that_moves_are_exact() -> Done {
    let viscous = arm()?.viscosity("body", MaxwellBranch::new(1e4, 0.05)?)?;
    for (solid, scheme) in
        [(arm()?, Scheme::tr_bdf2()), (arm()?, Scheme::generalized_alpha(0.8)?), (viscous, Scheme::bdf2())]
    {
        let name = scheme.name();
        let problem = driven(solid, scheme, MotionMemory::All)?
            .trajectory_cost(KineticEnergy::new(When::Integral, 1.0)?)?
            .trajectory_cost(ControlRate::of("gripper.translation", 1e-3)?)?;
        let mut set = Product::new();
        for block in problem.layout().blocks() {
            let most = if block.unit == "Pa" { 5e3 } else { 0.2 };
            set.push(block.len(), Arc::new(Bounds::new(-most, most)?));
        }
        let m = wave(&problem);
        let blocks: Vec<_> = problem.layout().blocks().iter().map(|b| b.first..b.first + b.len()).collect();
        for components in blocks {
            let taylor = Taylor { components: Some(components), ..Taylor::default() };
            let report = taylor.test(&problem, &set, &m)?;
            assert_eq!(report.verdict(), Verdict::Right, "{name}: {report}");
            assert!(report.directions.iter().all(|direction| direction.order1 > 1.95), "{name}: {report}");
        }
    }
    Ok(())
}

#[test]
fn few_states_give_the_same_bits() -> Done {
    let derivative = |memory: MotionMemory| -> Done<(Vec<u64>, usize)> {
        let problem = driven(arm()?, Scheme::tr_bdf2(), memory)?;
        let mut workspace = Default::default();
        let mut point = problem.evaluate(&wave(&problem), &Default::default(), &mut workspace)?;
        let mut found = problem.derivative(&mut point, &mut workspace)?;
        found.extend(&point.terms);
        let again = point.solved.recording.counts().recomputed_steps;
        Ok((found.iter().map(|x| x.to_bits()).collect(), again))
    };
    let ((all, none), (few, again)) = (derivative(MotionMemory::All)?, derivative(MotionMemory::Checkpoints(2))?);
    assert!(none == 0 && again > 0 && all == few);
    Ok(())
}

/// A gripper carries an arm, which swings with 5 Hz, 0.1 m away in 0.4 s so that it stands still there, along a path that the optimiser finds: at constant speed it is left
/// swinging.
#[test]
fn a_gripper_carries_an_arm_without_leaving_it_swinging() -> Done {
    let arm = Solid::new(rectangle([0.1, 0.03], [4, 1], CellKind::Quad9)?)?
        .material("body", NeoHooke::from_young_poisson(1e5, 0.3)?)?
        .motion(MovingSupport::of("gripper", "x-"))?
        .inertia(Inertia::new("body", 1000.0))?
        .rayleigh_damping(0.0, 3e-3)?;
    let place = Target::position(|x| [x[0], x[1] + 0.1, x[2]]);
    let problem = Reduced::new(arm)
        .in_time(Timeline::uniform(Scheme::tr_bdf2(), END, 32)?.from_rest())?
        .control_along_in_time(
            "gripper.translation",
            Space::Uniform,
            [0.0, 1.0, 0.0],
            Knots::every(0.05, END, Interpolation::Linear)?,
        )?
        .cost(Tracking::region("body", place).weight(1e4))?
        .trajectory_cost(KineticEnergy::new(When::End, 1.0)?)?;
    let ends = |free: f64| [vec![0.0], vec![free; 7], vec![0.1]].concat();
    let m: Vec<f64> = (0..9).map(|k| 0.1 * f64::from(k) / 8.0).collect();
    let bounds = Bounds::new(ends(-0.3), ends(0.3))?;
    let best = Lbfgs::default().within(bounds).minimize(&problem, m.as_slice())?;
    let (before, after) = (problem.at(&m)?, problem.at(&best.m)?);
    println!(
        "{:?} J, before {:?} J, at {:.4?}, {} iterations",
        after.terms, before.terms, best.m, best.counts.iterations
    );
    assert!(after.cost() < 1e-3 * before.cost());
    Ok(())
}

#[test]
fn the_work_of_a_gripper_is_not_taken_for_nothing() -> Done {
    let refused = driven(arm()?, Scheme::tr_bdf2(), MotionMemory::All)?.trajectory_cost(ActuationWork::new(1.0)?);
    let refused = refused.err().ok_or("no error")?.to_string();
    assert!(refused.contains("gripper.translation") && refused.contains("control_rate"), "{refused}");
    // also of a control that comes later
    let later = Reduced::new(arm()?)
        .in_time(Timeline::uniform(Scheme::tr_bdf2(), END, 4)?)?
        .trajectory_cost(ActuationWork::new(1.0)?)?
        .control_in_time("gripper.translation", Space::Uniform, knots()?)?;
    let refused = later.at(&vec![0.0; later.layout().len()]).err().ok_or("no error")?.to_string();
    assert!(refused.contains("gripper.translation"), "{refused}");
    // beside a given motion it is that of the fibres
    let still = |moves: bool| -> Done<f64> {
        let problem = Reduced::new(arm()?)
            .in_time(Timeline::uniform(Scheme::tr_bdf2(), END, 4)?.from_rest())?
            .trajectory_cost(ActuationWork::new(1.0)?)?
            .control("tension", Space::Region)?;
        let along = move |t: f64| Ok(vec![if moves { t * t } else { 0.0 }]);
        let gripper = 1;
        let problem = problem.fix_in_time(gripper, 2, along)?;
        Ok(problem.at(&[0.0])?.terms[0])
    };
    assert_eq!((still(false)?, still(true)?), (0.0, 0.0));
    Ok(())
}
