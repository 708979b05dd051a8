//! Lines beside a body to VTU and from it: cells of the type polyline.

use super::read::{Entity, GridFile, bytes_of, with_grid};
use super::write::{array, integers, reals};
use crate::atomic::write_atomically;
use crate::error::{ReadError, WriteError};
use nastic_mesh::Polyline;
use std::collections::BTreeSet;
use std::path::Path;

/// VTK's number of a polyline.
const POLYLINE: u8 = 4;

/// Writes lines to a VTU file of their own: one cell each, with cell data `line`, its number from 0, and its quantities (NaN where one has
/// not what another has). Field data `line:NAME` has the number of the line of that name.
///
/// # Errors
///
/// [`WriteError::System`].
pub fn write_lines(path: impl AsRef<Path>, lines: &[Polyline]) -> Result<(), WriteError> {
    let points: Vec<f64> = lines.iter().flat_map(|line| line.points.iter().flatten().copied()).collect();
    let offsets: Vec<i64> = lines
        .iter()
        .scan(0, |end, line| {
            *end += line.points.len() as i64;
            Some(*end)
        })
        .collect();
    let connectivity: Vec<i64> = (0..points.len() as i64 / 3).collect();
    let names: BTreeSet<&str> =
        lines.iter().flat_map(|line| line.quantities.iter().map(|(name, _)| name.as_str())).collect();
    write_atomically(path.as_ref(), |out| {
        writeln!(
            out,
            r#"<?xml version="1.0"?>
<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian" header_type="UInt64" compressor="vtkZLibDataCompressor">
<UnstructuredGrid>
<FieldData>"#
        )?;
        for (k, line) in lines.iter().enumerate() {
            array(out, "Int64", &format!("line:{}", line.name), 1, Some(1), &integers(&[k as i64]))?;
        }
        writeln!(out, "</FieldData>")?;
        writeln!(out, r#"<Piece NumberOfPoints="{}" NumberOfCells="{}">"#, connectivity.len(), lines.len())?;
        writeln!(out, "<CellData>")?;
        array(out, "Int64", "line", 1, None, &integers(&(0..lines.len() as i64).collect::<Vec<_>>()))?;
        for name in names {
            let of =
                |line: &Polyline| line.quantities.iter().find(|(own, _)| own == name).map_or(f64::NAN, |(_, x)| *x);
            array(out, "Float64", name, 1, None, &reals(&lines.iter().map(of).collect::<Vec<_>>()))?;
        }
        writeln!(out, "</CellData>\n<Points>")?;
        array(out, "Float64", "Points", 3, None, &reals(&points))?;
        writeln!(out, "</Points>\n<Cells>")?;
        array(out, "Int64", "connectivity", 1, None, &integers(&connectivity))?;
        array(out, "Int64", "offsets", 1, None, &integers(&offsets))?;
        array(out, "UInt8", "types", 1, None, &vec![POLYLINE; lines.len()])?;
        writeln!(out, "</Cells>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>")
    })
}

/// Reads what [`write_lines`] wrote.
///
/// # Errors
///
/// [`ReadError`] naming file, line and array.
pub fn read_lines(path: impl AsRef<Path>) -> Result<Vec<Polyline>, ReadError> {
    let path = path.as_ref();
    with_grid(path, &bytes_of(path)?, |grid| {
        let mut lines = corners(grid)?;
        for (k, line) in lines.iter_mut().enumerate() {
            line.name = format!("line {k}");
        }
        for element in grid.field_arrays() {
            let Some(name) = element.attribute("Name").and_then(|name| name.strip_prefix("line:")) else { continue };
            if let [number] = grid.integers(element, 1)?[..]
                && let Some(line) = usize::try_from(number).ok().and_then(|k| lines.get_mut(k))
            {
                name.clone_into(&mut line.name);
            }
        }
        for element in grid.cell_arrays() {
            let array = grid.array(element, Entity::Cell)?;
            if array.components == 1 && array.name != "line" {
                let of_lines = lines.iter_mut().zip(&array.values).filter(|(_, value)| !value.is_nan());
                of_lines.for_each(|(line, value)| line.quantities.push((array.name.clone(), *value)));
            }
        }
        Ok(lines)
    })
}

/// The lines of a grid, without names.
fn corners(grid: &GridFile<'_>) -> Result<Vec<Polyline>, ReadError> {
    let points = grid.node_positions()?;
    let section = grid.section("Cells")?;
    let named = |name: &str| {
        let array = section.children_named("DataArray").find(|array| array.attribute("Name") == Some(name));
        array.ok_or_else(|| grid.missing(section, &format!("the array \"{name}\"")))
    };
    let (offsets_at, nodes_at) = (named("offsets")?, named("connectivity")?);
    let offsets = grid.integers(offsets_at, grid.cells)?;
    let nodes = grid.integers(nodes_at, offsets.last().map_or(0, |last| u64::try_from(*last).unwrap_or(0)))?;
    let mut start = 0;
    let mut lines = Vec::with_capacity(offsets.len());
    for end in offsets {
        let listed = usize::try_from(end).ok().and_then(|end| nodes.get(start..end));
        let place = |node: &i64| usize::try_from(*node).ok().and_then(|node| points.get(node).copied());
        let corners = listed.and_then(|listed| listed.iter().map(place).collect::<Option<Vec<_>>>());
        let Some(corners) = corners else {
            return Err(grid.storage.malformed(offsets_at, "an offset or a node is out of range"));
        };
        start += corners.len();
        lines.push(Polyline { name: String::new(), points: corners, quantities: Vec::new() });
    }
    Ok(lines)
}
