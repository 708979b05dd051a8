//! Meshes, snapshots and single arrays from VTU files.

use std::path::Path;
use std::sync::Arc;

use nastic_mesh::{Mesh, NamedArray, Snapshot};

use super::array::{Expect, Storage, describe};
use super::xml::{self, Element};
use crate::error::ReadError;
use crate::grid::{
    GHOSTS, Grid, GridArray, GridMesh, LagrangeOrder, ListedCell, Numbers, OTHER_CELLS, REGION, Refused, SURFACE, TAGS,
    cell, is_group,
};
use crate::source::{Source, brief};

/// What an array has one tuple for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Entity {
    /// Every point of the file.
    Point,
    /// Every cell of the file.
    Cell,
}

/// An array of a file, in the order of the file; files of [`write_vtu`](crate::write_vtu) are in mesh order.
#[derive(Clone, Debug, PartialEq)]
pub struct FileArray {
    /// What it belongs to.
    pub entity: Entity,
    /// Its name.
    pub name: String,
    /// Values per entity.
    pub components: usize,
    /// The values, entity after entity.
    pub values: Vec<f64>,
}

/// Reads the mesh of a VTU file.
///
/// Regions, surfaces and node sets come from the file if [`write_vtu`](crate::write_vtu) made it; else regions (and
/// surfaces, from cells of one dimension less) bear the tags of an integer cell array `region`, `gmsh:physical` or
/// `CellEntityIds`. Ghost cells (`vtkGhostType`) are left out.
///
/// # Errors
///
/// [`ReadError`] naming file, line and array, and what to try.
pub fn read_vtu(path: impl AsRef<Path>) -> Result<Mesh, ReadError> {
    read_vtu_scaled(path, 1.0)
}

/// As [`read_vtu`], all lengths multiplied by `scale`.
///
/// # Errors
///
/// As [`read_vtu`], and [`ReadError::Scale`].
pub fn read_vtu_scaled(path: impl AsRef<Path>, scale: f64) -> Result<Mesh, ReadError> {
    let path = path.as_ref();
    parse_vtu(path, &bytes_of(path)?, scale)
}

/// Reads the mesh from the bytes of a VTU file; `file` is the name that errors and the mesh bear.
///
/// # Errors
///
/// As [`read_vtu_scaled`].
pub fn parse_vtu(file: impl AsRef<Path>, bytes: &[u8], scale: f64) -> Result<Mesh, ReadError> {
    let file = file.as_ref();
    crate::check_scale(file, scale)?;
    with_grid(file, bytes, |grid| {
        let mut raw = grid.mesh()?.raw;
        raw.name = file.display().to_string();
        raw.scale(scale);
        Ok(Mesh::build(raw)?)
    })
}

/// Reads mesh and arrays, the arrays in mesh order.
///
/// # Errors
///
/// As [`read_vtu`].
pub fn read_snapshot(path: impl AsRef<Path>) -> Result<Snapshot, ReadError> {
    let path = path.as_ref();
    let bytes = bytes_of(path)?;
    with_grid(path, &bytes, |grid| {
        let GridMesh { mut raw, file_cells } = grid.mesh()?;
        raw.name = path.display().to_string();
        let mesh = Arc::new(Mesh::build(raw)?);
        let cells: Vec<u32> = mesh.cell_origin().iter().map(|element| file_cells[*element as usize]).collect();
        let in_order = |array: FileArray, order: &[u32]| {
            let rows = order.iter().map(|from| *from as usize * array.components);
            let values = rows.flat_map(|at| array.values[at..at + array.components].iter().copied()).collect();
            NamedArray { name: array.name, components: array.components, values, single: false }
        };
        let (mut point_data, mut cell_data) = (Vec::new(), Vec::new());
        for element in grid.point_arrays() {
            point_data.push(in_order(grid.array(element, Entity::Point)?, mesh.node_origin()));
        }
        for element in grid.cell_arrays() {
            if grid.repeats_group(element) {
                continue;
            }
            cell_data.push(in_order(grid.array(element, Entity::Cell)?, &cells));
        }
        Ok(Snapshot { mesh, point_data, cell_data, lines: Vec::new(), obstacles: None })
    })
}

