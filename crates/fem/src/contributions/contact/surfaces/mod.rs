//! [`SurfaceContact`]: surfaces of bodies that touch each other, or themselves.

mod bound;
mod gap;
mod moves;
mod pieces;
mod point;
mod side;
mod simplex;
mod sums;

use super::ContactLaw;
use crate::contributions::body_energy::BodyEnergy;
use crate::error::FemError;
pub(crate) use bound::BoundSurfaces;
use nastic_mesh::GroupNames;

/// Two surfaces that push each other back, without friction; or one that pushes itself back.
///
/// **Potential.** `sum_s w_s psi(d_s)` over the samples s of either surface, with half of their reference areas as w_s (both walls that touch have
/// samples), psi a [`ContactLaw`] of thickness delta and stiffness k (Pa). The gap of a sample is its distance from the other
/// surface less `2 delta`: where surfaces touch, they stay about `2 delta` apart, and no edge is so sharp that a distance has no derivative.
///
/// ```text
/// d = -e ln(sum_i exp(-|x_s - y_i| / e)) - 2 delta,     e = delta / 100
/// ```
///
/// over the flat pieces i of the other surface (between the nodes of its facets), y_i the nearest point of each, moving with the body. The
/// smooth least distance keeps the force continuous where a sample passes from one piece of a hollow to the next.
///
/// Forces on the two surfaces are equal and opposite, with equal moments, to rounding. The residual is continuously differentiable but
/// where the nearest point goes from a face to an edge or corner: there the tangent jumps.
///
/// Facets that share a node with a sample's own ones, or with a neighbour of these, are left out: a surface does not touch itself there.
/// Where edges cross between samples nothing is seen.
///
/// **Control**: the stiffness (Pa), a design.
///
/// Source: docs/contact.md; nearest points as in Ericson, "Real-time collision detection" (2005), section 5.1.5.
#[derive(Debug, Clone)]
pub struct SurfaceContact {
    name: String,
    surfaces: [GroupNames; 2],
    law: ContactLaw,
    thickness: Option<f64>,
    stiffness: Option<f64>,
    refine: usize,
}

impl SurfaceContact {
    /// Of a surface, or several together, with another; of a surface with itself where both are the same.
    pub fn between(name: &str, surface: impl Into<GroupNames>, other: impl Into<GroupNames>) -> Self {
        SurfaceContact {
            name: name.to_owned(),
            surfaces: [surface.into(), other.into()],
            law: ContactLaw::Cubic,
            thickness: None,
            stiffness: None,
            refine: 1,
        }
    }

    /// Another law of the pressure.
    #[must_use]
    pub fn law(mut self, law: ContactLaw) -> Self {
        self.law = law;
        self
    }

    /// Thickness delta of the layer in which it acts, m. If not given 1/500 of the diagonal of the smaller surface, and no more than a quarter of the
    /// distance between the surfaces at rest.
    #[must_use]
    pub fn thickness(mut self, thickness: f64) -> Self {
        self.thickness = Some(thickness);
        self
    }

    /// Stiffness k, Pa; if not given that of [`Contact`](crate::Contact) by the softer of both sides.
    #[must_use]
    pub fn stiffness(mut self, stiffness: f64) -> Self {
        self.stiffness = Some(stiffness);
        self
    }

    /// Samples of each facet as of `refine^2` pieces, 1 if not given: its nodes.
    #[must_use]
    pub fn refine(mut self, refine: usize) -> Self {
        self.refine = refine;
        self
    }

    /// The contribution on a body whose materials are there.
    ///
    /// # Errors
    /// An unknown surface, numbers that are none; surfaces that are nearer at rest than twice the thickness; no stiffness given and no
    /// material behind a surface.
    pub(crate) fn on(&self, body: &BodyEnergy) -> Result<BoundSurfaces, FemError> {
        BoundSurfaces::new(self, body)
    }
}
