//! What pulls between held points: supports take it.

use super::context::Context;
use crate::warning::INPUT;
use nastic_fem::{BodyPoint, Solid};
use nastic_language::schema::{Case, Means};
use nastic_mesh::GroupNames;

/// Shape functions that are zero but for rounding.
const ROUNDING: f64 = 1e-9;

/// Warns of those that move nothing.
pub(super) fn check(case: &Case, solid: &Solid, context: &mut Context<'_>) {
    for actuation in &case.actuation {
        let Means::Contribution { values, .. } = &actuation.means else { continue };
        let mut cables = values.points.values().filter(|points| points.len() > 1);
        if cables.any(|points| points.iter().all(|point| is_held(point, solid))) {
            let message = "all its guides are held: its pull ends in the supports and moves nothing; lead it through a part \
                           that is free to move";
            context.warn(&INPUT, &actuation.at, message);
        }
    }
    for block in case.blocks() {
        if let Some(message) = block.idle(&|point| is_held(point, solid)) {
            context.warn(&INPUT, block.at(), message);
        }
    }
}

/// Whether no component of the nodes of a point can move.
fn is_held(point: &BodyPoint, solid: &Solid) -> bool {
    let (mesh, fixed) = (solid.mesh(), solid.supports().fixed());
    let dim = mesh.dim();
    let nodes: Vec<u32> = match point {
        BodyPoint::At(place) => match mesh.locate_inside(*place) {
            Ok(at) => at.weights.iter().filter(|(_, shape)| shape.abs() > ROUNDING).map(|(node, _)| *node).collect(),
            Err(_) => return false,
        },
        BodyPoint::Nodes(name) => solid.nodes_of(GroupNames::from(name.as_str())).unwrap_or_default(),
    };
    !nodes.is_empty() && nodes.iter().all(|node| (0..dim).all(|i| fixed[dim * *node as usize + i]))
}
