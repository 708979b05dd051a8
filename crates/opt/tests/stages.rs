//! Continuation stages, and points that must be saved to be had again.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout)]

use crate::common;

use common::{begin, resume, wide};
use nastic_opt::{
    Bounds, CATALOGUE, Euclidean, Failed, Hessian, InnerProduct, Lbfgs, Objective, Options, Outcome, Reason, Request,
    RunState, Saved, Stall, Stop, Summary, Trial,
};
use std::sync::Mutex;

/// sum (m_i - t_i)^2 + alpha_s (m_0 m_1)^2 with alpha growing by stage; the state is found by an iteration begun at the
/// neighbour's state and ended early, so that values depend (slightly) on it.
struct Staged {
    alpha: Vec<f64>,
    log: Mutex<Vec<String>>,
    no_stage: Option<usize>,
}

#[derive(Clone, Debug)]
struct Point {
    m: Vec<f64>,
    root: f64,
    stage: usize,
}

impl Staged {
    fn new(alpha: &[f64]) -> Self {
        Self { alpha: alpha.to_vec(), log: Mutex::new(Vec::new()), no_stage: None }
    }
}

impl Objective for Staged {
    type Point = Point;
    type Workspace = ();

    fn evaluate(&self, m: &[f64], how: &Request<'_, Point>, (): &mut ()) -> Result<Point, Failed> {
        assert!(how.near.is_none_or(|near| near.stage == how.stage), "the neighbour is of the same stage");
        // x^3 + x = m_0 by three Newton steps from the neighbour's root.
        let mut root = how.near.map_or(0.0, |near| near.root);
        for _ in 0..3 {
            root -= (root.powi(3) + root - m[0]) / (3.0 * root * root + 1.0);
        }
        Ok(Point { m: m.to_vec(), root, stage: how.stage })
    }

    fn value(&self, p: &Point) -> f64 {
        let coupling = self.alpha[p.stage] * (p.root * p.m[1]).powi(2);
        (p.root - 1.0).powi(2) + (p.m[1] - 2.0).powi(2) + coupling
    }

    fn derivative(&self, p: &mut Point, (): &mut ()) -> Result<Vec<f64>, Failed> {
        let a = self.alpha[p.stage];
        let root = 2.0 * (p.root - 1.0) + 2.0 * a * p.root * p.m[1] * p.m[1];
        let slope = 1.0 / (3.0 * p.root * p.root + 1.0);
        Ok(vec![root * slope, 2.0 * (p.m[1] - 2.0) + 2.0 * a * p.root * p.root * p.m[1]])
    }

    fn hessian_vector(&self, p: &Point, v: &[f64], _: Hessian, (): &mut ()) -> Result<Vec<f64>, Failed> {
        let (a, root, slope) = (self.alpha[p.stage], p.root, 1.0 / (3.0 * p.root * p.root + 1.0));
        let by_root = 2.0 * (root - 1.0) + 2.0 * a * root * p.m[1] * p.m[1];
        let first = (2.0 + 2.0 * a * p.m[1] * p.m[1]) * slope * slope - by_root * 6.0 * root * slope.powi(3);
        let (mixed, second) = (4.0 * a * root * p.m[1] * slope, 2.0 + 2.0 * a * root * root);
        Ok(vec![first * v[0] + mixed * v[1], mixed * v[0] + second * v[1]])
    }

    fn stages(&self) -> usize {
        self.alpha.len()
    }

    fn restage(&self, stage: usize, p: &Point) -> Result<Point, Failed> {
        self.log.lock().unwrap().push(format!("restage {stage}"));
        if self.no_stage == Some(stage) {
            return Err(Failed::because("alpha is too large for the quadrature"));
        }
        Ok(Point { stage, ..p.clone() })
    }

    fn summary(&self, p: &Point) -> Summary {
        Summary(vec![("root".into(), p.root)])
    }

    fn save(&self, p: &Point) -> Vec<u8> {
        p.root.to_le_bytes().to_vec()
    }

    fn load(&self, m: &[f64], bytes: &[u8], how: &Request<'_, Point>) -> Result<Point, Failed> {
        let bytes = bytes.try_into().map_err(|_| Failed::because("not a root"))?;
        Ok(Point { m: m.to_vec(), root: f64::from_le_bytes(bytes), stage: how.stage })
    }
}

#[test]
fn stages_follow_each_other_from_the_same_state() {
    let objective_alpha = [0.1, 1.0, 10.0];
    for entry in CATALOGUE {
        let objective = Staged::new(&objective_alpha);
        let options = Options { tolerance: 1e-6, max_iterations: 600, stagnation: 0.0, ..Options::default() };
        let optimizer = (entry.build)(options);
        let (set, metric) = (Bounds::new(-5.0, 5.0).unwrap(), Euclidean::new(2));
        let mut lines = Vec::new();
        let mut watch = |t: &Trial<'_, Point>| {
            assert_eq!(t.summary.get("root"), t.point.map(|p| p.root));
            lines.push((t.stage, t.reason.clone(), t.relative_gradient));
        };
        let best = begin(optimizer.as_ref(), &objective, &set, &metric, &[0.0, 0.0]).unwrap().minimize(&mut watch);
        println!("{}: {} {:?} {:?}", entry.name, best.stop, best.counts, best.stages);
        assert!(best.stop.is_converged(), "{}", best.stop);
        assert_eq!(*objective.log.lock().unwrap(), ["restage 1", "restage 2"]);
        assert!(best.stages.iter().map(|s| s.stage).eq(0..3) && best.stages.iter().all(|s| s.converged));
        assert!(lines.windows(2).all(|w| w[0].0 <= w[1].0));
        let begun: Vec<_> = lines.iter().filter(|l| l.1 == Reason::Stage).collect();
        // Every stage is measured against its own first gradient.
        assert!(begun.len() == 2 && begun.iter().all(|l| l.2 == 1.0));
        assert_eq!(best.point.stage, 2);
    }
}

