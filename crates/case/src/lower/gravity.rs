//! The weight of all that has a density, also under a gravity that changes in time.

use super::actuation::{fix_in_time, uses_time, vector_at_time};
use super::context::Context;
use super::design;
use super::load::{MORE_POINTS, NO_Z};
use super::magnitude::check_gravity;
use super::named::attempt;
use super::named_groups;
use super::shape;
use nastic_control::Reduced;
use nastic_fem::{QuadraturePoints, Solid, VaryingLoad};
use nastic_language::schema::{Case, Fixed, Load, Material, VectorField, VectorInTime};
use nastic_language::syntax::{At, quoted};
use nastic_tensor::Vec3;

/// The weight `rho g` of every material.
pub(super) fn add(case: &Case, solid: &mut Solid, context: &mut Context<'_>) {
    for (at, VectorInTime(value), load) in of(case) {
        // a table that could not be read was complained about
        let Fixed::Vector(field) = value else { continue };
        if dense(case).next().is_none() {
            let message = "weight needs masses: give every material a \"density\", as in \"1000 kg/m^3\"";
            context.complain(&at, message);
        }
        if uses_time(value) {
            for (material, density) in dense(case) {
                if design::mass_map(case, material).is_some() {
                    let message = format!(
                        "a gravity that changes in time does not follow a design: say \"mass\": false of that of {}",
                        material.at
                    );
                    context.complain(&at, message);
                } else if let Some(shape) = shape::of_material(solid, material) {
                    let message = format!("a gravity that changes in time does not follow the shape {}", quoted(shape));
                    context.complain(&at, message);
                }
                add_varying(load, material, density, &at, solid, context);
            }
            continue;
        }
        let Some(gravity) = field.constant() else { continue };
        check_gravity(gravity, &at, context);
        for (material, density) in dense(case) {
            let force = Vec3::from(gravity) * density;
            let follows = design::mass_map(case, material).is_some() || shape::of_material(solid, material).is_some();
            attempt(solid, &at, context, |solid| match follows {
                false => solid.body_force(&material.region, force),
                true => {
                    let name = design::weight_name(load, material);
                    let weight = VaryingLoad::filled(&name, solid.body(), &material.region, force)?;
                    solid.contribution(weight)
                }
            });
        }
    }
}

/// Loads that are a gravity.
fn of(case: &Case) -> impl Iterator<Item = (At, &VectorInTime, &Load)> {
    case.loads.iter().filter_map(|load| Some((load.at.key("gravity"), load.gravity.as_ref()?, load)))
}

/// Materials with their densities.
fn dense(case: &Case) -> impl Iterator<Item = (&Material, f64)> {
    case.materials.iter().filter_map(|material| Some((material, material.density?)))
}

/// What the weight of a material is called in messages: no other block has its place.
fn name_of(load: &Load, material: &Material) -> String {
    format!("gravity in time, {}, {}", load.at, material.at)
}

fn add_varying(load: &Load, material: &Material, density: f64, at: &At, solid: &mut Solid, context: &mut Context<'_>) {
    let mesh = solid.mesh().clone();
    let region = &material.region;
    let Some(cells) = named_groups::cells(&mesh, region, &material.at.key("region"), context) else { return };
    let rule = |kind: nastic_mesh::CellKind| kind.rule_of_points(kind.order() + 1 + MORE_POINTS);
    let Some(sampling) = context.take(at, QuadraturePoints::of_cells(&mesh, cells, rule)) else { return };
    let weight = VaryingLoad::weight(name_of(load, material), &mesh, &sampling, density);
    attempt(solid, at, context, |solid| solid.contribution(weight));
}

/// Lets weights follow a gravity that changes in time; `None` after a complaint that leaves no problem to go on with.
pub(super) fn fix(case: &Case, mut reduced: Reduced, context: &mut Context<'_>) -> Option<Reduced> {
    for (at, VectorInTime(value), load) in of(case).filter(|(_, VectorInTime(value), _)| uses_time(value)) {
        let Fixed::Vector(VectorField::Formulas(entries)) = value else { continue };
        let plane = reduced.solid().mesh().dim() == 2;
        if plane && entries.get(2).is_some_and(|z| z.constant() != Some(0.0)) {
            context.complain(&at, NO_Z);
            return None;
        }
        let instants = reduced.timeline()?.instants().to_vec();
        let all = instants.iter().map(|t| vector_at_time(entries, *t)).collect::<Result<Vec<_>, _>>();
        let all = context.take(&at, all)?;
        let size = |g: &[f64; 3]| g.iter().map(|g| g * g).sum::<f64>();
        let largest = all.iter().copied().max_by(|a, b| size(a).total_cmp(&size(b)));
        check_gravity(largest.unwrap_or_default(), &at, context);
        for (material, _) in dense(case) {
            let name = name_of(load, material);
            let known = reduced.solid().model().controllable();
            let Some(index) = known.iter().position(|own| own.name == name) else { continue };
            for (component, first) in all[0].iter().enumerate() {
                let fixed = reduced.fix(index, component, &[*first]);
                reduced = context.take(&at, fixed)?;
            }
            reduced = fix_in_time(value, &at, (index, 0, None), reduced, vec![[0.0; 3]], context)?;
        }
    }
    Some(reduced)
}
