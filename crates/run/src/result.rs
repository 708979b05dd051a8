//! What commands leave behind: `result.json`, snapshots, pictures.

pub(crate) mod collections;
pub(crate) mod controls;
pub(crate) mod convergence;
pub(crate) mod failure;
pub(crate) mod files;
pub(crate) mod inspection;
pub(crate) mod listed;
pub(crate) mod member_report;
pub(crate) mod picture;
pub(crate) mod smoothing;
pub(crate) mod snapshot;
pub(crate) mod summary;
pub(crate) mod target_files;
pub(crate) mod title;
pub(crate) mod warning_record;

pub use crate::saved::CheckpointError;
pub use nastic_case::expectation::{Missed, find};
