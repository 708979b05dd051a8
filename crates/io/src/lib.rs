//! Gmsh, VTK and Abaqus in; VTU, PVD, STL and 3MF out; point clouds both ways.
//!
//! ```no_run
//! let mesh = nastic_io::read_gmsh("meshes/cantilever.msh")?;
//! for note in mesh.notes() {
//!     eprintln!("{}: {note}", mesh.name()); // what was mended
//! }
//! # Ok::<(), nastic_io::ReadError>(())
//! ```

mod abaqus;
mod atomic;
mod cloud;
mod error;
mod fingerprint;
mod gmsh;
mod grid;
mod lock;
mod other_format;
mod own_file;
mod pvd;
mod source;
mod stl;
mod three_mf;
mod vtk;
mod vtu;
mod written;

use std::path::Path;

use nastic_mesh::Mesh;

pub use abaqus::{parse_abaqus, read_abaqus};
pub use atomic::write_atomically;
pub use cloud::{PointCloud, is_cloud, read_cloud, write_cloud};
pub use error::{At, ReadError, WriteError};
pub use fingerprint::Fingerprint;
pub use gmsh::{parse_gmsh, read_gmsh, read_gmsh_scaled};
pub use lock::{DirectoryLock, LockError};
pub use own_file::append_to;
pub use pvd::write_pvd;
pub use stl::write_stl;
pub use three_mf::{PrintedBody, write_3mf};
pub use vtk::{parse_vtk, read_vtk};
pub use vtu::{
    Entity, FileArray, base64, escape, parse_vtu, read_array, read_lines, read_snapshot, read_vtu, read_vtu_scaled,
    write_lines, write_pvtu, write_vtu,
};
pub use written::WrittenFiles;

/// Reads a mesh from a `.msh` (Gmsh), `.vtu` or legacy `.vtk` (VTK) or `.inp` (Abaqus, CalculiX) file, all lengths multiplied by `scale`.
///
/// # Errors
///
/// [`ReadError`]; [`ReadError::Extension`] for any other name, with how to convert files of common formats.
pub fn read_mesh(path: impl AsRef<Path>, scale: f64) -> Result<Mesh, ReadError> {
    let path = path.as_ref();
    match other_format::extension(path).as_str() {
        "msh" => read_gmsh_scaled(path, scale),
        "vtu" => read_vtu_scaled(path, scale),
        "vtk" => read_vtk(path, scale),
        "inp" => read_abaqus(path, scale),
        _ => Err(ReadError::Extension { file: path.to_owned() }),
    }
}

fn check_scale(file: &Path, scale: f64) -> Result<(), ReadError> {
    if scale > 0.0 && scale.is_finite() {
        return Ok(());
    }
    Err(ReadError::Scale { file: file.to_owned(), scale })
}
