//! The commands on a case, as functions of a library, and what they leave behind.

pub mod console;
pub mod history;
pub(crate) mod pace;
pub mod result;
pub mod run;

/// Results as values.
pub use nastic_report::record;
pub mod signals;
