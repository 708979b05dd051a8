use std::collections::{BTreeMap, HashMap};

use super::boundary::Boundary;
use super::cell::Cells;
use super::patch_space::Conversion;
use super::tree::Aabb;
use super::{SpatialError, V};
use crate::{CellKind, GroupNames, Mesh};

/// Sag of the pieces of a facet, as a share of the diagonal.
const MAX_SAG_RATIO: f64 = 1e-4;

/// A solid to search: the cells of a mesh, or of one region, at given positions, with an index over cells and boundary
/// faces.
///
/// Curved cells and faces are taken as they are. Cells may overlap (a body pressed into itself is the union of its
/// cells); positions that turn cells inside out give an answer too, but then the boundary faces need not bound the
/// cells and no error bound holds.
#[derive(Clone, Debug)]
pub struct Shape {
    dim: usize,
    pub(super) cells: Cells,
    pub(super) boundary: Boundary,
    /// Mesh nodes at the corners of each cell's parameter domain.
    pub(super) corners: Vec<[u32; 8]>,
    /// Cells by their numbers in the mesh.
    pub(super) ids: Vec<u32>,
    /// Boundary faces in the order of the boundary.
    pub(super) faces: Vec<Face>,
    nodes: usize,
}

/// A boundary face.
#[derive(Clone, Copy, Debug)]
pub(super) struct Face {
    /// Its cell, counted within the shape.
    pub cell: u32,
    /// Its corner nodes, `u32::MAX` behind the last.
    pub corners: [u32; 4],
}

/// Where to look first: neighbouring questions have neighbouring answers.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Hint {
    part: Option<u32>,
    facet: Option<u32>,
}

/// The nearest point of a solid.
#[derive(Clone, Copy, Debug)]
pub(super) struct ClosestPoint {
    pub point: V,
    pub distance: f64,
}

impl Shape {
    /// The solid made of all cells, or of the cells of `region`, at these positions (one per mesh node, m).
    ///
    /// # Errors
    /// A position count that is not the node count, a position that is not finite, an unknown or empty region.
    pub fn new(mesh: &Mesh, positions: &[[f64; 3]], region: Option<&str>) -> Result<Self, SpatialError> {
        Self::of(mesh, positions, region.map(GroupNames::from).as_ref())
    }

