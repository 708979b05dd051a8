//! [`Tendon`]: a cable through points of the body that pulls.

pub mod force;
mod inextensible;

use crate::guides::{COINCIDENCE_TOLERANCE, Guides};
use force::{Drive, TendonForce};
use inextensible::InextensibleTendon;
use nastic_body::contribution::Contribution;
use nastic_body::contribution::body_point::{AttachedPoint, BodyPoint};
use nastic_body::error::FemError;
use nastic_mesh::Mesh;
use std::sync::Arc;

/// A tendon: a polyline through guides, points of the body that move with it, without friction and without resistance to
/// compression. With its length L(u) and the reference length L0 its control is
///
/// * by default the `tension` T >= 0 (N), potential `T L(u)`: a cable pulled by a given force;
/// * [`inextensible`](Self::inextensible) the `pull` s (m), by how much the cable is drawn in: the constraint `L(u) <= L0 - s` with the
///   tension as its multiplier, `T >= 0`, `T (L0 - s - L) = 0`. Derivatives are those of the taut cable where T > 0 and at the very onset
///   (T = 0, L = L0 - s to rounding, as at rest with s = 0), and zero where it is slack. The tension must be determined: cables that can
///   be taut together only at pulls that fit each other, as two along one way, are refused with
///   [`LinearError::Border`](nastic_linear::LinearError) where they are;
/// * with a stiffness k (N/m) the `pull` s (m), by how much the cable is drawn in: potential `(k/2) max(0, L(u) - (L0 - s))^2`,
///   tension `k max(0, L - L0 + s)`. Where the cable is slack (L <= L0 - s) it carries no force. The potential is continuously
///   differentiable; at the very onset of slackness the second derivatives jump, and those given there are those of the taut cable.
///
/// Residual `N dL/du`, tangent `N d2L/du2 + dN/dL dL/du (x) dL/du`, symmetric, with the tension N. The second term couples the nodes of all
/// guides with each other: many guides with a pull make the tangent's factor denser.
///
/// In plane strain tension and stiffness are per unit of thickness. Source: docs/model/equilibrium.md; Bieze, Largilliere, Kruszewski, Zhang,
/// Merzouki & Duriez, Soft Robotics 5 (2018), for cables through points of a finite element mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct Tendon {
    name: String,
    guides: Vec<BodyPoint>,
    /// Largest distance of guides on the straight lines between the points.
    pub spacing: Option<f64>,
    /// Force per elongation of the whole cable.
    pub stiffness: Option<f64>,
    /// Whether it is drawn in without stretching.
    pub inextensible: bool,
}

/// Guides of a tendon.
const MAX_GUIDES: usize = 10_000;

impl Tendon {
    /// A tendon through points of the body, in the order in which it passes them, straight between them; `name` is that of
    /// the control.
    pub fn through<P: Into<BodyPoint>>(name: &str, guides: impl IntoIterator<Item = P>) -> Self {
        let guides = guides.into_iter().map(Into::into).collect();
        Tendon { name: name.to_owned(), guides, spacing: None, stiffness: None, inextensible: false }
    }

    /// Adds guides on the straight lines between those given, no farther apart than this: a tendon in a sheath, which cannot leave
    /// its way through the body.
    #[must_use]
    pub fn spacing(mut self, spacing: f64) -> Self {
        self.spacing = Some(spacing);
        self
    }

    /// Makes the cable elastic with a stiffness in N/m, and its control the pull.
    #[must_use]
    pub fn stiffness(mut self, stiffness: f64) -> Self {
        self.stiffness = Some(stiffness);
        self
    }

    /// The cable does not stretch, and its control is the pull.
    #[must_use]
    pub fn inextensible(mut self) -> Self {
        self.inextensible = true;
        self
    }

    /// The contribution on a mesh.
    ///
    /// # Errors
    /// A guide outside the body; fewer than two guides, neighbours that coincide, too many; a stiffness or spacing that is not positive; a
    /// stiffness of one that does not stretch.
    pub fn on(&self, mesh: &Mesh) -> Result<Arc<dyn Contribution>, FemError> {
        if let (Some(stiffness), true) = (self.stiffness, self.inextensible) {
            return Err(
                self.refuse(format!("cannot stretch and has a stiffness of {stiffness}; leave one of them out"))
            );
        }
        for (what, value) in [("stiffness", self.stiffness), ("spacing", self.spacing)] {
            if let Some(value) = value.filter(|value| !(value.is_finite() && *value > 0.0)) {
                return Err(self.refuse(format!("has a {what} of {value}; it must be positive and finite")));
            }
        }
        let mut points = Vec::new();
        for (k, guide) in self.guides.iter().enumerate() {
            let next = self.attach(mesh, guide, || format!("guide {k}"))?;
            if let Some(last) = points.last() {
                self.check_apart(mesh, last, &next, k)?;
                points.extend(self.between(mesh, last, &next, k)?);
            }
            points.push(next);
            if points.len() > MAX_GUIDES {
                return Err(self.refuse(format!("has more than {MAX_GUIDES} guides; give a larger \"spacing\"")));
            }
        }
        if points.len() < 2 {
            return Err(self.refuse(format!("has {} guides; it needs two or more", points.len())));
        }
        let guides = Guides::new(mesh.dim(), points);
        if self.inextensible {
            return Ok(Arc::new(InextensibleTendon::new(&self.name, guides)));
        }
        let drive = self.stiffness.map_or(Drive::Tension, |stiffness| Drive::Pull { stiffness });
        Ok(Arc::new(TendonForce::new(&self.name, guides, drive)))
    }

    fn check_apart(&self, mesh: &Mesh, a: &AttachedPoint, b: &AttachedPoint, k: usize) -> Result<(), FemError> {
        let distance = (b.reference - a.reference).norm();
        if distance > COINCIDENCE_TOLERANCE * mesh.diagonal() {
            return Ok(());
        }
        let what = format!("passes guides {} and {k} at one place (distance {distance:.1e}); leave one out", k - 1);
        Err(self.refuse(what))
    }

    /// The guides that the spacing asks for before guide k.
    fn between(
        &self,
        mesh: &Mesh,
        a: &AttachedPoint,
        b: &AttachedPoint,
        k: usize,
    ) -> Result<Vec<AttachedPoint>, FemError> {
        let Some(spacing) = self.spacing else { return Ok(Vec::new()) };
        // a distance that is a multiple of the spacing but for rounding takes no further guide
        let pieces = ((b.reference - a.reference).norm() / spacing * (1.0 - 1e-9)).ceil();
        if pieces > MAX_GUIDES as f64 {
            return Err(self.refuse(format!("has more than {MAX_GUIDES} guides; give a larger \"spacing\"")));
        }
        let place = |i: usize| a.reference + (b.reference - a.reference) * (i as f64 / pieces);
        let shown = || format!("a guide on the straight way from guide {} to guide {k}", k - 1);
        let new = |i: usize| self.attach(mesh, &BodyPoint::At(place(i).into()), shown);
        (1..pieces as usize).map(new).collect()
    }

    fn attach(
        &self,
        mesh: &Mesh,
        guide: &BodyPoint,
        which: impl FnOnce() -> String,
    ) -> Result<AttachedPoint, FemError> {
        AttachedPoint::new(mesh, guide).map_err(|error| self.refuse(format!("cannot hold {}: {error}", which())))
    }

    fn refuse(&self, what: String) -> FemError {
        FemError::Meaningless { what: format!("tendon \"{}\" {what}", self.name) }
    }
}
