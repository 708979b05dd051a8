//! [`Certificate`]: the short gradient check that an optimisation begins with.

use crate::admissible::Admissible;
use crate::objective::{Objective, Request};
use crate::taylor::{Taylor, TaylorError, TaylorReport, Verdict};
use nastic_numeric::Random;
use nastic_numeric::vector::dot;
use std::fmt;

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
const STEP_SHARES: [f64; 4] = [1e-1, 1e-2, 1e-3, 1e-4];
/// Largest mismatch of a correct derivative: an error would show at every step.
const MAX_MISMATCH: f64 = 1e-3;
/// Length of a direction, as a share of the set's extent.
const DIRECTION_SHARE: f64 = 0.1;
/// Relative accuracy asked of state solves.
const STATE_ACCURACY: f64 = 1e-10;

/// An evaluated control with its derivative: what a certificate is about.
#[derive(Debug)]
pub struct Base<'a, P> {
    /// The control.
    pub m: &'a [f64],
    /// Its evaluated point.
    pub point: &'a P,
    /// The derivative there, dual.
    pub derivative: &'a [f64],
    /// Continuation stage of the point's value.
    pub stage: usize,
}

impl Certificate {
    /// Nothing was tried.
    pub fn undecided() -> Self {
        Self { mismatch: f64::NAN, trials: 0, verdict: Verdict::Undecided, full: None }
    }

    /// Compares the derivative at an evaluated control with differences of the cost along one random admissible
    /// direction: at most four evaluations when it is right. If they do not vouch for it, the full [`Taylor`] test
    /// decides. `size` is that of a control where neither the set nor the control gives it.
    ///
    /// # Errors
    /// Nothing says how to vary the control, or the full test could not be made.
    pub fn of<O: Objective>(
        objective: &O,
        set: &dyn Admissible,
        base: &Base<'_, O::Point>,
        workspace: &mut O::Workspace,
        size: Option<f64>,
        seed: u64,
    ) -> Result<Self, TaylorError> {
        let direction = direction(set, base.m, size, seed)?;
        let slope = dot(base.derivative, &direction);
        let cost = objective.value(base.point);
        let how = Request { near: Some(base.point), accuracy: STATE_ACCURACY, stage: base.stage, ..Request::default() };
        let mut certificate = Self { mismatch: f64::INFINITY, trials: 0, verdict: Verdict::Undecided, full: None };
        let mut trial = base.m.to_vec();
        for t in STEP_SHARES {
            set.retract(base.m, &direction, t, &mut trial);
            certificate.trials += 1;
            let evaluated = match objective.evaluate(&trial, &how, workspace) {
                Ok(evaluated) => evaluated,
                Err(failed) if failed.is_fatal() => return Err(failed.into()),
                Err(_) => continue,
            };
            let change = objective.value(&evaluated) - cost;
            let mismatch = (change - t * slope).abs() / (t * slope).abs();
            certificate.mismatch = certificate.mismatch.min(mismatch);
            if mismatch < MAX_MISMATCH {
                certificate.verdict = Verdict::Right;
                return Ok(certificate);
            }
        }
        let taylor = Taylor { directions: 1, seed, size, stage: base.stage, ..Taylor::default() };
        let full = taylor.test(objective, set, base.m)?;
        certificate.verdict = full.verdict();
        certificate.full = Some(full);
        Ok(certificate)
    }
}

impl fmt::Display for Certificate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { mismatch, trials, .. } = self;
        match self.verdict {
            Verdict::Right if self.full.is_none() => {
                write!(f, "right: differences of the cost agree with it to {mismatch:.1e} ({trials} trials)")
            }
            Verdict::Undecided => f.write_str("undecided: the cost hardly changes along a random direction"),
            verdict => verdict.fmt(f),
        }
    }
}

/// Random, admissible, a tenth of the set's extent long in every component.
fn direction(set: &dyn Admissible, m: &[f64], size: Option<f64>, seed: u64) -> Result<Vec<f64>, TaylorError> {
    let fallback = size.unwrap_or_else(|| m.iter().fold(0.0, |most: f64, x| most.max(x.abs())));
    let mut random = Random::new(seed);
    let extent = set.extent(m).into_iter();
    let mut d: Vec<f64> =
        extent.map(|e| DIRECTION_SHARE * if e > 0.0 { e } else { fallback } * random.symmetric()).collect();
    set.inward(m, &mut d);
    if d.iter().any(|d| *d != 0.0) { Ok(d) } else { Err(TaylorError::NoDirection) }
}
