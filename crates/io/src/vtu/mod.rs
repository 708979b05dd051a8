//! VTK's XML unstructured grids, `.vtu`.
//!
//! Format: <https://docs.vtk.org/en/latest/design_documents/VTKFileFormats.html>. Read: text, base64 and raw bytes,
//! inline and appended, plain, zlib, LZ4 and LZMA, either byte order, one piece. Written: base64, inline, zlib.

mod array;
mod base64;
mod compressor;
mod lines;
mod parts;
mod read;
mod write;
mod xml;

pub use lines::{read_lines, write_lines};
pub use parts::write_pvtu;
pub use read::{Entity, FileArray, parse_vtu, read_array, read_snapshot, read_vtu, read_vtu_scaled};
pub use write::write_vtu;
pub use xml::escape;

/// Bytes as base64, padded.
pub fn base64(bytes: &[u8]) -> String {
    base64::encode(bytes)
}
