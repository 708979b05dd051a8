//! [`SavedMembers`]: a point of an ensemble as bytes, member by member, and the blocks of members that checkpoints have files of.

use nastic_opt::SavedRunError;
use nastic_opt::bytes::{Reader, Writer};
use std::ops::Range;

const MAGIC: &str = "nastic-ensemble-point-1";

/// Members of a block at least, and how many blocks there are at most while they are no larger than that: files of a checkpoint.
const LEAST: usize = 4;
const MOST_BLOCKS: usize = 4096;

/// What [`Objective::save`](nastic_opt::Objective::save) gives of an ensemble: every member as its problem saves it, empty where it is another rank's.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SavedMembers(pub Vec<Vec<u8>>);

impl SavedMembers {
    /// Of so many members none.
    pub fn none(members: usize) -> Self {
        Self(vec![vec![]; members])
    }

    /// Reads what [`to_bytes`](Self::to_bytes) gave.
    ///
    /// # Errors
    /// Bytes of something else, truncated or damaged ones.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, SavedRunError> {
        let mut input = Reader::new(bytes, MAGIC)?;
        let members = (0..input.count(8)?).map(|_| input.list()).collect::<Result<_, _>>()?;
        input.finish()?;
        Ok(Self(members))
    }

    /// The saved point.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut out = Writer::new(MAGIC);
        out.count(self.0.len());
        self.0.iter().for_each(|member| out.bytes(member));
        out.finish()
    }
}

/// What was made of the members of a block.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct MemberBlock {
    /// The number of the block.
    pub number: usize,
    /// By member.
    pub members: Vec<Vec<u8>>,
}

/// Blocks of so many members, by their numbers alone: each but the last has the same power of two of them.
pub fn blocks(members: usize) -> impl ExactSizeIterator<Item = Range<usize>> {
    let size = members.div_ceil(MOST_BLOCKS).next_power_of_two().max(LEAST);
    (0..members.div_ceil(size)).map(move |block| block * size..((block + 1) * size).min(members))
}
