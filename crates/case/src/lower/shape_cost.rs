//! Costs of positions, directions, curvatures and stretches, as the library makes them.

use super::context::Context;
use super::cost::Lowering;
use super::place::{self, Kind, Place};
use nastic_control::{Compliance, Cost, Curvature, IntoCost, LargestStretch, MeanPosition, Orientation};
use nastic_language::schema;

impl Lowering<'_> {
    pub(super) fn position(&self, block: &schema::Position, context: &mut Context<'_>) -> Option<Box<dyn Cost>> {
        let solid = self.reduced.solid();
        let mut target = [None; 3];
        for ((value, formula), axis) in target.iter_mut().zip(block.target.entries()).zip(["x", "y", "z"]) {
            let at = block.target.at.key(axis);
            *value =
                formula.map(|formula| context.take(&at, formula.at([0.0; 3]))).map_or(Some(None), |v| v.map(Some))?;
        }
        let position = if let Some(point) = &block.point {
            let point = point.xyz();
            context.take(&block.at.key("point"), solid.mesh().locate_inside(point))?;
            MeanPosition::point(point, target)
        } else {
            let place = Place::of(&block.surface, &block.region, &block.nodes)?;
            place.nodes(solid.mesh(), &block.at, context)?;
            match place.kind {
                Kind::Surface => MeanPosition::surface(place.names, target),
                Kind::Region => MeanPosition::region(place.names, target),
                Kind::Nodes => MeanPosition::nodes(place.names, target),
            }
        };
        context.take(&block.at.key("target"), position.weight(block.weight).bind(solid))
    }

    pub(super) fn orientation(&self, block: &schema::Orientation, context: &mut Context<'_>) -> Option<Box<dyn Cost>> {
        let solid = self.reduced.solid();
        place::facets(solid.mesh(), &block.surface, &block.at.key("surface"), context)?;
        let cost = Orientation::surface(&block.surface, block.direction.xyz()).weight(block.weight);
        context.take(&block.at.key("direction"), cost.bind(solid))
    }

    pub(super) fn compliance(&self, block: &schema::Compliance, context: &mut Context<'_>) -> Option<Box<dyn Cost>> {
        let solid = self.reduced.solid();
        if self.case.time.is_some() {
            let message = "the compliance of a body in motion: it is that of an equilibrium; take a static case";
            context.complain(&block.at, message);
            return None;
        }
        if ["gauss_newton", "newton_cg"].contains(&self.case.optimizer.method.name()) {
            let message = "a compliance has no second derivatives, which the method of this case needs: take \"lbfgs\"";
            context.complain(&block.at, message);
            return None;
        }
        place::facets(solid.mesh(), &block.surface, &block.at.key("surface"), context)?;
        let cost = Compliance::surface(&block.surface, block.direction.xyz()).weight(block.weight);
        context.take(&block.at, cost.bind(solid))
    }

    pub(super) fn curvature(&self, block: &schema::Curvature, context: &mut Context<'_>) -> Option<Box<dyn Cost>> {
        let solid = self.reduced.solid();
        let points: Vec<[f64; 3]> = block.line.iter().map(schema::Vector::xyz).collect();
        let located = |(i, point): (usize, &[f64; 3])| {
            context.take(&block.at.key("line").index(i), solid.mesh().locate_inside(*point)).is_some()
        };
        // Every point outside is told.
        let inside = points.iter().enumerate().map(located).fold(true, |all, one| all & one);
        let axis = block.axis.as_ref().map(schema::Direction::xyz);
        if axis.is_none() && solid.mesh().dim() == 3 {
            context.complain(&block.at, "a body in space needs an \"axis\": turns about it count as positive");
            return None;
        }
        let cost = Curvature::of_line(points, axis.unwrap_or([0.0, 0.0, 1.0]), block.curvature).weight(block.weight);
        if inside { context.take(&block.at, cost.bind(solid)) } else { None }
    }

    pub(super) fn largest_stretch(
        &self,
        block: &schema::LargestStretch,
        context: &mut Context<'_>,
    ) -> Option<Box<dyn Cost>> {
        let solid = self.reduced.solid();
        let mut cost = LargestStretch::default().exponent(block.exponent as u32).weight(block.weight);
        if let Some(region) = &block.region {
            place::cells(solid.mesh(), region, &block.at.key("region"), context)?;
            cost = cost.region(region);
        }
        context.take(&block.at.key("exponent"), cost.bind(solid))
    }
}
