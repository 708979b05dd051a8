//! [`Surface`]: faces of a mesh to search.

use super::boundary::Boundary;
use super::shape::{check, conversion, exterior};
use super::tree::Aabb;
use super::{SpatialError, V};
use crate::{Facet, Mesh};
use std::collections::BTreeMap;

/// Sag of the pieces of a facet, as a share of the diagonal.
const MAX_SAG_RATIO: f64 = 1e-4;

/// Faces of a mesh at given positions, curved ones as they are, with an index over them.
#[derive(Clone, Debug)]
pub struct Surface {
    boundary: Boundary,
}

impl Surface {
    /// These facets of a mesh at these positions (one per mesh node, m).
    ///
    /// # Errors
    /// A position count that is not the node count, a position that is not finite, no facets.
    pub fn of(mesh: &Mesh, positions: &[[f64; 3]], facets: &[Facet]) -> Result<Self, SpatialError> {
        check(mesh, positions)?;
        if facets.is_empty() {
            return Err(SpatialError::Empty { mesh: mesh.name().into(), region: "(no facets)".to_owned() });
        }
        let mut boundary = Boundary::new(mesh.dim() == 2);
        let mut conversions = BTreeMap::new();
        let points: Vec<V> = positions.iter().map(|x| V::from(*x)).collect();
        let flatness = MAX_SAG_RATIO * Aabb::around(&points).diagonal();
        for facet in facets {
            let (kind, nodes) = mesh.facet_nodes(*facet);
            let nodes: Vec<V> = nodes.iter().map(|&node| points[node as usize]).collect();
            boundary.push(conversion(&mut conversions, kind), &nodes, flatness);
        }
        boundary.finish();
        Ok(Self { boundary })
    }

    /// The nearest point and its distance; an infinite distance from points that are not finite.
    pub fn nearest(&self, p: [f64; 3]) -> ([f64; 3], f64) {
        match self.boundary.nearest(&V::from(p), None) {
            Some(near) => (near.point.into(), near.squared.sqrt()),
            None => (p, f64::INFINITY),
        }
    }
}

/// Facets that belong to one of these cells only, in the order of the cells.
pub fn exterior_facets(mesh: &Mesh, cells: &[u32]) -> Vec<Facet> {
    exterior(mesh, cells).into_iter().map(|(cell, face)| Facet { cell, face: face as u8 }).collect()
}
