//! The same mesh with its nodes elsewhere: scaled, distorted, bent.

use crate::build::orient;
use crate::{Fault, Mesh, MeshError};

impl Mesh {
    /// The same cells and names on other reference positions, one per node.
    ///
    /// # Errors
    /// [`MeshError::Faulty`] when a position is not finite, a plane mesh leaves z = 0, or a cell is flat, folded or
    /// turned inside out.
    pub fn with_points(mut self, points: Vec<[f64; 3]>) -> Result<Mesh, MeshError> {
        match check(&mut self, &points) {
            Ok(()) => Ok(Mesh { points, ..self }),
            Err(fault) => Err(MeshError::Faulty { mesh: self.name, fault: Box::new(fault) }),
        }
    }

    /// Every node X moved to `map(X)`; for errors see [`Mesh::with_points`].
    ///
    /// # Errors
    /// [`MeshError::Faulty`].
    pub fn mapped(self, map: impl FnMut([f64; 3]) -> [f64; 3]) -> Result<Mesh, MeshError> {
        let points = self.points.iter().copied().map(map).collect();
        self.with_points(points)
    }

    /// All coordinates multiplied by `factor`, for instance 1e-3 for a drawing in millimetres.
    ///
    /// # Errors
    /// [`MeshError::Faulty`] unless the factor is positive and finite.
    pub fn scaled(self, factor: f64) -> Result<Mesh, MeshError> {
        if !(factor > 0.0 && factor.is_finite()) {
            return Err(MeshError::Faulty { mesh: self.name, fault: Box::new(Fault::Scale { factor }) });
        }
        self.mapped(|point| point.map(|x| x * factor))
    }
}

fn check(mesh: &mut Mesh, points: &[[f64; 3]]) -> Result<(), Fault> {
    if points.len() != mesh.points.len() {
        let what = "positions of the nodes".to_owned();
        return Err(Fault::Inconsistent { what, found: points.len(), expected: mesh.points.len() });
    }
    for (node, point) in (0u64..).zip(points) {
        if !point.iter().all(|x| x.is_finite()) {
            return Err(Fault::NotFinite { node, point: *point });
        }
        if mesh.dim == 2 && point[2] != 0.0 {
            return Err(Fault::Membrane { node, z: point[2], other: 0, other_z: mesh.points[0][2] });
        }
    }
    match orient(&mut mesh.blocks, points, |id| id as u64)?.first() {
        Some(&id) => Err(Fault::InsideOut { cell: id as u64, kind: mesh.cell(id).kind }),
        None => Ok(()),
    }
}
