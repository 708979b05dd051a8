//! What is asked of results: why a run cannot be resumed, what a result misses.

pub use crate::saved::CheckpointError;
pub use nastic_case::expectation::{Missed, find};
