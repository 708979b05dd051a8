//! The commands on a case, as functions of a library, and what they leave behind.

pub mod console;
pub mod history;
pub(crate) mod pace;
pub mod result;
pub mod run;
pub mod signals;
