//! [`Checkpoint`]: everything that an optimisation needs to go on to the bit.

use super::journal::Written;
use super::run_trials::RunTrials;
use crate::result::checkpoint_file::{self, CheckpointError};
use crate::result::files::Directory;
use crate::run::case_record::CaseRecord;
use crate::run::error::RunError;
use nastic_opt::bytes::{Reader, Writer};
use nastic_opt::{AugmentedState, SavedRunError};
use serde_json::Value;
use std::path::Path;

const MAGIC: &str = "nastic-optimisation-5";

/// The content of `checkpoint.bin`.
pub(in crate::run) struct Checkpoint {
    pub case: CaseRecord,
    /// Where the optimisation stood; `None` before its start was evaluated and its gradient checked.
    pub position: Option<Position>,
    /// Whether the optimisation came to its end, and all of its results were written.
    pub ended: bool,
}

/// Where an optimisation stood.
pub(in crate::run) struct Position {
    pub(super) fixed: Fixed,
    pub(super) trials: Trials,
    /// The run from the present start.
    pub(super) run: AugmentedState,
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

impl Position {
    /// The start and iteration it is of.
    pub(super) fn place(&self) -> Written {
        Written { start: self.fixed.index, iteration: self.run.run.progress.counts.iterations }
    }

    /// Whether nothing was done yet beyond the first start.
    pub fn is_start(&self) -> bool {
        self.place() == Written { start: 0, iteration: 0 }
    }
}

impl Checkpoint {
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, SavedRunError> {
        let (ended, body) = open(bytes)?;
        let mut input = Reader::new(&body, "")?;
        let case = CaseRecord::from_bytes(&input.list()?)?;
        let position = if input.flag()? { Some(read_position(&mut input)?) } else { None };
        input.finish()?;
        Ok(Self { case, position, ended })
    }

    /// That of a directory.
    pub fn read(directory: &Path) -> Result<Self, CheckpointError> {
        let content = checkpoint_file::read(directory)?;
        Self::from_bytes(&content).map_err(|error| unfit(directory, &error))
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

/// Where an optimisation stood that did not come to its end; `None` where there is none, or where nothing was evaluated.
///
/// # Errors
/// There is a checkpoint, and it cannot be read: whether it is worth keeping is not known.
pub(super) fn interrupted(out: &Directory) -> Result<Option<Written>, CheckpointError> {
    match Checkpoint::read(out.path()) {
        Ok(Checkpoint { ended: false, position: Some(position), .. }) => Ok(Some(position.place())),
        // Before the first scheduled checkpoint there may be iterations to lose; the start alone is none.
        Ok(Checkpoint { ended: false, position: None, .. }) if iterations(out) => {
            Ok(Some(Written { start: 0, iteration: 0 }))
        }
        Ok(_) | Err(CheckpointError::Missing { .. }) => Ok(None),
        Err(error) => Err(error),
    }
}

/// Whether the history of a directory goes beyond its start.
fn iterations(out: &Directory) -> bool {
    std::fs::read_to_string(out.file("history.jsonl")).is_ok_and(|text| text.lines().count() > 1)
}

/// Records in the checkpoint of a directory, if it has one, whether the optimisation has ended.
///
/// # Errors
/// It cannot be read or written; the earlier one stays.
pub(super) fn record_end(out: &Directory, ended: bool) -> Result<(), RunError> {
    let content = match checkpoint_file::read(out.path()) {
        Err(CheckpointError::Missing { .. }) => return Ok(()),
        content => content?,
    };
    let (recorded, body) = open(&content).map_err(|error| unfit(out.path(), &error))?;
    if recorded != ended {
        checkpoint_file::write(out, &close(ended, &body))?;
    }
    Ok(())
}

/// Whether the optimisation has ended, and all that the end leaves as it is.
fn open(content: &[u8]) -> Result<(bool, Vec<u8>), SavedRunError> {
    let mut input = Reader::new(content, MAGIC)?;
    let parts = (input.flag()?, input.list()?);
    input.finish()?;
    Ok(parts)
}

/// What [`open`] reads.
fn close(ended: bool, body: &[u8]) -> Vec<u8> {
    let mut out = Writer::new(MAGIC);
    out.count(usize::from(ended));
    out.bytes(body);
    out.finish()
}

fn unfit(directory: &Path, error: &SavedRunError) -> CheckpointError {
    CheckpointError::Content { file: directory.join(checkpoint_file::NAME), what: error.to_string() }
}

/// A checkpoint before the start was evaluated.
pub(super) fn before_the_start(case: &CaseRecord) -> Vec<u8> {
    let mut out = Writer::new("");
    out.bytes(&case.to_bytes());
    out.count(0);
    close(false, &out.finish())
}

/// A checkpoint of a run; `fixed` is [`Fixed::to_bytes`], made once for all checkpoints of a start.
pub(super) fn of_run(
    case: &CaseRecord,
    fixed: &[u8],
    history: &[u8],
    trials: &RunTrials,
    run: &AugmentedState,
) -> Vec<u8> {
    let mut out = Writer::new("");
    out.bytes(&case.to_bytes());
    out.count(1);
    out.bytes(fixed);
    out.bytes(history);
    trials.write(&mut out);
    out.bytes(&run.to_bytes());
    close(false, &out.finish())
}

fn read_position(input: &mut Reader<'_>) -> Result<Position, SavedRunError> {
    let fixed = Fixed::from_bytes(&input.list()?)?;
    let trials = Trials { history: input.list()?, run: RunTrials::read(input)? };
    let run = AugmentedState::from_bytes(&input.list()?)?;
    Ok(Position { fixed, trials, run })
}

pub(super) fn read_json(input: &mut Reader<'_>) -> Result<Value, SavedRunError> {
    serde_json::from_str(&input.text()?).map_err(|_| input.damaged("text that is not JSON"))
}
