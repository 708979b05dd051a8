//! Snapshots to VTU: inline base64, zlib-compressed, true quadratic cells.

use std::collections::BTreeSet;
use std::io::{self, Write};
use std::path::Path;

use flate2::Compression;
use flate2::write::ZlibEncoder;
use nastic_mesh::{Mesh, NamedArray, Snapshot};

use super::base64;
use super::xml::escape;
use crate::atomic::write_atomically;
use crate::error::WriteError;
use crate::grid::{NODES, REGION, SURFACE};

/// Writes a mesh with its fields to a VTU file that ParaView, `vtk` and `meshio` read.
///
/// Entities stand in mesh order; arrays of two components get a third that is zero. An integer cell array `region` is added unless the snapshot has one: the number,
/// from one, of the first region in alphabetical order that holds the cell; and for every group a cell array of zeros and ones by which viewers
/// threshold: `region:NAME` (cells of the region), `surface:NAME` (cells with a face on the surface). Names of regions, surfaces and node sets
/// travel as field data, so that the mesh read back is the same.
///
/// # Errors
///
/// [`WriteError::System`]; [`WriteError::Content`] for an array of the wrong length, or two of one name.
pub fn write_vtu(path: impl AsRef<Path>, snapshot: &Snapshot) -> Result<(), WriteError> {
    let path = path.as_ref();
    let mesh = &snapshot.mesh;
    check(path, "point", &snapshot.point_data, mesh.points().len())?;
    check(path, "cell", &snapshot.cell_data, mesh.cells())?;
    write_atomically(path, |out| {
        writeln!(out, r#"<?xml version="1.0"?>"#)?;
        writeln!(
            out,
            r#"<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian" header_type="UInt64" compressor="vtkZLibDataCompressor">"#
        )?;
        writeln!(out, "<UnstructuredGrid>")?;
        field_data(out, mesh)?;
        writeln!(out, r#"<Piece NumberOfPoints="{}" NumberOfCells="{}">"#, mesh.points().len(), mesh.cells())?;
        point_data(out, &snapshot.point_data)?;
        cell_data(out, snapshot)?;
        points(out, mesh)?;
        cells(out, mesh)?;
        writeln!(out, "</Piece>\n</UnstructuredGrid>\n</VTKFile>")
    })
}

fn check(path: &Path, of: &str, arrays: &[NamedArray], entities: usize) -> Result<(), WriteError> {
    let mut names = BTreeSet::new();
    for NamedArray { name, components, values, .. } in arrays {
        if name.is_empty() || !names.insert(name) {
            let what = format!("two {of} arrays are named \"{name}\", or one has no name");
            return Err(WriteError::content(path, what, "give each array a name of its own"));
        }
        if *components == 0 || Some(values.len()) != components.checked_mul(entities) {
            let what = format!(
                "{of} array \"{name}\" holds {} values where {components} x {entities} are needed",
                values.len()
            );
            return Err(WriteError::content(path, what, "give one value per component and entity of the mesh"));
        }
    }
    Ok(())
}

fn field_data(out: &mut dyn Write, mesh: &Mesh) -> io::Result<()> {
    writeln!(out, "<FieldData>")?;
    let mut group = |prefix: &str, name: &str, components: usize, values: Vec<i64>| {
        let tuples = values.len() / components;
        array(out, "Int64", &format!("{prefix}{name}"), components, Some(tuples), &integers(&values))
    };
    for (name, cells) in mesh.regions() {
        group(REGION, name, 1, cells.iter().map(|cell| i64::from(*cell)).collect())?;
    }
    for (name, facets) in mesh.surfaces() {
        let pairs = facets.iter().flat_map(|facet| [i64::from(facet.cell), i64::from(facet.face)]);
        group(SURFACE, name, 2, pairs.collect())?;
    }
    for (name, nodes) in mesh.node_sets() {
        group(NODES, name, 1, nodes.iter().map(|node| i64::from(*node)).collect())?;
    }
    writeln!(out, "</FieldData>")
}

fn point_data(out: &mut dyn Write, arrays: &[NamedArray]) -> io::Result<()> {
    // What ParaView warps by at once.
    let active = arrays.iter().find(|array| array.name == "displacement" && matches!(array.components, 2 | 3));
    match active {
        Some(_) => writeln!(out, r#"<PointData Vectors="displacement">"#)?,
        None => writeln!(out, "<PointData>")?,
    }
    for data in arrays {
        real_array(out, data)?;
    }
    writeln!(out, "</PointData>")
}

fn cell_data(out: &mut dyn Write, snapshot: &Snapshot) -> io::Result<()> {
    writeln!(out, "<CellData>")?;
    for data in &snapshot.cell_data {
        real_array(out, data)?;
    }
    if !snapshot.cell_data.iter().any(|array| array.name == "region") {
        let mut number = vec![0; snapshot.mesh.cells()];
        for (at, cells) in snapshot.mesh.regions().values().enumerate() {
            for cell in cells {
                let entry = &mut number[*cell as usize];
                if *entry == 0 {
                    *entry = at as i64 + 1;
                }
            }
        }
        array(out, "Int64", "region", 1, None, &integers(&number))?;
    }
    let mesh = &snapshot.mesh;
    let mut marks = |prefix: &str, name: &str, cells: &mut dyn Iterator<Item = u32>| {
        let mut marked = vec![0; mesh.cells()];
        cells.for_each(|cell| marked[cell as usize] = 1);
        array(out, "UInt8", &format!("{prefix}{name}"), 1, None, &marked)
    };
    for (name, cells) in mesh.regions() {
        marks(REGION, name, &mut cells.iter().copied())?;
    }
    for (name, facets) in mesh.surfaces() {
        marks(SURFACE, name, &mut facets.iter().map(|facet| facet.cell))?;
    }
    writeln!(out, "</CellData>")
}

fn points(out: &mut dyn Write, mesh: &Mesh) -> io::Result<()> {
    writeln!(out, "<Points>")?;
    array(out, "Float64", "Points", 3, None, &reals(mesh.points().as_flattened()))?;
    writeln!(out, "</Points>")
}

fn cells(out: &mut dyn Write, mesh: &Mesh) -> io::Result<()> {
    let mut nodes = Vec::new();
    let mut offsets = Vec::with_capacity(mesh.cells());
    let mut types = Vec::with_capacity(mesh.cells());
    for id in 0..mesh.cells() {
        let cell = mesh.cell(id);
        nodes.extend(cell.nodes.iter().map(|node| i64::from(*node)));
        offsets.push(nodes.len() as i64);
        types.push(cell.kind.vtk());
    }
    writeln!(out, "<Cells>")?;
    array(out, "Int64", "connectivity", 1, None, &integers(&nodes))?;
    array(out, "Int64", "offsets", 1, None, &integers(&offsets))?;
    array(out, "UInt8", "types", 1, None, &types)?;
    writeln!(out, "</Cells>")
}

/// Plane vectors get z = 0: viewers take only three components for a vector.
fn real_array(out: &mut dyn Write, data: &NamedArray) -> io::Result<()> {
    let NamedArray { name, components, values, single } = data;
    if *single {
        let bytes: Vec<u8> = values.iter().flat_map(|value| (*value as f32).to_le_bytes()).collect();
        return array(out, "Float32", name, *components, None, &bytes);
    }
    if *components == 2 {
        let padded: Vec<f64> = values.chunks_exact(2).flat_map(|v| [v[0], v[1], 0.0]).collect();
        return array(out, "Float64", name, 3, None, &reals(&padded));
    }
    array(out, "Float64", name, *components, None, &reals(values))
}

pub(super) fn reals(values: &[f64]) -> Vec<u8> {
    values.iter().flat_map(|value| value.to_le_bytes()).collect()
}

pub(super) fn integers(values: &[i64]) -> Vec<u8> {
    values.iter().flat_map(|value| value.to_le_bytes()).collect()
}

/// One `DataArray`; `tuples` only in field data, where nothing else gives it.
pub(super) fn array(
    out: &mut dyn Write,
    kind: &str,
    name: &str,
    components: usize,
    tuples: Option<usize>,
    bytes: &[u8],
) -> io::Result<()> {
    write!(out, r#"<DataArray type="{kind}" Name="{}""#, escape(name))?;
    // As VTK has it: meshio makes a table of one column if a single component is spelled out.
    if components > 1 {
        write!(out, r#" NumberOfComponents="{components}""#)?;
    }
    for (at, component) in component_names(components).iter().enumerate() {
        write!(out, r#" ComponentName{at}="{component}""#)?;
    }
    if let Some(tuples) = tuples {
        write!(out, r#" NumberOfTuples="{tuples}""#)?;
    }
    writeln!(out, r#" format="binary">"#)?;
    packed(out, bytes)?;
    writeln!(out, "\n</DataArray>")
}

fn component_names(components: usize) -> &'static [&'static str] {
    match components {
        3 => &["x", "y", "z"],
        9 => &["xx", "xy", "xz", "yx", "yy", "yz", "zx", "zy", "zz"],
        _ => &[],
    }
}

/// Blocks of zlib with VTK's header: number of blocks, their size, size of a partial last one, packed sizes.
fn packed(out: &mut dyn Write, bytes: &[u8]) -> io::Result<()> {
    const BLOCK: usize = 1 << 20;
    let mut header = vec![bytes.len().div_ceil(BLOCK) as u64, BLOCK as u64, (bytes.len() % BLOCK) as u64];
    let mut body = Vec::new();
    for block in bytes.chunks(BLOCK) {
        let before = body.len();
        let mut encoder = ZlibEncoder::new(&mut body, Compression::new(5));
        encoder.write_all(block)?;
        encoder.finish()?;
        header.push((body.len() - before) as u64);
    }
    let header: Vec<u8> = header.into_iter().flat_map(u64::to_le_bytes).collect();
    out.write_all(base64::encode(&header).as_bytes())?;
    out.write_all(base64::encode(&body).as_bytes())
}
