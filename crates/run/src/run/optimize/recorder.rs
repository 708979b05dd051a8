//! Trial by trial: the table, `history.jsonl`, snapshots of iterations, `iterates.bin`.

use crate::history;
use crate::history::json_line;
use crate::run::error::RunError;
use crate::run::optimize::branch_changes::Before;
use crate::run::optimize::minimization::Minimization;
use crate::run::optimize::ordered_output::StartOutput;
use crate::run::optimize::starts::journal::SharedJournal;
use crate::run::optimize::starts::start_run::{Phase, RunTrials, StartRecord, StartRun, UnderWay};
use nastic_case::lower::CaseProblem;
use nastic_control::{Evaluated, FigureKind, StateFields};
use nastic_ensemble::EnsemblePoint;
use nastic_fem::SolveOptions;
use nastic_opt::{AugmentedState, Constrained, Objective, Reason, Summary, Trial, TrialTable};
use nastic_report::Iterates;
use nastic_report::Pace;
use nastic_report::record::{Nullable, Number, numbers};
use nastic_result::files::Directory;
use nastic_result::snapshot;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

/// Newton iterations, of the member that takes most, after which a checkpoint is written before its turn. Counted, never timed: what is kept
/// between iterations goes at a checkpoint, so that its place decides on bits.
const NEWTON_BETWEEN_CHECKPOINTS: usize = 200;

/// Called for every trial.
pub(super) struct Recorder<'s> {
    problem: &'s CaseProblem,
    record: &'s StartRecord,
    output: &'s StartOutput,
    cancel: Arc<AtomicBool>,
    out: Option<Directory>,
    journal: SharedJournal,
    /// Which start of how many.
    start: (usize, usize),
    /// The columns, from the first trial on; whether they are explained.
    table: Option<TrialTable>,
    explain: bool,
    trials: RunTrials,
    /// The last accepted point.
    before: Option<Before>,
    /// The start, saved where its members are since they moved.
    moved_start: Option<Vec<u8>>,
    /// Newton iterations of the members up to the last checkpoint, and evaluations since then.
    counted: (Vec<usize>, usize),
    /// Newton iterations of evaluations since the last checkpoint, of the member that takes most: every rank knows these.
    newton_since: usize,
    /// Whether what belongs to the last accepted trial was not found because the run is cancelled.
    broken_off: bool,
    last: Instant,
    pace: Pace,
}

impl<'s> Recorder<'s> {
    /// For the start of this number.
    pub fn new(
        Minimization { input, destination, journal, .. }: &Minimization<'s>,
        index: usize,
        record: &'s StartRecord,
        output: &'s StartOutput,
    ) -> Self {
        let problem = &input.problem;
        Self {
            problem,
            record,
            output,
            cancel: input.cancel.clone(),
            out: destination.own_out.clone(),
            journal: (*journal).clone(),
            start: (index, problem.case.optimizer.starts),
            table: None,
            explain: input.options.explain,
            trials: RunTrials::new(problem.members().count(), problem.leads().count()),
            before: None,
            moved_start: None,
            counted: (vec![0; problem.members().count()], 0),
            newton_since: 0,
            broken_off: false,
            last: Instant::now(),
            pace: Pace::new(problem.case.optimizer.max_iterations),
        }
    }

    /// Takes up what an earlier program reported of the same start, up to this point.
    pub fn restore(&mut self, trials: RunTrials, point: &EnsemblePoint) {
        self.counted.0 = trials.work.iter().map(|work| work.newton).collect();
        self.trials = trials;
        self.goes_on_from(point);
        self.begin_table(&self.problem.ensemble.figures(point));
    }

    /// The last accepted point is this one.
    pub fn goes_on_from(&mut self, point: &EnsemblePoint) {
        self.before = Some(Before::new(point));
    }

    /// Whether a checkpoint is due behind so many iterations: by the schedule, and where iterations are expensive earlier.
    pub fn is_checkpoint_due(&self, iterations: usize) -> bool {
        let every = self.problem.case.output.checkpoint;
        every > 0 && (iterations.is_multiple_of(every) || self.newton_since >= NEWTON_BETWEEN_CHECKPOINTS)
    }

    /// Shares the members out anew by what they took since the last checkpoint; the start as it is then, if any member moves. `kept`: the points that are
    /// to be loaded again.
    pub fn moved_members(
        &mut self,
        shared: &Minimization<'_>,
        kept: &[&EnsemblePoint],
    ) -> Option<Result<EnsemblePoint, RunError>> {
        self.newton_since = 0;
        let now: Vec<usize> = self.trials.work.iter().map(|work| work.newton).collect();
        let since: Vec<usize> = now.iter().zip(&self.counted.0).map(|(now, before)| now - before).collect();
        let (_, solves) = std::mem::replace(&mut self.counted, (now, 0));
        let moves = since.iter().any(|work| *work > 0) && self.problem.ensemble.share_anew(&since, kept, solves);
        moves.then(|| {
            let start = shared.read_record(self.record)?;
            self.moved_start = Some(self.problem.ensemble.save(&start));
            Ok(start)
        })
    }

