//! Meshes from input files of Abaqus and CalculiX, `.inp`.
//!
//! * Read: `*NODE`, `*ELEMENT`, `*NSET`, `*ELSET` (`GENERATE` too), `*SURFACE`, parts and their instances. Everything else is
//!   named in a note.
//! * Sets of solid elements become regions; surfaces, and sets of elements that are faces of those, surfaces; sets of nodes
//!   node sets. Sets of a part are called `INSTANCE.SET` where there are several instances.
//! * Work and memory are bounded by the file's length, copies by instances and members of sets by counts.

mod element;
mod lines;
mod mesh;
mod model;
mod place;
mod read;
mod sets;

use nastic_mesh::Mesh;
use std::path::Path;

use crate::error::ReadError;
use read::Reader;

/// Reads the mesh of an input file of Abaqus or CalculiX, all lengths multiplied by `scale`. What was passed over is in [`Mesh::notes`].
///
/// # Errors
/// [`ReadError`]: the line and what to try.
pub fn read_abaqus(path: impl AsRef<Path>, scale: f64) -> Result<Mesh, ReadError> {
    let path = path.as_ref();
    let bytes = std::fs::read(path).map_err(|source| ReadError::Open { file: path.to_owned(), source })?;
    parse_abaqus(path, &bytes, scale)
}

/// Reads the mesh from the bytes of such a file; `file` is the name that errors and the mesh bear.
///
/// # Errors
/// As [`read_abaqus`].
pub fn parse_abaqus(file: impl AsRef<Path>, bytes: &[u8], scale: f64) -> Result<Mesh, ReadError> {
    let file = file.as_ref();
    crate::check_scale(file, scale)?;
    let text = String::from_utf8_lossy(bytes);
    let mut reader = Reader::new(file, &text);
    reader.all()?;
    if reader.root.elements.is_empty() {
        return Err(reader
            .lines
            .malformed("the file has no elements (*ELEMENT) outside of parts without an *INSTANCE"));
    }
    let mut raw = reader.mesh()?;
    raw.name = file.display().to_string();
    raw.scale(scale);
    Ok(Mesh::build(raw)?)
}
