//! Supports: components held or prescribed on surfaces, regions and node sets.

use super::context::Context;
use super::named::attempt;
use super::named_groups::NamedGroups;
use crate::warning::INPUT;
use nastic_fem::{Foundation, Solid};
use nastic_language::expression::EvaluationError;
use nastic_language::number::count;
use nastic_language::schema::{Along, Case, Displacement, Support};
use nastic_language::syntax::At;
use nastic_mesh::Mesh;

pub(super) fn add(case: &Case, solid: &mut Solid, context: &mut Context<'_>) {
    for support in &case.supports {
        let mesh = solid.mesh().clone();
        let Some(place) = NamedGroups::of(&support.surface, &support.region, &support.nodes) else { continue };
        let Some(nodes) = place.nodes(&mesh, &support.at, context) else { continue };
        if let Some(stiffness) = support.foundation {
            let foundation = Foundation::on(place.names, stiffness);
            let foundation = if support.along == Along::Normal { foundation.normal_only() } else { foundation };
            attempt(solid, &support.at, context, |solid| solid.foundation(foundation));
            continue;
        }
        let Some(values) = values(support, &mesh, &nodes, context) else { continue };
        attempt(solid, &support.at, context, |solid| {
            solid.displace_nodes(&place.names.to_string(), &nodes, |node, _| {
                let known = nodes.binary_search(&node).ok();
                known.and_then(|k| values.get(k)).copied().unwrap_or([None; 3])
            })
        });
        warn_of_led(solid, &place.names.to_string(), &support.at, context);
    }
}

/// A motion leads the nodes that a support holds too, which may not be what was meant.
fn warn_of_led(solid: &Solid, name: &str, at: &At, context: &mut Context<'_>) {
    for (motion, _, nodes) in solid.supports().shared_with_motions().filter(|(_, support, _)| *support == name) {
        let message = format!(
            "the motion \"{motion}\" has {} of this support too, and leads them in the components that both hold",
            count(nodes, "node")
        );
        context.warn(&INPUT, at, message);
    }
}

/// What is prescribed at each node.
fn values(support: &Support, mesh: &Mesh, nodes: &[u32], context: &mut Context<'_>) -> Option<Vec<[Option<f64>; 3]>> {
    let held = support.fix.held();
    let Some(moved) = &support.displacement else { return Some(vec![held; nodes.len()]) };
    let at = support.at.key("displacement");
    let each = nodes.iter().map(|&node| prescribed(moved, mesh.points()[node as usize], held));
    let each: Result<Vec<_>, (usize, EvaluationError)> = each.collect();
    each.map_err(|(axis, error)| context.complain(&component(&at, axis), error)).ok()
}

fn prescribed(
    moved: &Displacement,
    point: [f64; 3],
    held: [Option<f64>; 3],
) -> Result<[Option<f64>; 3], (usize, EvaluationError)> {
    let mut out = held;
    for (axis, entry) in moved.entries().into_iter().enumerate() {
        if let Some(formula) = entry {
            out[axis] = Some(formula.at(point).map_err(|error| (axis, error))?);
        }
    }
    Ok(out)
}

fn component(at: &At, axis: usize) -> At {
    at.key(nastic_fem::AXES[axis])
}
