//! Trials with a budget, and trials that fail and show how far their step may go.

use nastic_opt::{
    Bounds, Budget, Diagonal, Failed, InnerProduct, Lbfgs, LineSearch, Objective, Optimizer, Options, Problem, Reason,
    Request, Trial,
};
use std::error::Error;
use std::sync::{Arc, Mutex};

type Outcome<T = ()> = Result<T, Box<dyn Error>>;

/// `(m - 10)^2` where m < 3, nothing or another branch beyond; asked, it says how far the step may go, or not.
struct Cliff {
    tells: bool,
    /// Whether there is another branch.
    jumps: bool,
    asked: Mutex<Vec<Budget>>,
}

const EDGE: f64 = 3.0;

impl Objective for Cliff {
    type Point = Vec<f64>;
    type Workspace = ();

    fn evaluate(&self, m: &[f64], how: &Request<'_, Vec<f64>>, (): &mut ()) -> Result<Vec<f64>, Failed> {
        if let Ok(mut asked) = self.asked.lock() {
            asked.push(how.budget);
        }
        match how.near {
            Some(near) if m[0] >= EDGE && !self.jumps => {
                let failed = Failed::because("beyond the edge");
                Err(if self.tells { failed.beyond((EDGE - near[0]) / (m[0] - near[0])) } else { failed })
            }
            _ => Ok(m.to_vec()),
        }
    }

    fn value(&self, m: &Vec<f64>) -> f64 {
        if m[0] >= EDGE { 1e3 } else { (m[0] - 10.0).powi(2) }
    }

    fn jump(&self, from: &Vec<f64>, to: &Vec<f64>, (): &mut ()) -> Option<Failed> {
        let jumped = self.tells && from[0] < EDGE && to[0] >= EDGE;
        jumped.then(|| Failed::because("over the edge").beyond((EDGE - from[0]) / (to[0] - from[0])))
    }

    fn derivative(&self, m: &mut Vec<f64>, (): &mut ()) -> Result<Vec<f64>, Failed> {
        Ok(vec![2.0 * (m[0] - 10.0)])
    }

    fn restage(&self, _: usize, m: &Vec<f64>) -> Result<Vec<f64>, Failed> {
        Ok(m.clone())
    }
}

impl Problem for Cliff {
    fn inner_product(&self) -> Result<Arc<dyn InnerProduct>, Failed> {
        Ok(Arc::new(Diagonal::new(vec![1.0]).map_err(Failed::new)?))
    }
}

/// The controls that were tried, and how many trials failed.
fn run(cliff: &Cliff, iterations: usize) -> Outcome<(Vec<f64>, usize)> {
    let (mut tried, mut failed) = (vec![], 0);
    let method = Lbfgs { options: Options { max_iterations: iterations, ..Options::default() }, ..Lbfgs::default() };
    let watch = |trial: &Trial<'_, Vec<f64>>| {
        tried.push(trial.m[0]);
        failed += usize::from(matches!(trial.reason, Reason::Failed(_)));
    };
    method.within(Bounds::new(0.0, 20.0)?).gradient_check(false).observe(watch).minimize(cliff, 0.5)?;
    Ok((tried, failed))
}

/// The next trial stands nine tenths of the way to the edge.
#[test]
fn a_known_limit_is_approached_and_not_crossed() -> Outcome {
    let cliff = |tells| Cliff { tells, jumps: false, asked: Mutex::default() };
    let (tried, failed) = run(&cliff(true), 3)?;
    let beyond = tried.iter().position(|m| *m >= EDGE).ok_or("no trial beyond the edge")?;
    let before = tried[..beyond].last().copied().unwrap_or_default();
    let expected = before + LineSearch::default().before_limit * (EDGE - before);
    assert!((tried[beyond + 1] - expected).abs() < 1e-12, "{tried:?}");
    assert!(failed <= 3, "one failure per iteration: {tried:?}");
    let reached = |tried: &[f64]| tried.iter().filter(|m| **m < EDGE).copied().fold(0.0, f64::max);
    let (blind, _) = run(&cliff(false), 3)?;
    assert!(EDGE - reached(&tried) < 0.1 * (EDGE - reached(&blind)), "{tried:?} and {blind:?}");
    Ok(())
}

/// Trials have a multiple of the work of the point they start near, the start as much as it takes.
#[test]
fn trials_have_a_budget_and_the_start_has_none() -> Outcome {
    let cliff = Cliff { tells: true, jumps: false, asked: Mutex::default() };
    run(&cliff, 2)?;
    let asked = cliff.asked.into_inner()?;
    assert_eq!(asked[0], Budget::Unlimited);
    assert!(asked.len() > 2 && asked[1..].iter().all(|one| *one == Budget::Times(Options::default().patience)));
    let work = |budget: Budget, near| budget.work(near, 40);
    assert_eq!([work(Budget::Times(5.0), Some(3)), work(Budget::Times(5.0), Some(21))], [Some(40), Some(105)]);
    assert_eq!([work(Budget::Times(5.0), None), work(Budget::Unlimited, Some(3))], [None, None]);
    assert_eq!([work(Budget::Of(7), None), work(Budget::Of(7), Some(100))], [Some(7), Some(7)]);
    Ok(())
}

/// A trial on another branch says so, and the next one stands before the edge, however much the cost has jumped.
#[test]
fn a_jump_is_told_and_the_next_trial_stays_before_it() -> Outcome {
    let cliff = Cliff { tells: true, jumps: true, asked: Mutex::default() };
    let mut message = vec![];
    let watch = |trial: &Trial<'_, Vec<f64>>| message.push((trial.m[0], trial.accepted, trial.reason.clone()));
    let method = Lbfgs { options: Options { max_iterations: 3, ..Options::default() }, ..Lbfgs::default() };
    method.within(Bounds::new(0.0, 20.0)?).gradient_check(false).observe(watch).minimize(&cliff, 0.5)?;
    let at = message.iter().position(|(m, ..)| *m >= EDGE).ok_or("no trial beyond the edge")?;
    let (_, accepted, reason) = &message[at];
    assert!(!accepted && matches!(reason, Reason::OtherBranch(_)), "{message:?}");
    assert_eq!(reason.to_string(), "no decrease, on another branch: over the edge");
    let expected = message[at - 1].0 + LineSearch::default().before_limit * (EDGE - message[at - 1].0);
    assert!((message[at + 1].0 - expected).abs() < 1e-12 && message[at + 1].1, "{message:?}");
    Ok(())
}

/// `j(m(t)) <= reference + armijo dj.(m(t) - m) + slack`, at its border.
#[test]
fn a_step_needs_its_share_of_the_predicted_decrease() {
    let search = LineSearch::default();
    let (reference, predicted) = (1.0, -2.0);
    let border = reference + search.armijo * predicted;
    assert!(search.accepts(reference, predicted, 0.0, border - 1e-9));
    assert!(!search.accepts(reference, predicted, 0.0, border + 1e-9), "a decrease of less than that share");
    assert!(search.accepts(reference, predicted, 2e-9, border + 1e-9), "within rounding");
}
