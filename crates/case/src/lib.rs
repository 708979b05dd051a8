//! Case files: schema, units, lowering into builder calls, runs and results.
//!
//! A case is read in three steps: [`syntax`] turns text into nodes that know their line, [`schema`] turns nodes into
//! typed blocks, and [`expression`] and [`quantity`] give every text with a unit its number in the case's own system.
//! All problems of a file are reported at once, each with its path and line.

pub mod catalogue;
pub mod console;
pub mod expression;
pub mod history;
pub mod lower;
pub(crate) mod number;
pub(crate) mod pace;
pub mod quantity;
pub mod result;
pub mod run;
pub mod schema;
pub mod signals;
pub mod syntax;
pub mod template;
pub mod warning;
