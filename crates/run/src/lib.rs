//! The commands on a case, as functions of a library, and what they leave behind.

pub mod history;
pub mod result;
pub mod run;
mod saved;

pub mod signals;

/// What is said, and results as values.
pub use nastic_report::{console, record};
