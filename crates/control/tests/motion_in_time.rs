//! Problems in time: values against closed forms, derivatives against differences, histories to the bit.

use nastic_control::{
    ActuationWork, ControlNorm, ControlRate, Evaluated, Interpolation, KineticEnergy, Knots, MeanPosition, Metric,
    MotionMemory, RateLimit, Reduced, Space, Target, Timeline, Tracking, When,
};
use nastic_energy::{FiberTension, KinematicGrowth, Magnet, MaxwellBranch, NeoHooke, Turgor};
use nastic_ensemble::Ensemble;
use nastic_fem::{Inertia, Scheme, Solid};
use nastic_mesh::{CellKind, box_mesh};
use nastic_opt::{
    AugmentedLagrangian, Bounds, Constrained, Domain, Lbfgs, Objective, Optimizer, Options, Problem, Product, Request,
    RunState, Saved, Taylor, Verdict,
};
use nastic_tensor::Vec3;
use nastic_uncertainty::risk::MeanDeviation;
use std::sync::Arc;

type Done<T = ()> = Result<T, Box<dyn std::error::Error>>;

/// A soft arm of 0.5 m, 50 mm thick, whose first bending mode swings with about 4 Hz.
fn arm(young: f64) -> Done<Solid> {
    Ok(Solid::new(box_mesh([0.5, 0.05, 0.05], [4, 1, 2], CellKind::Hex8)?)?
        .material("body", NeoHooke::from_young_poisson(young, 0.3)?)?
        .actuate("body", "tension", FiberTension::along(Vec3::x())?)?
        .clamp("x-")?
        .inertia(Inertia::new("body", 1000.0))?
        .rayleigh_damping(0.5, 1e-3)?)
}

const END: f64 = 0.2;
const STEPS: usize = 8;

fn timeline(scheme: Scheme) -> Done<Timeline> {
    Ok(Timeline::uniform(scheme, END, STEPS)?)
}

fn knots(interpolation: Interpolation) -> Done<Knots> {
    Ok(Knots::every(0.05, END, interpolation)?)
}

/// The end lifted.
fn raised(by: f64) -> Target {
    Target::position(move |x| [x[0], x[1], x[2] + by])
}

fn flicked(scheme: Scheme) -> Done<Reduced> {
    flicked_in(scheme, MotionMemory::All)
}

fn flicked_in(scheme: Scheme, memory: MotionMemory) -> Done<Reduced> {
    Ok(Reduced::new(arm(1e5)?)
        .in_time(timeline(scheme)?.from_rest().segments_of(2).keep(memory))?
        .control_in_time("tension", Space::Cell, knots(Interpolation::Linear)?)?
        .cost(Tracking::surface("x+", raised(0.1)))?)
}

fn assert_taylor(problem: &Reduced, m: &[f64], what: &str) -> Done {
    let mut set = Product::new();
    for block in problem.layout().blocks() {
        let most = if block.unit == "Pa" { 5e4 } else { 0.1 };
        set.push(block.len(), Arc::new(Bounds::new(-most, most)?));
    }
    let report = Taylor { directions: 2, ..Taylor::default() }.test(problem, &set, m)?;
    assert_eq!(report.verdict(), Verdict::Right, "{what}: {report}");
    Ok(())
}

fn wave(len: usize, amplitude: f64) -> Vec<f64> {
    (0..len).map(|i| amplitude * (1.0 + 0.8 * ((i * 37 % 11) as f64 / 11.0 - 0.5))).collect()
}

