//! [`Blocks`]: the files of a checkpoint that have the points, a file for each block of members.
//!
//! Blocks are by the members' numbers: the owner of the first member of one writes its file, and any ranks read those that they need. There are two
//! sets of files, that of the last checkpoint and that of the next one: `checkpoint.bin`, which is written last, says which one counts and what is in it.

use crate::run::error::RunError;
use crate::saved;
use crate::saved::CheckpointError;
use nastic_ensemble::{Ensemble, EnsembleError, MemberBlock, SavedMembers, blocks_of_members};
use nastic_io::{Fingerprint, WriteError};
use nastic_opt::Saved;
use nastic_opt::saved::{pack, unpack};
use nastic_result::files::Directory;
use nastic_team::{Team, TeamError, exchange};
use serde::{Deserialize, Serialize};
use std::ops::Range;
use std::path::Path;

/// The files of a checkpoint, by number of the block.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Blocks {
    /// How many members there are.
    pub members: usize,
    /// Which of the two sets of files.
    pub set: usize,
    /// Of the content of each.
    pub fingerprints: Vec<u64>,
}

/// The file of a block.
fn name(set: usize, block: usize) -> String {
    format!("checkpoint_{}{block}.bin", if set == 0 { 'a' } else { 'b' })
}

/// Removes the files of all blocks.
pub(crate) fn remove(out: &Directory) {
    let is_number = |text: &str| !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit());
    for entry in std::fs::read_dir(out.path()).into_iter().flatten().flatten() {
        let file = entry.file_name();
        let block = file.to_str().and_then(|name| name.strip_prefix("checkpoint_")?.strip_suffix(".bin"));
        if block.is_some_and(|block| is_number(block.strip_prefix(['a', 'b']).unwrap_or_default())) {
            let _ = out.remove(&file.to_string_lossy());
        }
    }
}

/// Writes the points to the files of a set, each rank its own: what all have written, at all ranks, or the first failure.
pub(crate) fn write(
    ensemble: &Ensemble,
    team: &dyn Team,
    out: &Directory,
    points: &[Vec<u8>],
    set: usize,
) -> Result<Blocks, RunError> {
    let unfit = |_| TeamError::Unexpected { rank: team.rank(), what: "a point of another form" };
    let points = points.iter().map(|point| SavedMembers::from_bytes(point));
    let points = points.collect::<Result<Vec<_>, _>>().map_err(unfit)?;
    let of = |index: usize| pack(&points.iter().map(|point| &point.0[index]).collect::<Vec<_>>());
    let own = ensemble.blocks_of(of).map_err(|error| match error {
        EnsembleError::Team(error) => RunError::Team(error),
        _ => RunError::Cancelled,
    })?;
    let write = |MemberBlock { number, members }: MemberBlock| {
        let content = pack(&members);
        saved::write(out, &name(set, number), &content).map(|()| (number, Fingerprint::of_bytes(&content)))
    };
    let written: Result<Vec<(usize, u64)>, WriteError> = own.into_iter().map(write).collect();
    let told = exchange(team, pack(&written.as_ref().map_err(ToString::to_string)))?;
    written?;
    let members = ensemble.members().len();
    let mut fingerprints = vec![0; blocks_of_members(members).len()];
    for (rank, bytes) in told.iter().enumerate() {
        let unfit = |_| TeamError::Unexpected { rank, what: "blocks of another form" };
        let blocks: Result<Vec<(usize, u64)>, String> = unpack(bytes).map_err(unfit)?;
        for (block, fingerprint) in blocks.map_err(|message| RunError::NotWrittenByRank { rank, message })? {
            if let Some(place) = fingerprints.get_mut(block) {
                *place = fingerprint;
            }
        }
    }
    Ok(Blocks { members, set, fingerprints })
}

impl Blocks {
    /// So many points, of which the members of a range are there.
    pub fn points(&self, directory: &Path, count: usize, own: Range<usize>) -> Result<Vec<Vec<u8>>, CheckpointError> {
        if self.set > 1 || self.fingerprints.len() != blocks_of_members(self.members).len() {
            let what = "another number of blocks than members need".to_owned();
            return Err(CheckpointError::Content { file: directory.join(saved::NAME), what });
        }
        let mut points = vec![SavedMembers::none(self.members); count];
        for (block, members) in blocks_of_members(self.members).enumerate() {
            if own.is_empty() || members.end <= own.start || own.end <= members.start {
                continue;
            }
            let file = directory.join(name(self.set, block));
            let unfit = |what: String| CheckpointError::Content { file: file.clone(), what };
            let content = saved::read(directory, &name(self.set, block)).map_err(|error| match error {
                CheckpointError::Missing { .. } => unfit("checkpoint.bin names it, and it is not there".to_owned()),
                error => error,
            })?;
            if Fingerprint::of_bytes(&content) != self.fingerprints[block] {
                return Err(unfit("it belongs to another checkpoint than checkpoint.bin".to_owned()));
            }
            let all = unpack::<Vec<Vec<u8>>>(&content).map_err(|error| unfit(error.to_string()))?;
            for (index, bytes) in members.zip(&all) {
                let member = unpack::<Vec<Vec<u8>>>(bytes).map_err(|error| unfit(error.to_string()))?;
                points.iter_mut().zip(member).for_each(|(point, bytes)| point.0[index] = bytes);
            }
        }
        Ok(points.iter().map(SavedMembers::to_bytes).collect())
    }
}
