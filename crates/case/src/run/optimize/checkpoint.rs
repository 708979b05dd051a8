//! [`Checkpoint`]: everything that an optimisation needs to go on to the bit.

use super::finished_run::{read_work, write_work};
use super::journal::Written;
use crate::result::checkpoint_file;
use crate::result::files::Directory;
use crate::run::case_record::CaseRecord;
use crate::run::error::Exit;
use nastic_fem::SolveReport;
use nastic_opt::bytes::{Reader, Writer};
use nastic_opt::{RunState, SavedRunError, Stop};
use nastic_report::Iterates;
use serde_json::Value;

const MAGIC: &str = "nastic-optimisation-2";

/// The content of `checkpoint.bin`.
pub(in crate::run) struct Checkpoint {
    pub case: CaseRecord,
    /// Where the optimisation stood; `None` before its start was evaluated and its gradient checked.
    pub position: Option<Position>,
}

/// Where an optimisation stood.
pub(in crate::run) struct Position {
    pub(super) fixed: Fixed,
    pub(super) trials: Trials,
    /// The run from the present start.
    pub(super) run: RunState,
}

/// What stays the same from one start to the next.
pub(super) struct Fixed {
    /// The result's entry of the gradient check at the start as written.
    pub gradient_check: Value,
    /// [`Starts`](super::starts::Starts) as bytes: the runs that have finished.
    pub finished: Vec<u8>,
    /// Number of the present start.
    pub index: usize,
    /// Its gradient check, where it is a random one.
    pub certificate: Value,
    /// The present start as bytes.
    pub start: Vec<u8>,
}

/// What was told of the trials so far.
pub(super) struct Trials {
    /// All of `history.jsonl`.
    pub history: Vec<u8>,
    /// What was kept of the trials of the present start.
    pub run: RunTrials,
}

/// What is kept of the trials of one start.
pub(super) struct RunTrials {
    /// Their work, by member.
    pub work: Vec<SolveReport>,
    /// Iterations of which snapshots were written.
    pub snapshots: Vec<usize>,
    /// Shapes and controls of accepted iterations, load case by load case.
    pub iterates: Vec<Iterates>,
}

/// The parts of [`RunTrials`], to be written.
pub(super) type TrialsOfRun<'a> = (&'a [SolveReport], &'a [usize], &'a [Iterates]);

impl Position {
    /// The start and iteration it is of.
    pub(super) fn place(&self) -> Written {
        Written { start: self.fixed.index, iteration: self.run.progress.counts.iterations }
    }
}

impl Checkpoint {
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, SavedRunError> {
        let mut input = Reader::new(bytes, MAGIC)?;
        let case = CaseRecord::from_bytes(&input.list()?)?;
        let position = if input.flag()? { Some(read_position(&mut input)?) } else { None };
        input.finish()?;
        Ok(Self { case, position })
    }
}

impl Fixed {
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut out = Writer::new("");
        out.bytes(self.gradient_check.to_string().as_bytes());
        out.bytes(&self.finished);
        out.count(self.index);
        out.bytes(self.certificate.to_string().as_bytes());
        out.bytes(&self.start);
        out.finish()
    }

    fn from_bytes(bytes: &[u8]) -> Result<Self, SavedRunError> {
        let mut input = Reader::new(bytes, "")?;
        let fixed = Self {
            gradient_check: read_json(&mut input)?,
            finished: input.list()?,
            index: input.number()?,
            certificate: read_json(&mut input)?,
            start: input.list()?,
        };
        input.finish()?;
        Ok(fixed)
    }
}

/// Where an optimisation stood that did not come to its end; `None` where there is none, or no checkpoint of it that can be read.
pub(super) fn interrupted(out: &Directory) -> Option<Written> {
    let content = checkpoint_file::read(out.path()).ok()?;
    let position = Checkpoint::from_bytes(&content).ok()?.position?;
    let result = std::fs::read_to_string(out.file("result.json")).ok();
    let result: Option<Value> = result.and_then(|text| serde_json::from_str(&text).ok());
    let ended = result.is_some_and(|result| {
        let unwritten = result["exit"] == Exit::NotWritten.code();
        // By a lack of memory: the best of several starts may have ended before.
        let aborted = result["exit"] == Exit::ForwardFailed.code();
        // Of several starts that were not all run the best may have converged.
        let between_starts = result["exit"] == Exit::NotConverged.code() && result["converged"] == true;
        let cancelled = result["stop"] == Stop::Cancelled.to_string();
        result["stop"].is_string() && !cancelled && !aborted && !unwritten && !between_starts
    });
    (!ended).then(|| position.place())
}

/// A checkpoint before the start was evaluated.
pub(super) fn before_the_start(case: &CaseRecord) -> Vec<u8> {
    let mut out = Writer::new(MAGIC);
    out.bytes(&case.to_bytes());
    out.count(0);
    out.finish()
}

/// A checkpoint of a run; `fixed` is [`Fixed::to_bytes`], made once for all checkpoints of a start.
pub(super) fn of_run(
    case: &CaseRecord,
    fixed: &[u8],
    history: &[u8],
    (work, snapshots, iterates): TrialsOfRun<'_>,
    run: &RunState,
) -> Vec<u8> {
    let mut out = Writer::new(MAGIC);
    out.bytes(&case.to_bytes());
    out.count(1);
    out.bytes(fixed);
    out.bytes(history);
    write_work(work, &mut out);
    out.count(snapshots.len());
    snapshots.iter().for_each(|iteration| out.count(*iteration));
    out.count(iterates.len());
    iterates.iter().for_each(|kept| out.bytes(&kept.to_bytes()));
    out.bytes(&run.to_bytes());
    out.finish()
}

fn read_position(input: &mut Reader<'_>) -> Result<Position, SavedRunError> {
    let fixed = Fixed::from_bytes(&input.list()?)?;
    let (history, work) = (input.list()?, read_work(input)?);
    let snapshots = (0..input.count(8)?).map(|_| input.number()).collect::<Result<_, _>>()?;
    let iterates = (0..input.count(8)?).map(|_| read_iterates(input)).collect::<Result<_, _>>()?;
    let run = RunState::from_bytes(&input.list()?)?;
    Ok(Position { fixed, trials: Trials { history, run: RunTrials { work, snapshots, iterates } }, run })
}

fn read_iterates(input: &mut Reader<'_>) -> Result<Iterates, SavedRunError> {
    Iterates::from_bytes(&input.list()?).map_err(|_| input.damaged("iterates of another form"))
}

pub(super) fn read_json(input: &mut Reader<'_>) -> Result<Value, SavedRunError> {
    serde_json::from_str(&input.text()?).map_err(|_| input.damaged("text that is not JSON"))
}
