//! One run after the other from several starts, of which the best is kept.

use super::branch_changes::BranchChanges;
use super::checkpoint::{Fixed, Position, read_json};
use super::finished_run::{FinishedRun, read_start, write_start};
use super::journal::Journal;
use super::recorder::Recorder;
use super::{Begun, Session, begin_run, evaluate, minimize, resume_run};
use crate::lower::Admitted;
use crate::run::check_gradient;
use crate::run::error::RunError;
use crate::run::number::{scientific, short};
use crate::warning::Warning;
use nastic_control::{Ensemble, EnsemblePoint, EnsembleWorkspace};
use nastic_fem::{Demand, Instant};
use nastic_opt::bytes::{Reader, Writer};
use nastic_opt::{Failed, Objective, Optimizer, SavedRunError, Stop, TaylorError, Verdict};
use serde_json::{Value, json};

const MAGIC: &str = "nastic-starts-3";

/// What became of the starts so far.
#[derive(Default)]
pub(super) struct Starts {
    /// The run that came down deepest, and its number.
    pub best: Option<(usize, FinishedRun)>,
    /// An entry for each, for the result.
    pub entries: Vec<Value>,
    /// The control at which each ended; empty of one that failed.
    pub optima: Vec<Vec<f64>>,
    /// What deserves attention in the states at the starts, those of the present one included; said already.
    pub warnings: Vec<Warning>,
    /// A stop was requested, or the machine had too little memory, before all had ended.
    pub interrupted: bool,
    /// What the machine had too little of.
    pub aborted: Option<String>,
}

impl Starts {
    /// Runs from the start as written, which is evaluated already, then from random ones.
    ///
    /// # Errors
    /// As [`Self::resume`]: what was said stays in `warnings`.
    pub fn run(
        &mut self,
        session: &Session<'_>,
        optimizer: &dyn Optimizer,
        mut first: Begun,
        gradient_check: Value,
        journal: &mut Journal,
    ) -> Result<(), RunError> {
        self.warnings.append(&mut first.warnings);
        say_optimizer(session, optimizer);
        journal.open_history(vec![])?;
        announce(session, 0, None);
        self.run_from(session, optimizer, (0, first), (&gradient_check, Value::Null), journal)?;
        self.run_rest(session, optimizer, &gradient_check, journal)
    }

    /// Goes on from a checkpoint.
    ///
    /// # Errors
    /// A run cannot begin, `history.jsonl` cannot be written, or the checkpoint is not of this case.
    pub fn resume(
        &mut self,
        session: &Session<'_>,
        optimizer: &dyn Optimizer,
        position: Position,
        journal: &mut Journal,
    ) -> Result<(), RunError> {
        let ensemble = &session.problem.ensemble;
        let Position { fixed, trials, run } = position;
        let (index, iteration) = (fixed.index, run.run.progress.counts.iterations);
        let unfit = |failed: Failed| session.unfit_checkpoint(&failed.to_string());
        *self = Starts::from_bytes(&fixed.finished, ensemble).map_err(unfit)?;
        self.warnings.iter().for_each(|warning| session.say_warning(warning));
        let start = Reader::new(&fixed.start, "").map_err(Failed::new);
        let start = start.and_then(|mut input| read_start(&mut input, ensemble)).map_err(unfit)?;
        let run = resume_run(session, optimizer, &run)?;
        if session.problem.case_file().is_none() {
            same_program(ensemble, run.point()).map_err(|what| session.unfit_checkpoint(&what))?;
        }

        say_optimizer(session, optimizer);
        announce(session, index, seed(session, index));
        session.console.say(format!("resumed     at iteration {iteration}"));
        journal.open_history(trials.history)?;
        journal.begin_start(&fixed);
        let mut recorder = Recorder::new(session, journal, index);
        recorder.restore(trials.run, run.point());
        let ended = minimize(session, run, start, recorder, Some(iteration));
        self.add(session, index, ended, fixed.certificate);
        self.run_rest(session, optimizer, &fixed.gradient_check, journal)
    }

