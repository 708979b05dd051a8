//! [`TeamError`]: a message that did not arrive.

use thiserror::Error;

/// Why ranks cannot go on together. All of them end the run: what was found is in the checkpoint.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum TeamError {
    /// A rank has ended.
    #[error(
        "rank {rank} has ended before the others: its own message says why; nastic resume goes on from the last checkpoint"
    )]
    Lost {
        /// The rank.
        rank: usize,
    },
    /// A rank has sent nothing for too long.
    #[error(
        "rank {rank} has sent nothing for {seconds} s, ten times what the longest trial took: its machine or the link to it does not answer; nastic \
         resume goes on from the last checkpoint"
    )]
    Silent {
        /// The rank.
        rank: usize,
        /// How long it was waited for.
        seconds: u64,
    },
    /// A message that is not the one that is due.
    #[error(
        "a message of rank {rank} is not the one that is due ({what}): do all ranks run the same program on the same case?"
    )]
    Unexpected {
        /// The rank.
        rank: usize,
        /// What is wrong with it.
        what: &'static str,
    },
    /// What passes the messages has failed.
    #[error("no messages pass between the ranks: {what}")]
    Transport {
        /// Its own words.
        what: String,
    },
}
