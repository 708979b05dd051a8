//! [`Checkpoint`]: everything that an optimisation needs to go on to the bit.

use crate::run::error::RunError;
use crate::run::optimize::starts::start_run::{FinishedRun, PointBytes, StartRun};
use crate::saved::blocks::Blocks;
use crate::saved::case_record::CaseRecord;
use crate::saved::{CheckpointError, NAME, json, read_value, write};
use nastic_opt::Saved;
use nastic_report::record::GradientCheckRecord;
use nastic_result::files::Directory;
use serde::{Deserialize, Serialize};
use std::ops::Range;
use std::path::Path;

/// Which of so many members are wanted of a checkpoint that has them in blocks.
pub(crate) type Wanted<'w> = &'w dyn Fn(usize) -> Range<usize>;

/// The content of `checkpoint.bin`.
#[derive(Serialize, Deserialize)]
pub(crate) struct Checkpoint {
    pub case: CaseRecord,
    /// `optimize` or `identify`.
    pub command: String,
    /// Where the optimisation stood; `None` before its start was evaluated and its gradient checked.
    pub position: Option<Position>,
    /// Whether the optimisation came to its end, and all of its results were written.
    pub ended: bool,
}

/// Where an optimisation stood.
#[derive(Default, Serialize, Deserialize)]
pub(crate) struct Position {
    /// The result's entry of the gradient check at the start as written.
    #[serde(with = "json")]
    pub gradient_check: GradientCheckRecord,
    /// The round of starts under way.
    pub round: usize,
    /// `history.jsonl` as it was when that round began.
    pub history: Vec<u8>,
    /// The best of the starts that had ended: its number and its run.
    pub best: Option<(usize, FinishedRun<PointBytes>)>,
    pub starts: Vec<StartRun>,
    /// The files that have the points, if they are in files of their own.
    pub blocks: Option<Blocks>,
}

/// The first start that had not ended.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct Place {
    /// Its number.
    pub start: usize,
    /// Its iteration.
    pub iteration: usize,
}

impl Saved for Checkpoint {
    const KIND: &'static str = "nastic-optimisation-13";
}

impl Position {
    pub fn place(&self) -> Place {
        let first = self.starts.iter().position(|start| !start.has_ended());
        let iteration = first.map_or(0, |first| self.starts[first].iteration());
        Place { start: first.unwrap_or(self.starts.len().saturating_sub(1)), iteration }
    }

    /// Whether nothing was done yet beyond the first start.
    pub fn is_start(&self) -> bool {
        self.starts.iter().all(|start| !start.has_ended() && start.iteration() == 0)
    }

    /// The points of all runs, each as the ensemble saves it.
    pub fn points(&mut self) -> impl Iterator<Item = &mut Vec<u8>> {
        let best = self.best.iter_mut().flat_map(|(_, run)| [&mut run.start.bytes, &mut run.best.point.bytes]);
        best.chain(self.starts.iter_mut().flat_map(StartRun::points))
    }
}

impl Checkpoint {
    /// That of a directory, with the wanted members of all points that are in files of their own.
    pub fn read(directory: &Path, wanted: Wanted<'_>) -> Result<Self, CheckpointError> {
        let mut checkpoint: Self = read_value(directory, NAME)?;
        let Some(position) = &mut checkpoint.position else { return Ok(checkpoint) };
        if position.starts.iter().enumerate().any(|(place, start)| start.index != place) {
            let what = "its starts are not in their order".to_owned();
            return Err(CheckpointError::Content { file: directory.join(NAME), what });
        }
        if let Some(blocks) = position.blocks.clone() {
            let points = blocks.points(directory, position.points().count(), wanted(blocks.members))?;
            position.points().zip(points).for_each(|(place, point)| *place = point);
        }
        Ok(checkpoint)
    }
}

/// Case and iteration of an optimisation that did not come to its end; `None` where there is none, or where nothing was evaluated.
///
/// # Errors
/// There is a checkpoint, and it cannot be read: whether it is worth keeping is not known.
pub(crate) fn interrupted(directory: &Path) -> Result<Option<(CaseRecord, usize)>, CheckpointError> {
    match Checkpoint::read(directory, &|_| 0..0) {
        Ok(Checkpoint { ended: false, position: Some(position), case, .. }) if !position.is_start() => {
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
pub(crate) fn record_end(out: &Directory, ended: bool) -> Result<(), RunError> {
    let checkpoint: Checkpoint = match read_value(out.path(), NAME) {
        Err(CheckpointError::Missing { .. }) => return Ok(()),
        found => found?,
    };
    if checkpoint.ended != ended {
        write(out, NAME, &Checkpoint { ended, ..checkpoint }.to_bytes())?;
    }
    Ok(())
}
