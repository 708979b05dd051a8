//! [`Round`]: starts side by side, to a limit of iterations.

use crate::run::check_gradient;
use crate::run::error::RunError;
use crate::run::optimize::branch_changes::place;
use crate::run::optimize::minimization::{Minimization, Minimized};
use crate::run::optimize::ordered_output::{OrderedOutput, StartOutput};
use crate::run::optimize::recorder::{Recorder, write_iterates};
use crate::run::optimize::starts::ranks::share;
use crate::run::optimize::starts::saved_best;
use crate::run::optimize::starts::start_run::{
    Begun, Ended, FinishedRun, Phase, RunTrials, StartRecord, StartRun, UnderWay,
};
use crate::run::optimize::starts::table::{entry, failed_entry, seed};
use crate::run::terminal::say_warning;
use nastic_case::lower::CaseProblem;
use nastic_ensemble::EnsembleWorkspace;
use nastic_fem::{Solver, available_memory};
use nastic_opt::early_stopping::Standing;
use nastic_opt::{DEFAULT_ACCURACY, Failed, Objective, Stop, TaylorError, Verdict};
use nastic_report::record::{GradientCheckRecord, StartRecord as StartEntry};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

/// Runs every start that has not ended until it ends or has done so many iterations, several at once.
pub(super) struct Round<'s> {
    pub shared: Minimization<'s>,
    /// Iterations at which starts pause.
    pub limit: usize,
    /// Whether the runs come from a checkpoint on disk.
    pub resumed: bool,
    /// Stops all starts.
    pub halt: AtomicBool,
    pub found: Mutex<RoundEnd>,
}

/// What the starts of a round have found together with those before.
#[derive(Default)]
pub(super) struct RoundEnd {
    /// The run that came down deepest, and its number.
    pub best: Option<(usize, FinishedRun)>,
    /// A stop was requested, or the machine had too little memory, before all had ended.
    pub interrupted: bool,
    /// What the machine had too little of: the start and the reason.
    pub aborted: Option<(usize, String)>,
    /// Why a start could not begin or go on.
    pub error: Option<(usize, RunError)>,
}

impl RoundEnd {
    /// Keeps the better one; of equal ones the first.
    pub fn add(&mut self, index: usize, run: FinishedRun) -> bool {
        let better = self
            .best
            .as_ref()
            .is_none_or(|(other, best)| run.is_better_than(best) || !best.is_better_than(&run) && index < *other);
        if better {
            self.best = Some((index, run));
        }
        better
    }

    fn abort(&mut self, index: usize, why: &Failed) {
        self.interrupted = true;
        if self.aborted.as_ref().is_none_or(|(other, _)| index < *other) {
            self.aborted = Some((index, why.to_string()));
        }
    }
}

