//! [`MovingSupport`]: a surface held rigid that moves and turns.

use crate::no_force::NoForce;
use crate::rigid_motion;
use crate::rigid_motion::{SLOTS, each_slot, vectors};
use nastic_body::contribution::Contribution;
use nastic_body::contribution::point::{ContributionPoint, Need};
use nastic_body::contribution::prescribes::Prescribes;
use nastic_body::contribution::sensitivities::Sensitivities;
use nastic_body::controls::Controls;
use nastic_body::discretization::Discretization;
use nastic_body::error::{FemError, Inadmissible};
use nastic_body::instant::Instant;
use nastic_body::rotation::{rotation, spin};
use nastic_energy::Slot;
use nastic_mesh::GroupNames;
use nastic_tensor::Vec3;

/// A surface that is held and moves as a rigid body: `u = t + (R(theta) - 1) (X - c)` at its nodes, with the translation t (m), the
/// rotation vector theta (radians: about its direction, by its length) and the centre c in the reference body.
///
/// Its controls are t and theta. They act through the supported unknowns alone: the derivative of a functional by them is
/// `(j_u + K^T lambda)_D . du_D/d(t, theta)`, D the nodes of the surface. Continuation scales t and theta; in steps in time
/// they may change, and velocities are those of the scheme (docs/model/motion.md).
///
/// With [`components`](Self::components) it holds these alone, `u_i = t_i + ((R - 1) (X - c))_i`, and the surface slides freely along the others: a
/// grip with free sides, a roller that moves.
///
/// In plane strain t is in the plane and theta along z. Source: docs/model/equilibrium.md.
#[derive(Debug, Clone, PartialEq)]
pub struct MovingSupport {
    name: String,
    surface: GroupNames,
    /// Point about which it turns; the mean of its nodes if `None`.
    pub centre: Option<[f64; 3]>,
    held: [bool; 3],
}

impl MovingSupport {
    /// The motion of a named surface or node set, or of several together, about the mean of their nodes; `name` is that of the control.
    pub fn of(name: &str, surface: impl Into<GroupNames>) -> Self {
        MovingSupport { name: name.to_owned(), surface: surface.into(), centre: None, held: [true; 3] }
    }

    /// Turns it about another point, which need not be one of the body.
    #[must_use]
    pub fn about(mut self, centre: [f64; 3]) -> Self {
        self.centre = Some(centre);
        self
    }

    /// Holds these components alone (0 to 2), in the axes of space.
    #[must_use]
    pub fn components(mut self, components: &[usize]) -> Self {
        self.held = [0, 1, 2].map(|i| components.contains(&i));
        self
    }

    /// The names of what moves.
    pub fn surface(&self) -> &GroupNames {
        &self.surface
    }

    /// The contribution on the nodes of the surface.
    ///
    /// # Errors
    /// No nodes; a centre that is not finite; no component that the body has.
    pub fn on(&self, disc: &Discretization, nodes: Vec<u32>) -> Result<RigidSurface, FemError> {
        let refuse = |what: &str| Err(FemError::Meaningless { what: format!("motion \"{}\" {what}", self.name) });
        let mesh = disc.mesh();
        let position = |node: &u32| Vec3::from(mesh.points()[*node as usize]);
        let owned = disc.parted().map_or(u32::MAX, |parted| parted.part.owned() as u32);
        // nodes between ranks count where they belong
        let counted = || nodes.iter().filter(|node| **node < owned);
        let sum = counted().map(position).sum::<Vec3>();
        let mut sums = [sum[0], sum[1], sum[2], counted().count() as f64];
        if let Some(parted) = disc.parted() {
            parted.share.sum(&mut sums);
        }
        if sums[3] == 0.0 {
            return refuse("has no nodes to move");
        }
        let mean = Vec3::new(sums[0], sums[1], sums[2]) / sums[3];
        let centre = self.centre.map_or(mean, Vec3::from);
        if centre.iter().any(|x| !x.is_finite()) {
            return refuse("has a centre that is not finite");
        }
        if !self.held[..mesh.dim()].contains(&true) {
            return refuse("holds no component of the body");
        }
        let arms: Vec<(u32, Vec3)> = nodes.iter().map(|node| (*node, position(node) - centre)).collect();
        Ok(RigidSurface { name: self.name.clone(), dim: mesh.dim(), held: self.held, arms, owned })
    }
}

