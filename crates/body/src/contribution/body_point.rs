//! [`BodyPoint`]: a point of the body that contributions act on.

use crate::error::FemError;
use nastic_mesh::Mesh;
use nastic_tensor::Vec3;

/// A point of the body, which moves with it: `x = sum_a w_a (X_a + u_a)`.
#[derive(Debug, Clone, PartialEq)]
pub enum BodyPoint {
    /// A place of the reference body; w are the values of its cell's shape functions there.
    At([f64; 3]),
    /// A node set by name: the mean of its nodes.
    Nodes(String),
}

impl From<[f64; 3]> for BodyPoint {
    fn from(place: [f64; 3]) -> Self {
        BodyPoint::At(place)
    }
}

impl From<&str> for BodyPoint {
    fn from(node_set: &str) -> Self {
        BodyPoint::Nodes(node_set.to_owned())
    }
}

/// Weights below this are rounding errors of shape functions, which would couple nodes that have nothing to do with the point.
const LEAST_WEIGHT: f64 = 1e-12;

/// Weights without those that are rounding errors.
pub fn without_rounding(weights: Vec<(u32, f64)>) -> Vec<(u32, f64)> {
    weights.into_iter().filter(|(_, weight)| weight.abs() > LEAST_WEIGHT).collect()
}

/// The nodes of a point, each with its weight, and where it is in the reference body. A fixed point of space has no nodes.
#[derive(Debug, Clone, PartialEq)]
pub struct AttachedPoint {
    /// Nodes with their weights, which sum to 1.
    pub weights: Vec<(u32, f64)>,
    /// Position in the reference body.
    pub reference: Vec3,
}

impl AttachedPoint {
    /// # Errors
    /// A place outside the body, with the nearest point of it and its distance; an unknown or empty node set.
    pub fn new(mesh: &Mesh, point: &BodyPoint) -> Result<Self, FemError> {
        let weights = match point {
            BodyPoint::At(place) => mesh.locate_inside(*place)?.weights,
            BodyPoint::Nodes(name) => {
                let nodes = mesh.node_set(name)?;
                nodes.iter().map(|&node| (node, 1.0 / nodes.len() as f64)).collect()
            }
        };
        let weights = without_rounding(weights);
        if weights.is_empty() {
            return Err(FemError::Meaningless { what: format!("the node set of {point:?} has no nodes") });
        }
        let position = |&(node, w): &(u32, f64)| w * Vec3::from(mesh.points()[node as usize]);
        let reference = weights.iter().map(position).sum();
        Ok(AttachedPoint { weights, reference })
    }

    /// A point of space that does not move.
    pub fn fixed(place: [f64; 3]) -> Self {
        AttachedPoint { weights: Vec::new(), reference: Vec3::from(place) }
    }

    /// The value there of a flat nodal field of `dim` components.
    pub fn of(&self, field: &[f64], dim: usize) -> Vec3 {
        let mut out = Vec3::zeros();
        for &(node, w) in &self.weights {
            (0..dim).for_each(|i| out[i] += w * field[dim * node as usize + i]);
        }
        out
    }

    /// Calls with every unknown of the point, its weight, and its component.
    pub fn each(&self, dim: usize, mut call: impl FnMut(usize, f64, usize)) {
        for &(node, w) in &self.weights {
            (0..dim).for_each(|i| call(dim * node as usize + i, w, i));
        }
    }

    /// Its nodes.
    pub fn nodes(&self) -> impl Iterator<Item = u32> + '_ {
        self.weights.iter().map(|(node, _)| *node)
    }
}
