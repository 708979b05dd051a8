//! What the past of a run may change: nothing beyond the accuracy of states, and nothing at all where it is the same.

use nastic_control::{ControlNorm, Evaluated, Reduced, ReducedWorkspace, SmoothedHausdorff, Space, Target, Tracking};
use nastic_energy::{FiberTension, MooneyRivlin};
use nastic_ensemble::{Ensemble, EnsemblePoint, EnsembleWorkspace};
use nastic_fem::{Discretization, Solid};
use nastic_mesh::{CellKind, box_mesh};
use nastic_opt::{
    Best, Bounds, Lbfgs, Objective, Optimizer, Options, Outcome as Step, Problem, Request, RunState, Saved, Start,
    Within, by_name,
};
use nastic_tensor::Vec3;
use nastic_uncertainty::risk::MeanDeviation;
use std::sync::Arc;

type Outcome<T = ()> = Result<T, Box<dyn std::error::Error>>;

/// A bar with a fibre that is to be lifted; its stiffness in multiples of 100 kPa.
fn bar(stiffness: f64) -> Outcome<Reduced> {
    let disc = Discretization::new(Arc::new(box_mesh([1.0, 0.2, 0.2], [5, 1, 2], CellKind::Hex8)?))?;
    let body = Solid::on(disc)
        .material("body", MooneyRivlin::new(1e5 * stiffness, 2e4 * stiffness, 5e5 * stiffness)?)?
        .actuate("body", "tension", FiberTension::along(Vec3::x())?)?
        .clamp("x-")?;
    let lifted = Target::position(|x| [0.95 * x[0], x[1], x[2] + 0.2]);
    Ok(Reduced::new(body)
        .control("tension", Space::Cell)?
        .cost(Tracking::surface("x+", lifted))?
        .cost(ControlNorm::of("tension", 1e-14)?)?)
}

fn two() -> Outcome<Ensemble> {
    Ok(Ensemble::new(MeanDeviation { lambda: 0.5 })
        .scenario("soft", 0.4, bar(0.8)?)
        .scenario("stiff", 0.6, bar(1.3)?)
        .build()?)
}

fn along(problem: &Reduced, t: f64) -> Vec<f64> {
    problem.layout().blocks()[0].basis.positions().iter().map(|x| -1.5e5 * t * x[2] / 0.2).collect()
}

/// Evaluates the controls one from the other, and differentiates each.
fn follow(problem: &Reduced, path: &[f64], accuracy: f64) -> Outcome<(Evaluated, Vec<f64>)> {
    let mut workspace = ReducedWorkspace::default();
    let mut last: Option<Evaluated> = None;
    let mut derivative = vec![];
    for t in path {
        let how = Request { near: last.as_ref(), accuracy, stage: 0, ..Request::default() };
        let mut point = problem.evaluate(&along(problem, *t), &how, &mut workspace)?;
        derivative = problem.derivative(&mut point, &mut workspace)?;
        last = Some(point);
    }
    Ok((last.ok_or("no path")?, derivative))
}

fn relative(a: &[f64], b: &[f64]) -> f64 {
    let norm = |v: &mut dyn Iterator<Item = f64>| v.map(|x| x * x).sum::<f64>().sqrt();
    norm(&mut a.iter().zip(b).map(|(a, b)| a - b)) / norm(&mut b.iter().copied())
}

fn bits(v: &[f64]) -> Vec<u64> {
    v.iter().map(|x| x.to_bits()).collect()
}

#[test]
fn two_histories_agree_to_the_accuracy_and_one_to_the_bit() -> Outcome {
    let problem = bar(1.0)?;
    for accuracy in [1e-6, 1e-8] {
        let histories: [&[f64]; 4] = [&[1.0], &[0.9, 1.0], &[0.3, 0.5, 0.7, 0.8, 1.0], &[1.6, 1.0]];
        let exact = problem.at(&along(&problem, 1.0))?;
        let mut seen = vec![];
        for history in histories {
            let (point, derivative) = follow(&problem, history, accuracy)?;
            let (again, same) = follow(&problem, history, accuracy)?;
            assert_eq!(bits(&point.state().u), bits(&again.state().u), "{history:?}");
            assert_eq!((bits(&derivative), bits(&point.terms)), (bits(&same), bits(&again.terms)), "{history:?}");
            assert!(relative(&point.state().u, &exact.state().u) < accuracy, "{history:?}");
            assert!((point.cost() / exact.cost() - 1.0).abs() < accuracy, "{history:?}");
            seen.push((point, derivative));
        }
        for (point, derivative) in &seen[1..] {
            assert_ne!(bits(&point.state().u), bits(&seen[0].0.state().u), "the histories are one: nothing is seen");
            assert!(relative(derivative, &seen[0].1) < 10.0 * accuracy);
        }
    }
    Ok(())
}

