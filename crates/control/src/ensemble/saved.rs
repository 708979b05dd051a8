//! [`SavedMembers`]: a point of an ensemble as bytes, member by member, and the blocks of members that checkpoints have files of.

use nastic_opt::Saved;
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// Members of a block at least, and how many blocks there are at most while they are no larger than that: files of a checkpoint.
const LEAST: usize = 4;
const MOST_BLOCKS: usize = 4096;

/// What [`Objective::save`](nastic_opt::Objective::save) gives of an ensemble: every member as its problem saves it, empty where it is another rank's.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct SavedMembers(pub Vec<Vec<u8>>);

impl SavedMembers {
    /// Of so many members none.
    pub fn none(members: usize) -> Self {
        Self(vec![vec![]; members])
    }
}

impl Saved for SavedMembers {
    const KIND: &'static str = "nastic-ensemble-point-2";
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
