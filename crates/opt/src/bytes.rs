//! Saved runs and points as little-endian bytes: numbers as they are, lists with their length first.

use thiserror::Error;

/// Bytes that are not a saved run, or not a saved point.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum SavedRunError {
    /// Another kind of file, or another version of it.
    #[error("not a saved run of this version (it does not begin with {expected:?})")]
    Magic {
        /// What it should begin with.
        expected: &'static str,
    },
    /// It ends early, or its counts lie.
    #[error("the saved run is damaged at byte {at}: {needed} more bytes are needed, {left} are left")]
    Truncated {
        /// Where.
        at: usize,
        /// How many bytes were to be read.
        needed: usize,
        /// How many there were.
        left: usize,
    },
    /// A field with an impossible value.
    #[error("the saved run is damaged at byte {at}: {what}")]
    Damaged {
        /// Where.
        at: usize,
        /// What is wrong.
        what: &'static str,
    },
}

/// Appends numbers and lists.
#[derive(Clone, Debug)]
pub struct Writer(Vec<u8>);

impl Writer {
    /// Begins with a magic word: kind and version of the bytes.
    pub fn new(magic: &'static str) -> Self {
        Self(magic.as_bytes().to_vec())
    }

    /// A count.
    pub fn count(&mut self, n: usize) {
        self.0.extend((n as u64).to_le_bytes());
    }

    /// A number.
    pub fn float(&mut self, x: f64) {
        self.0.extend(x.to_le_bytes());
    }

    /// A list of numbers.
    pub fn floats(&mut self, v: &[f64]) {
        self.count(v.len());
        v.iter().for_each(|x| self.float(*x));
    }

    /// A list of bytes.
    pub fn bytes(&mut self, v: &[u8]) {
        self.count(v.len());
        self.0.extend(v);
    }

    /// What was written.
    pub fn finish(self) -> Vec<u8> {
        self.0
    }
}

/// Reads what a [`Writer`] wrote; never trusts a count beyond the bytes that are there.
#[derive(Clone, Debug)]
pub struct Reader<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Reader<'a> {
    /// From behind the magic word.
    ///
    /// # Errors
    /// They do not begin with it.
    pub fn new(bytes: &'a [u8], magic: &'static str) -> Result<Self, SavedRunError> {
        match bytes.starts_with(magic.as_bytes()) {
            true => Ok(Self { bytes, at: magic.len() }),
            false => Err(SavedRunError::Magic { expected: magic }),
        }
    }

    /// Whether all bytes were read.
    ///
    /// # Errors
    /// There are more.
    pub fn finish(&self) -> Result<(), SavedRunError> {
        if self.at == self.bytes.len() { Ok(()) } else { Err(self.damaged("more bytes than expected")) }
    }

    /// The error of an impossible value that was read last.
    pub fn damaged(&self, what: &'static str) -> SavedRunError {
        SavedRunError::Damaged { at: self.at, what }
    }

    fn take(&mut self, n: usize) -> Result<&'a [u8], SavedRunError> {
        let left = self.bytes.len() - self.at;
        if n > left {
            return Err(SavedRunError::Truncated { at: self.at, needed: n, left });
        }
        self.at += n;
        Ok(&self.bytes[self.at - n..self.at])
    }

    fn word(&mut self) -> Result<[u8; 8], SavedRunError> {
        let mut word = [0; 8];
        word.copy_from_slice(self.take(8)?);
        Ok(word)
    }

    /// A count of nothing that follows.
    ///
    /// # Errors
    /// The bytes end, or it is larger than this machine counts.
    pub fn number(&mut self) -> Result<usize, SavedRunError> {
        let at = self.at;
        usize::try_from(u64::from_le_bytes(self.word()?))
            .map_err(|_| SavedRunError::Damaged { at, what: "a huge count" })
    }

    /// A count of items of at least `size` bytes each, which must be there.
    ///
    /// # Errors
    /// They are not.
    pub fn count(&mut self, size: usize) -> Result<usize, SavedRunError> {
        let n = self.number()?;
        let left = self.bytes.len() - self.at;
        match n.checked_mul(size) {
            Some(needed) if needed <= left => Ok(n),
            needed => Err(SavedRunError::Truncated { at: self.at, needed: needed.unwrap_or(usize::MAX), left }),
        }
    }

    /// A count that is 0 or 1.
    ///
    /// # Errors
    /// The bytes end, or it is another.
    pub fn flag(&mut self) -> Result<bool, SavedRunError> {
        match self.number()? {
            0 => Ok(false),
            1 => Ok(true),
            _ => Err(SavedRunError::Damaged { at: self.at - 8, what: "a flag that is neither 0 nor 1" }),
        }
    }

    /// A number.
    ///
    /// # Errors
    /// The bytes end.
    pub fn float(&mut self) -> Result<f64, SavedRunError> {
        Ok(f64::from_le_bytes(self.word()?))
    }

    /// A list of numbers.
    ///
    /// # Errors
    /// The bytes end.
    pub fn floats(&mut self) -> Result<Vec<f64>, SavedRunError> {
        (0..self.count(8)?).map(|_| self.float()).collect()
    }

    /// A list of bytes.
    ///
    /// # Errors
    /// The bytes end.
    pub fn list(&mut self) -> Result<Vec<u8>, SavedRunError> {
        let n = self.count(1)?;
        Ok(self.take(n)?.to_vec())
    }

    /// A list of bytes that are text.
    ///
    /// # Errors
    /// They are not.
    pub fn text(&mut self) -> Result<String, SavedRunError> {
        let at = self.at;
        String::from_utf8(self.list()?).map_err(|_| SavedRunError::Damaged { at, what: "text that is not UTF-8" })
    }
}