/// An evaluation without a point nearby has no history, whatever its workspace went through.
#[test]
fn evaluations_from_rest_have_no_history() -> Outcome {
    let problem = bar(1.0)?;
    let mut used = ReducedWorkspace::default();
    let mut first = problem.evaluate(&along(&problem, 0.4), &Request::default(), &mut used)?;
    problem.derivative(&mut first, &mut used)?;
    let m = along(&problem, 1.0);
    let after = problem.evaluate(&m, &Request::default(), &mut used)?;
    let fresh = problem.evaluate(&m, &Request::default(), &mut ReducedWorkspace::default())?;
    assert_eq!(bits(&after.state().u), bits(&fresh.state().u));
    assert_eq!(after.work, fresh.work);
    Ok(())
}

/// Where a member fails, how many of the members behind it were evaluated depends on timing. It leaves no trace.
#[test]
fn a_failed_trial_leaves_the_same_bits_on_any_number_of_threads() -> Outcome {
    let run = |threads: usize| -> Outcome<Vec<u64>> {
        let problem = Ensemble::new(MeanDeviation { lambda: 0.5 })
            .scenario("soft", 0.2, bar(0.2)?)
            .scenario("stiff", 0.4, bar(1.3)?)
            .scenario("stiffer", 0.4, bar(1.6)?)
            .build()?;
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build()?;
        let evaluate = || -> Result<EnsemblePoint, nastic_opt::Failed> {
            let mut workspace = EnsembleWorkspace::default();
            let control = |value: f64| vec![value; problem.len()];
            let mut first = problem.evaluate(&control(-2e4), &Request::default(), &mut workspace)?;
            problem.derivative(&mut first, &mut workspace)?;
            // far above what the soft bar bears
            problem.evaluate(&control(2.4e5), &Request::near(&first), &mut workspace).unwrap_err();
            problem.evaluate(&control(-2.5e4), &Request::near(&first), &mut workspace)
        };
        let point = pool.install(evaluate)?;
        Ok(point.members.iter().flat_map(|part| bits(&part.state().u)).collect())
    };
    let alone = run(1)?;
    for _ in 0..3 {
        assert_eq!(run(2)?, alone);
    }
    Ok(())
}

fn optimizer(iterations: usize) -> Outcome<Within<Lbfgs>> {
    Ok(Lbfgs::default().within(Bounds::new(-3e5, 1.3e5)?).tolerance(1e-8).max_iterations(iterations))
}

/// Steps to a checkpoint, then on; and from the checkpoint's bytes, on.
fn assert_goes_on_to_the_bit<P: Problem>(problem: &P, start: f64) -> Outcome<(RunState, RunState)> {
    let optimizer = optimizer(9)?;
    for steps in [0, 1, 4] {
        let mut run = optimizer.start(problem, start)?;
        for _ in 0..steps {
            run.step(&mut ());
        }
        let bytes = run.checkpoint().to_bytes();
        let mut resumed = optimizer.resume(problem, &RunState::from_bytes(&bytes)?)?;
        assert_eq!(resumed.save().to_bytes(), bytes, "what was read is not what was written");
        let (mut trials, mut again) = (vec![], vec![]);
        run.run(&mut |trial: &nastic_opt::Trial<'_, P::Point>| {
            trials.push((bits(trial.m), trial.cost.map(f64::to_bits)))
        });
        resumed.run(&mut |trial: &nastic_opt::Trial<'_, P::Point>| {
            again.push((bits(trial.m), trial.cost.map(f64::to_bits)))
        });
        if steps > 0 {
            assert_eq!(trials, again, "after {steps} steps");
        }
        assert!(trials.len() > 3);
        assert_eq!(run.save().to_bytes(), resumed.save().to_bytes(), "after {steps} steps");
        if steps == 4 {
            return Ok((RunState::from_bytes(&bytes)?, run.save()));
        }
    }
    Err("no checkpoint".into())
}

#[test]
fn a_run_goes_on_from_a_checkpoint_to_the_bit() -> Outcome {
    let problem = bar(1.0)?;
    let (saved, _) = assert_goes_on_to_the_bit(&problem, -1e4)?;
    // Loading solves nothing, and gives the point as it was, its adjoint state included.
    let how = Request { near: None, accuracy: 1e-8, stage: 0, ..Request::default() };
    let loaded = problem.load(&saved.current.m, &saved.current.point, &how)?;
    assert!(loaded.adjoint().is_some() && loaded.work.newton > 0 && loaded.state().load == 1.0);
    assert_eq!(problem.save(&loaded), saved.current.point);
    assert_eq!(*loaded.state().controls, problem.layout().to_points(&saved.current.m)?);
    Ok(())
}

#[test]
fn an_ensemble_goes_on_from_a_checkpoint_to_the_bit() -> Outcome {
    let problem = two()?;
    let (saved, _) = assert_goes_on_to_the_bit(&problem, -1e4)?;
    let how = Request { near: None, accuracy: 1e-8, stage: 0, ..Request::default() };
    let loaded = problem.load(&saved.current.m, &saved.current.point, &how)?;
    assert_eq!(problem.value(&loaded), saved.current.cost);
    assert_eq!(problem.save(&loaded), saved.current.point);
    Ok(())
}

