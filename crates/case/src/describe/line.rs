//! Lines under headings.

/// A line under a heading.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Line {
    /// The heading, which is said once over lines that follow each other.
    pub head: &'static str,
    /// The text.
    pub text: String,
}

/// A line.
pub fn line(head: &'static str, text: impl Into<String>) -> Line {
    Line { head, text: text.into() }
}