impl Round<'_> {
    /// The starts behind the round, in their order, and what was found.
    ///
    /// # Errors
    /// A run cannot begin or go on; the starts are given back all the same.
    pub fn run(self, starts: &mut Vec<StartRun>) -> Result<RoundEnd, RunError> {
        // Those that ended in this round before an interruption have lines to report.
        let active = starts.iter().filter(|start| self.shared.input.has_start(start.index));
        let active = active.filter(|start| !start.has_ended() || !start.lines().is_empty());
        let under_way = active.clone().filter(|start| !start.has_ended()).count();
        let active: Vec<usize> = active.map(|start| start.index).collect();
        let threads = rayon::current_num_threads();
        let at_once = under_way.min(threads).min(self.most_at_once()).max(1);
        let Minimization { input, console, journal, .. } = self.shared;
        let output = OrderedOutput::new(console, &input.options.on_trial, journal, &active, at_once);
        let places: Vec<Mutex<Option<StartRun>>> =
            std::mem::take(starts).into_iter().map(|start| Mutex::new(Some(start))).collect();
        let next = AtomicUsize::new(0);
        let work = || {
            while let Some((part, index)) = {
                let part = next.fetch_add(1, Ordering::Relaxed);
                active.get(part).map(|index| (part, *index))
            } {
                let output = output.part(part);
                let mut place = places[index].lock().unwrap_or_else(PoisonError::into_inner);
                *place = place.take().map(|start| self.advance(start, &output));
                output.end();
            }
        };
        console.show_solves(at_once == 1);
        let mut ran = Ok(());
        if at_once > 1 {
            ran = side_by_side(threads, at_once, &work);
        } else {
            work();
        }
        console.show_solves(true);
        starts
            .extend(places.into_iter().filter_map(|place| place.into_inner().unwrap_or_else(PoisonError::into_inner)));
        ran?;
        let mut found = self.found.into_inner().unwrap_or_else(PoisonError::into_inner);
        match found.error.take() {
            Some((_, error)) => Err(error),
            None => share(&self.shared, starts, &mut found).map(|()| found),
        }
    }

    /// How many runs the memory at hand can hold, if each makes the factors of its members at once; how many there are changes no result.
    fn most_at_once(&self) -> usize {
        let problem = &self.shared.input.problem;
        if problem.solid().model().solver() == Solver::MULTIGRID {
            return usize::MAX;
        }
        let each = problem.members().count() * problem.solid().model().tangent_structure().factorisation_bytes();
        match available_memory() {
            Ok(Some(available)) if each > 0 => available / each,
            // What cannot be asked is reported where a factor is made.
            _ => usize::MAX,
        }
    }

    /// One start, until it ends or pauses.
    fn advance(&self, start: StartRun, output: &StartOutput) -> StartRun {
        let index = start.index;
        output.add_recorded(start.lines());
        if start.has_ended() {
            return start;
        }
        if self.is_stopped() {
            // The result has what was kept of a run; a checkpoint has this one as it is.
            self.with_found(|found| found.interrupted = true);
            return match start.phase {
                Phase::UnderWay(_) => self.go_on(start, output),
                _ => start,
            };
        }
        self.announce(index, output);
        match start.phase {
            Phase::UnderWay(_) => self.go_on(start, output),
            Phase::Evaluated(begun) => self.begin(index, *begun, GradientCheckRecord::default(), output),
            Phase::Waiting => match self.evaluate(index, output) {
                Evaluation::Right(begun, certificate) => self.begin(index, *begun, certificate, output),
                Evaluation::Failed(warnings, entry) => self.end(failed(index, warnings, *entry), None),
                Evaluation::BrokenOff => StartRun::waiting(index),
            },
            Phase::Ended(_) => start,
        }
    }

    fn is_stopped(&self) -> bool {
        self.halt.load(Ordering::Relaxed) || self.shared.input.is_cancelled()
    }

    fn with_found<T>(&self, change: impl FnOnce(&mut RoundEnd) -> T) -> T {
        change(&mut self.found.lock().unwrap_or_else(PoisonError::into_inner))
    }

    fn announce(&self, index: usize, output: &StartOutput) {
        let count = self.shared.input.problem.case.optimizer.starts;
        output.console.say("");
        if count > 1 {
            let from = seed(&self.shared.input.problem, index)
                .map_or_else(|| "as written".to_owned(), |seed| format!("random, seed {seed}"));
            output.console.say(format!("start {} of {count}: {from}", index + 1));
        }
    }

    /// Evaluates a start, looks into it and, where it is a random one, checks its gradient.
    fn evaluate(&self, index: usize, output: &StartOutput) -> Evaluation {
        let (shared, seed) = (&self.shared, seed(&self.shared.input.problem, index));
        let evaluated = evaluated_start(shared, index, output).map(|mut begun| {
            let Begun { point, derivative, workspace, .. } = &mut begun;
            // That of the start as written was checked before all runs.
            let mut check = || check_gradient::check(shared.input, &output.console, point, derivative, workspace);
            let checked = seed.map(|_| check()).transpose();
            (checked, begun)
        });
        let refused = |why: &dyn std::fmt::Display| {
            output.console.say(format!("failed      {why}"));
            failed_entry(seed, why.to_string())
        };
        match evaluated {
            // Broken off, not failed: what other starts found is kept.
            _ if self.is_stopped() => {
                self.with_found(|found| found.interrupted = true);
                Evaluation::BrokenOff
            }
            Ok((Err(RunError::Taylor(TaylorError::Base(why))), _)) | Err(why) if why.is_fatal() => {
                self.with_found(|found| found.abort(index, &why));
                self.halt.store(true, Ordering::Relaxed);
                Evaluation::BrokenOff
            }
            Ok((Err(error), begun)) => Evaluation::Failed(begun.warnings, Box::new(refused(&error))),
            Err(why) => Evaluation::Failed(vec![], Box::new(refused(&why))),
            Ok((Ok(None), begun)) => Evaluation::Right(Box::new(begun), GradientCheckRecord::default()),
            Ok((Ok(Some(certificate)), begun)) => {
                let check = check_gradient::record(&certificate);
                if certificate.verdict == Verdict::Wrong {
                    let gradient_check = Some(check);
                    let entry = StartEntry { gradient_check, ..failed_entry(seed, "its gradient is wrong") };
                    return Evaluation::Failed(begun.warnings, Box::new(entry));
                }
                Evaluation::Right(Box::new(begun), check)
            }
        }
    }

    /// A run from an evaluated start.
    fn begin(
        &self,
        index: usize,
        mut begun: Begun,
        certificate: GradientCheckRecord,
        output: &StartOutput,
    ) -> StartRun {
        let start = begun.point.clone();
        let warnings = std::mem::take(&mut begun.warnings);
        let saved = self.shared.input.problem.ensemble.save(&start);
        let record = StartRecord { warnings, m: start.m.clone(), start: saved, certificate };
        match self.shared.begin(begun) {
            Ok(run) => {
                let recorder = Recorder::new(&self.shared, index, &record, output);
                let (limit, halt) = (self.limit, &self.halt);
                let ended = self.shared.run(run, start, recorder, None, (limit, halt));
                self.settle(index, record, ended, output)
            }
            Err(error) => self.give_up(index, record.warnings, error),
        }
    }

    /// A run goes on from a checkpoint.
    fn go_on(&self, start: StartRun, output: &StartOutput) -> StartRun {
        let (index, iteration) = (start.index, start.iteration());
        let Phase::UnderWay(at) = start.phase else { return start };
        let UnderWay { record, trials, run } = *at;
        let begun = self.shared.read_record(&record).and_then(|start| Ok((self.shared.resume(&run)?, start)));
        let (run, start) = match begun {
            Ok(begun) => begun,
            Err(error) => return self.give_up(index, record.warnings, error),
        };
        let how = if self.resumed { "resumed" } else { "goes on" };
        output.console.say(format!("{how:<12}at iteration {iteration}"));
        let mut recorder = Recorder::new(&self.shared, index, &record, output);
        recorder.restore(trials, run.point());
        let (limit, halt) = (self.limit, &self.halt);
        let ended = self.shared.run(run, start, recorder, Some(iteration), (limit, halt));
        self.settle(index, record, ended, output)
    }

    /// Keeps what became of a run.
    fn settle(&self, index: usize, record: StartRecord, ran: Minimized, output: &StartOutput) -> StartRun {
        match ran {
            Minimized::Paused(run, trials) => {
                let under_way = UnderWay { record, trials, run: *run };
                StartRun { index, phase: Phase::UnderWay(Box::new(under_way)) }
            }
            Minimized::Ended(run, trials) => {
                let found = trials.changes.warnings(&self.shared.input.problem, index);
                found.iter().for_each(|warning| say_warning(&output.console, warning));
                write_iterates(&self.shared, index, &trials);
                let ended = ended(&self.shared.input.problem, index, &run, record, trials, found);
                self.end(ended, Some(*run))
            }
        }
    }

    /// A start has ended: the next checkpoint says so, unless it was broken off.
    fn end(&self, start: StartRun, run: Option<FinishedRun>) -> StartRun {
        let index = start.index;
        let stop = run.as_ref().map(|run| run.best.stop.clone());
        let interrupted = stop.as_ref().is_some_and(Stop::is_interrupted);
        self.with_found(|found| {
            if let Some(Stop::Aborted(why)) = &stop {
                found.abort(index, why);
                self.halt.store(true, Ordering::Relaxed);
            }
            found.interrupted |= interrupted;
            let best = run.is_some_and(|run| found.add(index, run));
            if !interrupted {
                let best =
                    found.best.as_ref().filter(|_| best).map(|best| saved_best(&self.shared.input.problem, best));
                self.shared.journal.lock().end_start(&start, best);
            }
        });
        start
    }

    fn give_up(&self, index: usize, warnings: Vec<nastic_case::warning::Warning>, error: RunError) -> StartRun {
        self.halt.store(true, Ordering::Relaxed);
        let entry = failed_entry(seed(&self.shared.input.problem, index), error.to_string());
        self.with_found(|found| {
            if found.error.as_ref().is_none_or(|(other, _)| index < *other) {
                found.error = Some((index, error));
            }
        });
        failed(index, warnings, entry)
    }
}

