//! The contract of every optimiser of the catalogue.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout)]

use crate::common;

use common::{Cost, Tridiagonal, begin, chain, distance, quadratic, resume, rosenbrock, wide};
use nastic_opt::{
    Admissible, Best, Bounds, CATALOGUE, Diagonal, Euclidean, Hessian, InnerProduct, NoSecondDerivatives, Objective,
    Optimizer, Options, Outcome, Reason, RunError, RunState, Saved, Stall, Stop, Trial, by_name,
};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

const SLOW: [&str; 2] = ["projected_gradient", "mma"];

fn options(tolerance: f64, max_iterations: usize) -> Options {
    Options { tolerance, max_iterations, ..Options::default() }
}

fn every(options: Options) -> impl Iterator<Item = Box<dyn Optimizer>> {
    CATALOGUE.iter().map(move |entry| (entry.build)(options))
}

fn run<O: Objective>(
    o: &dyn Optimizer,
    cost: &O,
    set: &(impl Admissible + Clone + 'static),
    metric: &(impl InnerProduct + Clone + 'static),
    m: &[f64],
) -> Best<O::Point> {
    begin(o, cost, set, metric, m).unwrap().minimize(&mut ())
}

#[test]
fn names_are_those_of_case_files() {
    let names: Vec<_> = CATALOGUE.iter().map(|entry| entry.name).collect();
    assert_eq!(names, ["projected_gradient", "spectral", "lbfgs", "mma", "gauss_newton", "newton_cg"]);
    for name in names {
        assert_eq!(by_name(name, Options::default()).unwrap().name(), name);
    }
    assert!(by_name("simplex", Options::default()).is_none());
}

#[test]
fn rosenbrock_is_minimised() {
    // Steepest descent creeps along the valley: it gets the iterations it takes, without the test for creeping.
    let patient = Options { stagnation: 0.0, ..options(1e-7, 100_000) };
    for entry in CATALOGUE {
        let slow = SLOW.contains(&entry.name);
        // a gradient of 1e-8 is within 1e-5 of the minimiser: the smallest curvature there is 0.4
        let o = (entry.build)(if slow { patient } else { options(1e-8, 400) });
        for n in if slow { &[2][..] } else { &[2, 20] } {
            let n = *n;
            let start = [-1.2, 1.0].repeat(n / 2);
            let set = wide(entry.name);
            let best = run(o.as_ref(), &rosenbrock(set.clone()), &set, &Euclidean::new(n), &start);
            println!("{} {n}: {} {:?}", o.name(), best.stop, best.counts);
            assert!(best.stop.is_converged(), "{}: {}", o.name(), best.stop);
            // its gradient is as small, but the valley is flat
            assert!(distance(&best.m, &vec![1.0; n]) < if slow { 1e-4 } else { 1e-5 }, "{}", o.name());
        }
    }
}

#[test]
fn bounded_rosenbrock_ends_on_its_bound() {
    // With m_0 <= 0.5 the minimiser is (0.5, 0.25).
    let set = Bounds::new(vec![-2.0, -2.0], vec![0.5, 2.0]).unwrap();
    for o in every(options(1e-6, 3000)) {
        let best = run(o.as_ref(), &rosenbrock(set.clone()), &set, &Euclidean::new(2), &[-1.2, 1.0]);
        println!("{}: {} {:?}", o.name(), best.stop, best.counts);
        assert!(best.stop.is_converged(), "{}: {}", o.name(), best.stop);
        assert_eq!(best.m[0], 0.5, "{}", o.name());
        assert!((best.m[1] - 0.25).abs() < 1e-4, "{}: {:?}", o.name(), best.m);
        assert_eq!(best.active, 1);
    }
}

#[test]
fn bound_active_quadratic_finds_the_clamped_target() {
    let n = 40;
    let c: Vec<f64> = (0..n).map(|i| 10f64.powf(i as f64 / n as f64 * 2.0)).collect();
    let target: Vec<f64> = (0..n).map(|i| 2.0 * (i as f64 * 1.7).sin()).collect();
    let set = Bounds::new(-1.0, 1.0).unwrap();
    let metric = Diagonal::new((0..n).map(|i| 0.5 + (i % 3) as f64).collect()).unwrap();
    let exact: Vec<f64> = target.iter().map(|t| t.clamp(-1.0, 1.0)).collect();
    for o in every(Options { stagnation: 0.0, ..options(1e-6, 2000) }) {
        let cost = quadratic(set.clone(), c.clone(), target.clone(), 1.0, 1.0, 0.0);
        let best = run(o.as_ref(), &cost, &set, &metric, &vec![0.0; n]);
        println!("{}: {} {:?}", o.name(), best.stop, best.counts);
        assert!(best.stop.is_converged(), "{}: {}", o.name(), best.stop);
        assert!(distance(&best.m, &exact) < 1e-3, "{}", o.name());
        for (m, e) in best.m.iter().zip(&exact).filter(|(_, e)| e.abs() == 1.0) {
            assert_eq!(m, e, "{}: a bound is reached exactly", o.name());
        }
        assert_eq!(best.active, exact.iter().filter(|e| e.abs() == 1.0).count());
    }
}

/// An obstacle problem with a coupled Hessian (condition 4e3) and about half of the bounds active: KKT conditions.
#[test]
fn obstacle_problem_satisfies_its_conditions() {
    let n = 63;
    let set = Bounds::new(-0.02, 0.05).unwrap();
    let force = |i: usize| if i < 31 { 5.0 } else { -3.0 };
    for o in every(Options { stagnation: 0.0, ..options(1e-5, 5000) }) {
        let cost = chain(set.clone(), n, force);
        let metric = Diagonal::new(vec![1.0 / 64.0; n]).unwrap();
        let best = run(o.as_ref(), &cost, &set, &metric, &vec![0.0; n]);
        println!("{}: {} {:?}", o.name(), best.stop, best.counts);
        assert!(best.stop.is_converged(), "{}: {}", o.name(), best.stop);
        assert!(best.active > 10 && best.active < n - 10, "{}", best.active);
        let g = (cost.derivative)(&best.m);
        for (m, g) in best.m.iter().zip(&g) {
            let inside = *m > -0.02 && *m < 0.05;
            assert!(if inside { g.abs() < 1e-4 } else { g * (m - 0.015) <= 0.0 }, "{}: m {m} g {g}", o.name());
        }
    }
}

#[test]
fn units_do_not_matter() {
    let n = 30;
    let c: Vec<f64> = (0..n).map(|i| 10f64.powf(i as f64 / n as f64 * 3.0)).collect();
    let target: Vec<f64> = (0..n).map(|i| 1.5 * (i as f64).cos()).collect();
    let path = |o: &dyn Optimizer, unit_m: f64, unit_j: f64, bounded: bool, weight: f64| {
        let set = if bounded { Bounds::new(-unit_m, unit_m).unwrap() } else { Bounds::none() };
        let cost = quadratic(set.clone(), c.clone(), target.clone(), unit_m, unit_j, 0.3);
        let metric = Diagonal::new(vec![weight; n]).unwrap();
        let mut path: Vec<Vec<f64>> = Vec::new();
        let mut watch = |trial: &Trial<'_, Vec<f64>>| path.push(trial.m.iter().map(|m| m / unit_m).collect());
        begin(o, &cost, &set, &metric, &vec![0.0; n]).unwrap().minimize(&mut watch);
        path
    };
    for o in every(options(1e-6, 60)) {
        for bounded in [true, false].into_iter().filter(|bounded| *bounded || o.name() != "mma") {
            let plain = path(o.as_ref(), 1.0, 1.0, bounded, 1.0);
            // Powers of two scale without rounding: the same path to the bit.
            let scaled = path(o.as_ref(), 2f64.powi(17), 2f64.powi(-10), bounded, 2f64.powi(-20));
            assert!(plain == scaled, "{} bounded {bounded}", o.name());
            // Pascals and a cost in square metres: the same steps up to rounding, which slowly grows.
            let si = path(o.as_ref(), 1e5, 1e-3, bounded, 1e-6);
            for (k, (a, b)) in plain.iter().zip(&si).take(15).enumerate() {
                assert!(
                    distance(a, b) < 1e-5,
                    "{} bounded {bounded}: trial {k} differs by {:e}",
                    o.name(),
                    distance(a, b)
                );
            }
        }
    }
}

#[test]
fn costs_fall_as_promised_and_trials_are_told_in_order() {
    let set = Bounds::new(-2.0, 2.0).unwrap();
    for o in every(options(1e-6, 80)) {
        let cost = rosenbrock(set.clone());
        let mut costs = Vec::new();
        let mut seen = Vec::new();
        let mut before = None;
        let mut watch = |trial: &Trial<'_, Vec<f64>>| {
            assert!(set.check(trial.m).is_ok());
            assert_eq!(trial.accepted, trial.derivative.is_some());
            seen.push((trial.trial, trial.iteration, trial.accepted, trial.reason.clone()));
            // What the derivative at the point before predicts.
            let step: Option<f64> = before.as_ref().map(|(m, derivative): &(Vec<f64>, Vec<f64>)| {
                (0..2).map(|i| derivative[i] * (trial.m[i] - m[i])).sum()
            });
            assert_eq!(
                (trial.predicted, trial.predicted.is_none()),
                (step, trial.reason == Reason::Start),
                "{}",
                o.name()
            );
            if trial.accepted {
                costs.push(trial.cost.unwrap());
                before = trial.derivative.map(|derivative| (trial.m.to_vec(), derivative.to_vec()));
            }
        };
        let metric = Euclidean::new(2);
        let run = begin(o.as_ref(), &cost, &set, &metric, &[-1.2, 1.0]).unwrap();
        let best = run.minimize(&mut watch);
        // Values for every trial, derivatives for accepted points alone.
        assert_eq!(cost.counts(), (best.counts.trials + 1, best.counts.iterations + 1), "{}", o.name());
        if o.name() != "spectral" {
            assert!(costs.windows(2).all(|w| w[1] <= w[0]), "{}: {costs:?}", o.name());
        }
        let least = costs.iter().copied().fold(f64::INFINITY, f64::min);
        assert!(best.cost <= least + 1e-6 * (costs[0] - least), "{}", o.name());
        assert!(seen.iter().map(|s| s.0).eq(0..=best.counts.trials));
        assert_eq!(seen[0], (0, 0, true, Reason::Start));
        assert_eq!(seen.iter().filter(|s| s.2).count(), best.counts.iterations + 1);
        assert_eq!(best.counts.derivatives, best.counts.iterations + 1);
    }
}

#[test]
fn interrupted_anywhere_it_gives_the_best_it_has_seen() {
    let (n, metric) = (63, Euclidean::new(63));
    let mut risen = 0;
    for entry in CATALOGUE {
        for iterations in 1..60 {
            let (o, set) = ((entry.build)(options(1e-6, iterations)), wide(entry.name));
            let cost = chain(set.clone(), n, |i| if i < 31 { 5.0 } else { -3.0 });
            let mut costs = Vec::new();
            let mut watch = |trial: &Trial<'_, Vec<f64>>| {
                if trial.accepted {
                    costs.push(trial.cost.unwrap());
                }
            };
            let run = begin(o.as_ref(), &cost, &set, &metric, &vec![0.001; n]).unwrap();
            let best = run.minimize(&mut watch);
            let least = costs.iter().copied().fold(f64::INFINITY, f64::min);
            assert_eq!(best.cost, least, "{} after {iterations}", o.name());
            assert_eq!(best.cost, (cost.value)(&best.m));
            risen += usize::from(costs.last() > Some(&least));
        }
    }
    assert!(risen > 3, "the non-monotone method was seen to rise ({risen})");
}