    /// The same of the union of regions; of all cells without any.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn of(mesh: &Mesh, positions: &[[f64; 3]], regions: Option<&GroupNames>) -> Result<Self, SpatialError> {
        check(mesh, positions)?;
        let cells: Vec<u32> = match regions {
            Some(names) => mesh.cells_of(names)?,
            None => (0..mesh.cells() as u32).collect(),
        };
        if cells.is_empty() {
            let region = regions.map_or_else(|| "(all cells)".to_owned(), ToString::to_string);
            return Err(SpatialError::Empty { mesh: mesh.name().into(), region });
        }
        let mut conversions = BTreeMap::new();
        let mut shape = Self {
            dim: mesh.dim(),
            cells: Cells::default(),
            boundary: Boundary::new(mesh.dim() == 2),
            corners: Vec::with_capacity(cells.len()),
            ids: cells.clone(),
            faces: Vec::new(),
            nodes: positions.len(),
        };
        let gather = |nodes: &mut dyn Iterator<Item = u32>| -> Vec<V> {
            nodes.map(|n| V::from(positions[n as usize])).collect()
        };
        for &id in &cells {
            let cell = mesh.cell(id as usize);
            let conversion = conversion(&mut conversions, cell.kind);
            shape.cells.push(conversion, &gather(&mut cell.nodes.iter().copied()));
            let mut corners = [u32::MAX; 8];
            for (corner, &local) in corners.iter_mut().zip(&conversion.corners) {
                *corner = cell.nodes[local];
            }
            shape.corners.push(corners);
        }
        shape.cells.finish();
        let index_of: HashMap<u32, u32> = cells.iter().enumerate().map(|(k, &id)| (id, k as u32)).collect();
        let flatness = MAX_SAG_RATIO * shape.cells.bounds().diagonal();
        for (id, face) in exterior(mesh, &cells) {
            let cell = mesh.cell(id as usize);
            let (kind, locals) = cell.kind.faces()[face];
            let mut corners = [u32::MAX; 4];
            corners.iter_mut().zip(&locals[..kind.corners()]).for_each(|(node, &local)| *node = cell.nodes[local]);
            shape.faces.push(Face { cell: index_of[&id], corners });
            let nodes = gather(&mut locals.iter().map(|&l| cell.nodes[l]));
            shape.boundary.push(conversion(&mut conversions, kind), &nodes, flatness);
        }
        shape.boundary.finish();
        Ok(shape)
    }

    /// Space dimension: 2 or 3.
    pub fn dim(&self) -> usize {
        self.dim
    }

    /// Lower and upper corner of an axis-aligned box that holds the solid (a little larger than the smallest, where
    /// cells are curved).
    pub fn bounds(&self) -> ([f64; 3], [f64; 3]) {
        let Aabb { lo, hi } = self.cells.bounds();
        (lo.into(), hi.into())
    }

    /// Diagonal of [`bounds`](Self::bounds).
    pub fn diagonal(&self) -> f64 {
        self.cells.bounds().diagonal()
    }

    /// Is the point in the solid? Its boundary belongs to it, up to 1e-9 of a cell.
    pub fn contains(&self, p: [f64; 3]) -> bool {
        self.cells.find(&V::from(p), None).is_some()
    }

    /// The nearest point of the solid and its distance: the point itself and 0 inside.
    pub fn nearest(&self, p: [f64; 3]) -> ([f64; 3], f64) {
        let closest = self.closest_point(&V::from(p), &mut Hint::default());
        (closest.point.into(), closest.distance)
    }

    /// The nearest point of the solid's boundary and its distance, for points inside as well.
    pub fn nearest_boundary(&self, p: [f64; 3]) -> ([f64; 3], f64) {
        let closest = self.closest_boundary_point(&V::from(p), &mut Hint::default());
        (closest.point.into(), closest.distance)
    }

    /// Distance to the solid, 0 inside.
    pub fn distance(&self, p: [f64; 3]) -> f64 {
        self.nearest(p).1
    }

    pub(super) fn closest_point(&self, p: &V, hint: &mut Hint) -> ClosestPoint {
        if let Some(part) = self.cells.find(p, hint.part) {
            hint.part = Some(part);
            return ClosestPoint { point: *p, distance: 0.0 };
        }
        self.closest_boundary_point(p, hint)
    }

    fn closest_boundary_point(&self, p: &V, hint: &mut Hint) -> ClosestPoint {
        match self.boundary.nearest(p, hint.facet) {
            Some(near) => {
                hint.facet = Some(near.facet);
                ClosestPoint { point: near.point, distance: near.squared.sqrt() }
            }
            // No finite distance: p is NaN or beyond the range of squares.
            None => ClosestPoint { point: *p, distance: f64::INFINITY },
        }
    }

    /// Closest points on this solid of the corner nodes of the cells of another one, by node.
    pub(super) fn closest_points_of_corners(&self, of: &Self) -> Vec<Option<(V, ClosestPoint)>> {
        let mut closest = vec![None; of.nodes];
        let mut hint = Hint::default();
        for (cell, corners) in of.corners.iter().enumerate() {
            let patch = of.cells.patch(cell);
            for (i, &node) in corners.iter().enumerate().take(patch.space.corners()) {
                if let Some(slot @ None) = closest.get_mut(node as usize) {
                    let x = patch.value(&patch.space.corner(i));
                    *slot = Some((x, self.closest_point(&x, &mut hint)));
                }
            }
        }
        closest
    }
}

pub(super) fn check(mesh: &Mesh, positions: &[[f64; 3]]) -> Result<(), SpatialError> {
    let nodes = mesh.points().len();
    if positions.len() != nodes {
        return Err(SpatialError::Positions { mesh: mesh.name().into(), nodes, found: positions.len() });
    }
    match positions.iter().position(|x| x.iter().any(|v| !v.is_finite())) {
        Some(node) => Err(SpatialError::NotFinite { mesh: mesh.name().into(), node, position: positions[node] }),
        None => Ok(()),
    }
}

pub(super) fn conversion(known: &mut BTreeMap<CellKind, Conversion>, kind: CellKind) -> &Conversion {
    known.entry(kind).or_insert_with(|| Conversion::of(kind))
}

/// Faces (cell, face) that belong to one of these cells only, in the order of the cells.
pub(super) fn exterior(mesh: &Mesh, cells: &[u32]) -> Vec<(u32, usize)> {
    let mut faces = Vec::new();
    for &id in cells {
        let cell = mesh.cell(id as usize);
        for (face, (kind, locals)) in cell.kind.faces().iter().enumerate() {
            let mut key = [u32::MAX; 4];
            for (k, &local) in key.iter_mut().zip(&locals[..kind.corners()]) {
                *k = cell.nodes[local];
            }
            key.sort_unstable();
            faces.push((key, id, face));
        }
    }
    faces.sort_unstable();
    let mut alone: Vec<(u32, usize)> =
        faces.chunk_by(|a, b| a.0 == b.0).filter(|same| same.len() == 1).map(|same| (same[0].1, same[0].2)).collect();
    alone.sort_unstable();
    alone
}
