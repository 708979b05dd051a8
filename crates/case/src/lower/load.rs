//! Dead loads: tractions and body forces, constant or varying, over the body and in time.

use super::actuation::{fix_in_time, uses_time};
use super::context::Context;
use super::field::SamplePoints;
use super::named::attempt;
use super::{named_groups, pressures, shape};
use nastic_control::Reduced;
use nastic_fem::{QuadraturePoints, Solid, VaryingLoad};
use nastic_language::schema::{Case, Fixed, Load, VectorField};
use nastic_language::syntax::At;
use nastic_mesh::Mesh;
use nastic_tensor::Vec3;

/// Gauss points more than the shape functions need, for loads that vary.
pub(super) const MORE_POINTS: usize = 1;

pub(super) fn add(case: &Case, solid: &mut Solid, context: &mut Context<'_>) {
    for load in &case.loads {
        let Some((at, value)) = density(load) else { continue };
        // a table that could not be read was complained about
        let Fixed::Vector(field) = value else { continue };
        let mesh = solid.mesh().clone();
        let Some(sampling) = sampling(load, &mesh, context) else { continue };
        shape::note_of_load(load, &sampling, solid, context);
        if uses_time(value) {
            let name = name_of(load);
            let varying = VaryingLoad::new(name, &mesh, &sampling, load.surface.is_some());
            attempt(solid, &load.at, context, |solid| solid.contribution(varying));
            continue;
        }
        match (field.constant().map(Vec3::from), &load.surface, &load.region) {
            (Some(constant), Some(names), _) => {
                pressures::check_given(constant.norm(), solid, &at, context);
                attempt(solid, &load.at, context, |solid| solid.traction(names, constant));
            }
            (Some(constant), None, Some(names)) => {
                pressures::check_body_force(constant.norm(), solid, &at, context);
                attempt(solid, &load.at, context, |solid| solid.body_force(names, constant));
            }
            (_, surface, _) => {
                let Some(largest) = add_sampled(case, &sampling, field, &at, solid, context) else { continue };
                match surface {
                    Some(_) => pressures::check_given(largest, solid, &at, context),
                    None => pressures::check_body_force(largest, solid, &at, context),
                }
            }
        }
    }
}

/// Lets the loads that change in time follow their values; `None` after a complaint that leaves no problem to go on with.
pub(super) fn fix(case: &Case, mut reduced: Reduced, context: &mut Context<'_>) -> Option<Reduced> {
    for load in &case.loads {
        let Some((at, value)) = density(load).filter(|(_, value)| uses_time(value)) else { continue };
        let Fixed::Vector(field) = value else { continue };
        let name = name_of(load);
        let Some(index) = reduced.solid().model().controllable().iter().position(|own| own.name == name) else {
            continue;
        };
        let mesh = reduced.solid().mesh().clone();
        let sampling = sampling(load, &mesh, context)?;
        let points = SamplePoints::of(case, &mesh, &sampling);
        let first = points.vectors(field, &at, context)?;
        if mesh.dim() == 2
            && matches!(field, VectorField::Formulas(entries) if entries.get(2).is_some_and(|z| z.constant() != Some(0.0)))
        {
            context.complain(&at, NO_Z);
            return None;
        }
        for component in 0..3 {
            let values: Vec<f64> = first.iter().map(|v| v[component]).collect();
            let fixed = reduced.fix(index, component, &values);
            reduced = context.take(&at, fixed)?;
        }
        reduced = fix_in_time(value, &at, (index, 0, None), reduced, points.places(), context)?;
    }
    Some(reduced)
}

pub(super) const NO_Z: &str = "a load on a body in plane strain has no z component";

/// What a load is called in messages: no other block has its place.
fn name_of(load: &Load) -> String {
    format!("load in time, {}", load.at)
}

/// The density of a load with its key; none of gravity.
fn density(load: &Load) -> Option<(At, &Fixed)> {
    let parts = [("traction", &load.traction), ("body_force", &load.body_force)];
    let mut given = parts.into_iter().filter_map(|(key, part)| Some((load.at.key(key), &part.as_ref()?.0)));
    given.next()
}

/// The points of the surface or region that a load acts on; `None` after a complaint.
fn sampling(load: &Load, mesh: &Mesh, context: &mut Context<'_>) -> Option<QuadraturePoints> {
    let rule = |kind: nastic_mesh::CellKind| kind.rule_of_points(kind.order() + 1 + MORE_POINTS);
    if let Some(names) = &load.surface {
        let facets = named_groups::facets(mesh, names, &load.at.key("surface"), context)?;
        return Some(QuadraturePoints::of_facets(mesh, &facets, rule));
    }
    let cells = named_groups::cells(mesh, load.region.as_ref()?, &load.at.key("region"), context)?;
    let sampling = QuadraturePoints::of_cells(mesh, cells, rule);
    context.take(&load.at, sampling)
}

/// The nodal force of a density at the points of a sampling; its largest value, `None` after a complaint.
fn add_sampled(
    case: &Case,
    sampling: &QuadraturePoints,
    density: &VectorField,
    at: &At,
    solid: &mut Solid,
    context: &mut Context<'_>,
) -> Option<f64> {
    let mesh = solid.mesh().clone();
    let values = SamplePoints::of(case, &mesh, sampling).vectors(density, at, context)?;
    let dim = mesh.dim();
    if dim == 2 && values.iter().any(|v| v.z != 0.0) {
        context.complain(at, NO_Z);
        return None;
    }
    let weighted = values.iter().zip(sampling.weights());
    let weighted: Vec<f64> = weighted.flat_map(|(v, w)| (0..dim).map(move |i| w * v[i])).collect();
    let mut force = vec![0.0; solid.discretization().dofs()];
    sampling.spread(&weighted, dim, &mut force);
    attempt(solid, at, context, |solid| solid.nodal_force(&force));
    values.iter().map(|v| v.norm()).reduce(f64::max)
}
