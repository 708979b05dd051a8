//! Parser of case files: JSON with comments and trailing commas, nodes with their positions, overrides, diagnostics.

mod diagnostic;
mod document;
mod node;
mod parse;
mod path;
mod setting;

pub(crate) mod nearest;
mod quote;

pub use diagnostic::{Diagnostic, Diagnostics};
pub use document::Document;
pub use nearest::nearest;
pub use node::{Node, Property, SourcePosition, Value};
pub use path::At;
pub use quote::quoted;
pub use setting::Setting;