/// Without damping the actuations do the work that kinetic and stored energy gain, up to h^2; their derivatives are right.
#[test]
fn actuations_do_the_work_that_a_motion_gains() -> Done {
    let body = |viscous: bool| -> Done<Solid> {
        let elastic = Solid::new(box_mesh([0.5, 0.05, 0.05], [4, 1, 2], CellKind::Hex8)?)?
            .material("body", NeoHooke::from_young_poisson(1e5, 0.3)?)?
            .actuate("body", "tension", FiberTension::along(Vec3::x())?)?
            .clamp("x-")?
            .inertia(Inertia::new("body", 1000.0))?;
        Ok(if viscous { elastic.viscosity("body", MaxwellBranch::new(2e4, 0.03)?)? } else { elastic })
    };
    let problem = |steps: usize, viscous: bool| -> Done<Reduced> {
        Ok(Reduced::new(body(viscous)?)
            .in_time(Timeline::uniform(Scheme::implicit_midpoint(), 0.1, steps)?.from_rest())?
            .control_in_time("tension", Space::Cell, Knots::every(0.05, 0.1, Interpolation::Linear)?)?
            .trajectory_cost(ActuationWork::new(2.0)?)?
            .trajectory_cost(KineticEnergy::new(When::End, 3.0)?)?
            .trajectory_cost(KineticEnergy::new(When::Integral, 1.0)?)?)
    };
    let mut gaps = Vec::new();
    for steps in [40, 80] {
        let problem = problem(steps, false)?;
        let m: Vec<f64> = (0..problem.layout().len()).map(|i| -3e4 * ((i * 5 % 7) as f64) / 7.0).collect();
        let at = problem.at(&m)?;
        let model = problem.solid().model();
        let passive = problem.solid().controls();
        let end = nastic_fem::Instant::new(&at.state().u, &passive, 1.0);
        let stored = model.evaluate(&end, nastic_fem::Demand { energy: true, force: false })?.energy;
        let kinetic = model.energies().kinetic_energy(at.state())?;
        assert!((at.terms[1] / (3.0 * kinetic) - 1.0).abs() < 1e-14);
        let work = at.terms[0] / 2.0;
        println!("{steps} steps: work {work:.6e}, gained {:.6e}", kinetic + stored);
        gaps.push((work - kinetic - stored).abs() / (kinetic + stored));
    }
    assert!(gaps[0] < 0.02 && gaps[1] < gaps[0] / 3.0, "{gaps:?}");
    for viscous in [false, true] {
        let problem = problem(8, viscous)?;
        let m = wave(problem.layout().len(), -2e4);
        assert_taylor(&problem, &m, "work and kinetic energy")?;
        if viscous {
            // what the spring of the branch holds is no gain of the work, and what its dashpot takes is part of it
            let at = problem.at(&m)?;
            let end = nastic_fem::Instant::new(&at.state().u, &at.state().controls, 1.0);
            let demand = nastic_fem::Demand { energy: true, force: false };
            let held = nastic_fem::Instant::of(at.state());
            let model = problem.solid().model();
            assert!(model.evaluate(&held, demand)?.energy > model.evaluate(&end, demand)?.energy);
        }
    }
    Ok(())
}

/// A viscous arm whose growth follows a control in time: internal variables see it too.
#[test]
fn a_viscous_arm_is_driven_by_its_growth() -> Done {
    for scheme in [Scheme::backward_euler(), Scheme::implicit_midpoint()] {
        let body = arm(1e5)?.viscosity("body", MaxwellBranch::new(2e4, 0.03)?)?.actuate(
            "body",
            "swell",
            KinematicGrowth::along(Vec3::x())?,
        )?;
        let problem = Reduced::new(body)
            .in_time(timeline(scheme)?.from_rest())?
            .control_in_time("swell", Space::Cell, knots(Interpolation::Linear)?)?
            .control_in_time("tension", Space::Uniform, knots(Interpolation::Linear)?)?
            .cost(Tracking::surface("x+", raised(0.1)))?;
        let growth = problem.layout().block("swell")?.len();
        let mut m = wave(growth, 0.05);
        m.extend(wave(problem.layout().len() - growth, -2e4));
        assert_taylor(&problem, &m, "growth of a viscous arm")?;
    }
    Ok(())
}

