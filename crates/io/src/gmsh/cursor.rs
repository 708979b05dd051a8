//! Sequential reader of a Gmsh file: numbers and words at the present position, in text or binary.

use std::path::Path;

use crate::error::{At, ReadError};

/// How the numbers of a section are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    Text,
    /// Binary; `swap` when the file's byte order is not little-endian.
    Binary {
        swap: bool,
    },
}

const CORRUPT: &str = "the file is truncated or corrupt: write it again from Gmsh";

/// Reads forward through the bytes of a file; every failure says where.
pub(super) struct Cursor<'a> {
    file: &'a Path,
    bytes: &'a [u8],
    position: usize,
    /// Start of the number or line read last: the place that errors name.
    mark: usize,
    encoding: Encoding,
    /// Name of the current section with its dollar sign.
    section: String,
}

impl<'a> Cursor<'a> {
    pub fn new(file: &'a Path, bytes: &'a [u8]) -> Self {
        let section = "the file header".to_owned();
        Self { file, bytes, position: 0, mark: 0, encoding: Encoding::Text, section }
    }

    pub fn set_encoding(&mut self, encoding: Encoding) {
        self.encoding = encoding;
    }

    pub fn is_binary(&self) -> bool {
        self.encoding != Encoding::Text
    }

    /// Enters the next section and returns its name without the dollar sign; `None` at the end of the file.
    pub fn next_section(&mut self) -> Result<Option<String>, ReadError> {
        self.skip_space();
        if self.remaining() == 0 {
            return Ok(None);
        }
        let line = self.line()?;
        let Some(name) = line.strip_prefix('$').filter(|name| !name.is_empty() && !name.starts_with("End")) else {
            return Err(self.malformed(
                format!("expected the start of a section such as $Nodes, found `{}`", brief(&line)),
                "the section before it may hold more entries than its count says; write the file again from Gmsh",
            ));
        };
        self.section = format!("${name}");
        Ok(Some(name.to_owned()))
    }

    /// Checks that the section ends here.
    pub fn end_section(&mut self) -> Result<(), ReadError> {
        self.skip_space();
        let wanted = format!("$End{}", self.section.trim_start_matches('$'));
        if self.remaining() == 0 {
            return Err(self.malformed(format!("the file ends before {wanted}"), CORRUPT));
        }
        let line = self.line()?;
        if line != wanted {
            return Err(self.malformed(
                format!("expected {wanted}, found `{}`", brief(&line)),
                "the section holds more entries than its count says; write the file again from Gmsh",
            ));
        }
        Ok(())
    }

    /// Goes to the end line of a section nobody here needs.
    pub fn skip_section(&mut self) -> Result<(), ReadError> {
        let wanted = format!("$End{}", self.section.trim_start_matches('$'));
        let body = &self.bytes[self.position..];
        let found = body
            .windows(wanted.len())
            .enumerate()
            .position(|(at, window)| window == wanted.as_bytes() && (at == 0 || body[at - 1] == b'\n'));
        match found {
            Some(at) => {
                self.position += at;
                Ok(())
            }
            None => Err(self.malformed(format!("the file ends before {wanted}"), CORRUPT)),
        }
    }

    /// The rest of the current line as text, without white space at its ends.
    pub fn line(&mut self) -> Result<String, ReadError> {
        self.mark = self.position;
        let body = &self.bytes[self.position..];
        let length = body.iter().position(|byte| *byte == b'\n').unwrap_or(body.len());
        self.position += (length + 1).min(body.len());
        match std::str::from_utf8(&body[..length]) {
            Ok(text) => Ok(text.trim().to_owned()),
            Err(_) => Err(self.malformed("this line is not text (UTF-8)", CORRUPT)),
        }
    }

    /// A number in text, whatever the encoding of the section: counts of format 2.2 are stored so.
    pub fn text_count(&mut self, of: &str, bytes_each: usize) -> Result<usize, ReadError> {
        let line = self.line()?;
        let claimed = line
            .parse::<u64>()
            .map_err(|_| self.malformed(format!("the number of {of} is `{}`", brief(&line)), CORRUPT))?;
        self.believe(claimed, of, bytes_each)
    }

    /// A count of entries that take at least `numbers` numbers each: refused when the rest of the file cannot
    /// hold them, so that nobody allocates for a count that lies.
    pub fn count(&mut self, of: &str, numbers: usize) -> Result<usize, ReadError> {
        let claimed = self.size()?;
        let bytes_each = if self.is_binary() { 4 * numbers } else { 2 * numbers };
        self.believe(claimed, of, bytes_each)
    }