#[test]
fn iterations_are_shared_out() {
    let objective = Staged::new(&[0.1, 1.0, 10.0]);
    let options = Options { tolerance: 1e-300, stage_tolerance: 1e-300, max_iterations: 7, ..Options::default() };
    let (set, metric) = (Bounds::none(), Euclidean::new(2));
    let optimizer = Lbfgs { options, ..Lbfgs::default() };
    let best = begin(&optimizer, &objective, &set, &metric, &[0.0, 0.0]).unwrap().minimize(&mut ());
    let spent: Vec<usize> = best.stages.iter().map(|s| s.iterations).collect();
    assert_eq!(spent, [3, 2, 2]);
    assert!(matches!(best.stop, Stop::MaxIterations { iterations: 7, .. }), "{}", best.stop);
}

#[test]
fn a_stage_that_cannot_begin_ends_the_run_with_the_last_good_point() {
    let objective = Staged { no_stage: Some(1), ..Staged::new(&[0.1, 1.0]) };
    let (set, metric) = (Bounds::none(), Euclidean::new(2));
    let best = begin(&Lbfgs::default(), &objective, &set, &metric, &[0.0, 0.0]).unwrap().minimize(&mut ());
    assert!(
        matches!(&best.stop, Stop::Stalled(Stall::Stage { stage: 1, why }) if why.to_string().contains("quadrature"))
    );
    assert!(best.stages[0].converged && best.point.stage == 0 && best.cost < 1.0);
}

#[test]
fn resumed_at_any_iteration_of_any_stage_it_ends_with_the_same_bits() {
    for entry in CATALOGUE {
        let objective = Staged::new(&[0.1, 1.0, 10.0]);
        let options = Options { tolerance: 1e-6, max_iterations: 60, ..Options::default() };
        let optimizer = (entry.build)(options);
        let (set, metric) = (Bounds::new(-5.0, 0.9).unwrap(), Euclidean::new(2));
        let mut run = begin(optimizer.as_ref(), &objective, &set, &metric, &[0.0, 0.0]).unwrap();
        let mut saved = vec![run.save().to_bytes()];
        while !matches!(run.step(&mut ()), Outcome::Stopped(_)) {
            saved.push(run.save().to_bytes());
        }
        let end = run.save().to_bytes();
        for bytes in &saved {
            let state = RunState::from_bytes(bytes).unwrap();
            let mut resumed = resume(optimizer.as_ref(), &objective, &set, &metric, &state).unwrap();
            while !matches!(resumed.step(&mut ()), Outcome::Stopped(_)) {}
            assert!(resumed.save().to_bytes() == end, "{}", entry.name);
        }
        // The start is reported once, not again by a resumed run.
        let state = RunState::from_bytes(&saved[1]).unwrap();
        let mut starts = 0;
        let mut watch = |t: &Trial<'_, Point>| starts += usize::from(t.reason == Reason::Start);
        resume(optimizer.as_ref(), &objective, &set, &metric, &state).unwrap().minimize(&mut watch);
        assert_eq!(starts, 0);
    }
}

/// A cost with a kink cannot meet a gradient tolerance: the run ends by stagnation, well before its iterations do.
#[test]
fn kinks_end_in_stagnation() {
    struct Kink;
    impl Objective for Kink {
        type Point = Vec<f64>;
        type Workspace = ();
        fn evaluate(&self, m: &[f64], _: &Request<'_, Vec<f64>>, (): &mut ()) -> Result<Vec<f64>, Failed> {
            Ok(m.to_vec())
        }
        fn value(&self, m: &Vec<f64>) -> f64 {
            1.0 + m.iter().enumerate().map(|(i, m)| (m - (i as f64).sin()).abs() * (1.0 + i as f64)).sum::<f64>()
        }
        fn derivative(&self, m: &mut Vec<f64>, (): &mut ()) -> Result<Vec<f64>, Failed> {
            Ok(m.iter().enumerate().map(|(i, m)| (m - (i as f64).sin()).signum() * (1.0 + i as f64)).collect())
        }
        fn hessian_vector(&self, _: &Vec<f64>, v: &[f64], _: Hessian, (): &mut ()) -> Result<Vec<f64>, Failed> {
            Ok(vec![0.0; v.len()])
        }
        fn restage(&self, _: usize, m: &Vec<f64>) -> Result<Vec<f64>, Failed> {
            Ok(m.clone())
        }
    }
    let options = Options { max_iterations: 2000, ..Options::default() };
    for entry in CATALOGUE {
        let (set, metric) = (wide(entry.name), Euclidean::new(8));
        let optimizer = (entry.build)(options);
        let best = begin(optimizer.as_ref(), &Kink, &set, &metric, &[0.0; 8]).unwrap().minimize(&mut ());
        println!("{}: {} cost {} {:?}", entry.name, best.stop, best.cost, best.counts);
        assert!(matches!(best.stop, Stop::Stalled(_)), "{}", best.stop);
        assert!(best.counts.iterations < 500);
        assert!(metric.norm(&best.derivative) > 0.0);
    }
}
