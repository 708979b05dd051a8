//! Meshes from legacy VTK files, versions 1.0 to 5.1, text and binary.
//!
//! Format: <https://docs.vtk.org/en/latest/vtk_file_formats/vtk_legacy_file_format.html>.
//!
//! * Groups as in `.vtu`: field arrays that [`write_vtu`](crate::write_vtu) made and VTK copied, else an integer cell array
//!   `region`, `gmsh:physical` or `CellEntityIds`. Point arrays and all other cell arrays are passed over.
//! * No count in a file is believed before the rest of the file is seen to be long enough for it.

mod attributes;
mod cells;
mod cursor;
mod kind;

use nastic_mesh::Mesh;
use std::path::Path;

use crate::error::ReadError;
use crate::grid::{CORRUPT, Grid, LagrangeOrder};
use crate::source::{Source, brief};
use attributes::Attributes;
use cursor::Cursor;

/// Reads the mesh of a legacy VTK file (an unstructured grid), all lengths multiplied by `scale`.
///
/// # Errors
/// [`ReadError`]: line (text) or byte (binary) and what to try; other data sets are named as not supported.
pub fn read_vtk(path: impl AsRef<Path>, scale: f64) -> Result<Mesh, ReadError> {
    let path = path.as_ref();
    let bytes = std::fs::read(path).map_err(|source| ReadError::Open { file: path.to_owned(), source })?;
    parse_vtk(path, &bytes, scale)
}

/// Reads the mesh from the bytes of a legacy VTK file; `file` is the name that errors and the mesh bear.
///
/// # Errors
/// As [`read_vtk`].
pub fn parse_vtk(file: impl AsRef<Path>, bytes: &[u8], scale: f64) -> Result<Mesh, ReadError> {
    let file = file.as_ref();
    crate::check_scale(file, scale)?;
    let mut cursor = Cursor::new(Source::new(file, bytes));
    let order = header(&mut cursor)?;
    let mut raw = grid(cursor, order)?.mesh()?.raw;
    raw.name = file.display().to_string();
    raw.scale(scale);
    Ok(Mesh::build(raw)?)
}

/// Version, title, encoding and kind of data set.
fn header(cursor: &mut Cursor) -> Result<LagrangeOrder, ReadError> {
    const HEAD: &str = "# vtk DataFile Version";
    let first = cursor.line().unwrap_or_default();
    let Some(version) = first.strip_prefix(HEAD) else {
        return Err(cursor.malformed(format!("it does not begin with \"{HEAD}\""), "is it a legacy VTK file (.vtk)?"));
    };
    let (major, minor) = version.trim().split_once('.').unwrap_or((version.trim(), "0"));
    let version: (u32, u32) = (major.parse().unwrap_or(0), minor.parse().unwrap_or(0));
    cursor.line(); // the title
    let encoding = cursor.line().unwrap_or_default();
    match encoding.to_ascii_uppercase().as_str() {
        "ASCII" => {}
        "BINARY" => cursor.set_binary(),
        _ => {
            let what = format!("the third line is \"{}\", neither ASCII nor BINARY", brief(&encoding));
            return Err(cursor.malformed(what, CORRUPT));
        }
    }
    let dataset = cursor.line().unwrap_or_default().to_ascii_uppercase();
    if dataset.split_whitespace().ne(["DATASET", "UNSTRUCTURED_GRID"]) {
        let advice =
            "save an unstructured grid of cells (in pyvista cast_to_unstructured_grid(), in ParaView Append Datasets)";
        return Err(cursor.unsupported(format!("\"{}\"", brief(&dataset)), advice));
    }
    Ok(if version < (5, 1) { LagrangeOrder::Former } else { LagrangeOrder::Present })
}

/// All sections.
fn grid(mut cursor: Cursor, order: LagrangeOrder) -> Result<Grid, ReadError> {
    let (mut points, mut nodes, mut cells) = (None, None, None);
    let mut attributes = Attributes::default();
    while let Some(word) = cursor.section()? {
        match word.as_str() {
            "POINTS" => points = Some(cells::points(&mut cursor)?),
            "CELLS" => nodes = Some(cells::nodes(&mut cursor)?),
            "CELL_TYPES" => {
                let (Some(points), Some(nodes)) = (&points, nodes.take()) else {
                    return Err(cursor.malformed("CELL_TYPES stand before CELLS or POINTS", CORRUPT));
                };
                cells = Some(cells::cells(&mut cursor, nodes, points.len(), order)?);
            }
            _ => attributes.section(&mut cursor, &word)?,
        }
    }
    let (Some(points), Some(cells)) = (points, cells) else {
        return Err(cursor.malformed("the file ends without POINTS, CELLS and CELL_TYPES", CORRUPT));
    };
    let Attributes { groups, tags, ghosts, .. } = attributes;
    Ok(Grid { source: cursor.source, points, cells, groups, tags, ghosts })
}