/// Reads one array by its name, for instance the control of a previous result.
///
/// # Errors
///
/// As [`read_vtu`]; [`ReadError::Array`] if no array or two (one of points, one of cells) have that name.
pub fn read_array(path: impl AsRef<Path>, name: &str) -> Result<FileArray, ReadError> {
    let path = path.as_ref();
    let bytes = bytes_of(path)?;
    with_grid(path, &bytes, |grid| {
        let of = |element: &Element| element.attribute("Name") == Some(name);
        let refuse = |has: String| ReadError::Array { file: path.to_owned(), name: name.to_owned(), has };
        match (grid.point_arrays().find(|e| of(e)), grid.cell_arrays().find(|e| of(e))) {
            (Some(element), None) => grid.array(element, Entity::Point),
            (None, Some(element)) => grid.array(element, Entity::Cell),
            (Some(_), Some(_)) => Err(refuse("both a point and a cell array bear that name; rename one".to_owned())),
            (None, None) => {
                let list = |arrays: Vec<&str>| if arrays.is_empty() { "none".to_owned() } else { arrays.join(", ") };
                let points = list(grid.point_arrays().filter_map(|e| e.attribute("Name")).collect());
                let cells = list(grid.cell_arrays().filter_map(|e| e.attribute("Name")).collect());
                Err(refuse(format!("it has the point arrays: {points}; the cell arrays: {cells}")))
            }
        }
    })
}

pub(super) fn bytes_of(path: &Path) -> Result<Vec<u8>, ReadError> {
    std::fs::read(path).map_err(|source| ReadError::Open { file: path.to_owned(), source })
}

/// The one grid of a file.
pub(super) struct GridFile<'a> {
    source: Source<'a>,
    pub storage: &'a Storage<'a>,
    order: LagrangeOrder,
    fields: Option<&'a Element<'a>>,
    piece: &'a Element<'a>,
    points: u64,
    pub cells: u64,
}

pub(super) fn with_grid<T>(
    file: &Path,
    bytes: &[u8],
    then: impl FnOnce(&GridFile) -> Result<T, ReadError>,
) -> Result<T, ReadError> {
    let source = Source::new(file, bytes);
    let root = xml::parse(&source)?;
    let fail = |at: &Element, what: &str, advice: &str| source.malformed(at.start, describe(at), what, advice);
    let kind = root.attribute("type").unwrap_or_default();
    if root.name != "VTKFile" || kind != "UnstructuredGrid" {
        let what = format!("<{}> of type \"{}\" is not an unstructured grid", brief(&root.name), brief(kind));
        return Err(fail(&root, &what, "save as .vtu, VTK XML unstructured grid"));
    }
    let storage = Storage::new(source, &root)?;
    let Some(grid) = root.child("UnstructuredGrid") else {
        return Err(fail(&root, "it has no <UnstructuredGrid>", "write the file again"));
    };
    let mut pieces = grid.children_named("Piece");
    let (Some(piece), None) = (pieces.next(), pieces.next()) else {
        return Err(fail(grid, "it does not have exactly one <Piece>", "merge the pieces: in ParaView, Merge Blocks"));
    };
    let count = |name: &str| {
        let text = piece.attribute(name).and_then(|text| text.trim().parse::<u64>().ok());
        text.ok_or_else(|| fail(piece, &format!("{name} is missing or not a number"), "write the file again"))
    };
    let (points, cells) = (count("NumberOfPoints")?, count("NumberOfCells")?);
    let order = lagrange_order(root.attribute("version").unwrap_or_default());
    then(&GridFile { source, storage: &storage, order, fields: grid.child("FieldData"), piece, points, cells })
}

/// By the version of the file, such as "2.3".
fn lagrange_order(version: &str) -> LagrangeOrder {
    let (major, minor) = version.trim().split_once('.').unwrap_or((version, "0"));
    let version = (major.parse::<u32>().unwrap_or(0), minor.parse::<u32>().unwrap_or(0));
    if version < (2, 1) { LagrangeOrder::Former } else { LagrangeOrder::Present }
}

