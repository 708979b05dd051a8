//! [`Contact`]: a surface of the body that touches an obstacle, another surface or itself.

mod advance;
mod bound;
mod defaults;
mod friction;
mod lagged;
mod law;
mod layer;
mod obstacle;
mod point;
mod pose;
mod potential;
mod rubbing;
mod samples;
mod slots;
mod stencil;
mod surfaces;
mod touches;

use friction::Friction;
pub use law::ContactLaw;
use layer::Settings;
use nastic_body::body_energy::BodyEnergy;
use nastic_body::contribution::Contribution;
use nastic_body::error::FemError;
use nastic_mesh::spatial::Obstacle;
use nastic_mesh::{Facet, GroupNames, Mesh};
use obstacle::Placement;
use std::sync::Arc;
use surfaces::Surfaces;

/// A surface that is pushed back by an obstacle, by another surface or, where it touches itself, by itself; with friction or without.
///
/// **Potential**, without friction: `sum_s w_s psi(d(x_s))` over the samples s of the surface, of reference area w_s, d the signed distance
/// from what it touches, psi a [`ContactLaw`] of thickness delta and stiffness k (Pa), fixed for good. With `p = -psi'`, `n` the unit vector of `grad d` and
/// the pressure `P = p |grad d|`, which is p for exact distances,
///
/// ```text
/// r = sum_s w_s N(x_s)^T t_s,    t_s = -P n + mu P f(v_t),    v_t = (1 - n n^T) (v_s - v_o)
/// ```
///
/// The residual is continuously differentiable in u wherever d has a continuous second derivative, also where contact opens and closes: its
/// gap under a pressure p is `delta (1 - sqrt(p/k))` (cubic), so that **delta buys accuracy and k safety**.
///
/// **Friction** (Coulomb) acts in time steps alone, with the velocity of the scheme and that `v_o` of the obstacle or of the other surface; `f(v) = v/|v|` above the slip speed
/// e, smoothed below it. What sticks creeps at `e (1 - sqrt(1 - r))`, r the share of the cone that it takes. It has no potential, and the
/// tangent is not symmetric.
///
/// **Controls**: stiffness (Pa) and friction coefficient, designs; of an obstacle also its translation (m) and rotation vector about its centre, loads, the first slots.
/// The residual depends on the pose at both ends of a step.
///
/// Source: docs/contact.md; Li et al., ACM Trans. Graph. 39 (2020) for psi of the log law and f.
#[derive(Debug, Clone)]
pub struct Contact {
    settings: Settings,
    with: Touched,
    /// What was asked that an obstacle alone has.
    unfit: Option<&'static str>,
}

#[derive(Debug, Clone)]
enum Touched {
    Obstacle(Placement),
    Surface(GroupNames),
}

impl Contact {
    /// The thickness of its layer on facets, unless another is given: 1/500 of the diagonal of their bounding box.
    pub fn usual_thickness(mesh: &Mesh, facets: &[Facet]) -> f64 {
        defaults::thickness(mesh, facets)
    }

    /// Of a named surface, or of several together, with an obstacle; `name` is that of its controls.
    pub fn of(name: &str, surface: impl Into<GroupNames>, obstacle: Obstacle) -> Self {
        let placement = Placement { obstacle, centre: None, pose: None, settled: false };
        Self::with(name, surface, Touched::Obstacle(placement))
    }

    /// Of a surface, or several together, with another; of a surface with itself where both are the same. The gap of a sample, of either of them, is its smooth least
    /// distance from the flat pieces i of the other one, less `2 delta`: where surfaces touch, they stay about `2 delta` apart.
    ///
    /// ```text
    /// d = -e ln(sum_i exp(-|x_s - y_i| / e)) - 2 delta,     e = delta / 100
    /// ```
    pub fn between(name: &str, surface: impl Into<GroupNames>, other: impl Into<GroupNames>) -> Self {
        Self::with(name, surface, Touched::Surface(other.into()))
    }

    fn with(name: &str, surface: impl Into<GroupNames>, with: Touched) -> Self {
        Contact { settings: Settings::new(name, surface.into()), with, unfit: None }
    }

