//! Lines beside a body to VTU: cells of the type polyline.

use super::write::{array, integers, reals};
use crate::atomic::write_atomically;
use crate::error::WriteError;
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
    let names: BTreeSet<&str> = lines.iter().flat_map(|line| line.quantities.iter().map(|(name, _)| *name)).collect();
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
                |line: &Polyline| line.quantities.iter().find(|(own, _)| *own == name).map_or(f64::NAN, |(_, x)| *x);
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
