//! [`Side`]: one of two shapes that are compared.

use super::distances::apart;
use super::{ComparedPart, nodes_of};
use crate::error::ReportError;
use crate::figure::State;
use crate::folder::ResultFolder;
use nastic_io::{is_cloud, read_cloud, read_mesh, read_snapshot};
use nastic_mesh::spatial::{Aabb, Shape, Surface, Tree, exterior_facets};
use nastic_mesh::{Mesh, Snapshot};
use std::path::Path;
use std::sync::Arc;

/// A shape: its points, and how to find the nearest of it.
pub(super) struct Side {
    /// The file, or the state of a directory.
    pub name: String,
    /// What is compared of it.
    pub of: String,
    /// The unit of length that its results say.
    pub unit: Option<String>,
    pub points: Vec<[f64; 3]>,
    /// Of a mesh.
    pub body: Option<Body>,
    search: Search,
}

/// A mesh at its positions.
pub(super) struct Body {
    pub mesh: Arc<Mesh>,
    pub positions: Vec<[f64; 3]>,
    /// All nodes of the part.
    pub nodes: Vec<u32>,
    /// Of a whole body or a region.
    pub solid: Option<Shape>,
}

/// What finds nearest points.
enum Search {
    Surface(Surface),
    Points(Tree),
}

impl Side {
    pub fn open(path: &Path, part: &ComparedPart, scale: f64) -> Result<Self, ReportError> {
        if is_cloud(path) {
            return Self::of_cloud(path, scale);
        }
        if path.is_dir() {
            return Self::of_state(path, None, part, scale);
        }
        if !path.exists()
            && let (Some(parent), Some(name)) = (path.parent(), path.file_name())
            && parent.join("result.json").exists()
        {
            return Self::of_state(parent, Some(&name.to_string_lossy()), part, scale);
        }
        let is = |ending: &str| path.extension().is_some_and(|own| own.eq_ignore_ascii_case(ending));
        let (snapshot, unit) = if is("vtu") {
            (read_snapshot(path)?, unit_beside(path))
        } else if is("msh") || is("vtk") {
            (Snapshot::new(read_mesh(path, 1.0)?), None)
        } else {
            return Err(ReportError::NoShape { path: path.to_owned() });
        };
        Self::of_mesh(path.display().to_string(), &snapshot, unit, part, scale)
    }

    fn of_cloud(path: &Path, scale: f64) -> Result<Self, ReportError> {
        let points = read_cloud(path, scale)?;
        let boxes: Vec<Aabb> = points.iter().map(|x| Aabb::around([&(*x).into()])).collect();
        Ok(Self {
            name: path.display().to_string(),
            of: "points of the cloud".to_owned(),
            unit: None,
            body: None,
            search: Search::Points(Tree::build(&boxes)),
            points,
        })
    }

    fn of_state(directory: &Path, name: Option<&str>, part: &ComparedPart, scale: f64) -> Result<Self, ReportError> {
        let folder = ResultFolder::open(directory)?;
        let state = State::find(&folder, name)?;
        let unit = Some(folder.result.units.length.clone()).filter(|unit| !unit.is_empty());
        let name = directory.join(&state.name).display().to_string();
        Self::of_mesh(name, &state.shot, unit, part, scale)
    }

    fn of_mesh(
        name: String,
        snapshot: &Snapshot,
        unit: Option<String>,
        part: &ComparedPart,
        scale: f64,
    ) -> Result<Self, ReportError> {
        let mesh = snapshot.mesh.clone();
        let positions: Vec<[f64; 3]> = snapshot.positions().into_iter().map(|x| x.map(|x| scale * x)).collect();
        let facets = match part {
            ComparedPart::Whole => exterior_facets(&mesh, &(0..mesh.cells() as u32).collect::<Vec<_>>()),
            ComparedPart::Region(names) => exterior_facets(&mesh, &mesh.cells_of(names)?),
            ComparedPart::Surface(names) => mesh.facets_of(names)?,
        };
        let solid = |regions| Shape::of(&mesh, &positions, regions).map(Some);
        let (of, solid) = match part {
            ComparedPart::Whole => ("nodes of its boundary".to_owned(), solid(None)?),
            ComparedPart::Region(names) => (format!("nodes of the boundary of region {names}"), solid(Some(names))?),
            ComparedPart::Surface(names) => (format!("nodes of surface {names}"), None),
        };
        let nodes = nodes_of(&mesh, part)?;
        let search = Search::Surface(Surface::of(&mesh, &positions, &facets)?);
        let points = mesh.nodes_of_facets(&facets).iter().map(|&node| positions[node as usize]).collect();
        Ok(Self { name, of, unit, points, search, body: Some(Body { mesh, positions, nodes, solid }) })
    }

    /// The nearest point and its distance.
    pub fn nearest(&self, point: [f64; 3]) -> ([f64; 3], f64) {
        match &self.search {
            Search::Surface(surface) => surface.nearest(point),
            Search::Points(tree) => {
                let mut best = (point, f64::INFINITY);
                tree.nearest(&point.into(), f64::INFINITY, |k, limit| {
                    let distance = apart(point, self.points[k]);
                    if distance * distance < limit {
                        best = (self.points[k], distance);
                    }
                    limit.min(distance * distance)
                });
                best
            }
        }
    }
}

impl Body {
    /// Whether both are states of one mesh: the same cells between the same points.
    pub fn is_on_mesh_of(&self, other: &Body) -> bool {
        let (a, b) = (&self.mesh, &other.mesh);
        Arc::ptr_eq(a, b)
            || (a.points() == b.points()
                && a.cells() == b.cells()
                && (0..a.cells()).all(|k| (a.cell(k).kind, a.cell(k).nodes) == (b.cell(k).kind, b.cell(k).nodes)))
    }
}

/// The unit that the results beside a file say, if it is one of them.
fn unit_beside(path: &Path) -> Option<String> {
    let folder = ResultFolder::open(path.parent()?).ok()?;
    let unit = folder.result.units.length.clone();
    (folder.wrote(path.file_name()?.to_str()?) && !unit.is_empty()).then_some(unit)
}
