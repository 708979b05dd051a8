//! The builder of runs: what it passes on to them, the gradient check, stages.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use nastic_opt::{
    Best, Bounds, Diagonal, EvaluatedStart, Failed, InnerProduct, InnerProductError, Lbfgs, Objective, Optimizer,
    Options, Outcome, Problem, Request, RunError, Stop, Trial, Verdict, by_name,
};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// |m - (1, 2)|^2 + 1, in a product that the test chooses; counts its evaluations.
struct Square {
    weights: Vec<f64>,
    evaluations: AtomicUsize,
}

fn square(weights: [f64; 2]) -> Square {
    Square { weights: weights.to_vec(), evaluations: AtomicUsize::new(0) }
}

impl Objective for Square {
    type Point = Vec<f64>;
    type Workspace = usize;

    /// The workspace counts what was evaluated with it.
    fn evaluate(&self, m: &[f64], _: &Request<'_, Vec<f64>>, seen: &mut usize) -> Result<Vec<f64>, Failed> {
        self.evaluations.fetch_add(1, Ordering::Relaxed);
        *seen += 1;
        Ok(m.to_vec())
    }

    fn value(&self, m: &Vec<f64>) -> f64 {
        (m[0] - 1.0).powi(2) + (m[1] - 2.0).powi(2) + 1.0
    }

    fn derivative(&self, m: &mut Vec<f64>, _: &mut usize) -> Result<Vec<f64>, Failed> {
        Ok(vec![2.0 * (m[0] - 1.0), 2.0 * (m[1] - 2.0)])
    }

    fn restage(&self, _: usize, m: &Vec<f64>) -> Result<Vec<f64>, Failed> {
        Ok(m.clone())
    }
}

impl Problem for Square {
    fn inner_product(&self) -> Result<Arc<dyn InnerProduct>, Failed> {
        Ok(Arc::new(Diagonal::new(self.weights.clone()).map_err(Failed::new)?))
    }
}

fn bounds() -> Bounds {
    Bounds::new(-5.0, 5.0).unwrap()
}