    /// All random starts that are left.
    fn run_rest(
        &mut self,
        session: &Session<'_>,
        optimizer: &dyn Optimizer,
        gradient_check: &Value,
        journal: &mut Journal,
    ) -> Result<(), RunError> {
        for index in self.entries.len()..session.problem.case.optimizer.starts {
            if session.is_cancelled() {
                self.interrupted = true;
            }
            if self.interrupted {
                break;
            }
            let seed = seed(session, index);
            announce(session, index, seed);
            let checked = begin(session, index, seed.unwrap_or_default()).map(|mut begun| {
                let Begun { point, derivative, workspace, .. } = &mut begun;
                (check_gradient::check(session, point, derivative, workspace), begun)
            });
            let (certificate, begun) = match checked {
                // Broken off, not failed: what the starts before found is kept.
                _ if session.is_cancelled() => {
                    self.interrupted = true;
                    break;
                }
                Ok((Ok(certificate), begun)) => (certificate, begun),
                Ok((Err(RunError::Taylor(TaylorError::Base(failed))), _)) | Err(failed) if failed.is_fatal() => {
                    self.abort(&failed);
                    break;
                }
                Ok((Err(error), begun)) => {
                    self.warnings.extend(begun.warnings);
                    session.console.say(format!("failed      {error}"));
                    self.failed(json!({ "seed": seed, "failed": error.to_string() }));
                    continue;
                }
                Err(failed) => {
                    session.console.say(format!("failed      {failed}"));
                    self.failed(json!({ "seed": seed, "failed": failed.to_string() }));
                    continue;
                }
            };
            let check = check_gradient::json(&certificate);
            if certificate.verdict == Verdict::Wrong {
                self.warnings.extend(begun.warnings);
                self.failed(json!({ "seed": seed, "failed": "its gradient is wrong", "gradient_check": check }));
                continue;
            }
            self.run_from(session, optimizer, (index, begun), (gradient_check, check), journal)?;
        }
        Ok(())
    }

    /// The run from one start.
    fn run_from(
        &mut self,
        session: &Session<'_>,
        optimizer: &dyn Optimizer,
        (index, mut begun): (usize, Begun),
        (gradient_check, certificate): (&Value, Value),
        journal: &mut Journal,
    ) -> Result<(), RunError> {
        let ensemble = &session.problem.ensemble;
        let start = begun.point.clone();
        self.warnings.append(&mut begun.warnings);
        let mut bytes = Writer::new("");
        write_start(&start, ensemble, &mut bytes);
        let fixed = Fixed {
            gradient_check: gradient_check.clone(),
            finished: self.to_bytes(ensemble),
            index,
            certificate,
            start: bytes.finish(),
        };
        journal.begin_start(&fixed);
        let run = begin_run(session, optimizer, begun)?;
        let ended = minimize(session, run, start, Recorder::new(session, journal, index), None);
        self.add(session, index, ended, fixed.certificate);
        Ok(())
    }

    fn add(
        &mut self,
        session: &Session<'_>,
        index: usize,
        (ended, changes): (FinishedRun, BranchChanges),
        certificate: Value,
    ) {
        let found = changes.warnings(session, index);
        found.iter().for_each(|warning| session.say_warning(warning));
        self.warnings.extend(found);
        self.interrupted |= ended.best.stop.is_interrupted();
        if let Stop::Aborted(why) = &ended.best.stop {
            self.abort(why);
        }
        self.entries.push(entry(seed(session, index), &ended, certificate));
        self.optima.push(ended.best.m.clone());
        if self.best.as_ref().is_none_or(|(_, best)| ended.is_better_than(best)) {
            self.best = Some((index, ended));
        }
    }

    fn failed(&mut self, entry: Value) {
        self.entries.push(entry);
        self.optima.push(Vec::new());
    }

