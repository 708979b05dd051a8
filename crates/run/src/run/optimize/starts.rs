//! Several starts, of which the best is kept.

pub(super) mod journal;
pub(super) mod parts;
mod ranks;
pub(super) mod round;
pub(crate) mod start_run;
pub(super) mod table;

use crate::console::Console;
use crate::run::error::RunError;
use crate::run::optimize::minimization::Minimization;
use crate::run::optimize::recorder::write_iterates;
use crate::run::optimize::starts::round::{Round, RoundEnd, ended};
use crate::run::optimize::starts::start_run::{FinishedRun, Phase, PointBytes, StartRun, UnderWay};
use crate::run::optimize::starts::table::{failed_entry, seed};
use crate::run::study::record::same_program;
use crate::run::terminal::say_warning;
use crate::saved::checkpoint::Position;
use nastic_case::lower::CaseProblem;
use nastic_case::warning::Warning;
use nastic_language::number::short;
use nastic_opt::early_stopping;
use nastic_opt::early_stopping::{Outperformed, Standing};
use nastic_opt::{AugmentedBest, Constrained, Failed, Optimizer, Stop};
use nastic_report::record::{GradientCheckRecord, StartRecord};
use std::sync::Mutex;
use std::sync::atomic::AtomicBool;

/// What became of the starts.
#[derive(Default)]
pub(super) struct Starts {
    /// The run that came down deepest, and its number.
    pub best: Option<(usize, FinishedRun)>,
    /// An entry for each that has begun, for the result.
    pub entries: Vec<StartRecord>,
    /// The control at which each ended; empty of one that failed or was stopped early.
    pub optima: Vec<Vec<f64>>,
    /// What deserves attention in the states at the starts; said already.
    pub warnings: Vec<Warning>,
    /// A stop was requested, or the machine had too little memory, before all had ended.
    pub interrupted: bool,
    /// What the machine had too little of.
    pub aborted: Option<String>,
}

/// Rounds of starts.
struct Rounds<'s> {
    shared: Minimization<'s>,
    gradient_check: GradientCheckRecord,
    round: usize,
    starts: Vec<StartRun>,
    best: Option<(usize, FinishedRun)>,
}

impl Starts {
    /// Runs all starts from a position on to their ends; `resumed`: that of a program before this one.
    ///
    /// # Errors
    /// A run cannot begin, `history.jsonl` cannot be written, or a checkpoint is not of this case: what was said stays in `warnings`.
    pub fn run(&mut self, shared: Minimization<'_>, position: Position, resumed: bool) -> Result<(), RunError> {
        let Minimization { input, destination, console, .. } = shared;
        let Position { gradient_check, round, history, best, starts, .. } = position;
        let unfit = |failed: Failed| destination.unfit_checkpoint(input, &failed.to_string());
        let best = best.map(|best| restored_best(&input.problem, best)).transpose().map_err(unfit)?;
        let rounds = Rounds { shared, gradient_check, round, starts, best };
        if resumed {
            rounds.starts.iter().flat_map(StartRun::warnings).for_each(|warning| say_warning(console, warning));
            if input.problem.case_file().is_none() {
                rounds.check_program()?;
            }
        }
        say_optimizer(console, shared.optimizer);
        self.finish(rounds, history, resumed)
    }

    /// All rounds; what they have found.
    fn finish(&mut self, mut rounds: Rounds<'_>, history: Vec<u8>, resumed: bool) -> Result<(), RunError> {
        let opened = rounds.shared.journal.lock().open_history(history);
        let ran = opened.and_then(|()| rounds.run(resumed));
        let begun = rounds.starts.iter().rposition(StartRun::has_ended).map_or(0, |last| last + 1);
        for start in rounds.starts {
            self.warnings.extend(start.warnings().iter().cloned());
            if start.index >= begun {
                continue;
            }
            let (entry, m) = match start.phase {
                Phase::Ended(ended) => (ended.entry, ended.m),
                _ => (not_begun(&rounds.shared.input.problem, start.index), vec![]),
            };
            self.entries.push(entry);
            self.optima.push(m);
        }
        let RoundEnd { best, interrupted, aborted, .. } = ran?;
        (self.best, self.interrupted, self.aborted) = (best, interrupted, aborted.map(|(_, why)| why));
        Ok(())
    }
}

