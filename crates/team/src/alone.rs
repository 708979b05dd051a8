//! [`Alone`]: the team of a serial program.

use crate::error::TeamError;
use crate::team::Team;
use std::time::Duration;

/// One rank, which has nobody to talk to.
#[derive(Clone, Copy, Debug, Default)]
pub struct Alone;

impl Team for Alone {
    fn rank(&self) -> usize {
        0
    }

    fn size(&self) -> usize {
        1
    }

    fn send(&self, to: usize, _: Vec<u8>) -> Result<(), TeamError> {
        Err(TeamError::Lost { rank: to })
    }

    fn receive(&self, from: usize) -> Result<Vec<u8>, TeamError> {
        Err(TeamError::Lost { rank: from })
    }

    fn wait_at_most(&self, _: Duration) {}
}
