//! What is saved, as bytes, and read back: checkpoints, points, and what ranks tell each other.
//!
//! Values derive serde's traits; their bytes are those of [postcard](https://postcard.jamesmunns.com/wire-format), which stores a number by its
//! bits, little-endian, and a list behind its length.

use serde::de::DeserializeOwned;
use serde::ser::Serialize;
use thiserror::Error;

/// Bytes that are not what was to be read.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum SavedError {
    /// Another kind of value, or another version of it.
    #[error("not a saved run of this version (it does not begin with {expected:?})")]
    Kind {
        /// What they should begin with.
        expected: &'static str,
    },
    /// They are too short, too long, or hold a field with an impossible value.
    #[error("the saved run is damaged at byte {at} of {length}: {what}")]
    Damaged {
        /// Where.
        at: usize,
        /// How many bytes there are.
        length: usize,
        /// What is wrong.
        what: String,
    },
    /// Complete, but of another problem.
    #[error("the saved run is of another problem: {0}")]
    Unfit(&'static str),
}

/// A value that is saved on its own: its bytes begin with what it is.
pub trait Saved: Serialize + DeserializeOwned {
    /// Kind and version, which changes with the fields.
    const KIND: &'static str;

    /// Its bytes.
    fn to_bytes(&self) -> Vec<u8> {
        [Self::KIND.as_bytes(), &pack(self)].concat()
    }

    /// Reads what [`to_bytes`](Self::to_bytes) wrote; trusts no length beyond the bytes that are there.
    ///
    /// # Errors
    /// Bytes of something else, truncated or damaged ones.
    fn from_bytes(bytes: &[u8]) -> Result<Self, SavedError> {
        unpack(bytes.strip_prefix(Self::KIND.as_bytes()).ok_or(SavedError::Kind { expected: Self::KIND })?)
    }
}

/// The bytes of a value alone.
pub fn pack(value: &(impl Serialize + ?Sized)) -> Vec<u8> {
    let bytes = postcard::to_allocvec(value);
    debug_assert!(bytes.is_ok(), "{bytes:?}: a list of unknown length, or a field that is left out");
    bytes.unwrap_or_default()
}

/// Reads what [`pack`] wrote, to its end.
///
/// # Errors
/// [`SavedError::Damaged`].
pub fn unpack<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, SavedError> {
    let mut input = postcard::Deserializer::from_bytes(bytes);
    let value = T::deserialize(&mut input);
    let at = bytes.len() - input.finalize().map_or(0, <[u8]>::len);
    let damaged = |what: String| SavedError::Damaged { at, length: bytes.len(), what };
    match value {
        Ok(value) if at == bytes.len() => Ok(value),
        Ok(_) => Err(damaged("more bytes than expected".to_owned())),
        Err(postcard::Error::DeserializeUnexpectedEnd) => Err(damaged("they end early".to_owned())),
        Err(error) => Err(damaged(error.to_string())),
    }
}