#[test]
fn every_part_reaches_the_run() {
    let problem = square([1.0, 1.0]);
    let optimizer = by_name("lbfgs", Options::default()).unwrap();
    let mut seen = 0;
    let best = optimizer
        .within(bounds())
        .options(Options { stagnation: 0.0, ..Options::default() })
        .tolerance(1e-9)
        .max_iterations(50)
        .observe(|trial: &Trial<'_, Vec<f64>>| seen += usize::from(trial.accepted))
        .minimize(&problem, 0.0)
        .unwrap();
    assert!(best.stop.is_converged() && best.gradient_norm < 1e-8, "{}", best.stop);
    assert_eq!(seen, 1 + best.counts.iterations);
    let loose = Lbfgs::default().within(bounds()).tolerance(2.0).minimize(&problem, 0.0).unwrap();
    assert!(loose.stop.is_converged() && loose.counts.iterations == 0, "{}", loose.stop);
    let none = Options { max_iterations: 0, ..Options::default() };
    let none = Lbfgs::default().within(bounds()).options(none).minimize(&problem, 0.0).unwrap();
    assert!(matches!(none.stop, Stop::MaxIterations { iterations: 0, .. }), "{}", none.stop);
    let short = Lbfgs::default().within(bounds()).tolerance(0.0).max_iterations(1).minimize(&problem, 0.0).unwrap();
    assert!(matches!(short.stop, Stop::MaxIterations { iterations: 1, .. }), "{}", short.stop);
}

/// sum m_i^2 times 1 + stage, with a derivative `error` times too long.
struct Stretched {
    error: f64,
}

impl Objective for Stretched {
    type Point = (Vec<f64>, usize);
    type Workspace = ();

    fn evaluate(&self, m: &[f64], how: &Request<'_, Self::Point>, (): &mut ()) -> Result<Self::Point, Failed> {
        Ok((m.to_vec(), how.stage))
    }

    fn value(&self, (m, stage): &Self::Point) -> f64 {
        (1 + stage) as f64 * m.iter().map(|m| m * m).sum::<f64>()
    }

    fn derivative(&self, (m, stage): &mut Self::Point, (): &mut ()) -> Result<Vec<f64>, Failed> {
        Ok(m.iter().map(|m| 2.0 * (1.0 + self.error) * (1 + *stage) as f64 * m).collect())
    }

    fn stages(&self) -> usize {
        3
    }

    fn restage(&self, stage: usize, (m, _): &Self::Point) -> Result<Self::Point, Failed> {
        Ok((m.clone(), stage))
    }
}

impl Problem for Stretched {
    fn inner_product(&self) -> Result<Arc<dyn InnerProduct>, Failed> {
        Ok(Arc::new(Diagonal::new(vec![1.0; 2]).map_err(Failed::new)?))
    }
}

#[test]
fn minimize_refuses_a_wrong_derivative_and_keeps_the_certificate_of_a_right_one() {
    let mut search = Lbfgs::default().within(bounds());
    let best = search.minimize(Stretched { error: 0.0 }, 2.0).unwrap();
    let certificate = best.certificate.expect("a certificate");
    assert!(certificate.verdict == Verdict::Right && certificate.mismatch < 1e-3, "{certificate}");
    let wrong = || Stretched { error: 0.2 };
    let refused = search.minimize(wrong(), 2.0).map(drop).unwrap_err();
    assert!(matches!(&refused, RunError::Derivative(found) if found.verdict == Verdict::Wrong), "{refused}");
    assert!(refused.to_string().contains("gradient_check(false)"), "{refused}");
    let unchecked = search.gradient_check(false).minimize(wrong(), 2.0).unwrap();
    assert!(unchecked.certificate.is_none() && unchecked.cost < 1e-6, "{}", unchecked.cost);
}

#[test]
fn a_run_goes_through_the_stages_asked_for() {
    let problem = Stretched { error: 0.0 };
    let ran = |best: &Best<(Vec<f64>, usize)>| best.stages.iter().map(|end| end.stage).collect::<Vec<_>>();
    let all = Lbfgs::default().within(bounds()).minimize(&problem, 2.0).unwrap();
    assert_eq!(ran(&all), [0, 1, 2]);
    let mut costs = Vec::new();
    let last = Lbfgs::default()
        .within(bounds())
        .stages(1..3)
        .observe(|trial: &Trial<'_, (Vec<f64>, usize)>| costs.extend(trial.cost))
        .minimize(&problem, 2.0)
        .unwrap();
    assert_eq!((ran(&last), costs[0]), (vec![1, 2], 16.0));
    // An evaluated start is of stage 0.
    let point = (vec![2.0, 2.0], 0);
    let start = EvaluatedStart { m: point.0.clone(), point, derivative: Some(vec![4.0, 4.0]) };
    let run = Lbfgs::default().within(bounds()).stages(2..3).start(&problem, start).unwrap();
    assert_eq!((run.cost(), run.progress().stage), (24.0, 2));
    for (first, end) in [(0, 4), (3, 3), (2, 1)] {
        let refused = Lbfgs::default().within(bounds()).stages(first..end).start(&problem, 2.0).map(drop).unwrap_err();
        assert_eq!(refused, RunError::Stages { first, end, stages: 3 });
    }
}

/// The norm of the gradient shows in which product a run measures.
#[test]
fn a_product_of_ones_own_takes_the_place_of_the_problems() {
    let problem = square([4.0, 4.0]);
    let own = Lbfgs::default().within(bounds()).start(&problem, 0.0).unwrap();
    let other = Lbfgs::default().within(bounds()).metric(Diagonal::new(vec![1.0; 2]).unwrap());
    let other = other.start(&problem, 0.0).unwrap();
    assert!((own.gradient_norm() / 5f64.sqrt() - 1.0).abs() < 1e-12, "{}", own.gradient_norm());
    assert!((other.gradient_norm() / 20f64.sqrt() - 1.0).abs() < 1e-12, "{}", other.gradient_norm());
}

#[test]
fn a_product_that_cannot_be_built_is_an_error_with_its_type() {
    let refused = Lbfgs::default().within(bounds()).start(square([1.0, 0.0]), 0.0).map(drop).unwrap_err();
    let RunError::InnerProduct(failed) = &refused else { panic!("{refused}") };
    assert!(matches!(failed.downcast_ref(), Some(InnerProductError::Weight { index: 1, .. })), "{refused}");
    assert!(refused.to_string().contains("weight 1"), "{refused}");
}

#[test]
fn an_evaluated_start_is_taken_as_it_is() {
    let problem = square([1.0, 1.0]);
    let m = vec![0.5, 0.0];
    let start = EvaluatedStart { m: m.clone(), point: m.clone(), derivative: None };
    let run = Lbfgs::default().within(bounds()).start(&problem, start).unwrap().with_workspace(7);
    assert_eq!((problem.evaluations.load(Ordering::Relaxed), *run.workspace(), run.m()), (0, 7, m.as_slice()));
    let outside = EvaluatedStart { m: vec![9.0, 0.0], point: m, derivative: None };
    let refused = Lbfgs::default().within(bounds()).start(&problem, outside).map(drop).unwrap_err();
    assert!(matches!(refused, RunError::Outside(_)), "{refused}");
}

#[test]
fn runs_are_stepped_saved_taken_up_and_cancelled() {
    let problem = Arc::new(square([1.0, 1.0]));
    let flag = Arc::new(AtomicBool::new(false));
    let search = Lbfgs::default().within(bounds()).tolerance(1e-9).cancelled_by(flag.clone());
    let mut run = search.start(problem.clone(), &[-3.0, 4.0][..]).unwrap();
    assert_eq!(run.step(&mut ()), Outcome::Iterated);
    assert_eq!(*run.workspace(), 1 + run.progress().counts.trials);
    let state = run.checkpoint();
    assert_eq!(*run.workspace(), 0, "a checkpoint empties the workspace");
    let mut resumed = search.resume(problem.clone(), &state).unwrap();
    assert_eq!(*resumed.workspace(), 0);
    let (stop, again) = (run.run(&mut ()), resumed.run(&mut ()));
    assert_eq!((&stop, run.m()), (&again, resumed.m()));
    assert!(stop.is_converged() && run.objective().evaluations.load(Ordering::Relaxed) > 2);
    flag.store(true, Ordering::Relaxed);
    assert_eq!(search.start(problem, 0.0).unwrap().step(&mut ()), Outcome::Stopped(Stop::Cancelled));
}
