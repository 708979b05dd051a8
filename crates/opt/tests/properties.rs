//! Properties of every driver on every set: no evaluation outside the set, and convergence where a fifth of all trials fails.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout)]

use nastic_numeric::Random;
use nastic_numeric::vector::{dot, sub};
use nastic_opt::admissible::{CATALOGUE as SETS, SetRow};
use nastic_opt::{
    Admissible, Best, CATALOGUE, Diagonal, Failed, Hessian, InnerProduct, Objective, Optimizer, Options, Reason,
    Request, Run, Trial,
};
use std::sync::{Arc, Mutex};
use thiserror::Error;

const POINTS: usize = 6;
const STARTS: u64 = 5;
/// On the projected gradient's norm, which is 1 to 50 at the starts.
const TOLERANCE: f64 = 1e-5;
/// Of all evaluations but the first, where any fails.
const FAILING: f64 = 0.2;

/// A trial that was drawn to fail.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[error("evaluation {0} was drawn to fail")]
struct Drawn(usize);

/// Convex: q(m) = 1/2 sum c_i (m_i - t_i)^2 + 1/2 sum (m_i - m_{i+1})^2. Otherwise 0.05 q(m) + sum (1 - cos 3 (m_i - t_i)), which has many minima.
struct Problem {
    set: Arc<dyn Admissible>,
    convex: bool,
    c: Vec<f64>,
    target: Vec<f64>,
    /// The generator that draws failures and the evaluations so far.
    draws: Option<Mutex<(Random, usize)>>,
}

impl Problem {
    fn new(set: Arc<dyn Admissible>, convex: bool, len: usize) -> Self {
        let c = (0..len).map(|i| 1.0 + 3.0 * (i % 5) as f64).collect();
        let target = (0..len).map(|i| 1.2 * (1.7 * i as f64 + 0.4).sin()).collect();
        Self { set, convex, c, target, draws: None }
    }

    fn failing(self, seed: u64) -> Self {
        Self { draws: Some(Mutex::new((Random::new(seed), 0))), ..self }
    }

    fn quadratic(&self, m: &[f64]) -> Vec<f64> {
        let bend = |i: usize, j: usize| m.get(j).map_or(0.0, |other| m[i] - other);
        (0..m.len())
            .map(|i| self.c[i] * (m[i] - self.target[i]) + bend(i, i + 1) + bend(i, i.wrapping_sub(1)))
            .collect()
    }
}

impl Objective for Problem {
    type Point = Vec<f64>;
    type Workspace = ();

    fn evaluate(&self, m: &[f64], _: &Request<'_, Vec<f64>>, (): &mut ()) -> Result<Vec<f64>, Failed> {
        self.set.check(m).expect("nothing is evaluated outside the set");
        if let Some(draws) = &self.draws {
            let (random, count) = &mut *draws.lock().unwrap();
            *count += 1;
            if *count > 1 && random.unit() < FAILING {
                return Err(Failed::new(Drawn(*count)));
            }
        }
        Ok(m.to_vec())
    }

    fn value(&self, m: &Vec<f64>) -> f64 {
        let off = sub(m, &self.target);
        let springs: f64 = off.iter().zip(&self.c).map(|(e, c)| 0.5 * c * e * e).sum();
        let q = springs + m.windows(2).map(|pair| 0.5 * (pair[0] - pair[1]).powi(2)).sum::<f64>();
        if self.convex { q } else { 0.05 * q + off.iter().map(|e| 1.0 - (3.0 * e).cos()).sum::<f64>() }
    }

    fn derivative(&self, m: &mut Vec<f64>, (): &mut ()) -> Result<Vec<f64>, Failed> {
        let q = self.quadratic(m);
        let wave = m.iter().zip(&self.target).map(|(m, t)| 3.0 * (3.0 * (m - t)).sin());
        Ok(if self.convex { q } else { q.iter().zip(wave).map(|(q, w)| 0.05 * q + w).collect() })
    }

    fn hessian_vector(&self, m: &Vec<f64>, v: &[f64], _: Hessian, (): &mut ()) -> Result<Vec<f64>, Failed> {
        let of_zero = self.quadratic(&vec![0.0; v.len()]);
        let q = sub(&self.quadratic(v), &of_zero);
        let wave = m.iter().zip(&self.target).zip(v).map(|((m, t), v)| 9.0 * (3.0 * (m - t)).cos() * v);
        Ok(if self.convex { q } else { q.iter().zip(wave).map(|(q, w)| 0.05 * q + w).collect() })
    }

