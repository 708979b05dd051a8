//! One body in several VTU files, `.pvtu`.

use std::path::Path;

use nastic_mesh::{NamedArray, Snapshot};

use super::xml::escape;
use crate::atomic::write_atomically;
use crate::error::WriteError;
use crate::grid::{REGION, SURFACE};

/// Writes the index of parts of a body, each a file of [`write_vtu`](super::write_vtu), which `vtk`, the library below ParaView, opens as one; `files` are relative to the directory of the
/// index. The arrays of the snapshot of one part say what all of them have: all parts of a [division](nastic_mesh::Mesh::part) have the same groups.
///
/// Nodes between parts are in each of them.
///
/// # Errors
///
/// [`WriteError::System`]; [`WriteError::Content`] without a part.
pub fn write_pvtu<S: AsRef<str>>(path: impl AsRef<Path>, snapshot: &Snapshot, files: &[S]) -> Result<(), WriteError> {
    let path = path.as_ref();
    if files.is_empty() {
        return Err(WriteError::content(path, "no part".to_owned(), "give the file of one part or more"));
    }
    let mesh = &snapshot.mesh;
    let own_region = snapshot.cell_data.iter().any(|array| array.name == "region");
    let region = (!own_region).then(|| declared("Int64", "region", 1));
    let marks = mesh.regions().keys().map(|name| format!("{REGION}{name}"));
    let marks = marks.chain(mesh.surfaces().keys().map(|name| format!("{SURFACE}{name}")));
    let of_cells = snapshot.cell_data.iter().map(real).chain(region);
    let of_cells: Vec<String> = of_cells.chain(marks.map(|name| declared("UInt8", &name, 1))).collect();
    write_atomically(path, |out| {
        writeln!(out, r#"<?xml version="1.0"?>"#)?;
        writeln!(
            out,
            r#"<VTKFile type="PUnstructuredGrid" version="1.0" byte_order="LittleEndian" header_type="UInt64">"#
        )?;
        writeln!(out, "<PUnstructuredGrid GhostLevel=\"0\">\n<PPointData>")?;
        snapshot.point_data.iter().try_for_each(|array| writeln!(out, "{}", real(array)))?;
        writeln!(out, "</PPointData>\n<PCellData>")?;
        of_cells.iter().try_for_each(|array| writeln!(out, "{array}"))?;
        writeln!(out, "</PCellData>\n<PPoints>\n{}\n</PPoints>", declared("Float64", "Points", 3))?;
        files.iter().try_for_each(|file| writeln!(out, r#"<Piece Source="{}"/>"#, escape(file.as_ref())))?;
        writeln!(out, "</PUnstructuredGrid>\n</VTKFile>")
    })
}

/// As a part has it: plane vectors have a third component, unless in single precision.
fn real(array: &NamedArray) -> String {
    match (array.single, array.components) {
        (true, components) => declared("Float32", &array.name, components),
        (false, 2) => declared("Float64", &array.name, 3),
        (false, components) => declared("Float64", &array.name, components),
    }
}

fn declared(kind: &str, name: &str, components: usize) -> String {
    format!(r#"<PDataArray type="{kind}" Name="{}" NumberOfComponents="{components}"/>"#, escape(name))
}