/// The contribution of a [`MovingSupport`], which has no residual of its own.
#[derive(Debug)]
pub struct RigidSurface {
    name: String,
    dim: usize,
    /// Components that are held.
    held: [bool; 3],
    /// Nodes, each with X - c.
    arms: Vec<(u32, Vec3)>,
    /// The first node that another rank counts in sums.
    owned: u32,
}

impl RigidSurface {
    /// Calls with every held unknown and its value, given the displacement at the end of an arm.
    fn each(&self, displacement: impl Fn(&Vec3) -> Vec3, mut call: impl FnMut(usize, f64)) {
        for (node, arm) in &self.arms {
            let u = displacement(arm);
            self.components().for_each(|i| call(self.dim * *node as usize + i, u[i]));
        }
    }

    /// Those that are held, of the body's.
    fn components(&self) -> impl Iterator<Item = usize> + use<> {
        let held = self.held;
        (0..self.dim).filter(move |i| held[*i])
    }
}

impl Prescribes for RigidSurface {
    fn unknowns(&self) -> Vec<u32> {
        let of = |node: u32| self.components().map(move |i| self.dim as u32 * node + i as u32);
        self.arms.iter().flat_map(|(node, _)| of(*node)).collect()
    }

    fn prescribe(&self, at: &Instant, u: &mut [f64]) {
        let [t, theta] = vectors(at, at.controls);
        let r = rotation(&theta);
        self.each(|arm| t + (r * arm - arm), |dof, value| u[dof] = value);
    }

    fn add_change(&self, at: &Instant, v: &Controls, du: &mut [f64]) {
        let [_, theta] = vectors(at, at.controls);
        let [dt, dtheta] = vectors(at, v);
        let (r, omega) = (rotation(&theta), spin(&theta) * dtheta);
        self.each(|arm| dt + omega.cross(&(r * arm)), |dof, value| du[dof] += value);
    }

    fn vjp(&self, at: &Instant, force: &[f64], into: &mut Sensitivities) {
        let [_, theta] = vectors(at, at.controls);
        let r = rotation(&theta);
        let (mut sum, mut moment) = (Vec3::zeros(), Vec3::zeros());
        for (node, arm) in self.arms.iter().filter(|(node, _)| *node < self.owned) {
            let mut own = Vec3::zeros();
            self.components().for_each(|i| own[i] = force[self.dim * *node as usize + i]);
            sum += own;
            moment += (r * arm).cross(&own);
        }
        let by_rotation = spin(&theta).transpose() * moment;
        each_slot(self.dim, sum, by_rotation, |slot, value| into.add_control(at, slot, value));
    }

    fn is_straight_along(&self, at: &Instant, v: &Controls) -> bool {
        (3..6).all(|slot| at.slot_of(v, slot) == 0.0)
    }
}

impl Contribution for RigidSurface {
    fn name(&self) -> &str {
        &self.name
    }

    fn slots(&self) -> &[Slot] {
        &SLOTS
    }

    fn check_controls(&self, values: &[f64]) -> Result<(), FemError> {
        let what = format!("motion \"{}\"", self.name);
        rigid_motion::check(&what, self.dim, values)?;
        match (0..3).find(|i| !self.held[*i] && values[*i] != 0.0) {
            None => Ok(()),
            Some(i) => {
                let axis = ["x", "y", "z"][i];
                let what = format!(
                    "{what} goes {} along {axis}, which it does not hold; hold it, or leave that component 0",
                    values[i]
                );
                Err(FemError::Meaningless { what })
            }
        }
    }

    fn prescribes(&self) -> Option<&dyn Prescribes> {
        Some(self)
    }

    fn is_stiff(&self) -> bool {
        false
    }

    /// It moves the nodes that the rank has; the derivative by its controls is the share of those that belong to it.
    fn spans_ranks(&self) -> bool {
        true
    }

    fn at<'a>(&'a self, _: &Instant, _: Need) -> Result<Box<dyn ContributionPoint + 'a>, Inadmissible> {
        Ok(Box::new(NoForce))
    }
}