    /// Says the names of the columns, which follow from what is known of a point.
    fn begin_table(&mut self, figures: &Summary) -> TrialTable {
        let table = TrialTable::new(self.problem.stages(), figures)
            .with_violation(!self.problem.ensemble.constraints().is_empty());
        if self.explain {
            table.explain().into_iter().for_each(|line| self.output.console.say(line));
            self.output.console.say("");
        }
        self.output.console.say(table.header());
        *self.table.insert(table)
    }

    /// Writes a scheduled checkpoint, unless something that belongs into it was broken off.
    pub fn save(&mut self, run: &AugmentedState) {
        if self.broken_off || self.problem.ensemble.broken().is_some() {
            return;
        }
        let start = self.moved_start.as_ref().unwrap_or(&self.record.start).clone();
        let StartRecord { warnings, m, certificate, .. } = self.record.clone();
        let record = StartRecord { warnings, m, start, certificate };
        let at = UnderWay { record, trials: self.trials.clone(), run: run.clone() };
        let start = StartRun { index: self.start.0, phase: Phase::UnderWay(Box::new(at)) };
        self.journal.lock().save_start(start, &self.problem.ensemble);
    }

    pub fn record(&mut self, trial: &Trial<'_, EnsemblePoint>) {
        if trial.cost.is_none() && self.cancel.load(Ordering::Relaxed) {
            // Broken off, not failed: a run that goes on makes this trial again.
            return;
        }
        let point = trial.point.filter(|_| trial.accepted);
        let figures = point.map_or_else(Summary::default, |point| self.problem.ensemble.figures(point));
        let seconds = self.last.elapsed().as_secs_f64();
        self.last = Instant::now();
        if let Some(point) = trial.point.filter(|_| !trial.reason.is_revaluation()) {
            let own = point.work();
            self.newton_since += own.iter().map(|own| own.newton).max().unwrap_or(0);
            self.trials.work.iter_mut().zip(own).for_each(|(work, own)| work.add_work(&own));
            self.counted.1 += 1;
        } else if let (None, Some(newton), Some(first)) =
            (trial.cost, trial.summary.get("newton"), self.trials.work.first_mut())
        {
            first.newton += newton as usize;
        }
        self.trials.limits.add(trial);
        if trial.reason == Reason::Stage {
            let anew = match self.problem.case.optimizer.method.name() {
                "mma" => ", asymptotes begin anew",
                _ => "",
            };
            self.output.console.say(format!("stage {} of {}{anew}", trial.stage + 1, self.problem.stages()));
        }
        let table = self.table.unwrap_or_else(|| self.begin_table(&figures));
        self.output.console.say(table.row(trial, &figures, seconds));
        self.pace.done(trial.trial, trial.iteration, trial.cost.filter(|_| trial.accepted));
        if self.output.is_one_of_several() {
            self.output.show(trial.iteration);
        } else {
            self.output.console.set_pace(Some(self.pace));
        }
        let mut line = history::line(trial, seconds);
        let distance = |kind: FigureKind| {
            kind.history_name().and_then(|name| figures.get(name)).map(Number::from).unwrap_or_default()
        };
        line.hausdorff_true = distance(FigureKind::TrueDistance);
        line.tracking_root_mean_square = distance(FigureKind::RootMeanSquareDistance);
        line.tracking_largest = distance(FigureKind::LargestDistance);
        line.position_distance = distance(FigureKind::PositionDistance);
        if let Some(point) = point {
            line.inertia = self.inertia(point).into();
            let changed = self.changes_branch(point, trial);
            line.branch_changed = if changed == Some(false) { Nullable::default() } else { changed.into() };
        }
        line.scenarios = trial.point.filter(|_| self.problem.has_scenarios()).map(|point| numbers(&point.costs));
        line.start = (self.start.1 > 1).then_some(self.start.0);
        self.trials.lines.extend(json_line(&line));
        self.output.add_line(line);
        let kept = self.out.is_some() && trial.accepted && !trial.reason.is_revaluation();
        let every = self.problem.case.output.every;
        let written = kept && every > 0 && trial.iteration.is_multiple_of(every);
        let kept = kept && Iterates::wants(trial.iteration);
        let Some(point) = trial.point.filter(|_| kept || written) else { return };
        let leads = self.problem.leads().count();
        let Ok(Some(leads)) = self.problem.ensemble.first_members(point, leads) else { return };
        if written && let Err(error) = self.write(trial.iteration, &leads, trial.derivative) {
            self.trials.snapshots.retain(|iteration| *iteration != trial.iteration);
            self.journal.lock().note(error);
        }
        if kept {
            self.keep(trial.iteration, &leads);
        }
    }

