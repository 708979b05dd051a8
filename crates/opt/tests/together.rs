//! Runs beside others that make the same calls: what any of them says ends all.

use nastic_opt::{Bounds, Diagonal, Failed, InnerProduct, Lbfgs, Objective, Optimizer, Problem, Request, Stop};
use std::error::Error;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

type Outcome<T = ()> = Result<T, Box<dyn Error>>;

/// What the others say.
#[derive(Clone, Copy, PartialEq)]
enum Others {
    Nothing,
    /// One is cancelled when they are asked for this time.
    Cancelled(usize),
    /// One fails fatally where a trial fails here.
    FailFatally,
    /// They are not there any more when they are asked for this time.
    Lost(usize),
}

/// `(m - 10)^2`, of which a trial fails where m > 3.
struct Beside {
    others: Others,
    asked: AtomicUsize,
    failed: AtomicBool,
}

impl Beside {
    fn those(others: Others) -> Self {
        Beside { others, asked: AtomicUsize::new(0), failed: AtomicBool::new(false) }
    }
}

impl Objective for Beside {
    type Point = Vec<f64>;
    type Workspace = ();

    fn evaluate(&self, m: &[f64], _: &Request<'_, Vec<f64>>, (): &mut ()) -> Result<Vec<f64>, Failed> {
        self.failed.store(m[0] > 3.0, Ordering::Relaxed);
        if m[0] > 3.0 { Err(Failed::because("too far")) } else { Ok(m.to_vec()) }
    }

    fn value(&self, m: &Vec<f64>) -> f64 {
        (m[0] - 10.0).powi(2)
    }

    fn derivative(&self, m: &mut Vec<f64>, (): &mut ()) -> Result<Vec<f64>, Failed> {
        Ok(vec![2.0 * (m[0] - 10.0)])
    }

    fn restage(&self, _: usize, m: &Vec<f64>) -> Result<Vec<f64>, Failed> {
        Ok(m.clone())
    }

    fn any(&self, here: bool) -> Result<bool, Failed> {
        let asked = self.asked.fetch_add(1, Ordering::Relaxed);
        match self.others {
            Others::Cancelled(at) if asked >= at => Ok(true),
            Others::Lost(at) if asked >= at => Err(Failed::because("nobody answers").fatal()),
            Others::FailFatally => Ok(here || self.failed.load(Ordering::Relaxed)),
            _ => Ok(here),
        }
    }
}

impl Problem for Beside {
    fn inner_product(&self) -> Result<Arc<dyn InnerProduct>, Failed> {
        Ok(Arc::new(Diagonal::new(vec![1.0]).map_err(Failed::new)?))
    }
}

/// How a run beside these ends, the problem being borrowed or shared.
fn end(others: Others) -> Outcome<Stop> {
    let mut within = Lbfgs::default().within(Bounds::new(-100.0, 100.0)?).gradient_check(false);
    let borrowed = within.minimize(&Beside::those(others), vec![0.0])?.stop;
    let shared = within.minimize(Arc::new(Beside::those(others)), vec![0.0])?.stop;
    assert_eq!(borrowed, shared);
    Ok(borrowed)
}

#[test]
fn what_any_of_those_who_run_together_says_ends_all() -> Outcome {
    assert!(!end(Others::Nothing)?.is_interrupted());
    // before the iteration, before its first trial
    for at in [0, 1] {
        assert_eq!(end(Others::Cancelled(at))?, Stop::Cancelled);
    }
    for at in [0, 1, 2] {
        assert_eq!(end(Others::Lost(at))?, Stop::Aborted(Failed::because("nobody answers")));
    }
    assert_eq!(end(Others::FailFatally)?, Stop::Aborted(Failed::because("too far")));
    Ok(())
}
