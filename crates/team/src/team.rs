//! [`Team`]: ranks that pass messages.

use crate::error::TeamError;
use std::fmt::Debug;
use std::time::Duration;

/// One of several ranks that run the same program on the same data, each on its own members. It passes bytes; what is made of them stands on these methods,
/// so that every team has the same messages and the same bits.
///
/// Messages of one rank to another arrive in the order in which they were sent. Once a method has failed all later calls fail.
pub trait Team: Debug + Send + Sync {
    /// The number of this rank, below [`size`](Self::size).
    fn rank(&self) -> usize;

    /// How many ranks there are.
    fn size(&self) -> usize;

    /// Sends a message, whether the other waits for it or not.
    ///
    /// # Errors
    /// The other has ended.
    fn send(&self, to: usize, message: Vec<u8>) -> Result<(), TeamError>;

    /// Waits for the next message of another rank.
    ///
    /// # Errors
    /// The other has ended, or nothing came for longer than [`wait_at_most`](Self::wait_at_most) allows.
    fn receive(&self, from: usize) -> Result<Vec<u8>, TeamError>;

    /// How long messages are waited for from now on; at first for ever.
    fn wait_at_most(&self, limit: Duration);

    /// Whether this is the rank that speaks, and writes what belongs to no member.
    fn leads(&self) -> bool {
        self.rank() == 0
    }
}