    fn abort(&mut self, why: &Failed) {
        self.interrupted = true;
        self.aborted = Some(why.to_string());
    }

    fn to_bytes(&self, ensemble: &Ensemble) -> Vec<u8> {
        let mut out = Writer::new(MAGIC);
        out.count(self.entries.len());
        self.entries.iter().for_each(|entry| out.bytes(entry.to_string().as_bytes()));
        self.optima.iter().for_each(|m| out.floats(m));
        out.count(self.warnings.len());
        self.warnings.iter().for_each(|warning| out.bytes(warning.json().to_string().as_bytes()));
        out.count(usize::from(self.best.is_some()));
        if let Some((index, best)) = &self.best {
            out.count(*index);
            out.bytes(&best.to_bytes(ensemble));
        }
        out.finish()
    }

    fn from_bytes(bytes: &[u8], ensemble: &Ensemble) -> Result<Self, Failed> {
        let mut input = Reader::new(bytes, MAGIC).map_err(Failed::new)?;
        let entries = input.count(8).and_then(|n| (0..n).map(|_| read_json(&mut input)).collect::<Result<Vec<_>, _>>());
        let entries = entries.map_err(Failed::new)?;
        let optima = entries.iter().map(|_| input.floats()).collect::<Result<_, _>>().map_err(Failed::new)?;
        let warnings = input.count(8).and_then(|n| (0..n).map(|_| read_warning(&mut input)).collect());
        let warnings = warnings.map_err(Failed::new)?;
        let best = if input.flag().map_err(Failed::new)? {
            let index = input.number().map_err(Failed::new)?;
            Some((index, FinishedRun::from_bytes(&input.list().map_err(Failed::new)?, ensemble)?))
        } else {
            None
        };
        input.finish().map_err(Failed::new)?;
        Ok(Self { best, entries, optima, warnings, interrupted: false, aborted: None })
    }
}

/// The cost and the potential of a state computed again, relative: rounding is less, another law or cost is more.
const SAME: f64 = 1e-9;

/// Whether laws and costs, which no record holds, give a point of a checkpoint the values that it has there.
fn same_program(ensemble: &Ensemble, point: &EnsemblePoint) -> Result<(), String> {
    let stage = point.members.iter().map(|at| at.stage).max().unwrap_or(0);
    let again = ensemble.restage(stage, point).map_err(|failed| failed.to_string())?;
    // A value that is no number is not the same either.
    let same = (again.risk - point.risk).abs() <= SAME * point.risk.abs();
    if !same {
        let (cost, was) = (scientific(again.risk, 6), scientific(point.risk, 6));
        return Err(format!("its control costs {cost} now and cost {was} before: a cost of the program has changed"));
    }
    for (member, at) in ensemble.members().iter().zip(&point.members) {
        let state = &at.state;
        let place = Instant::new(&state.u, &state.controls, state.load);
        let now = member.problem().solid().model().evaluate(&place, Demand { energy: true, force: false });
        let now = now.map_err(|error| error.to_string())?;
        let same = (now.energy - state.report.energy).abs() <= SAME * now.energy_scale;
        if !same {
            let (now, was) = (scientific(now.energy, 6), scientific(state.report.energy, 6));
            return Err(format!(
                "its state has the potential {now} now and had {was} before: a law or a load of the program has changed"
            ));
        }
    }
    Ok(())
}

fn read_warning(input: &mut Reader<'_>) -> Result<Warning, SavedRunError> {
    Warning::from_json(&read_json(input)?).ok_or_else(|| input.damaged("a warning of no known kind"))
}

/// What warnings call a start: "start", of several "start 2 of 4".
pub(super) fn place(session: &Session<'_>, index: usize) -> String {
    match session.problem.case.optimizer.starts {
        0 | 1 => "start".to_owned(),
        count => format!("start {} of {count}", index + 1),
    }
}

