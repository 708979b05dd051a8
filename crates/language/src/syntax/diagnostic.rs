//! Errors of case files.

use std::fmt;
use thiserror::Error;

/// One problem: what, where, and what would be right.
#[derive(Clone, PartialEq, Eq, Debug, Error)]
pub struct Diagnostic {
    /// The file as the user named it, or the `--set` option the value came from.
    pub file: String,
    /// Path of the block or key: `materials/0/mu1`; empty for the file as a whole.
    pub path: String,
    /// Line from 1; 0 where there is none.
    pub line: usize,
    /// Column from 1, in characters; 0 where there is none.
    pub column: usize,
    /// The problem.
    pub message: String,
}

impl Diagnostic {
    /// Where it is: `case.json:12:5: materials/0/mu1`.
    #[must_use]
    pub fn place(&self) -> String {
        let mut out = self.file.clone();
        if self.line > 0 {
            out += &format!(":{}:{}", self.line, self.column);
        }
        if !self.path.is_empty() {
            out += ": ";
            out.extend(self.path.chars().filter(|c| !c.is_control()));
        }
        out
    }
}

/// `case.json:12:5: materials/0/mu1: unit of the wrong kind ...`
impl fmt::Display for Diagnostic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.place(), self.message)
    }
}

/// The problems of a case, in the order of its lines, at most [`MOST`](Self::MOST) of them; never empty as an error.
#[derive(Clone, PartialEq, Eq, Debug, Default, Error)]
pub struct Diagnostics {
    list: Vec<Diagnostic>,
    more: bool,
}

impl Diagnostics {
    /// Problems that are reported at once: nobody reads more, and a generated file may have a hundred thousand.
    pub const MOST: usize = 100;

    /// In the order of lines, each problem once, at the deepest of its paths.
    #[must_use]
    pub fn new(mut list: Vec<Diagnostic>) -> Self {
        list.sort_by_key(|problem| (problem.line, problem.column));
        let mut kept: Vec<Diagnostic> = Vec::new();
        let mut more = false;
        for problem in list {
            if kept.contains(&problem) {
                continue;
            }
            if kept.len() == Self::MOST {
                more = true;
                break;
            }
            kept.push(problem);
        }
        let deeper = |one: &Diagnostic, other: &Diagnostic| {
            let inside = other.path.strip_prefix(&one.path).is_some_and(|rest| rest.starts_with('/'));
            inside && (&one.file, &one.message) == (&other.file, &other.message)
        };
        let told_deeper: Vec<bool> = kept.iter().map(|one| kept.iter().any(|other| deeper(one, other))).collect();
        let mut told_deeper = told_deeper.into_iter();
        kept.retain(|_| !told_deeper.next().unwrap_or_default());
        Self { list: kept, more }
    }

    /// The problems.
    #[must_use]
    pub fn list(&self) -> &[Diagnostic] {
        &self.list
    }

    /// Whether there are more problems than those of the list.
    #[must_use]
    pub fn has_more(&self) -> bool {
        self.more
    }

    /// True if nothing is wrong.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// `Err(self)` unless empty.
    ///
    /// # Errors
    ///
    /// Itself.
    pub fn into_result(self) -> Result<(), Self> {
        if self.list.is_empty() { Ok(()) } else { Err(self) }
    }
}

impl From<Diagnostic> for Diagnostics {
    fn from(one: Diagnostic) -> Self {
        Self { list: vec![one], more: false }
    }
}

/// One line per problem.
impl fmt::Display for Diagnostics {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, problem) in self.list.iter().enumerate() {
            if i > 0 {
                f.write_str("\n")?;
            }
            write!(f, "{problem}")?;
        }
        if self.more {
            write!(f, "\nthere are more problems than these {}", self.list.len())?;
        }
        Ok(())
    }
}