/// What became of the evaluation of a start.
enum Evaluation {
    /// It can begin; with the entry of its gradient check.
    Right(Box<Begun>, GradientCheckRecord),
    /// It cannot; with its entry in the result.
    Failed(Vec<nastic_case::warning::Warning>, Box<StartEntry>),
    BrokenOff,
}

/// Calls `work` on so many threads at once, each with its share of the threads at hand for what runs in parallel within.
fn side_by_side(threads: usize, at_once: usize, work: &(dyn Fn() + Sync)) -> Result<(), RunError> {
    let share = |k: usize| threads / at_once + usize::from(k < threads % at_once);
    let pool = |k: usize| rayon::ThreadPoolBuilder::new().num_threads(share(k)).build();
    let pools: Result<Vec<_>, _> = (0..at_once).map(pool).collect();
    let pools = pools.map_err(|error| RunError::Threads(error.to_string()))?;
    std::thread::scope(|scope| pools.iter().for_each(|pool| drop(scope.spawn(|| pool.install(work)))));
    Ok(())
}

/// The start as written, or a random one, evaluated and looked into.
fn evaluated_start(shared: &Minimization<'_>, index: usize, output: &StartOutput) -> Result<Begun, Failed> {
    let (input, console) = (shared.input, shared.console);
    let mut workspace = EnsembleWorkspace::default();
    let m = match seed(&input.problem, index) {
        Some(seed) => input.problem.random_start(seed),
        None => input.problem.start.clone(),
    };
    let mut point = input.evaluate(console, &m, DEFAULT_ACCURACY, &mut workspace)?;
    let derivative = input.problem.ensemble.derivative(&mut point, &mut workspace)?;
    let (_, warnings) = input.look_into(&output.console, &place(&input.problem, index), &point);
    Ok(Begun { point, derivative, workspace, warnings })
}

/// A start that has failed.
pub(super) fn failed(index: usize, warnings: Vec<nastic_case::warning::Warning>, entry: StartEntry) -> StartRun {
    let ended = Ended { entry, m: vec![], standing: None, warnings, lines: vec![] };
    StartRun { index, phase: Phase::Ended(Box::new(ended)) }
}

/// A start that has ended, with what deserves attention in its run.
pub(super) fn ended(
    problem: &CaseProblem,
    index: usize,
    run: &FinishedRun,
    record: StartRecord,
    trials: RunTrials,
    found: Vec<nastic_case::warning::Warning>,
) -> StartRun {
    let StartRecord { mut warnings, certificate, .. } = record;
    warnings.extend(found);
    let best = &run.best;
    let stopped_early = matches!(best.stop, Stop::Outperformed { .. });
    let in_last_stage = best.stage + 1 == problem.stages();
    let ended = Ended {
        entry: entry(seed(problem, index), run, certificate),
        m: if stopped_early { vec![] } else { best.m.clone() },
        standing: (in_last_stage && !stopped_early).then(|| Standing::ended(best.cost)),
        warnings,
        lines: trials.lines,
    };
    StartRun { index, phase: Phase::Ended(Box::new(ended)) }
}
