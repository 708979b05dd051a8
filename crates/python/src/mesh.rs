//! Meshes from NumPy arrays, and their arrays.

use crate::error;
use nastic_language::syntax::quoted;
use nastic_mesh::{CellKind, RawMesh};
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::collections::BTreeSet;
use std::sync::Arc;

/// A checked mesh.
#[pyclass(frozen, module = "nastic._nastic")]
pub(crate) struct Mesh {
    pub mesh: Arc<nastic_mesh::Mesh>,
}

type Named<T> = Vec<(String, T)>;

#[pymethods]
impl Mesh {
    /// `points` `[n][2 or 3]`; `cells` by kind `[k][nodes]`; `regions`: numbers of cells, through all kinds; `facets`: nodes of every
    /// facet of a surface; `surfaces`: nodes, of which the boundary facets all of whose nodes are among them make the surface; `nodes`:
    /// node sets.
    #[new]
    #[allow(clippy::too_many_arguments)]
    fn new(
        py: Python<'_>,
        name: &str,
        points: PyReadonlyArray2<'_, f64>,
        cells: Named<PyReadonlyArray2<'_, i64>>,
        regions: Named<PyReadonlyArray1<'_, i64>>,
        facets: Named<PyReadonlyArray2<'_, i64>>,
        surfaces: Named<PyReadonlyArray1<'_, i64>>,
        nodes: Named<PyReadonlyArray1<'_, i64>>,
    ) -> PyResult<Self> {
        let rows1 = |(name, array): &(String, PyReadonlyArray1<'_, i64>)| {
            (name.clone(), array.as_array().iter().copied().collect::<Vec<i64>>())
        };
        let rows2 = |(name, array): &(String, PyReadonlyArray2<'_, i64>)| {
            (name.clone(), array.as_array().rows().into_iter().map(|row| row.to_vec()).collect::<Vec<_>>())
        };
        let given = MeshArrays {
            name: name.to_owned(),
            points: points.as_array().rows().into_iter().map(|row| row.to_vec()).collect(),
            cells: cells.iter().map(rows2).collect(),
            regions: regions.iter().map(rows1).collect(),
            facets: facets.iter().map(rows2).collect(),
            surfaces: surfaces.iter().map(rows1).collect(),
            nodes: nodes.iter().map(rows1).collect(),
        };
        let mesh = py.detach(|| given.build()).map_err(|message| error::input(py, message))?;
        Ok(Self { mesh: Arc::new(mesh) })
    }

    /// What makes the same mesh again: the arguments of the class.
    fn parts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let out = arrays(py, &self.mesh)?;
        let facets = PyDict::new(py);
        for (name, own) in self.mesh.surfaces() {
            let nodes: Vec<Vec<i64>> =
                own.iter().map(|facet| self.mesh.facet_nodes(*facet).1.into_iter().map(i64::from).collect()).collect();
            let wide = nodes.first().map_or(0, Vec::len);
            if nodes.iter().any(|facet| facet.len() != wide) {
                return Err(error::input(py, format!("surface {} has facets of several kinds", quoted(name))));
            }
            facets.set_item(name, matrix(py, nodes.into_iter().flatten().collect(), wide)?)?;
        }
        out.set_item("facets", facets)?;
        Ok(out)
    }

    /// Points, cells by kind, regions, boundary facets of surfaces as `[cell, face]`, node sets, notes.
    fn arrays<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        arrays(py, &self.mesh)
    }
}

/// What a user gave, without borrowed arrays.
struct MeshArrays {
    name: String,
    points: Vec<Vec<f64>>,
    cells: Named<Vec<Vec<i64>>>,
    regions: Named<Vec<i64>>,
    facets: Named<Vec<Vec<i64>>>,
    surfaces: Named<Vec<i64>>,
    nodes: Named<Vec<i64>>,
}

impl MeshArrays {
    fn build(&self) -> Result<nastic_mesh::Mesh, String> {
        let mut raw = RawMesh::new(&self.name);
        raw.points = self.points.iter().map(|p| point(p)).collect::<Result<_, _>>()?;
        let dim = self.add_cells(&mut raw)?;
        let mut tag = self.regions.len() as i32;
        for (name, facets) in &self.facets {
            tag += 1;
            raw.name_group(dim - 1, tag, name);
            for nodes in facets {
                let kind = facet_kind(dim, nodes.len()).ok_or_else(|| {
                    format!("surface {}: no facet in {dim} dimensions has {} nodes", quoted(name), nodes.len())
                })?;
                raw.push(kind, &self.node_numbers(nodes)?, &[tag]);
            }
        }
        for (name, nodes) in &self.nodes {
            tag += 1;
            raw.name_group(0, tag, name);
            raw.vertices.extend(self.node_numbers(nodes)?.into_iter().map(|node| (node, tag)));
        }
        if !self.surfaces.is_empty() {
            self.add_surfaces_of_nodes(&mut raw, dim, tag)?;
        }
        nastic_mesh::Mesh::build(raw).map_err(|error| error.to_string())
    }

