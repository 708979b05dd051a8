//! Constraints, and the obstacles of costs and constraints.

use super::context::Context;
use super::cost::{Lowering, TargetShape};
use super::place::{Kind, Place};
use crate::schema::{Case, Constraint as Block, KeepOut, Shape};
use nastic_control::{
    Constraint, ConstraintPoint, ControlError, CostContext, CostLimit, IntoConstraint, Obstacle, ObstacleDistance,
    Reduced,
};
use nastic_opt::ConstraintGroup;
use std::sync::Arc;

pub(super) fn obstacle(shape: &Shape) -> Obstacle {
    match shape {
        Shape::Sphere(sphere) => Obstacle::sphere(sphere.center.xyz(), sphere.radius),
        Shape::HalfSpace(half) => Obstacle::half_space(half.point.xyz(), half.normal.xyz()),
        Shape::Capsule(capsule) => Obstacle::capsule(capsule.from.xyz(), capsule.to.xyz(), capsule.radius),
    }
}

/// Target meshes of bounded functionals, by constraint.
pub(super) fn load_targets(case: &Case, context: &mut Context<'_>) -> Vec<Option<TargetShape>> {
    let target = |block: &Block, context: &mut Context<'_>| super::cost::load_target(block.cost.as_ref()?, context);
    case.constraints.iter().map(|block| target(block, context)).collect()
}

/// Adds all constraints to the problem; `None` if that cannot be.
pub(super) fn add(
    case: &Case,
    targets: Vec<Option<TargetShape>>,
    mut reduced: Reduced,
    context: &mut Context<'_>,
) -> Option<Reduced> {
    let mut all = Vec::new();
    for (block, target) in case.constraints.iter().zip(targets) {
        let bound = match (&block.obstacle, &block.cost) {
            (Some(keep_out), _) => distance(keep_out, &reduced, context),
            (None, Some(cost)) => {
                let cost = Lowering { case, reduced: &reduced, block: cost }.lower(target, context)?;
                let limit = match (block.at_most, block.equal) {
                    (Some(bound), _) => CostLimit::at_most(cost, bound),
                    (None, bound) => CostLimit::equal(cost, bound.unwrap_or_default()),
                };
                let limit = block.scale.into_iter().fold(limit, CostLimit::scale);
                context.take(&block.at, limit.bind(reduced.solid()))
            }
            (None, None) => None,
        };
        let constraint = bound?;
        all.push((block, Named { name: block.name().to_owned(), constraint }));
    }
    for (block, named) in all {
        let named: Box<dyn Constraint> = Box::new(named);
        reduced = context.take(&block.at, reduced.constrain(named))?;
    }
    Some(reduced)
}

fn distance(block: &KeepOut, reduced: &Reduced, context: &mut Context<'_>) -> Option<Box<dyn Constraint>> {
    let solid = reduced.solid();
    let place = Place::of(&block.surface, &block.region, &block.nodes)?;
    place.nodes(solid.mesh(), &block.at, context)?;
    let shape = obstacle(&block.shape);
    let distance = match place.kind {
        Kind::Surface => ObstacleDistance::surface(place.names, shape),
        Kind::Region => ObstacleDistance::region(place.names, shape),
        Kind::Nodes => ObstacleDistance::nodes(place.names, shape),
    };
    context.take(&block.at, distance.clearance(block.clearance).bind(solid))
}

/// Constraints under the name the case gives them.
#[derive(Debug)]
struct Named {
    name: String,
    constraint: Box<dyn Constraint>,
}

impl Constraint for Named {
    fn group(&self) -> ConstraintGroup {
        ConstraintGroup { name: self.name.clone(), ..self.constraint.group() }
    }

    fn unit(&self) -> &'static str {
        self.constraint.unit()
    }

    fn at(&self, at: &CostContext) -> Result<Arc<dyn ConstraintPoint>, ControlError> {
        self.constraint.at(at)
    }
}