/// The seed of a start; the first is as written.
fn seed(session: &Session<'_>, index: usize) -> Option<u64> {
    // Seeds of neighbouring cases shall not share their starts.
    let of = |index: usize| session.problem.case.optimizer.seed.wrapping_mul(1_000_003).wrapping_add(index as u64);
    (index > 0).then(|| of(index))
}

/// A random start, evaluated and looked into.
fn begin(session: &Session<'_>, index: usize, seed: u64) -> Result<Begun, Failed> {
    let mut workspace = EnsembleWorkspace::default();
    let mut point = evaluate(session, &session.problem.random_start(seed), &mut workspace)?;
    let derivative = session.problem.ensemble.derivative(&mut point, &mut workspace)?;
    let (_, warnings) = session.look_into(&place(session, index), &point);
    Ok(Begun { point, derivative, workspace, warnings })
}

fn say_optimizer(session: &Session<'_>, optimizer: &dyn Optimizer) {
    let options = optimizer.options();
    let absolute = match options.absolute_tolerance {
        norm if norm > 0.0 => format!(", or {}", short(norm)),
        _ => String::new(),
    };
    session.console.say(format!(
        "optimizer   {}, at most {} iterations, until the projected gradient is {} of the first{absolute}",
        optimizer.name(),
        options.max_iterations,
        short(options.tolerance)
    ));
}

fn announce(session: &Session<'_>, index: usize, seed: Option<u64>) {
    let count = session.problem.case.optimizer.starts;
    session.console.say("");
    if count > 1 {
        let from = seed.map_or_else(|| "as written".to_owned(), |seed| format!("random, seed {seed}"));
        session.console.say(format!("start {} of {count}: {from}", index + 1));
    }
}

fn entry(seed: Option<u64>, ended: &FinishedRun, certificate: Value) -> Value {
    let best = &ended.best;
    let mut out = json!({
        "seed": seed, "start_cost": ended.start.risk, "cost": best.cost, "gradient_norm": best.gradient_norm,
        "iterations": best.counts.iterations, "trials": best.counts.trials, "converged": best.stop.is_converged(),
        "stop": best.stop.to_string(),
    });
    if !ended.constraints.groups.is_empty() {
        out["violation"] = json!(ended.constraints.violation);
    }
    // That of the start as written is the result's own.
    if seed.is_some() {
        out["gradient_check"] = certificate;
    }
    out
}

/// One line per start.
pub(super) fn say(session: &Session<'_>, entries: &[Value], best: usize) {
    let directions = session.problem.controls.iter().any(|field| matches!(field.admitted, Admitted::Norm(_)));
    if entries.len() == 1 && session.problem.case.optimizer.starts == 1 && directions {
        let hint = "one; vectors of given length often have several minima: --set optimizer/starts=4 tries three more";
        session.console.say(format!("starts      {hint}"));
    }
    for (k, entry) in entries.iter().enumerate().filter(|_| entries.len() > 1) {
        let head = if k == 0 { "starts" } else { "" };
        let seed = entry["seed"].as_u64().map_or_else(|| "as written".to_owned(), |seed| format!("seed {seed}"));
        let what = match (entry["cost"].as_f64(), entry["failed"].as_str()) {
            (Some(cost), _) => {
                format!("cost {} after {} iterations", scientific(cost, 6), entry["iterations"])
            }
            (None, why) => format!("failed: {}", why.unwrap_or_default()),
        };
        let mark = match (entry["minimum"].as_u64(), k == best) {
            (_, true) => ", the best".to_owned(),
            (Some(0), _) => ", the same minimum".to_owned(),
            (Some(minimum), _) => {
                let percent = 100.0 * entry["distance"].as_f64().unwrap_or(f64::NAN);
                format!(", minimum {}, its control {percent:.0} % away", minimum + 1)
            }
            (None, _) => String::new(),
        };
        session.console.say(format!("{head:<12}{} ({seed}): {what}{mark}", k + 1));
    }
}
