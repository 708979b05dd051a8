//! [`Cursor`]: reads forward through the sections of a legacy file.

use super::kind::Kind;
use crate::error::ReadError;
use crate::grid::{CORRUPT, Numbers};
use crate::source::{Source, brief};

/// Place in a file; every failure says where.
pub(super) struct Cursor<'a> {
    pub source: Source<'a>,
    position: usize,
    /// Start of the line, number or array read last: the place that errors name.
    pub mark: usize,
    /// The section being read, for messages.
    pub section: String,
}

impl<'a> Cursor<'a> {
    pub fn new(source: Source<'a>) -> Self {
        Self { source, position: 0, mark: 0, section: "the header".to_owned() }
    }

    /// Numbers are binary from here on.
    pub fn set_binary(&mut self) {
        self.source.binary = true;
    }

    fn rest(&self) -> &'a [u8] {
        &self.source.bytes[self.position..]
    }

    fn skip_space(&mut self) {
        let rest = self.rest();
        self.position += rest.iter().position(|byte| !byte.is_ascii_whitespace()).unwrap_or(rest.len());
        self.mark = self.position;
    }

    /// The rest of the line, without white space at its ends; nothing at the end of the file.
    pub fn line(&mut self) -> Option<String> {
        let rest = self.rest();
        self.mark = self.position;
        if rest.is_empty() {
            return None;
        }
        let length = rest.iter().position(|byte| *byte == b'\n').unwrap_or(rest.len());
        self.position += (length + 1).min(rest.len());
        Some(String::from_utf8_lossy(&rest[..length]).trim().to_owned())
    }

    /// The next word on this line or a later one.
    fn word(&mut self) -> &'a [u8] {
        self.skip_space();
        let rest = self.rest();
        let length = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
        self.position += length;
        &rest[..length]
    }

    /// The keyword of the next section, in capitals; nothing at the end of the file.
    pub fn section(&mut self) -> Result<Option<String>, ReadError> {
        let word = self.word();
        if word.is_empty() {
            return Ok(None);
        }
        let is_keyword = |byte: &u8| byte.is_ascii_alphanumeric() || *byte == b'_';
        if !word[0].is_ascii_alphabetic() || !word.iter().all(is_keyword) {
            let what =
                format!("expected a section such as CELL_DATA, found `{}`", brief(&String::from_utf8_lossy(word)));
            return Err(self.malformed(what, CORRUPT));
        }
        self.section = String::from_utf8_lossy(word).to_ascii_uppercase();
        Ok(Some(self.section.clone()))
    }

    /// Whether this word comes next; it is taken then.
    pub fn take_word(&mut self, wanted: &str) -> bool {
        let before = self.position;
        let found = self.word().eq_ignore_ascii_case(wanted.as_bytes());
        if !found {
            self.position = before;
        }
        found
    }

    /// The words up to the end of the line.
    pub fn words(&mut self) -> Vec<String> {
        self.line().unwrap_or_default().split_whitespace().map(str::to_owned).collect()
    }

    /// A count among the words of a section's line.
    pub fn count(&self, words: &[String], at: usize) -> Result<u64, ReadError> {
        let word = words.get(at).map_or("", String::as_str);
        word.parse().map_err(|_| self.malformed(format!("`{}` where a count was expected", brief(word)), CORRUPT))
    }

    /// A type among the words of a section's line.
    pub fn kind(&self, words: &[String], at: usize) -> Result<Kind, ReadError> {
        let word = words.get(at).map_or("", String::as_str);
        let advice = "use float, double or an integer type";
        Kind::named(word).ok_or_else(|| self.unsupported(format!("the type \"{}\"", brief(word)), advice))
    }

    /// The numbers of an array; refused where the rest of the file cannot hold them.
    pub fn numbers(&mut self, kind: Kind, count: u64) -> Result<Numbers, ReadError> {
        self.believe(kind, count)?;
        if self.source.binary {
            return self.binary(kind, count as usize);
        }
        if kind.is_integer() {
            self.parsed(count).map(Numbers::Integers)
        } else {
            self.parsed(count).map(Numbers::Reals)
        }
    }

    /// As [`numbers`](Self::numbers), where integers alone are meant.
    pub fn integers(&mut self, kind: Kind, count: u64) -> Result<Vec<i64>, ReadError> {
        match self.numbers(kind, count)? {
            Numbers::Integers(values) => Ok(values),
            Numbers::Reals(_) => Err(self.malformed("real numbers where integers were expected", CORRUPT)),
        }
    }

    /// Passes over an array.
    pub fn skip(&mut self, kind: Kind, count: u64) -> Result<(), ReadError> {
        self.believe(kind, count)?;
        match (self.source.binary, kind) {
            (false, Kind::Text) => (0..count).try_for_each(|_| self.line().map(drop).ok_or_else(|| self.short())),
            (false, _) => (0..count).try_for_each(|_| if self.word().is_empty() { Err(self.short()) } else { Ok(()) }),
            (true, Kind::Text) => (0..count).try_for_each(|_| self.skip_text()),
            (true, _) => {
                let bytes = kind.bytes(count).and_then(|bytes| usize::try_from(bytes).ok());
                self.take(bytes.unwrap_or(usize::MAX)).map(drop)
            }
        }
    }

    fn believe(&mut self, kind: Kind, count: u64) -> Result<(), ReadError> {
        let room = self.rest().len() as u64;
        // a number of text has a digit and a separator, of which the last needs none
        let needed =
            if self.source.binary { kind.bytes(count) } else { count.checked_mul(2).map(|n| n.saturating_sub(1)) };
        if needed.is_some_and(|needed| needed <= room) {
            return Ok(());
        }
        Err(self.malformed(format!("it claims {count} values, but only {room} bytes are left in the file"), CORRUPT))
    }

    fn parsed<T: std::str::FromStr>(&mut self, count: u64) -> Result<Vec<T>, ReadError> {
        let one = |_| {
            let word = self.word();
            if word.is_empty() {
                return Err(self.short());
            }
            let number = std::str::from_utf8(word).ok().and_then(|word| word.parse().ok());
            number.ok_or_else(|| {
                let found = String::from_utf8_lossy(word);
                self.malformed(format!("`{}` is not such a number", brief(&found)), CORRUPT)
            })
        };
        (0..count).map(one).collect()
    }

    fn take(&mut self, count: usize) -> Result<&'a [u8], ReadError> {
        self.mark = self.position;
        let taken = self.rest().get(..count).ok_or_else(|| self.short())?;
        self.position += count;
        Ok(taken)
    }

    fn binary(&mut self, kind: Kind, count: usize) -> Result<Numbers, ReadError> {
        let bytes = kind.bytes(count as u64).and_then(|bytes| usize::try_from(bytes).ok()).unwrap_or(usize::MAX);
        let bytes = self.take(bytes)?;
        let word = |chunk: &[u8]| chunk.iter().fold(0u64, |word, byte| word << 8 | u64::from(*byte));
        let words = |size: usize| bytes.chunks_exact(size).map(word);
        Ok(match kind {
            Kind::Bit => {
                let bit = |k: usize| i64::from(bytes[k / 8] >> (7 - k % 8) & 1);
                Numbers::Integers((0..count).map(bit).collect())
            }
            Kind::Real(4) => Numbers::Reals(words(4).map(|word| f64::from(f32::from_bits(word as u32))).collect()),
            Kind::Real(size) => Numbers::Reals(words(size).map(f64::from_bits).collect()),
            Kind::Unsigned(size) => {
                Numbers::Integers(words(size).map(|word| i64::try_from(word).unwrap_or(i64::MAX)).collect())
            }
            Kind::Signed(size) => {
                let unused = 64 - 8 * size as u32;
                Numbers::Integers(words(size).map(|word| ((word << unused) as i64) >> unused).collect())
            }
            Kind::Text => return Err(self.malformed("texts where numbers were expected", CORRUPT)),
        })
    }

    /// A text of a binary file: its length, in as many bytes as the first two bits say, before it.
    fn skip_text(&mut self) -> Result<(), ReadError> {
        let first = self.take(1)?[0];
        let more = match first >> 6 {
            3 => 0,
            2 => 1,
            1 => 3,
            _ => 7,
        };
        let rest = self.take(more)?;
        let length = rest.iter().fold(u64::from(first & 0x3f), |length, byte| length << 8 | u64::from(*byte));
        self.take(usize::try_from(length).unwrap_or(usize::MAX)).map(drop)
    }

    fn short(&self) -> ReadError {
        self.malformed("the file ends in it", CORRUPT)
    }

    pub fn malformed(&self, what: impl Into<String>, advice: &str) -> ReadError {
        self.source.malformed(self.mark, self.section.clone(), what, advice)
    }

    pub fn unsupported(&self, what: impl Into<String>, advice: &str) -> ReadError {
        self.source.unsupported(self.mark, self.section.clone(), what, advice)
    }
}