impl Rounds<'_> {
    fn run(&mut self, mut resumed: bool) -> Result<RoundEnd, RunError> {
        loop {
            self.shared.journal.lock().begin_round(Position {
                gradient_check: self.gradient_check.clone(),
                round: self.round,
                best: self.best.as_ref().map(|best| saved_best(&self.shared.input.problem, best)),
                starts: self.starts.iter().map(StartRun::saved).collect(),
                ..Position::default()
            });
            if self.round > 0 && !resumed && self.shared.input.problem.case.output.checkpoint > 0 {
                self.shared.journal.lock().save(&self.shared.input.problem.ensemble);
            }
            let found = Mutex::new(RoundEnd { best: self.best.take(), ..RoundEnd::default() });
            let (shared, limit) = (self.shared, self.limit());
            let round = Round { shared, limit, resumed, halt: AtomicBool::new(false), found };
            let mut found = round.run(&mut self.starts)?;
            if found.interrupted {
                self.end_paused(&mut found)?;
            }
            if found.interrupted || self.starts.iter().all(StartRun::has_ended) {
                return Ok(found);
            }
            self.best = found.best.take();
            self.stop_outperformed()?;
            self.starts.iter_mut().for_each(StartRun::forget_lines);
            (self.round, resumed) = (self.round + 1, false);
        }
    }

    /// Iterations at which this round ends.
    fn limit(&self) -> usize {
        let problem = &self.shared.input.problem;
        let optimizer = &problem.case.optimizer;
        // Costs of runs that violate constraints do not compare.
        let compares = optimizer.early_stopping && optimizer.starts > 1 && problem.ensemble.constraints().is_empty();
        let limit = early_stopping::limit(self.round);
        if compares && limit < self.shared.optimizer.options().max_iterations { limit } else { usize::MAX }
    }

    /// Ends those starts that cannot reach the best one any more.
    fn stop_outperformed(&mut self) -> Result<(), RunError> {
        let last_stage = self.shared.input.problem.stages() - 1;
        let (mut under_way, mut others) = (Vec::new(), Vec::new());
        for start in &self.starts {
            match &start.phase {
                Phase::UnderWay(at) => under_way.push((start.index, Standing::of(&at.run.run.progress, last_stage))),
                Phase::Ended(ended) => others.extend(ended.standing),
                Phase::Waiting | Phase::Evaluated(_) => {}
            }
        }
        let mut stopped = early_stopping::outperformed(&under_way, &others);
        stopped.sort_by_key(|one| one.start);
        stopped.into_iter().try_for_each(|one| self.stop(one))
    }

    fn stop(&mut self, Outperformed { start, standing, best }: Outperformed) -> Result<(), RunError> {
        let Standing { cost, within_reach } = standing;
        let stop = Stop::Outperformed { cost, within_reach, best };
        self.shared.console.say("");
        self.shared.console.say(format!("start {} {stop}", start + 1));
        self.end_here(start, stop).map(drop)
    }

    /// An interruption finds some starts at the end of their round: what they have found counts too.
    fn end_paused(&mut self, found: &mut RoundEnd) -> Result<(), RunError> {
        for index in 0..self.starts.len() {
            if let Some(run) = self.end_here(index, Stop::Cancelled)? {
                found.add(index, run);
            }
        }
        Ok(())
    }

    /// Ends a run under way where it stands.
    fn end_here(&mut self, index: usize, stop: Stop) -> Result<Option<FinishedRun>, RunError> {
        let start = std::mem::replace(&mut self.starts[index], StartRun::waiting(index));
        let Phase::UnderWay(at) = start.phase else {
            self.starts[index] = start;
            return Ok(None);
        };
        let UnderWay { record, trials, run } = *at;
        let start = self.shared.read_record(&record)?;
        let AugmentedBest { best, constraints } = self.shared.resume(&run)?.finish(stop);
        let finished =
            FinishedRun { start, best, constraints, work: trials.work.clone(), limits: trials.limits.clone() };
        let found = trials.changes.warnings(&self.shared.input.problem, index);
        found.iter().for_each(|warning| say_warning(self.shared.console, warning));
        write_iterates(&self.shared, index, &trials);
        self.starts[index] = ended(&self.shared.input.problem, index, &finished, record, trials, found);
        Ok(Some(finished))
    }

    /// Laws and costs, which no record holds, are those of the program before.
    fn check_program(&self) -> Result<(), RunError> {
        for start in &self.starts {
            let Phase::UnderWay(at) = &start.phase else { continue };
            let run = self.shared.resume(&at.run)?;
            let same = same_program(&self.shared.input.problem.ensemble, run.point());
            same.map_err(|what| self.shared.destination.unfit_checkpoint(self.shared.input, &what))?;
        }
        Ok(())
    }
}

/// The best of the starts that have ended, for a checkpoint.
fn saved_best(problem: &CaseProblem, best: &(usize, FinishedRun)) -> (usize, FinishedRun<PointBytes>) {
    (best.0, best.1.saved(&problem.ensemble))
}

/// The same, from a checkpoint.
fn restored_best(
    problem: &CaseProblem,
    best: (usize, FinishedRun<PointBytes>),
) -> Result<(usize, FinishedRun), Failed> {
    Ok((best.0, best.1.restored(&problem.ensemble)?))
}

/// The entry of a start that an interruption found before its first trial.
fn not_begun(problem: &CaseProblem, index: usize) -> StartRecord {
    failed_entry(seed(problem, index), "interrupted before it had begun")
}

fn say_optimizer(console: &Console, optimizer: &dyn Optimizer) {
    let options = optimizer.options();
    let absolute = match options.absolute_tolerance {
        norm if norm > 0.0 => format!(", or {}", short(norm)),
        _ => String::new(),
    };
    console.say(format!(
        "optimizer   {}, at most {} iterations, until the projected gradient is {} of the first{absolute}",
        optimizer.name(),
        options.max_iterations,
        short(options.tolerance)
    ));
}