    fn believe(&self, claimed: u64, of: &str, bytes_each: usize) -> Result<usize, ReadError> {
        // The last number of a text file needs no separator.
        let room = (self.remaining() + 1) as u64;
        let needed = claimed.checked_mul(bytes_each.max(1) as u64);
        match needed {
            Some(needed) if needed <= room => Ok(claimed as usize),
            _ => Err(self.malformed(
                format!("the file claims {claimed} {of}, but only {} bytes are left in it", self.remaining()),
                CORRUPT,
            )),
        }
    }

    /// A 32-bit integer.
    pub fn int(&mut self) -> Result<i32, ReadError> {
        match self.encoding {
            Encoding::Text => self.parse("an integer"),
            Encoding::Binary { swap } => {
                let bytes = self.take::<4>("an integer")?;
                Ok(if swap { i32::from_be_bytes(bytes) } else { i32::from_le_bytes(bytes) })
            }
        }
    }

    /// An unsigned 64-bit integer: counts and tags of format 4.1.
    pub fn size(&mut self) -> Result<u64, ReadError> {
        match self.encoding {
            Encoding::Text => self.parse("a count or tag"),
            Encoding::Binary { swap } => {
                let bytes = self.take::<8>("a count or tag")?;
                Ok(if swap { u64::from_be_bytes(bytes) } else { u64::from_le_bytes(bytes) })
            }
        }
    }

    /// A tag of format 2.2: not negative.
    pub fn tag(&mut self, of: &str) -> Result<u64, ReadError> {
        let tag = self.int()?;
        u64::try_from(tag).map_err(|_| self.malformed(format!("{of} {tag} is negative"), CORRUPT))
    }

    /// A real number, finite or not.
    pub fn real(&mut self) -> Result<f64, ReadError> {
        match self.encoding {
            Encoding::Text => self.parse("a real number"),
            Encoding::Binary { swap } => {
                let bytes = self.take::<8>("a real number")?;
                Ok(if swap { f64::from_be_bytes(bytes) } else { f64::from_le_bytes(bytes) })
            }
        }
    }

    /// Reads and drops real numbers.
    pub fn skip_reals(&mut self, count: usize) -> Result<(), ReadError> {
        (0..count).try_for_each(|_| self.real().map(|_| ()))
    }

    fn take<const N: usize>(&mut self, what: &str) -> Result<[u8; N], ReadError> {
        self.mark = self.position;
        match self.bytes[self.position..].first_chunk::<N>() {
            Some(chunk) => {
                self.position += N;
                Ok(*chunk)
            }
            None => Err(self.malformed(format!("expected {what}, but the file ends"), CORRUPT)),
        }
    }

    fn parse<T: std::str::FromStr>(&mut self, what: &str) -> Result<T, ReadError> {
        self.skip_space();
        self.mark = self.position;
        let body = &self.bytes[self.position..];
        if body.is_empty() {
            return Err(self.malformed(format!("expected {what}, but the file ends"), CORRUPT));
        }
        let length = body.iter().position(u8::is_ascii_whitespace).unwrap_or(body.len());
        let word = &body[..length];
        match std::str::from_utf8(word).ok().and_then(|word| word.parse().ok()) {
            Some(number) => {
                self.position += length;
                Ok(number)
            }
            None => {
                let found = String::from_utf8_lossy(&word[..length.min(80)]).into_owned();
                Err(self.malformed(format!("expected {what}, found `{}`", brief(&found)), CORRUPT))
            }
        }
    }

    fn skip_space(&mut self) {
        let body = &self.bytes[self.position..];
        self.position += body.iter().position(|byte| !byte.is_ascii_whitespace()).unwrap_or(body.len());
        self.mark = self.position;
    }

    fn remaining(&self) -> usize {
        self.bytes.len() - self.position
    }

    fn at(&self) -> At {
        match self.encoding {
            Encoding::Text => {
                let before = &self.bytes[..self.mark];
                At::Line(before.iter().filter(|byte| **byte == b'\n').count() as u64 + 1)
            }
            Encoding::Binary { .. } => At::Byte(self.mark as u64),
        }
    }

    pub fn malformed(&self, what: impl Into<String>, advice: impl Into<String>) -> ReadError {
        ReadError::Malformed {
            file: self.file.to_owned(),
            section: self.section.clone(),
            at: self.at(),
            what: what.into(),
            advice: advice.into(),
        }
    }

    pub fn unsupported(&self, what: impl Into<String>, advice: impl Into<String>) -> ReadError {
        ReadError::Unsupported {
            file: self.file.to_owned(),
            section: self.section.clone(),
            at: self.at(),
            what: what.into(),
            advice: advice.into(),
        }
    }
}

/// The start of a text, short enough for a message.
fn brief(text: &str) -> String {
    const LONGEST: usize = 40;
    let printable = text.chars().map(|c| if c.is_control() { '?' } else { c });
    let more = if text.chars().nth(LONGEST).is_some() { "..." } else { "" };
    printable.take(LONGEST).chain(more.chars()).collect()
}