#[test]
fn failed_evaluations_shorten_the_step() {
    let set = Bounds::new(-3.0, 3.0).unwrap();
    for o in every(options(1e-5, 2000)) {
        // No state beyond a curve close to the path, and none for anything far from the start's basin.
        let cost = rosenbrock(set.clone()).failing(|m| m[1] < m[0] * m[0] - 0.3 || m[1] > m[0] * m[0] + 0.5);
        let mut failed = 0;
        let mut watch = |t: &Trial<'_, Vec<f64>>| failed += usize::from(matches!(t.reason, Reason::Failed(_)));
        let run = begin(o.as_ref(), &cost, &set, &Euclidean::new(2), &[-1.2, 1.44]).unwrap();
        let best = run.minimize(&mut watch);
        println!("{}: {} {:?}", o.name(), best.stop, best.counts);
        assert!(failed > 0 && failed == best.counts.failed, "{}", o.name());
        if !SLOW.contains(&o.name()) {
            assert!(distance(&best.m, &[1.0, 1.0]) < 1e-3, "{}: {:?} {}", o.name(), best.m, best.stop);
        }
    }
}

/// A failure that says nothing about the control rejects no trial: the run stands where it stood and goes on to the same bits.
#[test]
fn a_fatal_failure_ends_the_run_before_its_step() {
    let set = Bounds::new(-3.0, 3.0).unwrap();
    let metric = Euclidean::new(2);
    for o in every(options(1e-5, 60)) {
        let at = |cost: &Cost| {
            begin(o.as_ref(), cost, &set, &metric, &[-1.2, 1.44]).unwrap().minimize(&mut |_: &Trial<'_, _>| {})
        };
        let whole = at(&rosenbrock(set.clone()));
        let lacking = Arc::new(AtomicBool::new(false));
        let cost = rosenbrock(set.clone()).failing_fatally(lacking.clone());
        let mut run = begin(o.as_ref(), &cost, &set, &metric, &[-1.2, 1.44]).unwrap();
        (0..3).for_each(|_| assert_eq!(run.step(&mut |_: &Trial<'_, _>| {}), Outcome::Iterated));
        let before = (run.progress().counts, run.save());
        lacking.store(true, Ordering::Relaxed);
        let mut message = 0;
        let stopped = run.step(&mut |_: &Trial<'_, _>| message += 1);
        assert!(
            matches!(&stopped, Outcome::Stopped(Stop::Aborted(why)) if why.to_string() == "no memory"),
            "{stopped:?}"
        );
        assert_eq!((message, run.progress().counts), (0, before.0), "{}", o.name());
        assert_eq!(run.save().to_bytes(), before.1.to_bytes(), "{}", o.name());
        lacking.store(false, Ordering::Relaxed);
        let best = run.minimize(&mut |_: &Trial<'_, _>| {});
        assert_eq!((best.m, best.counts), (whole.m, whole.counts), "{}", o.name());
    }
}

#[test]
fn a_wall_of_failures_is_said_so() {
    let set = Bounds::new(-3.0, 3.0).unwrap();
    for o in every(Options::default()) {
        let cost = rosenbrock(set.clone()).failing(|m| m != [-1.2, 1.0]);
        let best = run(o.as_ref(), &cost, &set, &Euclidean::new(2), &[-1.2, 1.0]);
        let Stop::Stalled(Stall::LineSearch { trials, failed, .. }) = best.stop else { panic!("{}", best.stop) };
        assert!(trials == failed && trials > 5, "{trials} {failed}");
        assert_eq!(best.m, [-1.2, 1.0]);
    }
}

/// Each of Newton's methods asks for its own second derivative, and an objective without any ends the run with the reason.
#[test]
fn newton_methods_ask_for_their_own_second_derivative() {
    for (name, wanted) in [("gauss_newton", Hessian::GaussNewton), ("newton_cg", Hessian::Exact)] {
        let cost = rosenbrock(Bounds::none());
        let optimizer = by_name(name, options(1e-6, 200)).unwrap();
        let best = run(optimizer.as_ref(), &cost, &Bounds::none(), &Euclidean::new(2), &[-1.2, 1.0]);
        assert!(best.stop.is_converged() && best.counts.products > 0, "{}", best.stop);
        let asked = cost.asked.lock().unwrap();
        assert!(asked.len() == best.counts.products && asked.iter().all(|which| *which == wanted), "{asked:?}");

        let none = rosenbrock(Bounds::none()).without_hessian();
        let ended = run(optimizer.as_ref(), &none, &Bounds::none(), &Euclidean::new(2), &[-1.2, 1.0]);
        let Stop::Stalled(Stall::SecondDerivatives { why }) = &ended.stop else { panic!("{}", ended.stop) };
        assert!(why.downcast_ref::<NoSecondDerivatives>().is_some() && ended.counts.trials == 0, "{why}");
        assert!(ended.stop.to_string().contains("\"lbfgs\" does without"), "{}", ended.stop);
    }
}

/// A step so long that the set bends it back to a corner is shortened without evaluating the corner again and again.
#[test]
fn a_corner_is_tried_once() {
    let set = Bounds::new(0.0, 1.0).unwrap();
    for o in every(Options { first_move: 1e6, ..options(1e-4, 50) }) {
        // Steep at the start, so that the linear model overshoots far; the minimiser is near the start.
        let cost = Cost::new(
            set.clone(),
            |m| 1e6 + m.iter().map(|m| 1e3 * (m - 0.01).powi(2)).sum::<f64>(),
            |m| m.iter().map(|m| 2e3 * (m - 0.01)).collect(),
        );
        let mut seen: Vec<Vec<f64>> = Vec::new();
        let mut watch = |t: &Trial<'_, Vec<f64>>| seen.push(t.m.to_vec());
        let best = begin(o.as_ref(), &cost, &set, &Euclidean::new(3), &[0.0; 3]).unwrap().minimize(&mut watch);
        println!("{}: {} {:?}", o.name(), best.stop, best.counts);
        assert!(best.stop.is_converged(), "{}", best.stop);
        let corner = seen.iter().filter(|m| **m == vec![1.0; 3]).count();
        // Newton's step is the minimiser, however long the first one may be; that of moving asymptotes has a limit.
        let newton = ["gauss_newton", "newton_cg", "mma"].contains(&o.name());
        assert!(corner == usize::from(!newton), "{}: {corner} trials at the corner of {}", o.name(), seen.len());
    }
}

#[test]
fn a_wrong_derivative_stalls_and_says_so() {
    for o in every(Options::default()) {
        let set = wide(o.name());
        let cost = Cost::new(set.clone(), |m| 1.0 + m[0] * m[0], |m| vec![-m[0]]);
        let best = run(o.as_ref(), &cost, &set, &Euclidean::new(1), &[1.0]);
        assert!(matches!(best.stop, Stop::Stalled(Stall::LineSearch { .. })), "{}", best.stop);
        assert!(best.stop.to_string().contains("gradient check"));
        assert_eq!(best.m, [1.0]);
    }
}

#[test]
fn a_cost_at_its_rounding_ends() {
    // Below 1e-9 relative no change of the cost is visible: the run must end by itself, near the minimiser.
    for o in every(options(1e-14, 500)) {
        let n = 6;
        let c = (0..n).map(|i| 1.0 + i as f64).collect();
        let set = wide(o.name());
        let cost = quadratic(set.clone(), c, vec![1.0; n], 1.0, 1.0, 1e3);
        let best = run(o.as_ref(), &cost, &set, &Euclidean::new(n), &vec![0.0; n]);
        println!("{}: {} {:?}", o.name(), best.stop, best.counts);
        assert!(!matches!(best.stop, Stop::MaxIterations { .. }), "{}: {}", o.name(), best.stop);
        assert!(best.counts.trials < 150, "{}: {:?}", o.name(), best.counts);
        assert!(distance(&best.m, &vec![1.0; n]) < 1e-5, "{}: {:?}", o.name(), best.m);
    }
}

#[test]
fn an_optimal_start_is_left_alone() {
    let set = Bounds::new(-1.0, 1.0).unwrap();
    for o in every(Options::default()) {
        let cost = quadratic(set.clone(), vec![1.0, 1.0], vec![5.0, 0.5], 1.0, 1.0, 0.0);
        let best = run(o.as_ref(), &cost, &set, &Euclidean::new(2), &[1.0, 0.5]);
        assert!(best.stop.is_converged() && best.counts.trials == 0, "{}", best.stop);
    }
}

#[test]
fn starts_outside_are_refused() {
    let set = Bounds::new(-1.0, 1.0).unwrap();
    let o = by_name("lbfgs", Options::default()).unwrap();
    let cost = rosenbrock(set.clone());
    let metric = Euclidean::new(2);
    let outside = begin(o.as_ref(), &cost, &set, &metric, &[0.0, 1.5]).map(|_| ()).unwrap_err();
    assert_eq!(
        outside.to_string(),
        "the start is not admissible: control component 1 is 1.5e0, which is outside: [-1e0, 1e0]"
    );
    let lengths = begin(o.as_ref(), &cost, &set, &metric, &[0.0]).map(|_| ()).unwrap_err();
    assert_eq!(lengths, RunError::Lengths { control: 1, metric: 2 });
    assert!(begin(o.as_ref(), &cost, &set, &metric, &[0.0, f64::NAN]).is_err());
    let nowhere = Cost::new(Bounds::none(), |m| m[0], |_| vec![1.0]);
    let scale = begin(o.as_ref(), &nowhere, &Bounds::none(), &Euclidean::new(1), &[0.0]).map(|_| ()).unwrap_err();
    assert_eq!(scale, RunError::NoScale);
    assert!(Bounds::new(vec![0.0, 1.0], vec![1.0, 0.5]).unwrap_err().to_string().contains("component 1"));
}

#[test]
fn a_run_can_be_cancelled_and_goes_on() {
    let set = Bounds::new(-2.0, 2.0).unwrap();
    for o in every(options(1e-6, 300)) {
        let cost = rosenbrock(set.clone());
        let metric = Euclidean::new(2);
        let whole = run(o.as_ref(), &cost, &set, &metric, &[-1.2, 1.0]);
        for stop_at in [1, 5, 6, 7, 8, 20] {
            let flag = Arc::new(AtomicBool::new(false));
            let mut run = begin(o.as_ref(), &cost, &set, &metric, &[-1.2, 1.0]).unwrap().cancelled_by(flag.clone());
            let mut watch = |t: &Trial<'_, Vec<f64>>| flag.store(t.trial >= stop_at, Ordering::Relaxed);
            let stop = loop {
                if let Outcome::Stopped(stop) = run.step(&mut watch) {
                    break stop;
                }
            };
            assert_eq!(stop, Stop::Cancelled);
            assert!(run.progress().counts.trials <= stop_at);
            let resumed = resume(o.as_ref(), &cost, &set, &metric, &run.save()).unwrap().minimize(&mut ());
            assert_eq!((&resumed.m, resumed.counts, &resumed.stop), (&whole.m, whole.counts, &whole.stop));
        }
    }
}

#[test]
fn cancelled_at_any_trial_it_repeats_the_iteration() {
    let set = Bounds::new(-3.0, 3.0).unwrap();
    let metric = Euclidean::new(2);
    for o in every(options(1e-5, 60)) {
        let cost = || rosenbrock(set.clone()).failing(|m| m[1] < m[0] * m[0] - 0.02 || m[1] > m[0] * m[0] + 0.5);
        let problem = cost();
        let whole = run(o.as_ref(), &problem, &set, &metric, &[-1.2, 1.44]);
        for stop_at in 1..whole.counts.trials.min(80) {
            let flag = Arc::new(AtomicBool::new(false));
            let begun = begin(o.as_ref(), &problem, &set, &metric, &[-1.2, 1.44]).unwrap();
            let mut begun = begun.cancelled_by(flag.clone());
            let mut watch = |t: &Trial<'_, Vec<f64>>| flag.store(t.trial >= stop_at, Ordering::Relaxed);
            while !matches!(begun.step(&mut watch), Outcome::Stopped(_)) {}
            let resumed = resume(o.as_ref(), &problem, &set, &metric, &begun.save()).unwrap().minimize(&mut ());
            assert_eq!((&resumed.m, resumed.counts), (&whole.m, whole.counts), "{} at {stop_at}", o.name());
        }
    }
}

#[test]
fn a_saved_run_goes_on_to_the_bit() {
    let n = 63;
    let set = Bounds::new(-0.02, 0.05).unwrap();
    let metric = Tridiagonal::h1(n, 0.05);
    for o in every(options(1e-5, 40)) {
        let cost = chain(set.clone(), n, |i| if i < 31 { 5.0 } else { -3.0 });
        let mut run = begin(o.as_ref(), &cost, &set, &metric, &vec![0.0; n]).unwrap();
        let mut states = Vec::new();
        while let Outcome::Iterated = run.step(&mut ()) {
            states.push(run.save());
        }
        let last = states.last().unwrap().clone();
        for state in states.iter().step_by(7) {
            let read = RunState::from_bytes(&state.to_bytes()).unwrap();
            assert_eq!(&read, state);
            let mut resumed = resume(o.as_ref(), &cost, &set, &metric, &read).unwrap();
            while let Outcome::Iterated = resumed.step(&mut ()) {}
            assert!(resumed.save().current == last.current && resumed.save().memory == last.memory, "{}", o.name());
        }
    }
}

#[test]
fn damaged_checkpoints_are_refused() {
    let set = Bounds::new(-2.0, 2.0).unwrap();
    let cost = rosenbrock(set.clone());
    let metric = Euclidean::new(2);
    let o = by_name("lbfgs", Options::default()).unwrap();
    let mut run = begin(o.as_ref(), &cost, &set, &metric, &[-1.2, 1.0]).unwrap();
    for _ in 0..4 {
        run.step(&mut ());
    }
    let bytes = run.save().to_bytes();
    for end in 0..bytes.len() {
        assert!(RunState::from_bytes(&bytes[..end]).is_err());
    }
    for at in 0..bytes.len() {
        let mut bad = bytes.clone();
        bad[at] = 0xff;
        // It may still read as other numbers; it must not crash, nor allocate what a lying count claims.
        if let Ok(state) = RunState::from_bytes(&bad) {
            let _ = resume(o.as_ref(), &cost, &set, &metric, &state);
        }
    }
    let other = by_name("spectral", Options::default()).unwrap();
    let refused = resume(other.as_ref(), &cost, &set, &metric, &run.save()).map(|_| ()).unwrap_err();
    assert!(refused.to_string().contains("lbfgs"));
}

/// In a product that is not diagonal, clamping is not the projection: the active-set solve must still reach the
/// conditions of the bounded problem.
#[test]
fn other_inner_products_reach_the_same_point() {
    let n = 63;
    let set = Bounds::new(-0.02, 0.05).unwrap();
    let reference = {
        let o = by_name("lbfgs", options(1e-10, 2000)).unwrap();
        let cost = chain(set.clone(), n, |i| if i < 31 { 5.0 } else { -3.0 });
        run(o.as_ref(), &cost, &set, &Euclidean::new(n), &vec![0.0; n])
    };
    for length in [0.0, 0.1] {
        let metric = Tridiagonal::h1(n, length);
        let stagnation = 0.0;
        for o in every(Options { stagnation, ..options(1e-6, 3000) }) {
            let cost = chain(set.clone(), n, |i| if i < 31 { 5.0 } else { -3.0 });
            let best = run(o.as_ref(), &cost, &set, &metric, &vec![0.0; n]);
            println!("{} length {length}: {} {:?}", o.name(), best.stop, best.counts);
            assert!(best.stop.is_converged(), "{}: {}", o.name(), best.stop);
            assert!(distance(&best.m, &reference.m) < 1e-5, "{}: {}", o.name(), distance(&best.m, &reference.m));
        }
    }
}