/// At rest a cost of states is a constant c: its integral is c T, three instants make 3 c, the time above c is half of T.
#[test]
fn costs_at_rest_are_integrals_of_a_constant() -> Done {
    let c = 0.5 * 0.1 * 0.1 * 0.05 * 0.05;
    let cost = || Tracking::surface("x+", raised(0.1));
    let problem = Reduced::new(arm(1e5)?)
        .in_time(timeline(Scheme::tr_bdf2())?)?
        .control_in_time("tension", Space::Uniform, knots(Interpolation::Constant)?)?
        .cost(cost())?
        .cost_when(When::Integral, cost())?
        .cost_when(When::At(vec![0.0, 0.1, 0.2]), cost())?
        .cost_when(When::TimeAbove { scale: c }, cost())?
        .cost_along(When::Integral, |t| Ok(Tracking::surface("x+", raised(0.1 * t / END))))?;
    let terms = problem.at(&[0.0; 4])?.terms;
    // the trapezoidal rule of (t/T)^2 with 8 steps: T/3 (1 + 1/(2 8^2))
    let path = c * END / 3.0 * (1.0 + 0.5 / 64.0);
    for (found, expected) in terms.iter().zip([c, c * END, 3.0 * c, END / 2.0, path]) {
        assert!((found / expected - 1.0).abs() < 1e-9, "{found:e} {expected:e}");
    }
    let between = Reduced::new(arm(1e5)?).in_time(timeline(Scheme::bdf2())?)?.cost_when(When::At(vec![0.033]), cost());
    assert!(between.unwrap_err().to_string().contains("no instant of the motion"));
    Ok(())
}

/// A ramp to a: int |dm/dt|^2 = a^2 V / T; the inner product of a control in time is that of a constant one.
#[test]
fn rates_and_products_are_those_of_a_ramp() -> Done {
    let (a, volume) = (-1e4, 0.5 * 0.05 * 0.05);
    let problem = Reduced::new(arm(1e5)?)
        .in_time(timeline(Scheme::backward_euler())?.from_rest())?
        .control_in_time("tension", Space::Cell, knots(Interpolation::Linear)?)?
        .trajectory_cost(ControlRate::of("tension", 3.0)?)?
        .limit_rate(RateLimit::of("tension", 1e5)?)?
        .cost_when(When::Integral, ControlNorm::of("tension", 2.0)?)?;
    let m: Vec<f64> = (0..5).flat_map(|k| [a * k as f64 / 4.0; 8]).collect();
    let point = problem.at(&m)?;
    assert!((point.terms[1] / (1.5 * a * a * volume / END) - 1.0).abs() < 1e-12);
    assert!((point.terms[0] / (a * a * volume * END / 3.0) - 1.0).abs() < 1e-2); // the trapezoidal rule
    let rate: f64 = a / END / 1e5;
    assert_eq!(point.constraints.len(), 4 * 8);
    assert!(point.constraints.iter().all(|c| (c - (rate * rate - 1.0)).abs() < 1e-12));
    let product = problem.inner_product()?.apply(&[1.0; 40]);
    assert!((product.iter().sum::<f64>() / volume - 1.0).abs() < 1e-12);
    let smooth = problem.metric(Metric::H1 { length: 0.1 }).inner_product().unwrap_err();
    assert!(smooth.to_string().contains("H1 product of controls in time"));
    Ok(())
}

/// Every scheme, from rest and from the equilibrium under m(0), with controls that are linear or constant between knots.
#[test]
fn derivatives_of_motions_are_right() -> Done {
    for row in nastic_fem::schemes::SCHEMES.iter().filter(|row| row.name != "siere") {
        for (interpolation, rest) in [(Interpolation::Linear, false), (Interpolation::Constant, true)] {
            let line = timeline((row.build)()?)?;
            let problem = Reduced::new(arm(1e5)?)
                .in_time(if rest { line.from_rest() } else { line })?
                .control_in_time("tension", Space::Cell, knots(interpolation)?)?
                .cost(Tracking::surface("x+", raised(0.1)))?
                .cost_when(When::Integral, ControlNorm::of("tension", 1e-9)?)?;
            assert_taylor(&problem, &wave(problem.layout().len(), -1.5e4), row.name)?;
        }
    }
    Ok(())
}

