//! [`StartRun`]: one of several starts and what became of it, as a value and as bytes.

use crate::result::warning_record::{warning_of, warning_record};
use crate::run::optimize::checkpoint::{read_json, write_json};
use crate::run::optimize::parted::{Parted, next};
use crate::run::optimize::run_trials::RunTrials;
use nastic_case::warning::Warning;
use nastic_control::{EnsemblePoint, EnsembleWorkspace};
use nastic_opt::bytes::{Reader, Writer};
use nastic_opt::early_stopping::Standing;
use nastic_opt::{AugmentedState, SavedRunError};
use nastic_report::record::{GradientCheckRecord, StartRecord as StartEntry};

const MAGIC: &str = "nastic-start-5";

/// One of several starts.
pub(super) struct StartRun {
    /// Its number.
    pub index: usize,
    pub phase: Phase,
}

/// How far it is.
pub(super) enum Phase {
    /// To be evaluated.
    Waiting,
    /// Evaluated. A checkpoint holds it as waiting: an evaluation from rest gives the same bits again.
    Evaluated(Box<Begun>),
    /// At a scheduled checkpoint.
    UnderWay(Box<UnderWay>),
    Ended(Box<Ended>),
}

/// A run at a scheduled checkpoint.
pub(super) struct UnderWay {
    pub record: StartRecord,
    pub trials: RunTrials,
    pub run: AugmentedState,
}

/// What stays the same as long as a run goes on.
pub(super) struct StartRecord {
    /// What deserves attention in its states; said already.
    pub warnings: Vec<Warning>,
    /// The control of the start.
    pub m: Vec<f64>,
    /// The start, saved.
    pub start: Vec<u8>,
    /// Its gradient check, where it is a random one.
    pub certificate: GradientCheckRecord,
}

/// A start that has ended or failed.
pub(super) struct Ended {
    /// Its entry in the result.
    pub entry: StartEntry,
    /// The control at which it ended; empty of one that failed or was stopped early: it has found no minimum.
    pub m: Vec<f64>,
    /// Absent of one that failed.
    pub standing: Option<Standing>,
    pub warnings: Vec<Warning>,
    /// Its lines of `history.jsonl` since the round began.
    pub lines: Vec<u8>,
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

    pub fn to_parted(&self) -> Parted {
        match &self.phase {
            Phase::Waiting | Phase::Evaluated(_) => {
                let mut out = Writer::new(MAGIC);
                out.count(0);
                Parted::whole(out.finish())
            }
            Phase::UnderWay(at) => at.record.under_way(&at.trials, &at.run),
            Phase::Ended(ended) => Parted::whole(ended.to_bytes()),
        }
    }

    pub fn from_parted(index: usize, Parted { body, points }: Parted) -> Result<Self, SavedRunError> {
        let (mut input, mut points) = (Reader::new(&body, MAGIC)?, points.into_iter());
        let phase = match input.number()? {
            0 => Phase::Waiting,
            1 => {
                let record = StartRecord {
                    warnings: read_warnings(&mut input)?,
                    m: input.floats()?,
                    start: next(&mut points)?,
                    certificate: read_json(&mut input)?,
                };
                let trials = RunTrials::read(&mut input)?;
                let mut run = AugmentedState::from_bytes(&input.list()?)?;
                run.run.current.point = next(&mut points)?;
                if let Some(best) = &mut run.run.best {
                    best.point = next(&mut points)?;
                }
                Phase::UnderWay(Box::new(UnderWay { record, trials, run }))
            }
            2 => Phase::Ended(Box::new(Ended {
                entry: read_json(&mut input)?,
                m: input.floats()?,
                standing: if input.flag()? { Some(Standing::ended(input.float()?)) } else { None },
                warnings: read_warnings(&mut input)?,
                lines: input.list()?,
            })),
            _ => return Err(input.damaged("a start in an unknown phase")),
        };
        input.finish()?;
        Ok(Self { index, phase })
    }
}

impl StartRecord {
    /// A run at a checkpoint, as [`StartRun::to_parted`] writes it.
    pub fn under_way(&self, trials: &RunTrials, run: &AugmentedState) -> Parted {
        let (mut run, mut points) = (run.clone(), vec![self.start.clone()]);
        points.push(std::mem::take(&mut run.run.current.point));
        points.extend(run.run.best.as_mut().map(|best| std::mem::take(&mut best.point)));
        let mut out = Writer::new(MAGIC);
        out.count(1);
        write_warnings(&self.warnings, &mut out);
        out.floats(&self.m);
        write_json(&self.certificate, &mut out);
        trials.write(&mut out);
        out.bytes(&run.to_bytes());
        Parted { body: out.finish(), points }
    }
}

impl Ended {
    fn to_bytes(&self) -> Vec<u8> {
        let mut out = Writer::new(MAGIC);
        out.count(2);
        write_json(&self.entry, &mut out);
        out.floats(&self.m);
        out.count(usize::from(self.standing.is_some()));
        if let Some(standing) = self.standing {
            out.float(standing.cost);
        }
        write_warnings(&self.warnings, &mut out);
        out.bytes(&self.lines);
        out.finish()
    }
}

fn write_warnings(warnings: &[Warning], out: &mut Writer) {
    out.count(warnings.len());
    warnings.iter().for_each(|warning| write_json(&warning_record(warning), out));
}

fn read_warnings(input: &mut Reader<'_>) -> Result<Vec<Warning>, SavedRunError> {
    (0..input.count(8)?).map(|_| read_warning(input)).collect()
}

fn read_warning(input: &mut Reader<'_>) -> Result<Warning, SavedRunError> {
    warning_of(read_json(input)?).ok_or_else(|| input.damaged("a warning of no known kind"))
}

/// An evaluated start.
pub struct Begun {
    pub point: EnsemblePoint,
    pub derivative: Vec<f64>,
    pub workspace: EnsembleWorkspace,
    /// What deserves attention in its states; said already.
    pub warnings: Vec<Warning>,
}