    /// All cells with their regions; the dimension.
    fn add_cells(&self, raw: &mut RawMesh) -> Result<usize, String> {
        let count = self.cells.iter().map(|(_, cells)| cells.len()).sum();
        let mut tags = vec![Vec::new(); count];
        for (k, (name, cells)) in self.regions.iter().enumerate() {
            for &cell in cells {
                let tags: &mut Vec<i32> =
                    usize::try_from(cell).ok().and_then(|cell| tags.get_mut(cell)).ok_or_else(|| {
                        format!(
                            "region {}: there is no cell {cell}: cells are numbered from 0 to {}",
                            quoted(name),
                            count - 1
                        )
                    })?;
                tags.push(k as i32 + 1);
            }
        }
        let mut tags = tags.into_iter();
        let mut dim = 0;
        for (kind, cells) in &self.cells {
            let kind = CellKind::from_name(kind).ok_or_else(|| {
                let known: Vec<&str> = CellKind::ALL.into_iter().map(CellKind::name).collect();
                format!("cells {}: no kind of cell; there are {}", quoted(kind), known.join(", "))
            })?;
            dim = dim.max(kind.dim());
            for (nodes, tags) in cells.iter().zip(&mut tags) {
                if nodes.len() != kind.nodes() {
                    return Err(format!(
                        "cells of kind {} have {} nodes, found {}",
                        kind.name(),
                        kind.nodes(),
                        nodes.len()
                    ));
                }
                raw.push(kind, &self.node_numbers(nodes)?, &tags);
            }
        }
        if dim < 2 {
            return Err("a mesh needs cells: cells={\"tet10\": array of node numbers [cells][10]}".to_owned());
        }
        for (k, (name, _)) in self.regions.iter().enumerate() {
            raw.name_group(dim, k as i32 + 1, name);
        }
        Ok(dim)
    }

    /// Surfaces of all boundary facets whose nodes are given.
    fn add_surfaces_of_nodes(&self, raw: &mut RawMesh, dim: usize, mut tag: i32) -> Result<(), String> {
        let body = nastic_mesh::Mesh::build(raw.clone()).map_err(|error| error.to_string())?;
        for (name, nodes) in &self.surfaces {
            tag += 1;
            raw.name_group(dim - 1, tag, name);
            let nodes: BTreeSet<u32> = self.node_numbers(nodes)?.into_iter().collect();
            let mut found = false;
            for &facet in body.boundary() {
                let (kind, own) = body.facet_nodes(facet);
                let own: Vec<u32> = own.into_iter().map(|node| body.node_origin()[node as usize]).collect();
                if own.iter().all(|node| nodes.contains(node)) {
                    raw.push(kind, &own, &[tag]);
                    found = true;
                }
            }
            if !found {
                return Err(format!(
                    "surface {}: no facet of the boundary has all its nodes among the {} given",
                    quoted(name),
                    nodes.len()
                ));
            }
        }
        Ok(())
    }

    fn node_numbers(&self, nodes: &[i64]) -> Result<Vec<u32>, String> {
        let count = self.points.len();
        let number = |&node: &i64| match u32::try_from(node) {
            Ok(number) if (number as usize) < count => Ok(number),
            _ => Err(format!("there is no node {node}: nodes are numbered from 0 to {}", count.saturating_sub(1))),
        };
        nodes.iter().map(number).collect()
    }
}

fn point(p: &[f64]) -> Result<[f64; 3], String> {
    match *p {
        [x, y] => Ok([x, y, 0.0]),
        [x, y, z] => Ok([x, y, z]),
        _ => Err(format!("points have 2 or 3 coordinates, found {}", p.len())),
    }
}

/// The kind of facet with so many nodes.
fn facet_kind(dim: usize, nodes: usize) -> Option<CellKind> {
    CellKind::ALL.into_iter().find(|kind| kind.dim() + 1 == dim && kind.nodes() == nodes)
}

/// Everything a mesh holds; numbers of nodes and cells as `int64`.
pub(crate) fn arrays<'py>(py: Python<'py>, mesh: &nastic_mesh::Mesh) -> PyResult<Bound<'py, PyDict>> {
    let out = PyDict::new(py);
    let points: Vec<f64> = mesh.points().iter().flatten().copied().collect();
    out.set_item("points", matrix(py, points, 3)?)?;
    let cells = PyDict::new(py);
    for block in mesh.blocks() {
        let nodes = block.nodes.iter().map(|&node| i64::from(node)).collect();
        cells.set_item(block.kind.name(), matrix(py, nodes, block.kind.nodes())?)?;
    }
    out.set_item("cells", cells)?;
    for (key, sets) in [("regions", mesh.regions()), ("nodes", mesh.node_sets())] {
        let of = PyDict::new(py);
        for (name, members) in sets {
            of.set_item(name, PyArray1::from_iter(py, members.iter().map(|&member| i64::from(member))))?;
        }
        out.set_item(key, of)?;
    }
    let surfaces = PyDict::new(py);
    for (name, facets) in mesh.surfaces() {
        let pairs = facets.iter().flat_map(|facet| [i64::from(facet.cell), i64::from(facet.face)]).collect();
        surfaces.set_item(name, matrix(py, pairs, 2)?)?;
    }
    out.set_item("surfaces", surfaces)?;
    out.set_item("notes", mesh.notes())?;
    Ok(out)
}

/// An array `[rows][columns]` that takes over the memory of its values.
pub(crate) fn matrix<T: numpy::Element>(
    py: Python<'_>,
    values: Vec<T>,
    columns: usize,
) -> PyResult<Bound<'_, PyArray2<T>>> {
    let rows = values.len() / columns.max(1);
    PyArray1::from_vec(py, values).reshape([rows, columns])
}