/// All kinds of costs at once, a design beside a control in time, a cavity and a magnet.
#[test]
fn derivatives_of_all_costs_of_motions_are_right() -> Done {
    let body = Solid::new(box_mesh([0.5, 0.05, 0.05], [4, 1, 2], CellKind::Hex8)?)?
        .material("body", NeoHooke::from_young_poisson(1e5, 0.3)?)?
        .actuate("body", "magnet", Magnet::new())?
        .actuate("body", "turgor", Turgor::new())?
        .clamp("x-")?
        .inertia(Inertia::new("body", 1000.0))?;
    let cost = |by: f64| Tracking::surface("x+", raised(by));
    let problem = Reduced::new(body)
        .in_time(timeline(Scheme::tr_bdf2())?)?
        .control("magnet.remanence", Space::Region)?
        .control_in_time("magnet.field", Space::Uniform, knots(Interpolation::Linear)?)?
        .control_in_time("turgor", Space::Cell, knots(Interpolation::Constant)?)?
        .cost_when(When::Integral, cost(0.1))?
        .cost_when(When::At(vec![0.05, 0.1]), MeanPosition::surface("x+", [Some(0.5), None, Some(0.05)]))?
        .cost_when(When::TimeAbove { scale: 1e-4 }, cost(0.2))?
        .cost_along(When::Integral, |t| Ok(Tracking::surface("x+", raised(t))))?
        .trajectory_cost(ControlRate::of("turgor", 1e-7)?)?;
    let mut m = vec![0.02, 0.01, 0.08];
    m.extend((0..15).map(|k| 0.01 * (k as f64).sin()));
    m.extend(wave(problem.layout().len() - m.len(), 2e3));
    assert_taylor(&problem, &m, "all")
}

/// Same bits from one thread and from many; a run goes on from a checkpoint to the bit, also where motions keep few states, with which
/// it is the same run.
#[test]
fn motions_give_the_same_bits() -> Done {
    let m = |problem: &Reduced| wave(problem.layout().len(), -1e4);
    let bits = |point: &Evaluated| point.state().u.iter().map(|u| u.to_bits()).collect::<Vec<_>>();
    let run = |threads: usize| -> Done<Vec<u64>> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build()?;
        let problem = flicked(Scheme::bdf2())?;
        Ok(bits(&pool.install(|| problem.at(&m(&problem)))?))
    };
    assert_eq!(run(1)?, run(2)?);

    let optimizer = Lbfgs::default().within(Bounds::new(-4e4, 4e4)?).tolerance(1e-8).max_iterations(6);
    let mut ends = Vec::new();
    for memory in [MotionMemory::All, MotionMemory::Checkpoints(2)] {
        let problem = flicked_in(Scheme::bdf2(), memory)?;
        let mut run = optimizer.start(&problem, -1e3)?;
        (0..3).for_each(|_| {
            run.step(&mut ());
        });
        let bytes = run.checkpoint().to_bytes();
        let mut resumed = optimizer.resume(&problem, &RunState::from_bytes(&bytes)?)?;
        run.run(&mut ());
        let stop = resumed.run(&mut ());
        assert!(run.save().to_bytes() == resumed.save().to_bytes(), "{memory:?}");
        let best = resumed.finish(stop);
        ends.push((best.m.iter().map(|m| m.to_bits()).collect::<Vec<_>>(), best.cost.to_bits()));
    }
    assert_eq!(ends[0], ends[1]);
    let problem = flicked(Scheme::bdf2())?;
    // what is not near does not matter: a motion depends on m alone
    let near = problem.at(&wave(problem.layout().len(), -2e4))?;
    let alone = problem.evaluate(&m(&problem), &Request::default(), &mut Default::default())?;
    let there = problem.evaluate(&m(&problem), &Request::near(&near), &mut Default::default())?;
    assert_eq!(bits(&alone), bits(&there));
    Ok(())
}