/// A result is read as it was written, and bytes that are not one are refused.
#[test]
fn a_result_goes_through_bytes() -> Outcome {
    let problem = two()?;
    let best = optimizer(3)?.minimize(&problem, -1e4)?;
    let bytes = best.saved(&problem).to_bytes();
    let read = Best::from_bytes(&bytes)?.restored(&problem)?;
    assert_eq!((&read.stop, read.counts, &read.stages), (&best.stop, best.counts, &best.stages));
    assert_eq!((bits(&read.m), bits(&read.derivative)), (bits(&best.m), bits(&best.derivative)));
    assert_eq!(
        (read.cost.to_bits(), read.gradient_norm.to_bits()),
        (best.cost.to_bits(), best.gradient_norm.to_bits())
    );
    assert_eq!((read.stage, read.active), (0, best.active));
    assert_eq!(problem.save(&read.point), problem.save(&best.point));
    assert_eq!(read.saved(&problem).to_bytes(), bytes);
    for end in (0..bytes.len()).step_by(11) {
        assert!(Best::from_bytes(&bytes[..end]).is_err(), "cut off at {end}");
    }
    assert!(Best::from_bytes(&bytes)?.restored(&bar(1.0)?).is_err(), "of another problem");
    Ok(())
}

#[test]
fn points_of_another_problem_and_damaged_ones_are_refused() -> Outcome {
    let problem = bar(1.0)?;
    let m = along(&problem, 0.3);
    let bytes = problem.save(&problem.at(&m)?);
    let load = |bytes: &[u8], stage: usize| problem.load(&m, bytes, &Request { stage, ..Request::default() });
    assert!(load(&bytes, 0).is_ok() && load(&bytes, 1).is_err());
    for end in (0..bytes.len()).step_by(7) {
        assert!(load(&bytes[..end], 0).is_err());
    }
    let longer = [bytes.as_slice(), &[0]].concat();
    assert!(load(&longer, 0).is_err());
    let other = problem.cost(ControlNorm::of("tension", 1e-14)?)?;
    assert!(other.load(&m, &bytes, &Request::default()).is_err());
    assert!(two()?.load(&m, &bytes, &Request::default()).is_err());
    Ok(())
}

/// A run that owns its problem can go wherever it likes.
#[test]
fn runs_own_their_problem() -> Outcome {
    fn owned(problem: Reduced) -> Outcome<nastic_opt::Run<Arc<Reduced>>> {
        let optimizer = by_name("lbfgs", Options::default()).ok_or("no such optimiser")?;
        Ok(optimizer.within(Bounds::new(-3e5, 1.3e5)?).start(Arc::new(problem), -1e4)?)
    }
    let run = owned(bar(1.0)?)?;
    let handle = std::thread::spawn(move || {
        let mut run = run;
        let first = run.cost();
        let step = run.step(&mut ());
        (step, first, run.cost())
    });
    let (step, first, second) = handle.join().map_err(|_| "the thread died")?;
    assert!(step == Step::Iterated && second < first, "{first:e} -> {second:e}");
    Ok(())
}

/// A run from an evaluated point takes the same steps as one that evaluates its start, and does not evaluate it again.
#[test]
fn an_evaluated_start_is_not_evaluated_again() -> Outcome {
    let disc = Discretization::new(Arc::new(box_mesh([1.0, 0.2, 0.2], [4, 1, 1], CellKind::Hex8)?))?;
    let body = Solid::on(disc)
        .material("body", MooneyRivlin::new(1e5, 2e4, 5e5)?)?
        .actuate("body", "tension", FiberTension::along(Vec3::x())?)?
        .clamp("x-")?;
    let target = box_mesh([0.9, 0.2, 0.2], [3, 1, 1], CellKind::Hex8)?;
    let cost = SmoothedHausdorff::to(target).exponential(0.1).stages([(1.0, 4.0, 4.0), (4.0, 16.0, 8.0)]);
    let problem = Reduced::new(body).control("tension", Space::Cell)?.cost(cost)?;
    let m = vec![-1e4; problem.layout().len()];
    let optimizer = optimizer(4)?;
    let message = optimizer.start(&problem, &m)?;

    let mut workspace = ReducedWorkspace::default();
    let mut point = problem.evaluate(&m, &Request::default(), &mut workspace)?;
    let derivative = problem.derivative(&mut point, &mut workspace)?;
    let state = point.state().u.clone();
    let start = nastic_opt::EvaluatedStart { m: m.clone(), point, derivative: Some(derivative) };
    let known = optimizer.start(&problem, start)?.with_workspace(workspace);
    assert!(Arc::ptr_eq(&known.point().state().u, &state), "evaluated again");
    assert_eq!((message.progress().counts.derivatives, known.progress().counts.derivatives), (1, 0));
    let (message, known) = (message.minimize(&mut ()), known.minimize(&mut ()));
    assert_eq!((bits(&message.m), message.cost.to_bits()), (bits(&known.m), known.cost.to_bits()));

    let outside: Start<Evaluated> = problem.at(&vec![-1e6; m.len()])?.into();
    assert!(optimizer.start(&problem, outside).is_err(), "an evaluated start outside the set");
    Ok(())
}