impl<'a> GridFile<'a> {
    pub fn point_arrays(&self) -> impl Iterator<Item = &Element<'a>> {
        self.piece.child("PointData").into_iter().flat_map(|data| data.children_named("DataArray"))
    }

    pub fn cell_arrays(&self) -> impl Iterator<Item = &Element<'a>> {
        self.piece.child("CellData").into_iter().flat_map(|data| data.children_named("DataArray"))
    }

    pub fn field_arrays(&self) -> impl Iterator<Item = &Element<'a>> {
        self.fields.into_iter().flat_map(|data| data.children_named("DataArray"))
    }

    pub fn array(&self, element: &Element<'a>, entity: Entity) -> Result<FileArray, ReadError> {
        let entities = match entity {
            Entity::Point => self.points,
            Entity::Cell => self.cells,
        };
        let values = self.storage.read(element, Expect::Tuples(entities))?.into_reals();
        let name = element.attribute("Name").unwrap_or_default().to_owned();
        Ok(FileArray { entity, name, components: self.storage.components(element)?, values })
    }

    /// Whether a cell array says again what the groups say: `region`, `region:NAME`, `surface:NAME`.
    fn repeats_group(&self, array: &Element<'_>) -> bool {
        let name = array.attribute("Name").unwrap_or("");
        let is_mark = [REGION, SURFACE].iter().any(|prefix| name.starts_with(prefix));
        let mut names = self.field_arrays().filter_map(|group| group.attribute("Name"));
        name == "region" && names.any(|group| group.starts_with(REGION)) || is_mark && names.any(|group| group == name)
    }

    fn mesh(&self) -> Result<GridMesh, ReadError> {
        let points = self.node_positions()?;
        let cells = self.listed_cells(points.len())?;
        let named =
            |array: &&Element, names: &[&str]| array.attribute("Name").is_some_and(|name| names.contains(&name));
        let of_cells = |names: &[&str]| {
            let array = self.cell_arrays().find(|array| named(array, names));
            array.map(|element| self.placed(element, Expect::Tuples(self.cells))).transpose()
        };
        let groups = self.field_arrays().filter(|array| array.attribute("Name").is_some_and(is_group));
        let groups = groups.map(|element| self.placed(element, Expect::Any)).collect::<Result<_, _>>()?;
        let (tags, ghosts) = (of_cells(&TAGS)?, of_cells(&[GHOSTS])?);
        Grid { source: self.source, points, cells, groups, tags, ghosts }.mesh()
    }

    /// An array with its place.
    fn placed(&self, element: &Element<'a>, expect: Expect) -> Result<GridArray, ReadError> {
        Ok(GridArray {
            name: element.attribute("Name").unwrap_or_default().to_owned(),
            components: self.storage.components(element)?,
            numbers: self.storage.read(element, expect)?,
            section: describe(element),
            byte: element.start,
        })
    }

    pub fn node_positions(&self) -> Result<Vec<[f64; 3]>, ReadError> {
        let section = self.section("Points")?;
        let Some(element) = section.child("DataArray") else {
            return Err(self.missing(section, "a DataArray"));
        };
        if self.storage.components(element)? != 3 {
            return Err(self.storage.malformed(element, "points must have three components"));
        }
        let values = self.storage.read(element, Expect::Tuples(self.points))?.into_reals();
        Ok(values.as_chunks::<3>().0.to_vec())
    }

    fn listed_cells(&self, points: usize) -> Result<Vec<ListedCell>, ReadError> {
        let section = self.section("Cells")?;
        let named = |name: &str| {
            let array = section.children_named("DataArray").find(|array| array.attribute("Name") == Some(name));
            array.ok_or_else(|| self.missing(section, &format!("the array \"{name}\"")))
        };
        let (offsets_at, types_at, nodes_at) = (named("offsets")?, named("types")?, named("connectivity")?);
        let offsets = self.integers(offsets_at, self.cells)?;
        let types = self.integers(types_at, self.cells)?;
        let last = offsets.last().copied().unwrap_or(0);
        let last = u64::try_from(last).map_err(|_| self.storage.malformed(offsets_at, "an offset is negative"))?;
        let nodes = self.integers(nodes_at, last)?;
        let mut cells = Vec::with_capacity(offsets.len());
        let mut start = 0;
        for (cell, (end, number)) in offsets.into_iter().zip(types).enumerate() {
            let end = usize::try_from(end).ok();
            let Some(listed) = end.and_then(|end| nodes.get(start..end)) else {
                return Err(self.storage.malformed(offsets_at, format!("the offset of cell {cell} is out of order")));
            };
            let node = |node: &i64| usize::try_from(*node).ok().filter(|node| *node < points).map(|node| node as u32);
            let Some(listed) = listed.iter().map(node).collect::<Option<Vec<u32>>>() else {
                let what = format!("cell {cell} names a node outside 0..{points}");
                return Err(self.storage.malformed(nodes_at, what));
            };
            start += listed.len();
            let count = listed.len();
            cells.push(self::cell(number, listed, self.order).map_err(|refused| match refused {
                Refused::Nodes { wanted } => {
                    let what = format!("cell {cell} has {count} nodes, its type {number} needs {wanted}");
                    self.storage.malformed(offsets_at, what)
                }
                Refused::Type(name) => {
                    let what = format!("{name} of VTK type {number} (cell {cell})");
                    self.source.unsupported(types_at.start, describe(types_at), what, OTHER_CELLS)
                }
            })?);
        }
        Ok(cells)
    }

    pub fn integers(&self, element: &Element<'a>, count: u64) -> Result<Vec<i64>, ReadError> {
        match self.storage.read(element, Expect::Tuples(count))? {
            Numbers::Integers(values) => Ok(values),
            Numbers::Reals(_) => Err(self.storage.malformed(element, "its type must be an integer")),
        }
    }

    pub fn section(&self, name: &str) -> Result<&Element<'a>, ReadError> {
        self.piece.child(name).ok_or_else(|| self.missing(self.piece, &format!("<{name}>")))
    }

    pub fn missing(&self, element: &Element, what: &str) -> ReadError {
        self.storage.malformed(element, format!("it has no {what}"))
    }
}
