//! `checkpoint.bin` and its like: bytes that are complete and of this program, or refused.
//!
//! Layout, integers little-endian with 64 bits: the magic word, the version of the format, the length n of the content,
//! its checksum (FNV-1a), n bytes of content, which are a [`Saved`] value.

pub(crate) mod blocks;
pub(crate) mod case_record;
pub(crate) mod checkpoint;
pub(crate) mod motion_checkpoint;

use nastic_io::{Fingerprint, WriteError, write_atomically};
use nastic_opt::Saved;
use nastic_result::checkpoint_mark::MAGIC;
use nastic_result::files::Directory;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// The name of the file of an optimisation.
pub(crate) const NAME: &str = "checkpoint.bin";

const VERSION: u64 = 2;
const HEADER: usize = MAGIC.len() + 3 * 8;

/// Why a run cannot be resumed.
#[derive(Debug, Error)]
pub enum CheckpointError {
    /// There is no checkpoint.
    #[error(
        "{} has no checkpoint.bin: resume takes the output directory of an optimisation whose case does not \
         set output/checkpoint to 0, or of a motion that solve was stopped in",
        directory.display()
    )]
    Missing {
        /// Where one was looked for.
        directory: PathBuf,
    },
    /// It cannot be read.
    #[error("cannot read {}: {source}", file.display())]
    Read {
        /// The file.
        file: PathBuf,
        /// The system's answer.
        source: std::io::Error,
    },
    /// Another kind of file.
    #[error("{} is no checkpoint of nastic: it does not begin with \"nastic-checkpoint\"", file.display())]
    Foreign {
        /// The file.
        file: PathBuf,
    },
    /// Of another version of the format.
    #[error("{} is a checkpoint of format {found}, this program reads format {VERSION}: the version of nastic that wrote it can go on with it",
        file.display())]
    Version {
        /// The file.
        file: PathBuf,
        /// Its version.
        found: u64,
    },
    /// Shorter or longer than it says.
    #[error("{} is damaged: it has {found} bytes where it should have {expected}", file.display())]
    Length {
        /// The file.
        file: PathBuf,
        /// Its length in bytes.
        found: u64,
        /// What its header says.
        expected: u64,
    },
    /// Some bytes changed.
    #[error("{} is damaged: the checksum of its content is not the one it was written with", file.display())]
    Checksum {
        /// The file.
        file: PathBuf,
    },
    /// Whole, but not what this program wrote for this case.
    #[error("{} does not fit: {what}", file.display())]
    Content {
        /// The file.
        file: PathBuf,
        /// What is wrong.
        what: String,
    },
    /// Written by another version of the program, which may not give the same bits.
    #[error("{} was written by nastic {found}, this is nastic {}: use that version, or begin anew with nastic optimize --restart (nastic solve)",
        file.display(), env!("CARGO_PKG_VERSION"))]
    Program {
        /// The file.
        file: PathBuf,
        /// The version that wrote it.
        found: String,
    },
    /// Of an optimisation that a program runs without a case file.
    #[error("{} holds an optimisation of a program without a case file: that program goes on with it (Study::resume)", directory.display())]
    OfProgram {
        /// The output directory.
        directory: PathBuf,
    },
    /// The case, or a file it names, is another than when the optimisation began.
    #[error(
        "the case changed since the run in {} began: {}; put it back, or begin anew with nastic optimize --restart (nastic solve)",
        directory.display(),
        what.join("; ")
    )]
    Changed {
        /// The output directory.
        directory: PathBuf,
        /// What differs.
        what: Vec<String>,
    },
}

/// Writes content to a file of a directory; the earlier one stays until this one is complete.
pub(crate) fn write(directory: &Directory, name: &str, content: &[u8]) -> Result<(), WriteError> {
    write_atomically(directory.own(name)?, |out| {
        out.write_all(MAGIC)?;
        for number in [VERSION, content.len() as u64, Fingerprint::of_bytes(content)] {
            out.write_all(&number.to_le_bytes())?;
        }
        out.write_all(content)
    })
}

/// The value in a file of a directory.
pub(crate) fn read_value<T: Saved>(directory: &Path, name: &str) -> Result<T, CheckpointError> {
    let unfit = |what: String| CheckpointError::Content { file: directory.join(name), what };
    T::from_bytes(&read(directory, name)?).map_err(|error| unfit(error.to_string()))
}

/// The content of a file of a directory.
pub(crate) fn read(directory: &Path, name: &str) -> Result<Vec<u8>, CheckpointError> {
    let file = directory.join(name);
    let mut bytes = match std::fs::read(&file) {
        Ok(bytes) => bytes,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
            return Err(CheckpointError::Missing { directory: directory.to_owned() });
        }
        Err(source) => return Err(CheckpointError::Read { file, source }),
    };
    if !bytes.starts_with(&MAGIC[..MAGIC.len().min(bytes.len())]) {
        return Err(CheckpointError::Foreign { file });
    }
    let found = bytes.len() as u64;
    if bytes.len() < HEADER {
        return Err(CheckpointError::Length { file, found, expected: HEADER as u64 });
    }
    let number = |k: usize| {
        let mut word = [0; 8];
        word.copy_from_slice(&bytes[MAGIC.len() + 8 * k..][..8]);
        u64::from_le_bytes(word)
    };
    let (version, length, checksum) = (number(0), number(1), number(2));
    if version != VERSION {
        return Err(CheckpointError::Version { file, found: version });
    }
    let expected = length.saturating_add(HEADER as u64);
    if found != expected {
        return Err(CheckpointError::Length { file, found, expected });
    }
    bytes.drain(..HEADER);
    if Fingerprint::of_bytes(&bytes) != checksum {
        return Err(CheckpointError::Checksum { file });
    }
    Ok(bytes)
}

/// An entry of a result, as text: it leaves out what is absent, which only keys make up for.
pub(crate) mod json {
    use serde::de::{Deserialize, DeserializeOwned, Deserializer, Error as _};
    use serde::ser::{Error as _, Serialize, Serializer};

    pub fn serialize<T: Serialize, S: Serializer>(entry: &T, out: S) -> Result<S::Ok, S::Error> {
        out.serialize_str(&serde_json::to_string(entry).map_err(S::Error::custom)?)
    }

    pub fn deserialize<'de, T: DeserializeOwned, D: Deserializer<'de>>(input: D) -> Result<T, D::Error> {
        serde_json::from_str(&String::deserialize(input)?).map_err(D::Error::custom)
    }
}

/// Warnings of a run, in a checkpoint.
pub(crate) mod warnings {
    use super::json;
    use nastic_case::warning::Warning;
    use nastic_report::record::WarningRecord;
    use nastic_result::warning_record::{warning_of, warning_record};
    use serde::de::{Deserializer, Error as _};
    use serde::ser::Serializer;

    pub fn serialize<S: Serializer>(warnings: &[Warning], out: S) -> Result<S::Ok, S::Error> {
        json::serialize(&warnings.iter().map(warning_record).collect::<Vec<_>>(), out)
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(input: D) -> Result<Vec<Warning>, D::Error> {
        let records: Vec<WarningRecord> = json::deserialize(input)?;
        let known = records.into_iter().map(warning_of).collect::<Option<_>>();
        known.ok_or_else(|| D::Error::custom("a warning of no known kind"))
    }
}
