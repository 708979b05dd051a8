//! [`StartRun`]: one of several starts and what became of it; [`FinishedRun`]: a run from one start.

use crate::run::error::RunError;
use crate::run::optimize::branch_changes::BranchChanges;
use crate::run::optimize::met_limits::MetLimits;
use crate::run::session::{CommandInput, Destination};
use crate::saved::json;
use nastic_case::warning::Warning;
use nastic_ensemble::{Ensemble, EnsemblePoint, EnsembleWorkspace};
use nastic_fem::SolveReport;
use nastic_opt::early_stopping::Standing;
use nastic_opt::{AugmentedLagrangian, AugmentedState, Best, ConstraintsReport, Failed, Objective, Request};
use nastic_report::Iterates;
use nastic_report::record::{GradientCheckRecord, StartRecord as StartEntry};
use serde::{Deserialize, Serialize};
use std::convert::Infallible;

/// One of several starts.
#[derive(Serialize, Deserialize)]
pub(crate) struct StartRun {
    /// Its number.
    pub index: usize,
    pub phase: Phase,
}

/// How far it is.
#[derive(Serialize, Deserialize)]
pub(crate) enum Phase {
    /// To be evaluated.
    Waiting,
    /// At a scheduled checkpoint.
    UnderWay(Box<UnderWay>),
    Ended(Box<Ended>),
    /// Evaluated. A checkpoint holds it as waiting: an evaluation from rest gives the same bits again.
    #[serde(skip)]
    Evaluated(Box<Begun>),
}

/// A run at a scheduled checkpoint.
#[derive(Clone, Serialize, Deserialize)]
pub(crate) struct UnderWay {
    pub record: StartRecord,
    pub trials: RunTrials,
    pub run: AugmentedState,
}

/// What stays the same as long as a run goes on.
#[derive(Clone, Serialize, Deserialize)]
pub(crate) struct StartRecord {
    /// What deserves attention in its states; said already.
    #[serde(with = "crate::saved::warnings")]
    pub warnings: Vec<Warning>,
    /// The control of the start.
    pub m: Vec<f64>,
    /// The start, saved.
    pub start: Vec<u8>,
    /// Its gradient check, where it is a random one.
    #[serde(with = "json")]
    pub certificate: GradientCheckRecord,
}

/// A start that has ended or failed.
#[derive(Clone, Serialize, Deserialize)]
pub(crate) struct Ended {
    /// Its entry in the result.
    #[serde(with = "json")]
    pub entry: StartEntry,
    /// The control at which it ended; empty of one that failed or was stopped early: it has found no minimum.
    pub m: Vec<f64>,
    /// Absent of one that failed.
    pub standing: Option<Standing>,
    #[serde(with = "crate::saved::warnings")]
    pub warnings: Vec<Warning>,
    /// Its lines of `history.jsonl` since the round began.
    pub lines: Vec<u8>,
}

/// An evaluated start.
pub(crate) struct Begun {
    pub point: EnsemblePoint,
    pub derivative: Vec<f64>,
    pub workspace: EnsembleWorkspace,
    /// What deserves attention in its states; said already.
    pub warnings: Vec<Warning>,
}

/// What is kept of the trials of one start.
#[derive(Clone, Serialize, Deserialize)]
pub(crate) struct RunTrials {
    /// Their work, by member.
    pub work: Vec<SolveReport>,
    /// Those that led to another branch of equilibria.
    pub changes: BranchChanges,
    /// Those that met a limit point.
    pub limits: MetLimits,
    /// Iterations of which snapshots were written.
    pub snapshots: Vec<usize>,
    /// Shapes and controls of accepted iterations, load case by load case.
    pub iterates: Vec<Iterates>,
    /// Lines of `history.jsonl` since the round of starts began.
    pub lines: Vec<u8>,
}

/// A run from one start.
#[derive(Clone, Serialize, Deserialize)]
pub(crate) struct FinishedRun<P = EnsemblePoint> {
    /// Where it began.
    pub start: P,
    pub best: Best<P>,
    /// Values and multipliers of the constraints there.
    pub constraints: ConstraintsReport,
    /// Work of all trials, by member.
    pub work: Vec<SolveReport>,
    /// Its trials that met a limit point.
    pub limits: MetLimits,
}

/// A point as the ensemble saves it.
#[derive(Clone, Serialize, Deserialize)]
pub(crate) struct PointBytes {
    /// Its control.
    pub m: Vec<f64>,
    pub bytes: Vec<u8>,
}

impl RunTrials {
    /// None yet.
    pub fn new(members: usize, load_cases: usize) -> Self {
        Self {
            work: vec![SolveReport::default(); members],
            changes: BranchChanges::default(),
            limits: MetLimits::default(),
            snapshots: vec![],
            iterates: vec![Iterates::default(); load_cases],
            lines: vec![],
        }
    }
}

