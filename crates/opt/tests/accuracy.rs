//! How exactly states are asked for on the way to an optimum.
#![allow(clippy::unwrap_used)]

use crate::common;

use common::begin;
use nastic_opt::{Bounds, Euclidean, Failed, Lbfgs, Objective, Options, Request};
use std::sync::Mutex;

/// `sum k m_k^2`, which notes the accuracy it is asked for.
struct Asked(Mutex<Vec<f64>>);

impl Objective for Asked {
    type Point = Vec<f64>;
    type Workspace = ();

    fn evaluate(&self, m: &[f64], how: &Request<'_, Vec<f64>>, (): &mut ()) -> Result<Vec<f64>, Failed> {
        self.0.lock().unwrap().push(how.accuracy);
        Ok(m.to_vec())
    }

    fn value(&self, point: &Vec<f64>) -> f64 {
        point.iter().enumerate().map(|(k, m)| (k + 1) as f64 * m * m).sum()
    }

    fn derivative(&self, point: &mut Vec<f64>, (): &mut ()) -> Result<Vec<f64>, Failed> {
        Ok(point.iter().enumerate().map(|(k, m)| 2.0 * (k + 1) as f64 * m).collect())
    }

    fn restage(&self, _: usize, point: &Vec<f64>) -> Result<Vec<f64>, Failed> {
        Ok(point.clone())
    }
}

#[test]
fn states_are_asked_for_the_more_exactly_the_nearer_the_optimum() {
    let asked = Asked(Mutex::default());
    let optimizer = Lbfgs { options: Options { tolerance: 1e-6, ..Options::default() }, ..Lbfgs::default() };
    let set = Bounds::new(-10.0, 10.0).unwrap();
    let metric = Euclidean::new(6);
    begin(&optimizer, &asked, &set, &metric, &[1.0; 6]).unwrap().minimize(&mut ());
    let asked = asked.0.into_inner().unwrap();
    // the start in full, the first trial at the coarsest, the last in full
    assert_eq!((asked[0], asked[1], asked[asked.len() - 1]), (1e-8, 1e-7, 1e-8), "{asked:?}");
    assert!(asked.iter().all(|a| (1e-8..=1e-7).contains(a)), "{asked:?}");
}

#[test]
fn an_accuracy_of_ones_own_is_never_undercut() {
    let own = |accuracy: f64, relative: f64| Options { accuracy, ..Options::default() }.accuracy_at(relative);
    assert_eq!(own(1e-3, 1.0), 1e-3);
    assert_eq!((own(1e-12, 1.0), own(1e-12, 1e-4), own(1e-12, 0.0)), (1e-7, 1e-9, 1e-12));
    assert!(own(f64::NAN, 1.0) == 1e-7 && own(1e-8, f64::NAN) == 1e-7);
}
