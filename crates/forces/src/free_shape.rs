//! [`ShapeNodes`]: where the nodes of the drawn body are under a [`FreeShape`].

mod harmonic_extension;
mod operator;
mod skin_map;
mod surface_filter;

pub use skin_map::{DrawnKeeper, SkinMap};

use crate::no_force::NoForce;
use nastic_body::body_energy::free_shape::FreeShape;
use nastic_body::contribution::Contribution;
use nastic_body::contribution::point::{ContributionPoint, Need};
use nastic_body::controls::{ControlPoint, check_finite};
use nastic_body::discretization::Discretization;
use nastic_body::error::{FemError, Inadmissible};
use nastic_body::instant::Instant;
use nastic_energy::Slot;

/// The displacements s of the nodes of the drawn body, `dim` numbers at every node, which other blocks of controls (the gradients that the laws see) follow too: where equilibria begin, and what results
/// show. It has no force: that of a change of shape is in the laws.
#[derive(Debug)]
pub struct ShapeNodes {
    shape: FreeShape,
    slots: Vec<Slot>,
    points: Vec<ControlPoint>,
}

impl ShapeNodes {
    /// Of a body.
    pub fn new(shape: FreeShape, disc: &Discretization) -> Self {
        let slot = |i| Slot { component: Some(i), ..Slot::design("displacement", "m", 0.0) };
        let places = disc.mesh().points();
        let mut weights = vec![0.0; places.len()];
        disc.points().spread(disc.points().weights(), 1, &mut weights);
        let points = places.iter().zip(weights).map(|(position, weight)| ControlPoint { position: *position, weight });
        ShapeNodes { slots: (0..disc.dim()).map(slot).collect(), points: points.collect(), shape }
    }
}

impl Contribution for ShapeNodes {
    fn name(&self) -> &str {
        &self.shape.name
    }

    fn slots(&self) -> &[Slot] {
        &self.slots
    }

    fn control_points(&self) -> &[ControlPoint] {
        &self.points
    }

    fn check_controls(&self, values: &[f64]) -> Result<(), FemError> {
        check_finite(&format!("the displacement of shape \"{}\"", self.shape.name), values)
    }

    fn free_shape(&self) -> Option<&FreeShape> {
        Some(&self.shape)
    }

    fn is_stiff(&self) -> bool {
        false
    }

    fn at<'a>(&'a self, _: &Instant, _: Need) -> Result<Box<dyn ContributionPoint + 'a>, Inadmissible> {
        Ok(Box::new(NoForce))
    }
}
