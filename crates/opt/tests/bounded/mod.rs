//! Published problems with simple bounds: minimise f(x) for lower <= x <= upper.
//!
//! * `HS k`: W. Hock and K. Schittkowski, Test Examples for Nonlinear Programming Codes, Springer 1981.
//! * `MGH k`: J. J. Moré, B. S. Garbow and K. E. Hillstrom, Testing unconstrained optimization software, ACM TOMS 7 (1981) 17-41, with the bounds of
//!   D. M. Gay, A trust-region approach to linearly constrained optimization, in: Numerical Analysis, Lecture Notes in Mathematics 1066,
//!   Springer 1984, 72-105; bounds and least values as in TOMLAB's `mgh_prob` and in A. Neumaier's list of bounded problems. f is the sum of squares r . r.
//!
//! Starts outside the bounds (`HS 2`, `HS 45`, `MGH 19`, `MGH 27`, `MGH 35`) are projected onto them. `scipy.json` holds what SciPy's L-BFGS-B takes
//! (`scripts/scipy-bounded.py`).
#![allow(dead_code, clippy::unwrap_used, clippy::expect_used)]

mod data_fitting;
mod hock_schittkowski;
mod more_garbow_hillstrom;
mod scipy;

pub use scipy::{Reached, Scipy};

use nastic_opt::{Admissible, Bounds, Euclidean, Failed, Hessian, InnerProduct, Objective, Problem, Request};
use std::sync::Arc;

/// A cost and its derivative.
pub type Cost = fn(&[f64]) -> (f64, Vec<f64>);

#[derive(Clone, Debug)]
pub struct Bounded {
    pub name: &'static str,
    pub cost: Cost,
    pub start: Vec<f64>,
    pub set: Bounds,
    /// The least value published.
    pub least: f64,
    /// Values at other local minima and stationary points at which drivers may end.
    pub others: &'static [f64],
}

impl Bounded {
    fn new(name: &'static str, cost: Cost, start: &[f64], lower: &[f64], upper: &[f64], least: f64) -> Self {
        let set = Bounds::new(lower.to_vec(), upper.to_vec()).unwrap();
        let mut start = start.to_vec();
        set.project(&mut start);
        Self { name, cost, start, set, least, others: &[] }
    }

    fn with_others(mut self, others: &'static [f64]) -> Self {
        self.others = others;
        self
    }

    pub fn value(&self, x: &[f64]) -> f64 {
        (self.cost)(x).0
    }
}

/// All thirty.
pub fn problems() -> Vec<Bounded> {
    let mut all = hock_schittkowski::problems();
    all.extend(more_garbow_hillstrom::problems());
    all.extend(data_fitting::problems());
    all
}

/// A point with cost and derivative.
#[derive(Clone, Debug)]
pub struct Evaluated {
    m: Vec<f64>,
    value: f64,
    derivative: Vec<f64>,
}

/// Evaluations outside the bounds panic; a cost that is not finite has failed.
impl Objective for Bounded {
    type Point = Evaluated;
    type Workspace = ();

    fn evaluate(&self, m: &[f64], _: &Request<'_, Self::Point>, (): &mut ()) -> Result<Self::Point, Failed> {
        self.set.check(m).expect("nothing is evaluated outside the set");
        let (value, derivative) = (self.cost)(m);
        if !value.is_finite() {
            return Err(Failed::because("the cost is not finite"));
        }
        Ok(Evaluated { m: m.to_vec(), value, derivative })
    }

    fn value(&self, point: &Self::Point) -> f64 {
        point.value
    }

    fn derivative(&self, point: &mut Self::Point, (): &mut ()) -> Result<Vec<f64>, Failed> {
        Ok(point.derivative.clone())
    }

    /// (d(x + h v) - d(x - h v))/2h, of the cost's own formula, which goes on beyond the bounds.
    fn hessian_vector(&self, point: &Self::Point, v: &[f64], _: Hessian, (): &mut ()) -> Result<Vec<f64>, Failed> {
        let size = |v: &[f64]| v.iter().fold(0f64, |most, x| most.max(x.abs()));
        let h = 6e-6 * (1.0 + size(&point.m)) / size(v).max(f64::MIN_POSITIVE);
        let at = |h: f64| (self.cost)(&point.m.iter().zip(v).map(|(x, v)| x + h * v).collect::<Vec<_>>()).1;
        Ok(at(h).iter().zip(at(-h)).map(|(a, b)| (a - b) / (2.0 * h)).collect())
    }

    fn restage(&self, _: usize, point: &Self::Point) -> Result<Self::Point, Failed> {
        Ok(point.clone())
    }
}

impl Problem for Bounded {
    fn inner_product(&self) -> Result<Arc<dyn InnerProduct>, Failed> {
        Ok(Arc::new(Euclidean::new(self.start.len())))
    }
}

/// r . r and 2 J^T r, from the residuals and the rows of J.
fn squares<const N: usize>(rows: impl IntoIterator<Item = (f64, [f64; N])>) -> (f64, Vec<f64>) {
    let (mut cost, mut derivative) = (0.0, vec![0.0; N]);
    for (r, row) in rows {
        cost += r * r;
        derivative.iter_mut().zip(row).for_each(|(d, j)| *d += 2.0 * r * j);
    }
    (cost, derivative)
}

/// The first N components.
fn point<const N: usize>(x: &[f64]) -> [f64; N] {
    std::array::from_fn(|i| x[i])
}
