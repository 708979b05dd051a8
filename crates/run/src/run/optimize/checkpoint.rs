//! [`Checkpoint`]: everything that an optimisation needs to go on to the bit.

use crate::result::checkpoint_file;
use crate::result::checkpoint_file::CheckpointError;
use crate::result::files::Directory;
use crate::run::case_record::CaseRecord;
use crate::run::error::RunError;
use crate::run::optimize::blocks::Blocks;
use crate::run::optimize::journal::Written;
use crate::run::optimize::parted::Parted;
use crate::run::optimize::start_run::StartRun;
use nastic_opt::SavedRunError;
use nastic_opt::bytes::{Reader, Writer};
use nastic_report::record::GradientCheckRecord;
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::ops::Range;
use std::path::Path;

const MAGIC: &str = "nastic-optimisation-9";

/// A run has its start, the point at which it stands, and the best one.
const MOST_POINTS: usize = 3;

/// Which of so many members are wanted of a checkpoint that has them in blocks.
pub(in crate::run) type Wanted<'w> = &'w dyn Fn(usize) -> Range<usize>;

/// The content of `checkpoint.bin`.
pub(in crate::run) struct Checkpoint {
    pub case: CaseRecord,
    /// Where the optimisation stood; `None` before its start was evaluated and its gradient checked.
    pub position: Option<Position>,
    /// Whether the optimisation came to its end, and all of its results were written.
    pub ended: bool,
}

/// Where an optimisation stood.
#[derive(Default)]
pub(in crate::run) struct Position {
    /// The result's entry of the gradient check at the start as written.
    pub(super) gradient_check: GradientCheckRecord,
    /// The round of starts under way.
    pub(super) round: usize,
    /// `history.jsonl` as it was when that round began.
    pub(super) history: Vec<u8>,
    /// The best of the starts that had ended: its number and its run.
    pub(super) best: Option<Parted>,
    pub(super) starts: Vec<StartRun>,
    /// Which set of files has the points, if they are in files of their own.
    pub(super) set: Option<usize>,
}

/// What checkpoints of a round hold beside case and history.
#[derive(Default)]
pub(super) struct Record {
    pub gradient_check: GradientCheckRecord,
    pub round: usize,
    /// Length of `history.jsonl` when the round began.
    pub history: usize,
    pub best: Option<Parted>,
    pub starts: Vec<SavedStart>,
}

/// A start as bytes.
pub(super) struct SavedStart {
    pub run: Parted,
    pub iteration: usize,
    pub ended: bool,
}

impl SavedStart {
    pub fn of(start: &StartRun) -> Self {
        Self { run: start.to_parted(), iteration: start.iteration(), ended: start.has_ended() }
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
    /// That of a directory, with the wanted members of all points that are in files of their own.
    pub fn read(directory: &Path, wanted: Wanted<'_>) -> Result<Self, CheckpointError> {
        let content = checkpoint_file::read(directory, checkpoint_file::NAME)?;
        let unfit = |error: SavedRunError| unfit(directory, &error);
        let (ended, body) = open(&content).map_err(unfit)?;
        let mut input = Reader::new(&body, "").map_err(unfit)?;
        let case = input.list().and_then(|case| CaseRecord::from_bytes(&case)).map_err(unfit)?;
        let position = match input.flag().map_err(unfit)? {
            true => Some(read_position(&mut input, directory, wanted, &unfit)?),
            false => None,
        };
        input.finish().map_err(unfit)?;
        Ok(Self { case, position, ended })
    }
}

impl Record {
    /// The runs that have points.
    pub fn runs(&self) -> impl Iterator<Item = &Parted> {
        self.best.iter().chain(self.starts.iter().map(|start| &start.run))
    }

    /// A checkpoint; `history`: all of `history.jsonl` so far. The points are in it, or in `blocks`.
    pub fn to_bytes(&self, case: &CaseRecord, history: &[u8], blocks: Option<&Blocks>) -> Vec<u8> {
        let mut out = Writer::new("");
        out.bytes(&case.to_bytes());
        out.count(1);
        write_json(&self.gradient_check, &mut out);
        out.count(self.round);
        out.bytes(&history[..self.history.min(history.len())]);
        out.count(usize::from(self.best.is_some()));
        out.count(self.starts.len());
        out.count(usize::from(blocks.is_some()));
        for run in self.runs() {
            out.bytes(&run.body);
            out.count(run.points.len());
            run.points.iter().filter(|_| blocks.is_none()).for_each(|point| out.bytes(point));
        }
        blocks.iter().for_each(|blocks| blocks.write_to(&mut out));
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
    match Checkpoint::read(directory, &|_| 0..0) {
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

fn read_position(
    input: &mut Reader<'_>,
    directory: &Path,
    wanted: Wanted<'_>,
    unfit: &dyn Fn(SavedRunError) -> CheckpointError,
) -> Result<Position, CheckpointError> {
    let mut head = || Ok((read_json(input)?, input.number()?, input.list()?, input.flag()?, input.count(8)?));
    let (gradient_check, round, history, has_best, starts) = head().map_err(unfit)?;
    let mut body = || read_runs(input, usize::from(has_best) + starts);
    let (mut runs, blocks) = body().map_err(unfit)?;
    if let Some(blocks) = &blocks {
        let count = runs.iter().map(|run| run.points.len()).sum();
        let mut points = blocks.points(directory, count, wanted(blocks.members))?.into_iter();
        runs.iter_mut().flat_map(|run| &mut run.points).zip(&mut points).for_each(|(place, point)| *place = point);
    }
    let mut runs = runs.into_iter();
    let best = if has_best { runs.next() } else { None };
    let starts = runs.enumerate().map(|(index, run)| StartRun::from_parted(index, run));
    let starts = starts.collect::<Result<_, _>>().map_err(unfit)?;
    Ok(Position { gradient_check, round, history, best, starts, set: blocks.map(|blocks| blocks.set) })
}

/// So many runs, with their points unless these are in blocks.
fn read_runs(input: &mut Reader<'_>, count: usize) -> Result<(Vec<Parted>, Option<Blocks>), SavedRunError> {
    let in_blocks = input.flag()?;
    let mut runs = Vec::new();
    for _ in 0..count {
        let (body, points) = (input.list()?, input.number()?);
        let points = match in_blocks {
            true if points > MOST_POINTS => return Err(input.damaged("a run of too many points")),
            true => vec![vec![]; points],
            false => (0..points).map(|_| input.list()).collect::<Result<_, _>>()?,
        };
        runs.push(Parted { body, points });
    }
    let blocks = if in_blocks { Some(Blocks::read_from(input)?) } else { None };
    Ok((runs, blocks))
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
