//! What commands leave behind: the entries of `result.json`, snapshots, pictures, and the directory they are in.
//!
//! [`describe`] says what the case is, [`summary`] and [`member_report`] what is in a state, [`inspection`] what is wrong with it,
//! [`failure`] why there is none; all go to files by [`files::Directory`].

pub mod checkpoint_mark;
pub mod collections;
pub mod controls;
pub mod convergence;
pub mod cut_design;
pub mod describe;
mod error;
pub mod failure;
pub mod files;
pub mod inspection;
mod least_widths;
pub mod listed;
pub mod made_body;
pub mod member_report;
pub mod picture;
pub mod smoothing;
pub mod snapshot;
pub mod summary;
pub mod target_files;
pub mod title;
pub mod warning_record;

pub use error::ResultError;
