//! A mesh with named fields on it: what is written to files and drawn.

use crate::{Mesh, MeshError, Polyline, RawMesh};
use std::sync::Arc;

/// A field with a name: `components` numbers per node or cell, entity after entity.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedArray {
    /// What the field is called in files.
    pub name: String,
    /// Numbers per entity: 1 scalar, 3 vector, 9 tensor (row-major).
    pub components: usize,
    /// `components * entities` numbers.
    pub values: Vec<f64>,
    /// Whether files hold it in single precision; its values are rounded to that.
    pub single: bool,
}

impl NamedArray {
    /// The numbers of one node or cell.
    ///
    /// # Panics
    /// If there is no such entity, as slices do.
    pub fn at(&self, entity: usize) -> &[f64] {
        &self.values[entity * self.components..][..self.components]
    }

    /// Number of nodes or cells it covers.
    pub fn entities(&self) -> usize {
        self.values.len().checked_div(self.components).unwrap_or(0)
    }
}

/// A mesh with nodal and cell-wise fields, in the order of its nodes and cells.
#[derive(Clone, Debug)]
pub struct Snapshot {
    /// The mesh, in its reference position.
    pub mesh: Arc<Mesh>,
    /// Fields on nodes. "displacement" (3 components) moves the shape in viewers.
    pub point_data: Vec<NamedArray>,
    /// Fields on cells.
    pub cell_data: Vec<NamedArray>,
    /// Lines beside the cells, in the displaced body.
    pub lines: Vec<Polyline>,
    /// Rigid obstacles beside the body, where they are.
    pub obstacles: Option<Arc<Mesh>>,
}

impl Snapshot {
    /// A mesh without fields.
    pub fn new(mesh: impl Into<Arc<Mesh>>) -> Snapshot {
        Snapshot {
            mesh: mesh.into(),
            point_data: Vec::new(),
            cell_data: Vec::new(),
            lines: Vec::new(),
            obstacles: None,
        }
    }

    /// Adds a nodal field; one of the same name is replaced.
    ///
    /// # Errors
    /// [`MeshError::ArrayLength`] unless there are `components` values per node.
    pub fn with_points(mut self, name: &str, components: usize, values: Vec<f64>) -> Result<Snapshot, MeshError> {
        let array = array(name, components, values, self.mesh.points().len())?;
        put(&mut self.point_data, array);
        Ok(self)
    }

    /// Adds a cell-wise field; one of the same name is replaced.
    ///
    /// # Errors
    /// [`MeshError::ArrayLength`] unless there are `components` values per cell.
    pub fn with_cells(mut self, name: &str, components: usize, values: Vec<f64>) -> Result<Snapshot, MeshError> {
        let array = array(name, components, values, self.mesh.cells())?;
        put(&mut self.cell_data, array);
        Ok(self)
    }

    /// Some cells as a mesh of their own, whose skin is all around them, with the fields there and the same lines and obstacles; `None` of no cell.
    #[must_use]
    pub fn of_cells(&self, is_kept: impl Fn(usize) -> bool) -> Option<Snapshot> {
        let mut raw = RawMesh::new(self.mesh.name());
        raw.points = self.mesh.points().to_vec();
        let cells: Vec<usize> = (0..self.mesh.cells()).filter(|cell| is_kept(*cell)).collect();
        for cell in &cells {
            let cell = self.mesh.cell(*cell);
            raw.push(cell.kind, cell.nodes, &[]);
        }
        let mesh = Mesh::build(raw).ok()?;
        let of = |array: &NamedArray, entities: &mut dyn Iterator<Item = usize>| NamedArray {
            values: entities.flat_map(|entity| array.at(entity).iter().copied()).collect(),
            ..array.clone()
        };
        let nodes = || mesh.node_origin().iter().map(|node| *node as usize);
        let cells = || mesh.cell_origin().iter().map(|cell| cells[*cell as usize]);
        Some(Snapshot {
            point_data: self.point_data.iter().map(|array| of(array, &mut nodes())).collect(),
            cell_data: self.cell_data.iter().map(|array| of(array, &mut cells())).collect(),
            lines: self.lines.clone(),
            obstacles: self.obstacles.clone(),
            mesh: Arc::new(mesh),
        })
    }

    /// Rounds the fields of these names, nodal and cell-wise, to single precision, in which files then hold them.
    pub fn in_single(mut self, names: &[&str]) -> Snapshot {
        let arrays = self.point_data.iter_mut().chain(&mut self.cell_data);
        for array in arrays.filter(|array| names.contains(&array.name.as_str())) {
            array.single = true;
            array.values.iter_mut().for_each(|value| *value = f64::from(*value as f32));
        }
        self
    }

    /// With these lines beside its cells.
    pub fn with_lines(mut self, lines: Vec<Polyline>) -> Snapshot {
        self.lines = lines;
        self
    }

    /// The nodal field of that name.
    pub fn point_array(&self, name: &str) -> Option<&NamedArray> {
        self.point_data.iter().find(|array| array.name == name)
    }

    /// The cell-wise field of that name.
    pub fn cell_array(&self, name: &str) -> Option<&NamedArray> {
        self.cell_data.iter().find(|array| array.name == name)
    }

    /// Node positions moved by the field "displacement", if there is one of two or three components.
    pub fn positions(&self) -> Vec<[f64; 3]> {
        let mut positions = self.mesh.points().to_vec();
        if let Some(u) = self.point_array("displacement").filter(|u| matches!(u.components, 2 | 3)) {
            for (x, u) in positions.iter_mut().zip(u.values.chunks_exact(u.components)) {
                x.iter_mut().zip(u).for_each(|(x, u)| *x += u);
            }
        }
        positions
    }
}

fn array(name: &str, components: usize, values: Vec<f64>, entities: usize) -> Result<NamedArray, MeshError> {
    let (name, found, expected) = (name.to_owned(), values.len(), components * entities);
    if components == 0 || found != expected {
        return Err(MeshError::ArrayLength { name, found, expected, entities, components });
    }
    Ok(NamedArray { name, components, values, single: false })
}

fn put(arrays: &mut Vec<NamedArray>, array: NamedArray) {
    match arrays.iter_mut().find(|old| old.name == array.name) {
        Some(old) => *old = array,
        None => arrays.push(array),
    }
}
