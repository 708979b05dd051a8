//! The short gradient check that an optimisation begins with.

use nastic_numeric::Random;
use nastic_opt::{Admissible, Objective, Request, Taylor, TaylorError, TaylorReport, Verdict};

/// What a short check found.
#[derive(Clone, PartialEq, Debug)]
pub struct Certificate {
    /// Relative mismatch `|j(m(t)) - j(m) - t dj.d| / |t dj.d|` at its best step.
    pub mismatch: f64,
    /// Steps tried.
    pub trials: usize,
    /// The verdict.
    pub verdict: Verdict,
    /// The full Taylor test, where the short one could not vouch.
    pub full: Option<TaylorReport>,
}

/// Steps of the short check, as shares of a direction a tenth of the set's extent long.
const STEPS: [f64; 4] = [1e-1, 1e-2, 1e-3, 1e-4];
/// A mismatch below this vouches for the derivative: its error would show at every step.
const ENOUGH: f64 = 1e-3;
/// Share of the set's extent.
const LENGTH: f64 = 0.1;

/// Compares the derivative at an evaluated control with differences of the cost along one random admissible direction:
/// at most four evaluations when it is right. If they do not vouch for it, the full [`Taylor`] test decides.
///
/// # Errors
/// Nothing tells how to vary the control, or the full test could not be made.
pub fn certify<O: Objective>(
    objective: &O,
    set: &dyn Admissible,
    base: (&[f64], &O::Point, &[f64]),
    size: Option<f64>,
    seed: u64,
) -> Result<Certificate, TaylorError> {
    let (m, point, derivative) = base;
    let direction = direction(set, m, size, seed)?;
    let slope: f64 = derivative.iter().zip(&direction).map(|(a, b)| a * b).sum();
    let cost = objective.value(point);
    let how = Request { near: Some(point), accuracy: 1e-10, stage: 0 };
    let mut certificate = Certificate { mismatch: f64::INFINITY, trials: 0, verdict: Verdict::Undecided, full: None };
    let mut trial = m.to_vec();
    for t in STEPS {
        set.retract(m, &direction, t, &mut trial);
        certificate.trials += 1;
        let Ok(evaluated) = objective.evaluate(&trial, &how) else { continue };
        let change = objective.value(&evaluated) - cost;
        let mismatch = (change - t * slope).abs() / (t * slope).abs();
        certificate.mismatch = certificate.mismatch.min(mismatch);
        if mismatch < ENOUGH {
            certificate.verdict = Verdict::Right;
            return Ok(certificate);
        }
    }
    let taylor = Taylor { directions: 1, seed, size, ..Taylor::default() };
    let full = taylor.test(objective, set, m)?;
    certificate.verdict = full.verdict();
    certificate.full = Some(full);
    Ok(certificate)
}

/// Random, admissible, a tenth of the set's extent long in every component.
fn direction(set: &dyn Admissible, m: &[f64], size: Option<f64>, seed: u64) -> Result<Vec<f64>, TaylorError> {
    let fallback = size.unwrap_or_else(|| m.iter().fold(0.0, |most: f64, x| most.max(x.abs())));
    let mut random = Random::new(seed);
    let extent = set.extent(m).into_iter();
    let mut d: Vec<f64> = extent.map(|e| LENGTH * if e > 0.0 { e } else { fallback } * random.symmetric()).collect();
    set.inward(m, &mut d);
    if d.iter().any(|d| *d != 0.0) { Ok(d) } else { Err(TaylorError::NoDirection) }
}
