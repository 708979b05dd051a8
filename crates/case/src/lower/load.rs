//! Dead loads: tractions and body forces, constant or varying.

use super::context::Context;
use super::field::SamplePoints;
use super::named::attempt;
use super::named_groups;
use nastic_fem::{QuadraturePoints, Solid};
use nastic_language::schema::{Case, VectorField};
use nastic_language::syntax::At;
use nastic_mesh::GroupNames;
use nastic_tensor::Vec3;

/// Gauss points more than the shape functions need, for loads that vary.
const MORE_POINTS: usize = 1;

pub(super) fn add(case: &Case, solid: &mut Solid, context: &mut Context<'_>) {
    for load in &case.loads {
        if let (Some(name), Some(traction)) = (&load.surface, &load.traction) {
            add_traction(case, name, traction, &load.at, solid, context);
        } else if let (Some(name), Some(force)) = (&load.region, &load.body_force) {
            add_body_force(case, name, force, &load.at, solid, context);
        }
    }
}

fn add_traction(
    case: &Case,
    names: &GroupNames,
    traction: &VectorField,
    at: &At,
    solid: &mut Solid,
    context: &mut Context<'_>,
) {
    let mesh = solid.mesh().clone();
    let Some(facets) = named_groups::facets(&mesh, names, &at.key("surface"), context) else { return };
    if let Some(constant) = traction.constant() {
        attempt(solid, at, context, |solid| solid.traction(names, Vec3::from(constant)));
        return;
    }
    let sampling =
        QuadraturePoints::of_facets(&mesh, &facets, |kind| kind.rule_of_points(kind.order() + 1 + MORE_POINTS));
    add_sampled(case, &sampling, traction, &at.key("traction"), solid, context);
}

fn add_body_force(
    case: &Case,
    names: &GroupNames,
    force: &VectorField,
    at: &At,
    solid: &mut Solid,
    context: &mut Context<'_>,
) {
    let mesh = solid.mesh().clone();
    let Some(cells) = named_groups::cells(&mesh, names, &at.key("region"), context) else { return };
    if let Some(constant) = force.constant() {
        attempt(solid, at, context, |solid| solid.body_force(names, Vec3::from(constant)));
        return;
    }
    let rule = |kind: nastic_mesh::CellKind| kind.rule_of_points(kind.order() + 1 + MORE_POINTS);
    let sampling = QuadraturePoints::of_cells(&mesh, cells, rule);
    let Some(sampling) = context.take(at, sampling) else { return };
    add_sampled(case, &sampling, force, &at.key("body_force"), solid, context);
}

/// The nodal force of a density at the points of a sampling.
fn add_sampled(
    case: &Case,
    sampling: &QuadraturePoints,
    density: &VectorField,
    at: &At,
    solid: &mut Solid,
    context: &mut Context<'_>,
) {
    let mesh = solid.mesh().clone();
    let Some(values) = SamplePoints::of(case, &mesh, sampling).vectors(density, at, context) else { return };
    let dim = mesh.dim();
    if dim == 2 && values.iter().any(|v| v.z != 0.0) {
        context.complain(at, "a load on a body in plane strain has no z component");
        return;
    }
    let weighted = values.iter().zip(sampling.weights());
    let weighted: Vec<f64> = weighted.flat_map(|(v, w)| (0..dim).map(move |i| w * v[i])).collect();
    let mut force = vec![0.0; solid.discretization().dofs()];
    sampling.spread(&weighted, dim, &mut force);
    attempt(solid, at, context, |solid| solid.nodal_force(&force));
}
