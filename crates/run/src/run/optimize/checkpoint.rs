//! [`Checkpoint`]: everything that an optimisation needs to go on to the bit.

use crate::result::checkpoint_file;
use crate::result::checkpoint_file::CheckpointError;
use crate::result::files::Directory;
use crate::run::case_record::CaseRecord;
use crate::run::error::RunError;
use crate::run::optimize::journal::Written;
use crate::run::optimize::start_run::StartRun;
use nastic_opt::SavedRunError;
use nastic_opt::bytes::{Reader, Writer};
use nastic_report::record::GradientCheckRecord;
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::path::Path;

const MAGIC: &str = "nastic-optimisation-7";

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
    /// The result's entry of the gradient check at the start as written.
    pub(super) gradient_check: GradientCheckRecord,
    /// The round of starts under way.
    pub(super) round: usize,
    /// `history.jsonl` as it was when that round began.
    pub(super) history: Vec<u8>,
    /// The best of the starts that had ended, as bytes: its number and its run.
    pub(super) best: Option<Vec<u8>>,
    pub(super) starts: Vec<StartRun>,
}

/// What checkpoints of a round hold beside case and history.
#[derive(Default)]
pub(super) struct Record {
    pub gradient_check: GradientCheckRecord,
    pub round: usize,
    /// Length of `history.jsonl` when the round began.
    pub history: usize,
    pub best: Option<Vec<u8>>,
    pub starts: Vec<SavedStart>,
}

/// A start as bytes.
pub(super) struct SavedStart {
    pub bytes: Vec<u8>,
    pub iteration: usize,
    pub ended: bool,
}

impl SavedStart {
    pub fn of(start: &StartRun) -> Self {
        Self { bytes: start.to_bytes(), iteration: start.iteration(), ended: start.has_ended() }
    }
}

impl Position {
    /// The first start that had not ended, and its iteration.
    pub(super) fn place(&self) -> Written {
        place(self.starts.iter().map(|start| (start.has_ended(), start.iteration())))
    }

    /// Whether nothing was done yet beyond the first start.
    pub fn is_start(&self) -> bool {
        self.starts.iter().all(|start| !start.has_ended() && start.iteration() == 0)
    }
}

fn place(starts: impl ExactSizeIterator<Item = (bool, usize)>) -> Written {
    let last = starts.len().saturating_sub(1);
    let first = starts.enumerate().find(|(_, (ended, _))| !ended);
    first.map_or(Written { start: last, iteration: 0 }, |(start, (_, iteration))| Written { start, iteration })
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
        let content = checkpoint_file::read(directory, checkpoint_file::NAME)?;
        Self::from_bytes(&content).map_err(|error| unfit(directory, &error))
    }
}

impl Record {
    /// A checkpoint; `history`: all of `history.jsonl` so far.
    pub fn to_bytes(&self, case: &CaseRecord, history: &[u8]) -> Vec<u8> {
        let mut out = Writer::new("");
        out.bytes(&case.to_bytes());
        out.count(1);
        write_json(&self.gradient_check, &mut out);
        out.count(self.round);
        out.bytes(&history[..self.history.min(history.len())]);
        out.count(usize::from(self.best.is_some()));
        self.best.iter().for_each(|best| out.bytes(best));
        out.count(self.starts.len());
        self.starts.iter().for_each(|start| out.bytes(&start.bytes));
        close(false, &out.finish())
    }

    /// The first start that had not ended, and its iteration.
    pub fn place(&self) -> Written {
        place(self.starts.iter().map(|start| (start.ended, start.iteration)))
    }
}

/// Case and iteration of an optimisation that did not come to its end; `None` where there is none, or where nothing was evaluated.
///
/// # Errors
/// There is a checkpoint, and it cannot be read: whether it is worth keeping is not known.
pub(in crate::run) fn interrupted(directory: &Path) -> Result<Option<(CaseRecord, usize)>, CheckpointError> {
    match Checkpoint::read(directory) {
        Ok(Checkpoint { ended: false, position: Some(position), case }) if !position.is_start() => {
            Ok(Some((case, position.place().iteration)))
        }
        Ok(_) | Err(CheckpointError::Missing { .. }) => Ok(None),
        Err(error) => Err(error),
    }
}

/// Records in the checkpoint of a directory, if it has one, whether the optimisation has ended.
///
/// # Errors
/// It cannot be read or written; the earlier one stays.
pub(super) fn record_end(out: &Directory, ended: bool) -> Result<(), RunError> {
    let content = match checkpoint_file::read(out.path(), checkpoint_file::NAME) {
        Err(CheckpointError::Missing { .. }) => return Ok(()),
        content => content?,
    };
    let (recorded, body) = open(&content).map_err(|error| unfit(out.path(), &error))?;
    if recorded != ended {
        checkpoint_file::write(out, checkpoint_file::NAME, &close(ended, &body))?;
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

fn read_position(input: &mut Reader<'_>) -> Result<Position, SavedRunError> {
    let (gradient_check, round, history) = (read_json(input)?, input.number()?, input.list()?);
    let best = if input.flag()? { Some(input.list()?) } else { None };
    let starts = (0..input.count(8)?).map(|index| StartRun::from_bytes(index, &input.list()?));
    let starts = starts.collect::<Result<_, _>>()?;
    Ok(Position { gradient_check, round, history, best, starts })
}

/// An entry of the result as text.
pub(super) fn write_json(entry: &impl Serialize, out: &mut Writer) {
    // entries have keys that are texts: nothing in them fails
    out.bytes(&serde_json::to_vec(entry).unwrap_or_default());
}

/// An entry that [`write_json`] wrote.
pub(super) fn read_json<T: DeserializeOwned>(input: &mut Reader<'_>) -> Result<T, SavedRunError> {
    serde_json::from_str(&input.text()?).map_err(|_| input.damaged("text that is no such entry"))
}
