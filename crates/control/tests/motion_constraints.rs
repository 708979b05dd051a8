//! Constraints that hold at instants of a motion: values, derivatives, and an arm that stays below a ceiling all the time.

use nastic_control::{
    ControlNorm, CostLimit, Evaluated, Instants, Interpolation, Knots, MeanPosition, MotionMemory, Obstacle,
    ObstacleDistance, RateLimit, Reduced, ReducedWorkspace, Space, Timeline, When,
};
use nastic_energy::{FiberTension, NeoHooke};
use nastic_fem::{Inertia, Scheme, Solid};
use nastic_mesh::{CellKind, box_mesh};
use nastic_opt::{
    AugmentedLagrangian, AugmentedRun, Bounds, Constrained, Domain, Lbfgs, Options, Problem, Request, Taylor, Verdict,
};
use nastic_tensor::Vec3;
use std::sync::Arc;

type Done<T = ()> = Result<T, Box<dyn std::error::Error>>;

const END: f64 = 0.2;
const STEPS: usize = 20;
/// Nodes of the arm's end.
const NODES: usize = 6;

/// A soft arm of 0.5 m whose first bending mode swings with about 4 Hz.
fn arm() -> Done<Solid> {
    Ok(Solid::new(box_mesh([0.5, 0.05, 0.05], [4, 1, 2], CellKind::Hex8)?)?
        .material("body", NeoHooke::from_young_poisson(1e5, 0.3)?)?
        .actuate("body", "tension", FiberTension::along(Vec3::x())?)?
        .clamp("x-")?
        .inertia(Inertia::new("body", 1000.0))?)
}

fn timeline(scheme: Scheme) -> Done<Timeline> {
    Ok(Timeline::uniform(scheme, END, STEPS)?.segments_of(4))
}

/// The end is to be lifted by 40 mm, at t = T alone.
fn lifted(timeline: Timeline) -> Done<Reduced> {
    Ok(Reduced::new(arm()?)
        .in_time(timeline)?
        .control_in_time("tension", Space::Cell, Knots::every(0.05, END, Interpolation::Linear)?)?
        .cost(MeanPosition::surface("x+", [None, None, Some(0.065)]).weight(100.0))?)
}

/// The end stays below this height.
fn below(z: f64) -> ObstacleDistance {
    ObstacleDistance::surface("x+", Obstacle::half_space([0.0, 0.0, z], [0.0, 0.0, -1.0]))
}

fn begin(problem: Reduced) -> Done<AugmentedRun<Reduced>> {
    let start: Vec<f64> = (0..problem.layout().len()).map(|i| -200.0 * (i % 5) as f64).collect();
    let domain = Domain { set: Arc::new(Bounds::new(-4e4, 4e4)?), metric: problem.inner_product()?, cancel: None };
    let options = Options { tolerance: 1e-2, max_iterations: 200, ..Options::default() };
    Ok(AugmentedLagrangian::default().start(&Lbfgs { options, ..Lbfgs::default() }, problem, domain, start)?)
}

/// Without controls and loads the body stays as it is: the values are known, those of the beginning are left out where it is given.
#[test]
fn there_is_a_value_for_every_instant() -> Done {
    for (timeline, instants) in
        [(timeline(Scheme::bdf2())?, STEPS + 1), (timeline(Scheme::tr_bdf2())?.from_rest(), STEPS)]
    {
        let problem = lifted(timeline)?
            .constrain(below(0.06))?
            .constrain_when(Instants::All, below(0.07))?
            .constrain_when(
                Instants::At(vec![0.1, 0.05, 0.1]),
                CostLimit::at_most(MeanPosition::surface("x+", [None, None, Some(0.035)]), 1e-5),
            )?
            .limit_rate(RateLimit::of("tension", 1e5)?)?;
        let names: Vec<(String, usize)> = problem.constraints().into_iter().map(|g| (g.name, g.len)).collect();
        let rates = 4 * 8;
        let expected =
            [("obstacle_0", NODES), ("obstacle_1", NODES * instants), ("position", 2), ("rate_tension", rates)];
        assert_eq!(names, expected.map(|(name, len)| (name.to_owned(), len)));
        assert_eq!(
            (problem.constraint_states(0), problem.constraint_states(2)),
            ([STEPS].as_slice(), [5, 10].as_slice())
        );
        let at = problem.at(&vec![0.0; problem.layout().len()])?;
        let heights = [0.0, 0.025, 0.05];
        let close = |value: f64, bound: f64| heights.iter().any(|z| (value - (z - bound)).abs() < 1e-12);
        assert_eq!(at.constraints.len(), NODES * (1 + instants) + 2 + rates);
        assert!(at.constraints[..NODES].iter().all(|c| close(*c, 0.06)), "{:?}", &at.constraints[..NODES]);
        assert!(at.constraints[NODES..][..NODES * instants].iter().all(|c| close(*c, 0.07)));
        // (0.025 m - 0.035 m)^2 / 2
        let limits = &at.constraints[NODES * (1 + instants)..][..2];
        assert!(limits.iter().all(|c| (c - (0.5e-4 - 1e-5)).abs() < 1e-15), "{limits:?}");
    }
    Ok(())
}

