//! [`Blocks`]: the files of a checkpoint that have the points, a file for each block of members.
//!
//! Blocks are by the members' numbers: the owner of the first member of one writes its file, and any ranks read those that they need. There are two
//! sets of files, that of the last checkpoint and that of the next one: `checkpoint.bin`, which is written last, says which one counts and what is in it.

use crate::result::checkpoint_file;
use crate::result::checkpoint_file::CheckpointError;
use crate::result::files::Directory;
use crate::run::error::RunError;
use crate::run::optimize::parted::Parted;
use nastic_control::{Ensemble, EnsembleError, MemberBlock, SavedMembers, blocks_of_members};
use nastic_io::{Fingerprint, WriteError};
use nastic_opt::SavedRunError;
use nastic_opt::bytes::{Reader, Writer};
use nastic_team::{Team, TeamError, exchange};
use std::ops::Range;
use std::path::Path;

/// The files of a checkpoint, by number of the block.
#[derive(Clone, Debug, Default)]
pub(super) struct Blocks {
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
pub(super) fn remove(out: &Directory) {
    let is_number = |text: &str| !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit());
    for entry in std::fs::read_dir(out.path()).into_iter().flatten().flatten() {
        let file = entry.file_name();
        let block = file.to_str().and_then(|name| name.strip_prefix("checkpoint_")?.strip_suffix(".bin"));
        if block.is_some_and(|block| is_number(block.strip_prefix(['a', 'b']).unwrap_or_default())) {
            let _ = out.remove(&file.to_string_lossy());
        }
    }
}

/// Writes the files of a set, each rank its own: what all have written, at all ranks, or the first failure.
pub(super) fn write<'p>(
    ensemble: &Ensemble,
    team: &dyn Team,
    out: &Directory,
    runs: impl Iterator<Item = &'p Parted>,
    set: usize,
) -> Result<Blocks, RunError> {
    let unfit = |_| TeamError::Unexpected { rank: team.rank(), what: "a point of another form" };
    let points = runs.flat_map(|run| &run.points).map(|point| SavedMembers::from_bytes(point));
    let points = points.collect::<Result<Vec<_>, _>>().map_err(unfit)?;
    let of = |index: usize| packed(points.iter().map(|point| point.0[index].as_slice()));
    let own = ensemble.blocks_of(of).map_err(|error| match error {
        EnsembleError::Team(error) => RunError::Team(error),
        _ => RunError::Cancelled,
    })?;
    let write = |MemberBlock { number, members }: MemberBlock| {
        let content = packed(members.iter().map(Vec::as_slice));
        checkpoint_file::write(out, &name(set, number), &content).map(|()| (number, Fingerprint::of_bytes(&content)))
    };
    let written: Result<Vec<_>, WriteError> = own.into_iter().map(write).collect();
    let told = exchange(team, told(&written))?;
    written?;
    let members = ensemble.members().len();
    let mut fingerprints = vec![0; blocks_of_members(members).len()];
    for (rank, bytes) in told.iter().enumerate() {
        let unfit = |_| TeamError::Unexpected { rank, what: "blocks of another form" };
        let blocks = heard(bytes).map_err(unfit)?.map_err(|message| RunError::NotWrittenByRank { rank, message })?;
        for (block, fingerprint) in blocks {
            if let Some(place) = fingerprints.get_mut(block) {
                *place = fingerprint;
            }
        }
    }
    Ok(Blocks { members, set, fingerprints })
}

fn packed<'b>(all: impl ExactSizeIterator<Item = &'b [u8]>) -> Vec<u8> {
    let mut out = Writer::new("");
    out.count(all.len());
    all.for_each(|one| out.bytes(one));
    out.finish()
}

fn lists(bytes: &[u8]) -> Result<Vec<Vec<u8>>, SavedRunError> {
    let mut input = Reader::new(bytes, "")?;
    let all = (0..input.count(8)?).map(|_| input.list()).collect::<Result<_, _>>()?;
    input.finish()?;
    Ok(all)
}

/// What a rank has written.
fn told(written: &Result<Vec<(usize, u64)>, WriteError>) -> Vec<u8> {
    let mut out = Writer::new("");
    match written {
        Ok(blocks) => {
            out.count(0);
            out.count(blocks.len());
            for (block, fingerprint) in blocks {
                out.count(*block);
                out.float(f64::from_bits(*fingerprint));
            }
        }
        Err(error) => {
            out.count(1);
            out.bytes(error.to_string().as_bytes());
        }
    }
    out.finish()
}

#[allow(clippy::type_complexity)] // a message and its two halves
fn heard(bytes: &[u8]) -> Result<Result<Vec<(usize, u64)>, String>, SavedRunError> {
    let mut input = Reader::new(bytes, "")?;
    if input.flag()? {
        return Ok(Err(input.text()?));
    }
    let count = input.count(16)?;
    let block = |_| Ok((input.number()?, input.float()?.to_bits()));
    Ok(Ok((0..count).map(block).collect::<Result<_, _>>()?))
}

impl Blocks {
    pub fn write_to(&self, out: &mut Writer) {
        out.count(self.members);
        out.count(self.set);
        out.count(self.fingerprints.len());
        self.fingerprints.iter().for_each(|fingerprint| out.float(f64::from_bits(*fingerprint)));
    }

    pub fn read_from(input: &mut Reader<'_>) -> Result<Self, SavedRunError> {
        let (members, set) = (input.number()?, input.number()?);
        let fingerprints = (0..input.count(8)?).map(|_| Ok(input.float()?.to_bits())).collect::<Result<Vec<_>, _>>()?;
        if set > 1 || fingerprints.len() != blocks_of_members(members).len() {
            return Err(input.damaged("another number of blocks"));
        }
        Ok(Self { members, set, fingerprints })
    }

    /// So many points, of which the members of a range are there.
    pub fn points(&self, directory: &Path, count: usize, own: Range<usize>) -> Result<Vec<Vec<u8>>, CheckpointError> {
        let mut points = vec![SavedMembers::none(self.members); count];
        for (block, members) in blocks_of_members(self.members).enumerate() {
            if own.is_empty() || members.end <= own.start || own.end <= members.start {
                continue;
            }
            let file = directory.join(name(self.set, block));
            let unfit = |what: String| CheckpointError::Content { file: file.clone(), what };
            let content = checkpoint_file::read(directory, &name(self.set, block)).map_err(|error| match error {
                CheckpointError::Missing { .. } => unfit("checkpoint.bin names it, and it is not there".to_owned()),
                error => error,
            })?;
            if Fingerprint::of_bytes(&content) != self.fingerprints[block] {
                return Err(unfit("it belongs to another checkpoint than checkpoint.bin".to_owned()));
            }
            let all = lists(&content).map_err(|error| unfit(error.to_string()))?;
            for (index, bytes) in members.zip(&all) {
                let member = lists(bytes).map_err(|error| unfit(error.to_string()))?;
                points.iter_mut().zip(member).for_each(|(point, bytes)| point.0[index] = bytes);
            }
        }
        Ok(points.iter().map(SavedMembers::to_bytes).collect())
    }
}