/// A flick to a target, of soft and stiff arms at once, under a limit of the rate, which ends active.
#[test]
fn an_ensemble_is_flicked_under_a_limited_rate() -> Done {
    let one = |young: f64, rate: f64| -> Done<Reduced> {
        let tip = MeanPosition::surface("x+", [None, None, Some(0.08)]);
        Ok(Reduced::new(arm(young)?)
            .in_time(timeline(Scheme::backward_euler())?.from_rest())?
            .control_in_time("tension", Space::Cell, knots(Interpolation::Linear)?)?
            .cost(tip)?
            .limit_rate(RateLimit::of("tension", rate)?)?)
    };
    let solve = |rate: f64| -> Done<(f64, f64)> {
        let problem = Ensemble::new(MeanDeviation { lambda: 0.5 })
            .scenario("soft", 0.5, one(0.9e5, rate)?)
            .scenario("stiff", 0.5, one(1.1e5, rate)?)
            .build()?;
        let start = vec![0.0; problem.len()];
        let metric = problem.inner_product()?;
        let domain = Domain { set: Arc::new(Bounds::new(-3e4, 3e4)?), metric, cancel: None };
        let options = Options { tolerance: 1e-3, max_iterations: 40, ..Options::default() };
        let optimizer = Lbfgs { options, ..Lbfgs::default() };
        let before = problem.at(&start)?.risk;
        let mut run = AugmentedLagrangian::default().start(&optimizer, &problem, domain, start)?;
        let stop = run.run(&mut ());
        let violation = run.constraints().violation;
        assert!(violation < 1e-3, "{violation:e}");
        let best = run.finish(stop).best;
        Ok((before, best.cost))
    };
    let (before, free) = solve(1e7)?;
    let (_, limited) = solve(2e5)?;
    assert!(free < 0.05 * before && limited > 1.05 * free, "{before:e} {free:e} {limited:e}");
    Ok(())
}

#[test]
fn what_a_motion_lacks_is_said() -> Done {
    let problem = flicked(Scheme::trapezoidal())?;
    let point = problem.at(&vec![0.0; problem.layout().len()])?;
    assert_eq!((point.states().len(), point.state().time), (STEPS + 1, END));
    let second = problem.hessian_vector(&point, &vec![1.0; point.m.len()], &mut Default::default());
    assert!(second.unwrap_err().to_string().contains("optimiser of first derivatives"));
    let late = Reduced::new(arm(1e5)?).control("tension", Space::Cell)?.in_time(timeline(Scheme::bdf2())?);
    assert!(late.unwrap_err().to_string().contains("before controls"));
    let statics = Reduced::new(arm(1e5)?).control_in_time("tension", Space::Cell, knots(Interpolation::Linear)?);
    assert!(statics.unwrap_err().to_string().contains("call in_time first"));
    let short = Knots::every(0.05, 0.1, Interpolation::Linear)?;
    let ends =
        Reduced::new(arm(1e5)?).in_time(timeline(Scheme::bdf2())?)?.control_in_time("tension", Space::Cell, short);
    assert!(ends.unwrap_err().to_string().contains("let them agree"));
    let constant = Reduced::new(arm(1e5)?)
        .in_time(timeline(Scheme::bdf2())?)?
        .control("tension", Space::Cell)?
        .limit_rate(RateLimit::of("tension", 1.0)?);
    assert!(constant.unwrap_err().to_string().contains("constant in time"));
    assert!(problem.motion_footprint()?.is_some_and(|motion| motion.bytes > 0));
    Ok(())
}