/// Constraints of all kinds: at the end, at instants, always, of nodes and of costs, beside a limited rate.
fn held(timeline: Timeline, first: f64) -> Done<Reduced> {
    let near = || MeanPosition::surface("x+", [None, None, Some(0.03)]);
    Ok(lifted(timeline)?
        .cost_when(When::Integral, ControlNorm::of("tension", 1e-9)?)?
        .constrain_when(Instants::All, below(0.045))?
        .constrain_when(Instants::At(vec![first, 0.07]), CostLimit::at_most(near(), 1e-8))?
        .constrain(CostLimit::equal(near(), 1e-6))?
        .limit_rate(RateLimit::of("tension", 1e4)?)?)
}

#[test]
fn derivatives_under_constraints_at_instants_are_right() -> Done {
    let problems = [
        held(timeline(Scheme::tr_bdf2())?, 0.0)?,
        held(timeline(Scheme::bdf2())?.from_rest(), 0.01)?,
        held(timeline(Scheme::implicit_midpoint())?, 0.0)?,
        held(timeline(Scheme::generalized_alpha(0.5)?)?.from_rest(), 0.01)?,
    ];
    for problem in problems {
        let name = problem.timeline().map_or("", |timeline| timeline.scheme().name());
        let mut run = begin(problem)?;
        while run.progress().counts.iterations < 3 {
            run.step(&mut ());
        }
        let violated = run.constraints().groups.iter().filter(|group| group.violation() > 0.0).count();
        assert!(violated >= 3, "{name}: {violated} constraints are violated");
        let m = run.m().to_vec();
        let test = Taylor { directions: 2, ..Taylor::default() };
        let report = test.test(run.augmented(), &Bounds::new(-4e4, 4e4)?, &m)?;
        assert_eq!(report.verdict(), Verdict::Right, "{name}: {report}");
    }
    Ok(())
}

#[test]
fn few_states_give_the_same_bits() -> Done {
    let bits = |values: &[f64]| values.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
    let run = |memory: MotionMemory| -> Done<[Vec<u64>; 2]> {
        let problem = held(timeline(Scheme::tr_bdf2())?.keep(memory), 0.0)?;
        let m: Vec<f64> = (0..problem.layout().len()).map(|i| -1e4 * (i % 3) as f64).collect();
        let mut workspace = ReducedWorkspace::default();
        let mut point: Evaluated = nastic_opt::Objective::evaluate(&problem, &m, &Request::default(), &mut workspace)?;
        let y: Vec<f64> = (0..point.constraints.len()).map(|k| 1e-3 * (1.0 + (k % 4) as f64)).collect();
        let derivative = problem.lagrangian_derivative(&mut point, &y, &mut workspace)?;
        Ok([bits(&point.constraints), bits(&derivative)])
    };
    let all = run(MotionMemory::All)?;
    assert!(all == run(MotionMemory::Checkpoints(2))?);
    Ok(())
}

/// The end is to be at 80 mm at T/2 and at 65 mm at T. A ceiling that holds at T alone it swings through, one that holds always it does not.
#[test]
fn an_arm_stays_below_a_ceiling() -> Done {
    let height = 0.075;
    let reached = |instants: Instants| -> Done<(f64, f64)> {
        let problem = lifted(timeline(Scheme::bdf2())?)?
            .cost_when(When::At(vec![0.1]), MeanPosition::surface("x+", [None, None, Some(0.08)]).weight(100.0))?
            .constrain_when(instants, below(height))?;
        let mut run = begin(problem)?;
        let stop = run.run(&mut ());
        let violation = run.constraints().violation;
        let problem = run.augmented().objective();
        let mut highest = f64::NEG_INFINITY;
        let mesh = problem.solid().mesh();
        problem.for_each_state(run.point(), &mut |_, state| {
            for (a, x) in mesh.points().iter().enumerate().filter(|(_, x)| x[0] > 0.499) {
                highest = highest.max(x[2] + state.u[3 * a + 2]);
            }
            Ok(())
        })?;
        println!(
            "{stop}: highest {highest:.6}, violation {violation:.1e}, {} active",
            run.constraints().groups[0].active()
        );
        Ok((highest, violation))
    };
    let (free, at_end) = reached(Instants::End)?;
    let (held, always) = reached(Instants::All)?;
    assert!(at_end < 1e-6 && always < 1e-6, "{at_end:e} {always:e}");
    assert!(free > height + 5e-3 && held < height + 1e-6, "highest {free} and {held}");
    Ok(())
}

#[test]
fn instants_that_cannot_be_are_said() -> Done {
    let message = |instants: Instants, timeline: Timeline| -> Done<String> {
        let held = lifted(timeline)?.constrain_when(instants, below(0.1));
        Ok(held.err().ok_or("accepted")?.to_string())
    };
    let bdf2 = || timeline(Scheme::bdf2());
    assert!(message(Instants::At(vec![]), bdf2()?)?.contains("at no instant"));
    assert!(message(Instants::At(vec![0.013]), bdf2()?)?.contains("the nearest one is 0.01"));
    assert!(message(Instants::At(vec![0.0, 0.1]), bdf2()?.from_rest())?.contains("where no control has a say"));
    let statics = Reduced::new(arm()?).constrain_when(Instants::All, below(0.1));
    assert!(statics.is_err_and(|error| error.to_string().contains("call in_time first")));
    Ok(())
}