    /// Whether an accepted point lies on another branch than the one before; `None` where that is not known.
    fn changes_branch(&mut self, point: &EnsemblePoint, trial: &Trial<'_, EnsemblePoint>) -> Option<bool> {
        // The start, which a resumed run reports once more, and the point of a new stage have none before them.
        let fresh = trial.iteration == 0 || trial.reason.is_revaluation();
        if self.problem.is_motion() {
            return Some(false); // a motion from a given state is unique where equilibria are not
        }
        let before = self.before.replace(Before::new(point)).filter(|_| !fresh);
        let Some(before) = before else { return Some(false) };
        let changed = self.trials.changes.add(self.problem, &self.cancel, &before, point, trial.iteration);
        self.last = Instant::now();
        self.broken_off |= changed.is_err();
        changed.ok().flatten()
    }

    /// Negative pivots of the tangent, the most of all members; `None` where those of one were not counted, and in motion.
    fn inertia(&self, point: &EnsemblePoint) -> Option<usize> {
        if self.problem.is_motion() {
            return None;
        }
        let parallel = self.problem.members().nth(1).is_none();
        let how = SolveOptions { parallel, ..SolveOptions::default() };
        let of =
            |index: usize, at: &Evaluated| self.problem.member(index).solid().negative_pivots_by(at.state(), &how).ok();
        let all = self.problem.ensemble.gathered(point, of).ok()?;
        all.into_iter().collect::<Option<Vec<usize>>>()?.into_iter().max()
    }

    /// Keeps shape and controls of an accepted iteration, load case by load case.
    fn keep(&mut self, iteration: usize, leads: &[Evaluated]) {
        for ((member, at), kept) in self.problem.leads().zip(leads).zip(&mut self.trials.iterates) {
            match snapshot::iterate(member, &StateFields::of(at)) {
                Ok(shot) => kept.add(iteration, &shot, &snapshot::material_vectors(member)),
                Err(error) => self.journal.lock().note(error.into()),
            }
        }
    }

    /// The states of the first scenario, load case by load case.
    fn write(&mut self, iteration: usize, leads: &[Evaluated], derivative: Option<&[f64]>) -> Result<(), RunError> {
        let Some(out) = &self.out else { return Ok(()) };
        let stem = stem(self.problem, self.start.0);
        let file = |iteration: usize| format!("{stem}iteration_{iteration:04}.vtu");
        let gradient =
            derivative.zip(self.problem.inner_product()).map(|(derivative, product)| product.riesz(derivative));
        self.trials.snapshots.push(iteration);
        for (member, at) in self.problem.leads().zip(leads) {
            let gradient = gradient.as_ref().map(|gradient| member.local(gradient));
            let fields = StateFields { adjoint: at.adjoint(), gradient: gradient.as_deref(), ..StateFields::of(at) };
            out.write_vtu(&member.case_file(&file(iteration)), &snapshot::plain(member, &fields)?)?;
            // and those of an earlier program that had gone further
            let later = (1..).map(|k| iteration + k * self.problem.case.output.every);
            let later = later.take_while(|step| out.file(&member.case_file(&file(*step))).exists());
            let all = self.trials.snapshots.iter().copied().chain(later);
            let steps: Vec<(f64, String)> = all.map(|step| (step as f64, member.case_file(&file(step)))).collect();
            nastic_io::write_pvd(out.own(&member.case_file(&format!("{stem}iterations.pvd")))?, &steps)?;
        }
        Ok(())
    }

    /// What was kept of all trials.
    pub fn finish(self) -> RunTrials {
        self.output.console.set_pace(None);
        self.trials
    }
}

/// What the names of the files of one start begin with, behind the load case.
fn stem(problem: &CaseProblem, index: usize) -> String {
    if problem.case.optimizer.starts > 1 { format!("start_{index}_") } else { String::new() }
}

/// Writes `iterates.bin` of a start that has ended.
pub(super) fn write_iterates(shared: &Minimization<'_>, index: usize, trials: &RunTrials) {
    let (Some(out), input) = (&shared.destination.own_out, shared.input) else { return };
    if !input.writes_start(index) {
        return;
    }
    for (member, kept) in input.problem.leads().zip(&trials.iterates) {
        let name = member.case_file(&format!("{}iterates.bin", stem(&input.problem, index)));
        shared.journal.lock().keep_iterates(out, name, kept.to_bytes(), input.is_cancelled());
    }
}
