//! [`Spring`]: a linear spring between two points.

mod elsewhere;
mod force;
mod over_ranks;

use crate::guides::{COINCIDENCE_TOLERANCE, Guides};
use force::SpringForce;
use nastic_body::contribution::body_point::{AttachedPoint, BodyPoint};
use nastic_body::error::FemError;
use nastic_mesh::Mesh;
use nastic_tensor::Vec3;

/// A spring between two points of the body that move with it, or from one to a fixed point of space, linear in its elongation, with the
/// potential
///
/// ```text
/// (k/2) (l(u) - L)^2,   l = |x_1 - x_2|,      of rest length L = 0: (k/2) |x_1 - x_2|^2
/// ```
///
/// with the stiffness k (N/m) and the rest length L (m): the distance at rest unless one is given. It pulls where it is longer than L, with
/// the force k (l - L), and pushes where it is shorter. Residual `k (1 - L/l) (x_1 - x_2)` and its opposite, tangent by x_1 - x_2
/// `k (1 - (L/l) P)`, `P = 1 - n (x) n`, n along the spring.
///
/// A spring that has a force where the body is at rest, L other than the distance there, is tightened with the load: at the load factor q
/// the share `1 - q` of that force is balanced by a constant one (potential `-(1 - q) k (d - L) n . (x_1 - x_2)` with its distance d and
/// direction n at rest), so that every way begins in equilibrium.
///
/// A spring to the ground may help to hold a body that nothing else holds: along its direction at rest, of L < d in every direction. One between
/// two points of the body excludes no rigid motion, nor does it count for two parts that are not connected. In plane strain k is per unit of
/// thickness. Source: docs/model/equilibrium.md.
#[derive(Debug, Clone, PartialEq)]
pub struct Spring {
    name: String,
    from: BodyPoint,
    to: End,
    stiffness: f64,
    rest_length: Option<f64>,
}

#[derive(Debug, Clone, PartialEq)]
enum End {
    Body(BodyPoint),
    Ground([f64; 3]),
}

const AXES: [Vec3; 3] = [Vec3::new(1.0, 0.0, 0.0), Vec3::new(0.0, 1.0, 0.0), Vec3::new(0.0, 0.0, 1.0)];

impl Spring {
    /// Between two points of the body, with a stiffness in N/m.
    pub fn between(name: &str, from: impl Into<BodyPoint>, to: impl Into<BodyPoint>, stiffness: f64) -> Self {
        Spring { name: name.to_owned(), from: from.into(), to: End::Body(to.into()), stiffness, rest_length: None }
    }

    /// From a point of the body to a fixed point of space, with a stiffness in N/m.
    pub fn to_ground(name: &str, from: impl Into<BodyPoint>, ground: [f64; 3], stiffness: f64) -> Self {
        Spring { name: name.to_owned(), from: from.into(), to: End::Ground(ground), stiffness, rest_length: None }
    }

    /// The length at which it has no force, instead of the distance at rest.
    #[must_use]
    pub fn rest_length(mut self, length: f64) -> Self {
        self.rest_length = Some(length);
        self
    }

    /// The contribution on a mesh.
    ///
    /// # Errors
    /// An end outside the body; a stiffness that is not positive, a negative rest length; both ends at one place of the body, or
    /// anywhere at one place with a positive rest length, where the spring has no direction; in plane strain a ground out of the plane.
    pub fn on(&self, mesh: &Mesh) -> Result<SpringForce, FemError> {
        self.check()?;
        let from = self.attach(mesh, &self.from, "from")?;
        let to = match &self.to {
            End::Body(point) => self.attach(mesh, point, "to")?,
            End::Ground(place) => self.ground(mesh, *place)?,
        };
        self.held_by(from, to, mesh.dim(), mesh.diagonal())
    }

