//! One run after the other from several starts, of which the best is kept.

use super::recorder::Recorder;
use super::{Begun, FinishedRun, Session, evaluate, minimize};
use crate::run::check_gradient;
use crate::run::error::RunError;
use crate::run::number::{scientific, short};
use nastic_control::EnsembleWorkspace;
use nastic_opt::{Certificate, Failed, Objective, Optimizer, Verdict};
use serde_json::{Value, json};

/// What became of all starts.
pub(super) struct Starts {
    best: FinishedRun,
    /// Number of the best.
    pub index: usize,
    /// An entry for each, for the result.
    pub entries: Vec<Value>,
}

impl Starts {
    /// The run that came down deepest.
    pub fn best(&self) -> &FinishedRun {
        &self.best
    }
}

/// Runs from the start as written, which is evaluated already, then from random ones.
pub(super) fn run(session: &mut Session<'_>, optimizer: &dyn Optimizer, first: Begun) -> Result<Starts, RunError> {
    let block = &session.problem.case.optimizer;
    let (count, seed) = (block.starts, block.seed);
    session.console.say(format!(
        "optimizer   {}, at most {} iterations, until the projected gradient is {} of the first",
        optimizer.name(),
        block.max_iterations,
        short(block.tolerance)
    ));
    let mut history = Recorder::history(session)?;
    announce(session, 0, count, None);
    let recorder = Recorder::new(session, &mut history, (0, count));
    let ended = minimize(session, optimizer, first, recorder)?;
    let entries = vec![entry(None, &ended, None)];
    let mut starts = Starts { best: ended, index: 0, entries };
    for k in 1..count {
        if session.is_cancelled() {
            break;
        }
        // Seeds of neighbouring cases shall not share their starts.
        let seed = seed.wrapping_mul(1_000_003).wrapping_add(k as u64);
        announce(session, k, count, Some(seed));
        let mut begun = match begin(session, seed) {
            Ok(begun) => begun,
            Err(failed) => {
                session.console.say(format!("failed      {failed}"));
                starts.entries.push(json!({ "seed": seed, "failed": failed.to_string() }));
                continue;
            }
        };
        let certificate = check_gradient::check(session, &begun.point, &begun.derivative, &mut begun.workspace)?;
        if certificate.verdict == Verdict::Wrong {
            let check = check_gradient::json(&certificate);
            starts.entries.push(json!({ "seed": seed, "failed": "its gradient is wrong", "gradient_check": check }));
            continue;
        }
        let recorder = Recorder::new(session, &mut history, (k, count));
        let ended = minimize(session, optimizer, begun, recorder)?;
        starts.entries.push(entry(Some(seed), &ended, Some(&certificate)));
        if ended.best.cost < starts.best.best.cost {
            (starts.best, starts.index) = (ended, k);
        }
    }
    Recorder::close(history)?;
    Ok(starts)
}

/// A random start, evaluated.
fn begin(session: &Session<'_>, seed: u64) -> Result<Begun, Failed> {
    let mut workspace = EnsembleWorkspace::default();
    let mut point = evaluate(session, &session.problem.random_start(seed), &mut workspace)?;
    let derivative = session.problem.ensemble.derivative(&mut point, &mut workspace)?;
    Ok(Begun { point, derivative, workspace })
}

fn announce(session: &Session<'_>, index: usize, count: usize, seed: Option<u64>) {
    session.console.say("");
    if count > 1 {
        let from = seed.map_or_else(|| "as written".to_owned(), |seed| format!("random, seed {seed}"));
        session.console.say(format!("start {} of {count}: {from}", index + 1));
    }
}

fn entry(seed: Option<u64>, ended: &FinishedRun, certificate: Option<&Certificate>) -> Value {
    let best = &ended.best;
    let mut out = json!({
        "seed": seed, "start_cost": ended.start.risk, "cost": best.cost, "gradient_norm": best.gradient_norm,
        "iterations": best.counts.iterations, "trials": best.counts.trials, "converged": best.stop.is_converged(),
        "stop": best.stop.to_string(),
    });
    // That of the start as written is the result's own.
    if let Some(certificate) = certificate {
        out["gradient_check"] = check_gradient::json(certificate);
    }
    out
}

/// One line per start.
pub(super) fn say(session: &Session<'_>, starts: &Starts) {
    for (k, entry) in starts.entries.iter().enumerate().filter(|_| starts.entries.len() > 1) {
        let head = if k == 0 { "starts" } else { "" };
        let seed = entry["seed"].as_u64().map_or_else(|| "as written".to_owned(), |seed| format!("seed {seed}"));
        let what = match (entry["cost"].as_f64(), entry["failed"].as_str()) {
            (Some(cost), _) => {
                format!("cost {} after {} iterations", scientific(cost, 6), entry["iterations"])
            }
            (None, why) => format!("failed: {}", why.unwrap_or_default()),
        };
        let mark = if k == starts.index { ", the best" } else { "" };
        session.console.say(format!("{head:<12}{} ({seed}): {what}{mark}", k + 1));
    }
}
