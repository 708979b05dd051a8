//! [`Source`]: the file being read, for messages that say where.

use std::path::Path;

use crate::error::{At, ReadError};

/// The file being read: its name and its bytes.
#[derive(Clone, Copy)]
pub(crate) struct Source<'a> {
    pub file: &'a Path,
    pub bytes: &'a [u8],
    /// Whether places are bytes, and not lines.
    pub binary: bool,
}

impl<'a> Source<'a> {
    /// Of a text file.
    pub fn new(file: &'a Path, bytes: &'a [u8]) -> Self {
        Self { file, bytes, binary: false }
    }

    /// Where a byte is.
    fn at(&self, byte: usize) -> At {
        if self.binary {
            return At::Byte(byte as u64);
        }
        let before = &self.bytes[..byte.min(self.bytes.len())];
        At::Line(before.iter().filter(|byte| **byte == b'\n').count() as u64 + 1)
    }

    pub fn malformed(
        &self,
        byte: usize,
        section: impl Into<String>,
        what: impl Into<String>,
        advice: impl Into<String>,
    ) -> ReadError {
        ReadError::Malformed {
            file: self.file.to_owned(),
            section: section.into(),
            at: self.at(byte),
            what: what.into(),
            advice: advice.into(),
        }
    }

    pub fn unsupported(
        &self,
        byte: usize,
        section: impl Into<String>,
        what: impl Into<String>,
        advice: impl Into<String>,
    ) -> ReadError {
        ReadError::Unsupported {
            file: self.file.to_owned(),
            section: section.into(),
            at: self.at(byte),
            what: what.into(),
            advice: advice.into(),
        }
    }
}

/// The start of a text, printable and short enough for a message.
pub(crate) fn brief(text: &str) -> String {
    text.chars().take(40).map(|c| if c.is_control() { '?' } else { c }).collect()
}
