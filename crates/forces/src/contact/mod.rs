//! [`Contact`]: a surface of the body that touches an obstacle.

mod bound;
mod defaults;
mod exact;
mod friction;
mod lagged;
mod law;
mod layer;
mod point;
mod pose;
mod probes;
mod samples;
mod second_order;
mod slip;
mod sums;
pub mod surfaces;

pub(crate) use bound::BoundContact;
pub use law::ContactLaw;
use layer::{Layer, layer_methods};
use nastic_body::body_energy::BodyEnergy;
use nastic_body::error::FemError;
use nastic_mesh::spatial::Obstacle;
use nastic_mesh::{Facet, GroupNames, Mesh};
pub use surfaces::SurfaceContact;

/// A surface that an obstacle pushes back, with friction or without.
///
/// **Potential**, without friction: `sum_s w_s psi(d(x_s))` over the samples s of the surface, of reference area w_s, d the signed distance
/// from the obstacle, psi a [`ContactLaw`] of thickness delta and stiffness k (Pa), fixed for good. With `p = -psi'`, `n` the unit vector of `grad d` and
/// the pressure `P = p |grad d|`, which is p for exact distances,
///
/// ```text
/// r = sum_s w_s N(x_s)^T t_s,    t_s = -P n + mu P f(v_t),    v_t = (1 - n n^T) (v_s - v_o)
/// ```
///
/// The residual is continuously differentiable in u wherever d has a continuous second derivative, also where contact opens and closes: its
/// gap under a pressure p is `delta (1 - sqrt(p/k))` (cubic), so that **delta buys accuracy and k safety**.
///
/// **Friction** (Coulomb) acts in time steps alone, with the velocity of the scheme and that of the obstacle; `f(v) = v/|v|` above the slip speed
/// e, smoothed below it. What sticks creeps at `e (1 - sqrt(1 - r))`, r the share of the cone that it takes. It has no potential, and the
/// tangent is not symmetric.
///
/// **Controls**: translation (m) and rotation vector of the obstacle about its centre, loads; stiffness (Pa) and friction coefficient, designs.
/// The residual depends on the pose at both ends of a step.
///
/// Source: docs/contact.md; Li et al., ACM Trans. Graph. 39 (2020) for psi of the log law and f.
#[derive(Debug, Clone)]
pub struct Contact {
    name: String,
    surface: GroupNames,
    obstacle: Obstacle,
    layer: Layer,
    centre: Option<[f64; 3]>,
    pose: Option<String>,
    settled: bool,
}

impl Contact {
    /// The thickness of its layer on facets, unless another is given: 1/500 of the diagonal of their bounding box.
    pub fn usual_thickness(mesh: &Mesh, facets: &[Facet]) -> f64 {
        defaults::thickness(mesh, facets)
    }

    /// Of a named surface, or of several together, with an obstacle; `name` is that of its controls.
    pub fn of(name: &str, surface: impl Into<GroupNames>, obstacle: Obstacle) -> Self {
        Contact {
            name: name.to_owned(),
            surface: surface.into(),
            obstacle,
            layer: Layer::default(),
            centre: None,
            pose: None,
            settled: false,
        }
    }

    layer_methods!();

    /// The point about which the obstacle turns; its own centre if not given (of a half-space the point of its plane).
    #[must_use]
    pub fn about(mut self, centre: [f64; 3]) -> Self {
        self.centre = Some(centre);
        self
    }

    /// The name under which the pose of the obstacle is controlled, `NAME.translation` and `NAME.rotation`; contacts that share one move together.
    #[must_use]
    pub fn pose_of(mut self, name: &str) -> Self {
        self.pose = Some(name.to_owned());
        self
    }

    /// A body that is within the layer at rest, or not deeper inside than it is thick, begins without a pressure: gaps count from as deep inside
    /// the obstacle as it takes for the nearest sample to be where the layer begins. Else such a body is pushed away at once.
    #[must_use]
    pub fn settled(mut self) -> Self {
        self.settled = true;
        self
    }

    /// The contribution on a body whose materials are there.
    ///
    /// # Errors
    /// An unknown surface, an obstacle or numbers that are none; no stiffness given and no material behind the surface.
    pub fn on(&self, body: &BodyEnergy) -> Result<BoundContact, FemError> {
        BoundContact::new(self, body)
    }
}