    /// Another law of the pressure.
    #[must_use]
    pub fn law(mut self, law: ContactLaw) -> Self {
        self.settings.law = law;
        self
    }

    /// Thickness delta of the layer in which it acts, m; 1/500 of the surface's diagonal if not given; between surfaces of the smaller one, and no more
    /// than a quarter of their distance at rest.
    #[must_use]
    pub fn thickness(mut self, thickness: f64) -> Self {
        self.settings.thickness = Some(thickness);
        self
    }

    /// Stiffness k, Pa: of the cubic law the pressure that closes the gap, 100 times Young's modulus at rest behind the surface (of two the
    /// softer one) if not given; of the log law a tenth of that modulus.
    #[must_use]
    pub fn stiffness(mut self, stiffness: f64) -> Self {
        self.settings.stiffness = Some(stiffness);
        self
    }

    /// Coulomb's friction with a coefficient, smoothed below a slip speed (m/s).
    #[must_use]
    pub fn friction(mut self, coefficient: f64, slip_speed: f64) -> Self {
        self.settings.friction = Some(Friction { coefficient, slip_speed });
        self
    }

    /// Friction takes normal forces, normals and places where the step begins, not where it ends: the tangent is symmetric and a step the minimum
    /// of a potential, but a hold whose forces grow by more than `1/r - 1` a step slips, r the share of the cone that it takes. For comparison.
    #[must_use]
    pub fn lagged(mut self) -> Self {
        self.settings.lagged = true;
        self
    }

    /// Samples of each facet as of `refine^2` pieces. If not given, between surfaces 2 in space, where edges that cross between samples carry nothing, and 1 in the plane, and before an obstacle of each facet as many (4 at most) as leave its samples no
    /// further apart than half of its least width, two at least where its edges are sharper than half of the facet: a sphere of radius R enters by
    /// `h^2/(8 R)` where they are h apart, and [`Touch::between`](nastic_body::contribution::touches::Touch::between) has what is inside between them.
    #[must_use]
    pub fn refine(mut self, refine: usize) -> Self {
        self.settings.refine = Some(refine);
        self
    }

    /// The point about which the obstacle turns; its own centre if not given (of a half-space the point of its plane).
    #[must_use]
    pub fn about(self, centre: [f64; 3]) -> Self {
        self.placed("a centre", |placement| placement.centre = Some(centre))
    }

    /// The name under which the pose of the obstacle is controlled, `NAME.translation` and `NAME.rotation`; contacts that share one move together.
    #[must_use]
    pub fn pose_of(self, name: &str) -> Self {
        self.placed("a pose", |placement| placement.pose = Some(name.to_owned()))
    }

    /// A body that is within the layer at rest, or not deeper inside than it is thick, begins without a pressure: gaps count from as deep inside
    /// the obstacle as it takes for the nearest sample to be where the layer begins. Else such a body is pushed away at once.
    #[must_use]
    pub fn settled(self) -> Self {
        self.placed("a gap that settles", |placement| placement.settled = true)
    }

    fn placed(mut self, what: &'static str, set: impl FnOnce(&mut Placement)) -> Self {
        match &mut self.with {
            Touched::Obstacle(placement) => set(placement),
            Touched::Surface(_) => self.unfit = Some(what),
        }
        self
    }

    /// The contribution on a body whose materials are there.
    ///
    /// # Errors
    /// An unknown surface, an invalid obstacle, numbers that are NaN or infinite; no stiffness given and no material behind a surface; surfaces that are nearer at rest than
    /// twice the thickness, or that are asked for what an obstacle has.
    pub fn on(&self, body: &BodyEnergy) -> Result<Arc<dyn Contribution>, FemError> {
        match (&self.with, self.unfit) {
            (Touched::Obstacle(placement), _) => Ok(Arc::new(placement.on(&self.settings, body)?)),
            (Touched::Surface(other), None) => Ok(Arc::new(Surfaces::on(&self.settings, other, body)?)),
            (Touched::Surface(_), Some(what)) => {
                Err(self.settings.refusal(format!("it is between surfaces: {what} is that of an obstacle")))
            }
        }
    }
}
