//! [`ObstacleDistance`]: nodes that keep clear of an obstacle.

use super::{BetweenNodes, Constraint, ConstraintPoint, IntoConstraint};
use crate::cost::body_points::{BodyPart, BodyPoints};
use crate::cost::obstacle::check;
use crate::cost::{CostContext, Partials};
use nastic_fem::Solid;
use nastic_fields::ControlError;
use nastic_mesh::GroupNames;
use nastic_mesh::spatial::{Obstacle, SignedDistance};
use nastic_numeric::vector::dot;
use nastic_opt::{ConstraintGroup, Sense};
use std::sync::Arc;

/// `c_a = clearance - d(x_a) <= 0` for every node a of a surface, region or node set, with `x_a = X_a + u_a` and d the signed distance
/// from an [`Obstacle`]: one inequality and one multiplier for every node. Between nodes a surface may enter the obstacle by what
/// its cells bend: [`Constraint::between_nodes`] shows this, at the quadrature points of surfaces and regions.
///
/// `dc_a/du_a = -grad d`, `d2c_a/du_a^2 = -d2d/dx2`. Unit: length. Scale: the diagonal of the body's bounding box. The multiplier of a
/// node is the force (cost per length) with which the obstacle would push it.
/// Source: docs/model/costs.md.
#[derive(Clone, Debug)]
pub struct ObstacleDistance {
    place: BodyPart,
    obstacle: Obstacle,
    clearance: f64,
}

impl ObstacleDistance {
    fn of(place: BodyPart, obstacle: Obstacle) -> Self {
        ObstacleDistance { place, obstacle, clearance: 0.0 }
    }

    /// Of the nodes of a named surface, or of several.
    pub fn surface(names: impl Into<GroupNames>, obstacle: Obstacle) -> Self {
        Self::of(BodyPart::Surface(names.into()), obstacle)
    }

    /// Of the nodes of a named region, or of several.
    pub fn region(names: impl Into<GroupNames>, obstacle: Obstacle) -> Self {
        Self::of(BodyPart::Region(names.into()), obstacle)
    }

    /// Of named node sets.
    pub fn nodes(names: impl Into<GroupNames>, obstacle: Obstacle) -> Self {
        Self::of(BodyPart::Nodes(names.into()), obstacle)
    }

    /// The distance to keep; zero if not given.
    pub fn clearance(mut self, clearance: f64) -> Self {
        self.clearance = clearance;
        self
    }
}

impl IntoConstraint for ObstacleDistance {
    fn bind(self, solid: &Solid) -> Result<Box<dyn Constraint>, ControlError> {
        check(&self.obstacle, self.clearance, solid.discretization().dim())?;
        let (points, nodes) = self.place.points(solid)?;
        let between = match points {
            BodyPoints::Points(_) => Some(points),
            BodyPoints::Nodes(_) => None,
        };
        let (obstacle, clearance, scale) = (self.obstacle, self.clearance, solid.mesh().diagonal());
        Ok(Box::new(OnBody { nodes: nodes.into(), between, obstacle, clearance, scale }))
    }
}

#[derive(Debug)]
struct OnBody {
    nodes: Arc<[u32]>,
    /// Points between the nodes, of surfaces and regions.
    between: Option<BodyPoints>,
    obstacle: Obstacle,
    clearance: f64,
    scale: f64,
}

impl Constraint for OnBody {
    fn group(&self) -> ConstraintGroup {
        let (sense, len) = (Sense::AtMost, self.nodes.len());
        ConstraintGroup { name: "obstacle".into(), sense, len, scale: self.scale }
    }

    fn unit(&self) -> &'static str {
        "m"
    }

    fn nodes(&self) -> Option<&[u32]> {
        Some(&self.nodes)
    }

    fn between_nodes(&self, at: &CostContext) -> Option<BetweenNodes> {
        let positions = self.between.as_ref()?.positions(at.solid, Some(at.u));
        let found = positions.into_iter().map(|x| BetweenNodes { distance: self.obstacle.distance(&x), position: x });
        found.min_by(|a, b| a.distance.total_cmp(&b.distance))
    }

    fn at(&self, at: &CostContext) -> Result<Arc<dyn ConstraintPoint>, ControlError> {
        let (dim, rest) = (at.solid.discretization().dim(), at.solid.mesh().points());
        let distance = |node: &u32| {
            let mut x = rest[*node as usize];
            (0..dim).for_each(|i| x[i] += at.u[*node as usize * dim + i]);
            self.obstacle.at(&x)
        };
        let distances: Vec<SignedDistance> = self.nodes.iter().map(distance).collect();
        let values = distances.iter().map(|d| self.clearance - d.value).collect();
        Ok(Arc::new(EvaluatedConstraint { nodes: self.nodes.clone(), dim, distances, values }))
    }
}

#[derive(Debug)]
struct EvaluatedConstraint {
    nodes: Arc<[u32]>,
    dim: usize,
    distances: Vec<SignedDistance>,
    values: Vec<f64>,
}

impl EvaluatedConstraint {
    /// Every node's first unknown, and its distance.
    fn each(&self) -> impl Iterator<Item = (usize, &SignedDistance)> {
        self.nodes.iter().map(|node| *node as usize * self.dim).zip(&self.distances)
    }
}

impl ConstraintPoint for EvaluatedConstraint {
    fn values(&self) -> &[f64] {
        &self.values
    }

    fn add_partials(&self, y: &[f64], out: &mut Partials) -> Result<(), ControlError> {
        for ((first, d), y) in self.each().zip(y) {
            (0..self.dim).for_each(|i| out.u[first + i] -= y * d.gradient[i]);
        }
        Ok(())
    }

    fn change(&self, along: &Partials) -> Result<Vec<f64>, ControlError> {
        let of =
            |(first, d): (usize, &SignedDistance)| -dot(&d.gradient[..self.dim], &along.u[first..first + self.dim]);
        Ok(self.each().map(of).collect())
    }

    fn add_second_partials(&self, y: &[f64], along: &Partials, out: &mut Partials) -> Result<(), ControlError> {
        for ((first, d), y) in self.each().zip(y) {
            let bent = d.second(&along.u[first..first + self.dim]);
            (0..self.dim).for_each(|i| out.u[first + i] -= y * bent[i]);
        }
        Ok(())
    }
}
