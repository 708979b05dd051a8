//! Lines under headings.

/// A line under a heading.
pub(crate) struct Line {
    pub head: &'static str,
    pub text: String,
}

pub(crate) fn line(head: &'static str, text: impl Into<String>) -> Line {
    Line { head, text: text.into() }
}