/// Costs of states of all kinds and one of the whole motion, a limited rate, a motion that begins at an equilibrium.
fn costly(memory: MotionMemory) -> Done<Reduced> {
    let body = arm(1e5)?.viscosity("body", MaxwellBranch::new(1e4, 0.05)?)?;
    let timeline = Timeline::uniform(Scheme::bdf2(), END, 66)?.segments_of(4).keep(memory);
    Ok(Reduced::new(body)
        .in_time(timeline)?
        .control_in_time("tension", Space::Cell, knots(Interpolation::Linear)?)?
        .cost(Tracking::surface("x+", raised(0.1)))?
        .cost_when(When::Integral, ControlNorm::of("tension", 1e-9)?)?
        .cost_when(When::At(vec![END, 0.5 * END]), Tracking::surface("x+", raised(0.05)))?
        .cost_along(When::Integral, |t| Ok(Tracking::surface("x+", raised(t))))?
        .trajectory_cost(ControlRate::of("tension", 1e-9)?)?
        .limit_rate(RateLimit::of("tension", 1e6)?)?)
}

/// Cost, derivative and that under constraints with 3, 5 and 17 checkpoints, with so many bytes, and with all states.
#[test]
fn few_states_give_the_same_bits() -> Done {
    let all = costly(MotionMemory::All)?;
    let whole = all.motion_footprint()?.ok_or("in time")?;
    assert_eq!((whole.recomputed_steps, whole.states), (0, 67));
    let m = wave(all.layout().len(), -1e4);
    let bits = |values: &[f64]| values.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
    let run = |problem: &Reduced| -> Done<(Vec<Vec<u64>>, Evaluated)> {
        let mut workspace = Default::default();
        let mut point = problem.evaluate(&m, &Request::default(), &mut workspace)?;
        let terms = bits(&point.terms);
        let y = vec![1e-6; point.constraints.len()];
        let first = problem.derivative(&mut point, &mut workspace)?;
        // once more, now from the beginning alone; of a point that is shared; of one term
        let second = problem.lagrangian_derivative(&mut point, &y, &mut workspace)?;
        let term = problem.derivative_of_term(&point, 2, &mut workspace)?;
        let mut states = Vec::new();
        problem.for_each_state(&point, &mut |_, state| {
            states.extend(bits(&state.u));
            Ok(())
        })?;
        let again = problem.restage(0, &point)?;
        assert_eq!(bits(&again.terms), terms);
        let adjoint = bits(point.adjoint().unwrap_or_default());
        let constraints = bits(&point.constraints);
        Ok((vec![terms, constraints, bits(&first), bits(&second), bits(&term), states, adjoint], point))
    };
    let (expected, kept) = run(&all)?;
    assert_eq!(kept.states().len(), 67);
    let memories = [3, 5, 17].map(MotionMemory::Checkpoints);
    let third = MotionMemory::AtMost { bytes: whole.bytes / 3 };
    for memory in memories.into_iter().chain([third]) {
        let problem = costly(memory)?;
        let message = problem.motion_footprint()?.ok_or("in time")?;
        let (found, point) = run(&problem)?;
        for (found, expected) in found.iter().zip(&expected) {
            assert!(found == expected, "{memory:?}");
        }
        assert_eq!(point.min_j().to_bits(), kept.min_j().to_bits());
        let counts = point.solved.recording.counts();
        println!("{memory:?}: {message:?}, {counts:?}");
        assert!(counts.states <= message.states && message.bytes < whole.bytes);
        // the first derivative began with all checkpoints, the second with none of them: the rest of the motion once more
        let rest = 4 * (66usize.div_ceil(4) - 1) + 2;
        assert_eq!(counts.recomputed_steps, 2 * message.recomputed_steps + rest);
    }
    let little = costly(MotionMemory::AtMost { bytes: 1000 }).err().ok_or("too little")?.to_string();
    assert!(little.contains("take shorter segments"), "{little}");
    Ok(())
}