    fn restage(&self, _: usize, m: &Vec<f64>) -> Result<Vec<f64>, Failed> {
        Ok(m.clone())
    }
}

/// One run of one driver; the count is that of the trials that were drawn to fail, as the observer sees them.
struct Ended {
    best: Best<Vec<f64>>,
    message: usize,
    /// The projected gradient's norm at the end, computed here.
    stationary: f64,
}

fn run(optimizer: &dyn Optimizer, problem: &Problem, metric: &Arc<Diagonal>, start: &[f64]) -> Ended {
    let mut message = 0;
    let mut watch = |trial: &Trial<'_, Vec<f64>>| {
        assert!(problem.set.check(trial.m).is_ok());
        if let Reason::Failed(why) = &trial.reason {
            assert!(why.downcast_ref::<Drawn>().is_some(), "the type of a failure is kept");
            message += 1;
        }
    };
    let begun = Run::start(optimizer, problem, problem.set.clone(), metric.clone() as Arc<dyn InnerProduct>, start);
    let best = begun.unwrap().minimize(&mut watch);
    let mut derivative = problem.derivative(&mut best.m.clone(), &mut ()).unwrap();
    problem.set.tangent(&best.m, &mut derivative);
    let stationary = problem.set.optimality(metric.as_ref(), &best.m, &derivative).norm;
    Ended { best, message, stationary }
}

/// Calls back for every driver, set, kind of problem and start.
fn for_all(mut test: impl FnMut(&dyn Optimizer, &SetRow, &mut dyn FnMut() -> Problem, &Arc<Diagonal>, &[f64], u64)) {
    let options = Options {
        absolute_tolerance: TOLERANCE,
        tolerance: 0.0,
        max_iterations: 3000,
        stagnation: 0.0,
        ..Options::default()
    };
    for driver in CATALOGUE {
        let optimizer = (driver.build)(options);
        // Moving asymptotes take bounds alone.
        for row in SETS.iter().filter(|row| driver.name != "mma" || row.name == "bounds") {
            let set = (row.make)(POINTS).unwrap();
            let len = POINTS * row.components;
            // weights that differ over the components of some points too: shortening is not the projection there
            let metric = Diagonal::new((0..len).map(|i| 0.5 + (i / row.components % 3) as f64).collect()).unwrap();
            let metric = Arc::new(metric);
            for convex in [true, false] {
                for seed in 1..=STARTS {
                    let mut random = Random::new(seed);
                    let mut start: Vec<f64> = (0..len).map(|_| 1.5 * random.symmetric()).collect();
                    set.project(&mut start);
                    let mut make = || Problem::new(set.clone(), convex, len);
                    test(optimizer.as_ref(), row, &mut make, &metric, &start, seed);
                }
            }
        }
    }
}

/// [`Problem::evaluate`] panics outside the set; every run ends at a stationary point.
#[test]
fn nothing_is_evaluated_outside_the_set() {
    for_all(|optimizer, row, make, metric, start, seed| {
        let problem = make();
        let Ended { best, stationary, .. } = run(optimizer, &problem, metric, start);
        let what =
            format!("{} on {}, convex {}, start {seed}: {}", optimizer.name(), row.name, problem.convex, best.stop);
        assert!(best.stop.is_converged() && stationary <= 1.001 * TOLERANCE, "{what}: {stationary:e}");
    });
}

/// A fifth of all trials fails: the same optimum where cost and set are convex, a stationary point elsewhere.
#[test]
fn drivers_converge_where_a_fifth_of_the_trials_fails() {
    let (mut trials, mut failed) = (0, 0);
    for_all(|optimizer, row, make, metric, start, seed| {
        let problem = make().failing(1000 + seed);
        let Ended { best, message, stationary } = run(optimizer, &problem, metric, start);
        let what =
            format!("{} on {}, convex {}, start {seed}: {}", optimizer.name(), row.name, problem.convex, best.stop);
        assert_eq!(message, best.counts.failed, "{what}");
        (trials, failed) = (trials + best.counts.trials, failed + message);
        assert!(best.stop.is_converged() && stationary <= 1.001 * TOLERANCE, "{what}: {stationary:e}");
        if problem.convex && row.convex {
            let reliable = run(optimizer, &make(), metric, start).best;
            let off = sub(&best.m, &reliable.m);
            assert!(dot(&off, &off).sqrt() < 1e-4, "{what}: {:?} and {:?}", best.m, reliable.m);
        }
    });
    let share = failed as f64 / trials as f64;
    println!("{failed} of {trials} trials failed");
    assert!((share - FAILING).abs() < 0.02, "{share}");
}
