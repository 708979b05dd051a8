//! The language of case files: syntax, units, expressions, schema.
//!
//! A case is read in three steps: [`syntax`] turns text into nodes that know their line, [`schema`] turns nodes into
//! typed blocks, and [`expression`] and [`quantity`] give every text with a unit its number in the case's own system.
//! All problems of a file are reported at once, each with its path and line.

pub mod catalogue;
pub mod expression;
pub mod number;
pub mod quantity;
pub mod schema;
pub mod syntax;
pub mod template;