impl StartRun {
    pub fn waiting(index: usize) -> Self {
        Self { index, phase: Phase::Waiting }
    }

    pub fn has_ended(&self) -> bool {
        matches!(self.phase, Phase::Ended(_))
    }

    /// Iterations done by a run under way.
    pub fn iteration(&self) -> usize {
        match &self.phase {
            Phase::UnderWay(at) => at.run.run.progress.counts.iterations,
            _ => 0,
        }
    }

    pub fn warnings(&self) -> &[Warning] {
        match &self.phase {
            Phase::Waiting => &[],
            Phase::Evaluated(begun) => &begun.warnings,
            Phase::UnderWay(at) => &at.record.warnings,
            Phase::Ended(ended) => &ended.warnings,
        }
    }

    /// Its lines of `history.jsonl` since the round began.
    pub fn lines(&self) -> &[u8] {
        match &self.phase {
            Phase::Waiting | Phase::Evaluated(_) => &[],
            Phase::UnderWay(at) => &at.trials.lines,
            Phase::Ended(ended) => &ended.lines,
        }
    }

    /// A new round begins: the lines of the history so far are those of rounds before.
    pub fn forget_lines(&mut self) {
        match &mut self.phase {
            Phase::Waiting | Phase::Evaluated(_) => {}
            Phase::UnderWay(at) => at.trials.lines.clear(),
            Phase::Ended(ended) => ended.lines.clear(),
        }
    }

    /// As checkpoints hold it.
    pub fn saved(&self) -> Self {
        let phase = match &self.phase {
            Phase::Waiting | Phase::Evaluated(_) => Phase::Waiting,
            Phase::UnderWay(at) => Phase::UnderWay(at.clone()),
            Phase::Ended(ended) => Phase::Ended(ended.clone()),
        };
        Self { index: self.index, phase }
    }

    /// The points of a run under way, each as the ensemble saves it: its start, the present one, the best.
    pub fn points(&mut self) -> impl Iterator<Item = &mut Vec<u8>> {
        let at = if let Phase::UnderWay(at) = &mut self.phase { Some(at) } else { None };
        at.into_iter().flat_map(|at| {
            let UnderWay { record, run: AugmentedState { run, .. }, .. } = at.as_mut();
            [&mut record.start, &mut run.current.point].into_iter().chain(run.best.as_mut().map(|best| &mut best.point))
        })
    }
}

impl FinishedRun {
    /// Whether it came down deeper; of runs that do not both meet the constraints, whether it comes closer to that.
    pub fn is_better_than(&self, other: &Self) -> bool {
        // What feasible runs violate is rounding.
        let violation = |run: &Self| match run.constraints.violation {
            violation if violation <= AugmentedLagrangian::default().feasibility => 0.0,
            violation => violation,
        };
        let (own, others) = (violation(self), violation(other));
        own < others || own == others && self.best.cost < other.best.cost
    }

    /// As checkpoints hold it.
    pub fn saved(&self, ensemble: &Ensemble) -> FinishedRun<PointBytes> {
        let save = |point: EnsemblePoint, _| Ok(PointBytes { bytes: ensemble.save(&point), m: point.m });
        let Ok::<_, Infallible>(saved) = self.clone().try_map(save);
        saved
    }
}

impl FinishedRun<PointBytes> {
    /// The run whose points an ensemble has saved.
    pub fn restored(self, ensemble: &Ensemble) -> Result<FinishedRun, Failed> {
        let how = |stage| Request { stage, ..Request::default() };
        self.try_map(|PointBytes { m, bytes }, stage| ensemble.load(&m, &bytes, &how(stage)))
    }
}

impl<P> FinishedRun<P> {
    /// The same with what becomes of its points, each of a continuation stage.
    fn try_map<Q, E>(self, mut of: impl FnMut(P, usize) -> Result<Q, E>) -> Result<FinishedRun<Q>, E> {
        let Self { start, best, constraints, work, limits } = self;
        let (start, stage) = (of(start, 0)?, best.stage);
        Ok(FinishedRun { start, best: best.try_map(|point| of(point, stage))?, constraints, work, limits })
    }
}

impl CommandInput {
    /// A run with all members, at the first rank.
    pub(crate) fn whole_run(
        &self,
        destination: &Destination,
        run: &FinishedRun,
    ) -> Result<Option<FinishedRun>, RunError> {
        let whole = run.clone().try_map(|point, _| self.whole(destination, &point))?;
        Ok(whole.try_map(|point, _| point.ok_or(())).ok())
    }
}
