//! What lowering carries along: the document, and everything found on the way.

use crate::quantity::Units;
use crate::syntax::{At, Diagnostic, Diagnostics, Document};
use std::path::PathBuf;

pub(super) struct Context<'a> {
    pub document: &'a Document,
    pub units: Units,
    pub warnings: Vec<Diagnostic>,
    pub notes: Vec<String>,
    pub files: Vec<PathBuf>,
    problems: Vec<Diagnostic>,
}

impl<'a> Context<'a> {
    pub fn new(document: &'a Document, units: Units) -> Self {
        Self { document, units, warnings: vec![], notes: vec![], files: vec![], problems: vec![] }
    }

    /// Notes a problem at a path of the case.
    pub fn complain(&mut self, at: &At, message: impl ToString) {
        self.problems.push(self.document.complain(at, message.to_string()));
    }

    /// Notes what deserves attention but does not stop anything.
    pub fn warn(&mut self, at: &At, message: impl ToString) {
        self.warnings.push(self.document.complain(at, message.to_string()));
    }

    /// The value, or a complaint.
    pub fn take<T>(&mut self, at: &At, result: Result<T, impl ToString>) -> Option<T> {
        result.map_err(|error| self.complain(at, error)).ok()
    }

    /// The place of a file named in the case, which is noted as read.
    pub fn file(&mut self, name: &str) -> PathBuf {
        let path = self.document.resolve(name);
        if !self.files.contains(&path) {
            self.files.push(path.clone());
        }
        path
    }

    pub fn is_sound(&self) -> bool {
        self.problems.is_empty()
    }

    pub fn into_problems(self) -> Diagnostics {
        Diagnostics::new(self.problems)
    }
}
