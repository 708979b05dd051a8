//! [`Anchor`]: a proximal term about the present displacement.

use crate::model::Model;
use nastic_body::contribution::Sums;
use nastic_linear::SparseMatrix;

/// Least stiffness, as a share of the mean stiffness of the body per volume: the tangent of a body that rolls is singular without an anchor.
const MIN_ANCHOR_RATIO: f64 = 1e-10;

/// Springs from every node to where it is, by its volume: the potential `(s/2) sum_a V_a |u_a - c_a|^2`, s a stiffness per volume (N/m^4).
#[derive(Debug, Clone)]
pub(crate) struct Anchor {
    /// c
    at: Vec<f64>,
    /// `s V_a`, zero of further fields and of multipliers.
    stiffness: Vec<f64>,
}

impl Anchor {
    /// At unknowns of a model.
    pub fn new(model: &Model, at: &[f64], stiffness: f64) -> Self {
        let stiffness = model.volumes_by_unknown().into_iter().map(|volume| stiffness * volume).collect();
        Anchor { at: at.to_vec(), stiffness }
    }

    /// The least stiffness, by the tangent of the model: it matters only where nothing else resists.
    pub fn least(model: &Model, tangent: &SparseMatrix) -> f64 {
        let disc = model.discretization();
        let diagonal: f64 = tangent.diagonal().iter().map(|entry| entry.abs()).sum();
        MIN_ANCHOR_RATIO * diagonal / (disc.dim() as f64 * disc.nodal_volumes().iter().sum::<f64>())
    }

    /// What it adds to the tangent: a diagonal, by unknowns on nodes.
    pub fn diagonal(&self) -> &[f64] {
        &self.stiffness
    }

    /// Adds energy and residual at x.
    pub fn add(&self, x: &[f64], sums: &mut Sums) {
        for (dof, ((x, c), s)) in x.iter().zip(&self.at).zip(&self.stiffness).enumerate() {
            let (moved, force) = (x - c, s * (x - c));
            sums.energy += 0.5 * force * moved;
            sums.energy_scale += 0.5 * force * moved;
            sums.force[dof] += force;
            sums.force_scale[dof] += force.abs();
        }
    }
}
