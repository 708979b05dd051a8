//! [`BoundContact`]: a contact on a body.

use super::friction;
use super::layer::Layer;
use super::point::ContactPoint;
use super::pose::Pose;
use super::stencil::{Counterpart, Move};
use crate::rigid_motion;
use nastic_body::contribution::Contribution;
use nastic_body::contribution::point::{ContributionPoint, Need};
use nastic_body::contribution::touches::Touches;
use nastic_body::error::{FemError, Inadmissible};
use nastic_body::instant::Instant;
use nastic_energy::Slot;
use nastic_linear::Symmetry;
use nastic_numeric::vector::sub;

/// The contribution of a [`Contact`](super::Contact), by what its surface touches.
#[derive(Debug, Clone)]
pub(super) struct BoundContact<W> {
    pub layer: Layer,
    pub with: W,
    /// Displacements that it resists to: `n . u` at every sample, less that of what is nearest to it.
    pub normals: Vec<Vec<(u32, f64)>>,
}

impl<W: Counterpart> Contribution for BoundContact<W> {
    fn name(&self) -> &str {
        &self.layer.name
    }

    fn symmetry(&self) -> Symmetry {
        let general = self.layer.slip_speed.is_some() && !self.layer.lagged;
        if general { Symmetry::General } else { Symmetry::Symmetric }
    }

    fn slots(&self) -> &[Slot] {
        &self.layer.slots
    }

    fn shared_slots(&self) -> Option<(&str, usize)> {
        let moved = self.layer.moved.as_ref()?;
        moved.name.as_deref().map(|name| (name, self.layer.stiffness))
    }

    fn path_dependence(&self) -> Option<&'static str> {
        self.layer.slip_speed.map(|_| friction::PATH)
    }

    fn check_controls(&self, values: &[f64]) -> Result<(), FemError> {
        if self.layer.moved.is_some() {
            rigid_motion::check(&format!("contact \"{}\": its obstacle", self.layer.name), self.layer.dim, values)?;
        }
        let friction = values.get(self.layer.friction()).copied();
        friction::check_controls(&self.layer.name, values[self.layer.stiffness], friction)
    }

    /// A side that is not touched does not push, which the search for an equilibrium finds.
    fn resists(&self) -> &[Vec<(u32, f64)>] {
        &self.normals
    }

    /// Within the layer, or no deeper than it is thick.
    fn check_start(&self, at: &Instant) -> Result<(), Inadmissible> {
        let (nearest, extent) = (W::nearest(self, &W::state(self, at, true)?, at), self.with.extent());
        match nearest {
            // multipliers begin at an equilibrium, however deep its layer let it in
            Some(nearest) if nearest.gap + extent.inset < -self.layer.thickness && !extent.is_exact => {
                Err(self.layer.penetrates(&nearest.place, -(nearest.gap + extent.inset)))
            }
            _ => Ok(()),
        }
    }

    fn max_change(&self, at: &Instant, to: &Instant) -> Result<f64, Inadmissible> {
        let (way, poses) = (sub(to.u, at.u), [at, to].map(|at| self.layer.pose(at)));
        match way.iter().all(|way| *way == 0.0) && Pose::are_alike(&poses[0], &poses[1]) {
            true => Ok(1.0),
            false => {
                Ok(W::longest_move(self, &W::state(self, at, false)?, at, &Move { way: &way, to: Some(to.controls) }))
            }
        }
    }

    fn touches(&self) -> Option<&dyn Touches> {
        Some(self)
    }

    fn quantities(&self, at: &Instant) -> Vec<(&'static str, f64)> {
        self.told(at).map(|touch| touch.quantities(self.layer.dim)).unwrap_or_default()
    }

    fn at<'a>(&'a self, at: &Instant, _: Need) -> Result<Box<dyn ContributionPoint + 'a>, Inadmissible> {
        Ok(Box::new(ContactPoint::new(self, at)?))
    }
}