    /// The nodes that its ends are at, those of the first end first: a body over ranks has to have them in [one part](Mesh::part_reaching).
    ///
    /// # Errors
    /// An end outside the body, a name that is no node set.
    pub fn nodes(&self, mesh: &Mesh) -> Result<Vec<u32>, FemError> {
        let mut nodes: Vec<u32> = self.attach(mesh, &self.from, "from")?.nodes().collect();
        if let End::Body(point) = &self.to {
            let more: Vec<u32> = self.attach(mesh, point, "to")?.nodes().filter(|node| !nodes.contains(node)).collect();
            nodes.extend(more);
        }
        Ok(nodes)
    }

    fn check(&self) -> Result<(), FemError> {
        if !(self.stiffness.is_finite() && self.stiffness > 0.0) {
            return Err(self.refuse(format!("has a stiffness of {}; it must be positive and finite", self.stiffness)));
        }
        if let Some(length) = self.rest_length.filter(|length| !(length.is_finite() && *length >= 0.0)) {
            return Err(self.refuse(format!("has a rest length of {length}; it must be finite and not negative")));
        }
        Ok(())
    }

    /// With these ends on a body of these dimensions and this diagonal.
    fn held_by(
        &self,
        from: AttachedPoint,
        to: AttachedPoint,
        dim: usize,
        diagonal: f64,
    ) -> Result<SpringForce, FemError> {
        if from.weights == to.weights {
            return Err(self.refuse("has both ends at one point of the body; move one of them".to_owned()));
        }
        let along = to.reference - from.reference;
        let distance = if along.norm() > COINCIDENCE_TOLERANCE * diagonal { along.norm() } else { 0.0 };
        let rest_length = self.rest_length.unwrap_or(distance);
        if distance == 0.0 && rest_length > 0.0 {
            return Err(self.refuse(format!(
                "has no direction: its ends are at one place at rest, and its rest length is {rest_length}; move one of them, or \
                 take the rest length 0"
            )));
        }
        let direction = if distance > 0.0 { along / distance } else { Vec3::zeros() };
        let holds = match &self.to {
            End::Ground(_) if rest_length < distance || distance == 0.0 => held(&from, dim, &AXES),
            End::Ground(_) => held(&from, dim, &[direction]),
            // A rigid motion does not change its length.
            End::Body(_) => Vec::new(),
        };
        Ok(SpringForce {
            name: self.name.clone(),
            at_rest: self.stiffness * (distance - rest_length) * direction,
            ends: Guides::new(dim, vec![from, to]),
            stiffness: self.stiffness,
            rest_length,
            holds,
        })
    }

    fn ground(&self, mesh: &Mesh, place: [f64; 3]) -> Result<AttachedPoint, FemError> {
        if place.iter().any(|x| !x.is_finite()) {
            return Err(self.refuse(format!("is tied to the ground at {place:?}, which is not finite")));
        }
        if mesh.dim() == 2 && place[2] != 0.0 {
            let what = format!("is tied to the ground at z = {}, out of the plane of the body; take 0", place[2]);
            return Err(self.refuse(what));
        }
        Ok(AttachedPoint::fixed(place))
    }

    fn attach(&self, mesh: &Mesh, point: &BodyPoint, end: &str) -> Result<AttachedPoint, FemError> {
        AttachedPoint::new(mesh, point).map_err(|error| self.refuse(format!("cannot hold its end \"{end}\": {error}")))
    }

    fn refuse(&self, what: String) -> FemError {
        FemError::Meaningless { what: format!("spring \"{}\" {what}", self.name) }
    }
}

/// The displacement of a point along each of these directions, as a sum of weighted unknowns.
fn held(point: &AttachedPoint, dim: usize, directions: &[Vec3]) -> Vec<Vec<(u32, f64)>> {
    let along = |direction: &Vec3| {
        let mut terms = Vec::new();
        point.each(dim, |dof, weight, i| terms.push((dof as u32, weight * direction[i])));
        terms
    };
    directions.iter().map(along).collect()
}
