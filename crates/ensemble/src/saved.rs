//! [`SavedMembers`]: a point of an ensemble as bytes, member by member, and the blocks of members that checkpoints have files of.

use nastic_opt::Saved;
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// Least number of members of a block, which is a file of a checkpoint.
const MIN_BLOCK_MEMBERS: usize = 4;
/// Number of blocks above which blocks become larger.
const MAX_BLOCKS: usize = 4096;

/// What [`Objective::save`](nastic_opt::Objective::save) gives of an ensemble: every member as its problem saves it, empty where it is another rank's.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct SavedMembers(pub Vec<Vec<u8>>);

impl SavedMembers {
    /// None of the members.
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

/// Blocks of members, by their number alone: each but the last has the same power of two of them.
pub fn blocks(members: usize) -> impl ExactSizeIterator<Item = Range<usize>> {
    let size = members.div_ceil(MAX_BLOCKS).next_power_of_two().max(MIN_BLOCK_MEMBERS);
    (0..members.div_ceil(size)).map(move |block| block * size..((block + 1) * size).min(members))
}
