//! [`SurfaceContact`]: surfaces of bodies that touch each other, or themselves.

mod bound;
mod edges;
mod gap;
mod lagged;
mod moves;
mod pieces;
mod point;
mod pressures;
mod recovery;
mod rub;
mod sample;
mod side;
mod simplex;
mod slid;
mod spin;
mod sums;

use super::ContactLaw;
use super::layer::{Layer, layer_methods};
pub(crate) use bound::BoundSurfaces;
use nastic_body::body_energy::BodyEnergy;
use nastic_body::error::FemError;
use nastic_mesh::GroupNames;

/// Two surfaces that push each other back, with friction or without; or one that pushes itself back.
///
/// **Potential**, without friction: `sum_s w_s psi(d_s)` over the samples s of either surface, with half of their reference areas as w_s (both walls that touch have
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
/// **Friction** (Coulomb) acts in time steps alone, as that of [`Contact`](crate::contact::Contact): a sample that a piece i presses with `pi_i p` (parts
/// `pi_i` of the pressure, of the least distance) bears `mu pi_i p f(v_t)` per area, the piece the opposite, with
///
/// ```text
/// v_t = (1 - n n^T) (v_s - v_y - omega x r),     r = x_s - y_i,     v_y = sum_a b_a v_a  of  y_i = sum_a b_a x_a
/// ```
///
/// omega the spin of the sample's own surface, fitted to the velocities of its corners: where both surfaces move as one rigid body nothing slides, though
/// they stand `2 delta` apart, and forces and moments of friction cancel too.
///
/// **Controls**: the stiffness (Pa) and the friction coefficient, designs.
///
/// Source: docs/contact.md; nearest points as in Ericson, "Real-time collision detection" (2005), section 5.1.5.
#[derive(Debug, Clone)]
pub struct SurfaceContact {
    name: String,
    surfaces: [GroupNames; 2],
    layer: Layer,
}

impl SurfaceContact {
    /// Of a surface, or several together, with another; of a surface with itself where both are the same.
    pub fn between(name: &str, surface: impl Into<GroupNames>, other: impl Into<GroupNames>) -> Self {
        SurfaceContact { name: name.to_owned(), surfaces: [surface.into(), other.into()], layer: Layer::default() }
    }

    layer_methods!();

    /// The contribution on a body whose materials are there.
    ///
    /// # Errors
    /// An unknown surface, numbers that are none; surfaces that are nearer at rest than twice the thickness; no stiffness given and no
    /// material behind a surface.
    pub fn on(&self, body: &BodyEnergy) -> Result<BoundSurfaces, FemError> {
        BoundSurfaces::new(self, body)
    }
}
