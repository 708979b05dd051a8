//! Supports: components held or prescribed on surfaces, regions and node sets.

use super::context::Context;
use super::named::attempt;
use crate::expression::EvaluationError;
use crate::schema::{Case, Displacement, Support};
use crate::syntax::At;
use nastic_fem::Solid;
use nastic_mesh::{Mesh, MeshError};

pub(super) fn add(case: &Case, solid: &mut Solid, context: &mut Context<'_>) {
    for support in &case.supports {
        let mesh = solid.mesh().clone();
        let (key, name) = place(support);
        let Some(nodes) = context.take(&support.at.key(key), nodes(&mesh, key, name)) else { continue };
        let Some(values) = values(support, &mesh, &nodes, context) else { continue };
        attempt(solid, &support.at, context, |solid| {
            solid.displace_nodes(name, &nodes, |node, _| {
                let known = nodes.binary_search(&node).ok();
                known.and_then(|k| values.get(k)).copied().unwrap_or([None; 3])
            })
        });
    }
}

fn place(support: &Support) -> (&'static str, &str) {
    match (&support.surface, &support.region, &support.nodes) {
        (Some(name), _, _) => ("surface", name),
        (_, Some(name), _) => ("region", name),
        (_, _, Some(name)) => ("nodes", name),
        (None, None, None) => ("surface", ""),
    }
}

/// The nodes of a place, ascending.
pub(super) fn nodes(mesh: &Mesh, key: &str, name: &str) -> Result<Vec<u32>, MeshError> {
    Ok(match key {
        "surface" => mesh.nodes_of_facets(mesh.surface(name)?),
        "region" => mesh.nodes_of_cells(mesh.region(name)?),
        _ => mesh.node_set(name)?.to_vec(),
    })
}

/// What is prescribed at each node.
fn values(support: &Support, mesh: &Mesh, nodes: &[u32], context: &mut Context<'_>) -> Option<Vec<[Option<f64>; 3]>> {
    let mut held = [None; 3];
    support.fix.iter().for_each(|axis| held[axis.index()] = Some(0.0));
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
