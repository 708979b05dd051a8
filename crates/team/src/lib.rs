//! Ranks that share out numbered members: who owns which, messages between them, sums whose bits do not depend on the number of ranks.
//!
//! A [`Team`] only passes bytes from one rank to another; [`Alone`] has one rank, [`ThreadRank`] is one of many in one process, and other
//! crates may add processes. All else stands on these messages and is written once: [`exchange`], [`gather`], [`broadcast`],
//! [`sum`] along the binary tree of the members' numbers.
//!
//! ```
//! use nastic_team::{Shares, sum, threads};
//!
//! // the members 0..5, whose vectors are [1], [2], .., on three ranks
//! let sums = threads::run(3, &Default::default(), |rank| {
//!     let shares = Shares::even(5, 3);
//!     sum(&rank, &shares, 1, |member| Some(vec![member as f64 + 1.0]))
//! });
//! assert!(sums.into_iter().all(|sum| sum == Ok(vec![15.0])));
//! ```

mod alone;
mod collective;
mod error;
mod shares;
mod team;
pub mod threads;
mod tree;

pub use alone::Alone;
pub use collective::{broadcast, exchange, gather};
pub use error::TeamError;
pub use shares::Shares;
pub use team::Team;
pub use threads::ThreadRank;
pub use tree::{messages_of_sum, sum, sum_alone};
