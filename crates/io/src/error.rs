//! Errors of reading and of writing files, two types.

use std::fmt;
use std::path::{Path, PathBuf};

use nastic_mesh::MeshError;

/// Where in a file something was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum At {
    /// A line of a text file, from one.
    Line(u64),
    /// A byte of a binary file, from zero.
    Byte(u64),
}

impl fmt::Display for At {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            At::Line(line) => write!(f, "line {line}"),
            At::Byte(byte) => write!(f, "byte {byte}"),
        }
    }
}

/// A mesh or a result could not be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReadError {
    /// The file is missing, is a directory, or may not be read.
    #[error("cannot read {}: {source}", file.display())]
    Open {
        /// The file asked for.
        file: PathBuf,
        /// The system's answer.
        source: std::io::Error,
    },
    /// The name ends in none of `.msh`, `.vtu`, `.vtk`.
    #[error("{}: {}", file.display(), crate::other_format::advice(file))]
    Extension {
        /// The file asked for.
        file: PathBuf,
    },
    /// The name ends in none of `.csv`, `.npy`, `.ply`.
    #[error("{}: a point cloud is CSV, NPY or PLY; export it as CSV with the columns x,y,z", file.display())]
    CloudExtension {
        /// The file asked for.
        file: PathBuf,
    },
    /// The file breaks its own format: truncated, counts that lie, numbers out of range.
    #[error("{}, {at}, in {section}: {what}; {advice}", file.display())]
    Malformed {
        /// The file.
        file: PathBuf,
        /// The section or XML element, such as `$Nodes`.
        section: String,
        /// Line or byte.
        at: At,
        /// What was found.
        what: String,
        /// What to try.
        advice: String,
    },
    /// The file is sound, but holds what this program does not take (version, cell type, encoding).
    #[error("{}, {at}, in {section}: {what} is not supported; {advice}", file.display())]
    Unsupported {
        /// The file.
        file: PathBuf,
        /// The section or XML element.
        section: String,
        /// Line or byte.
        at: At,
        /// What was found, by name.
        what: String,
        /// What to try.
        advice: String,
    },
    /// An array that was asked for by name is not there.
    #[error("array \"{name}\" not found in {}; {has}", file.display())]
    Array {
        /// The file.
        file: PathBuf,
        /// The name asked for.
        name: String,
        /// A sentence that lists the arrays that are there.
        has: String,
    },
    /// The scale of lengths is not a positive finite number.
    #[error("{}: the scale of lengths is {scale}; it must be positive and finite, such as 1e-3 for millimetres", file.display())]
    Scale {
        /// The file it was meant for.
        file: PathBuf,
        /// The offending factor.
        scale: f64,
    },
    /// The file is sound, the mesh in it is not.
    #[error(transparent)]
    Mesh(#[from] MeshError),
}

/// A result could not be written (exit code 7 of the command line).
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WriteError {
    /// The system refused: no such directory, no permission, no space. Nothing half-written is left behind.
    #[error("cannot write {}: {source}", file.display())]
    System {
        /// The file that was to be written.
        file: PathBuf,
        /// The system's answer.
        source: std::io::Error,
    },
    /// What was to be written does not fit together, such as an array of the wrong length.
    #[error("cannot write {}: {what}; {advice}", file.display())]
    Content {
        /// The file that was to be written.
        file: PathBuf,
        /// What does not fit, with the sizes found and wanted.
        what: String,
        /// What to try.
        advice: String,
    },
}

impl WriteError {
    pub(crate) fn system(file: &Path, source: std::io::Error) -> Self {
        WriteError::System { file: file.to_owned(), source }
    }

    pub(crate) fn content(file: &Path, what: impl Into<String>, advice: impl Into<String>) -> Self {
        WriteError::Content { file: file.to_owned(), what: what.into(), advice: advice.into() }
    }
}
