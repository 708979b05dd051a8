//! Contacts, and the poses of obstacles that nobody controls.

use super::actuation::{fix_number, vector_at_time};
use super::context::Context;
use super::named::attempt;
use super::strides::{self, Course};
use super::{contact_doubts, named_groups, obstacle, obstacle_grid};
use crate::warning::{INPUT, INSIDE_OBSTACLE};
use nastic_control::Reduced;
use nastic_fem::{ContactLaw, Solid};
use nastic_language::number::short;
use nastic_language::schema::{Case, Contact, Fixed, Obstacle, PressureLaw, Shape, VectorField};
use nastic_language::syntax::quoted;
use nastic_mesh::{GroupNames, Mesh, spatial};

/// The slip speed where none is given: so much of the surface's diagonal over the motion's end.
const SLIP: f64 = 0.01;

pub(super) fn add(case: &Case, solid: &mut Solid, context: &mut Context<'_>) {
    for contact in &case.contact {
        let mesh = solid.mesh().clone();
        let facets = named_groups::facets(&mesh, &contact.surface, &contact.at.key("surface"), context);
        let Some(facets) = facets else { continue };
        let size = diagonal(&mesh, &contact.surface);
        contact_doubts::warn(case, contact, solid, size, context);
        if let Some(with) = &contact.with {
            if named_groups::facets(&mesh, with, &contact.at.key("with"), context).is_some() {
                let built = nastic_fem::Contact::between(&contact.name(), &contact.surface, with);
                let built = specified(built, case, contact, size.min(diagonal(&mesh, with)));
                attempt(solid, &contact.at, context, |solid| solid.contact(built));
            }
            continue;
        }
        let Some(touched) = case.obstacles.iter().find(|own| contact.is_on(&own.name)) else { continue };
        // one that could not be read was complained about
        let given = context.document.root().find(touched.at.key("grid").as_str()).is_some();
        if given && touched.grid.is_none() {
            continue;
        }
        let thickness = contact.thickness.unwrap_or_else(|| nastic_fem::Contact::usual_thickness(&mesh, &facets));
        let Some(shape) = obstacle::build(touched.outline(), thickness, context) else { continue };
        let built = nastic_fem::Contact::of(&contact.name(), &contact.surface, shape.clone());
        let mut built = specified(built, case, contact, size).pose_of(&touched.name).settled();
        if let Some(centre) = &touched.centre {
            built = built.about(centre.xyz());
        }
        attempt(solid, &contact.at, context, |solid| solid.contact(built));
        check_outside(case, contact, touched, &shape, solid, context);
        obstacle_grid::check(touched, &contact.name(), &shape, solid, context);
    }
    for untouched in case.obstacles.iter().filter(|own| !case.contact.iter().any(|contact| contact.is_on(&own.name))) {
        if let Some((key, _)) = untouched.pose().next() {
            let message = format!("no contact touches {}: its pose moves nothing", quoted(&untouched.name));
            context.warn(&INPUT, &untouched.at.key(key), message);
        }
    }
}

/// A contact with what was given, whatever it touches, of surfaces whose least one is so large.
fn specified(mut built: nastic_fem::Contact, case: &Case, contact: &Contact, size: f64) -> nastic_fem::Contact {
    built = built.law(match contact.law {
        PressureLaw::Cubic => ContactLaw::Cubic,
        PressureLaw::Log => ContactLaw::Log,
    });
    if let Some(thickness) = contact.thickness {
        built = built.thickness(thickness);
    }
    if let Some(stiffness) = contact.stiffness {
        built = built.stiffness(stiffness);
    }
    if let Some(refine) = contact.refine {
        built = built.refine(refine as usize);
    }
    if let (Some(friction), Some(time)) = (contact.friction, &case.time) {
        built = built.friction(friction, contact.slip_speed.unwrap_or(SLIP * size / time.end));
    }
    if contact.lagged { built.lagged() } else { built }
}

/// Warns of a body at rest that reaches deeper into an obstacle than a contact bears, also where no surface touches it: not into one that moves in a
/// motion, whose pose at t = 0 it begins with; an equilibrium begins where its shape is.
fn check_outside(
    case: &Case,
    contact: &Contact,
    touched: &Obstacle,
    shape: &spatial::Obstacle,
    solid: &Solid,
    context: &mut Context<'_>,
) {
    let pose = ["translation", "rotation"].map(|part| format!("{}.{part}", touched.name));
    let moves = touched.pose().next().is_some() || case.controls.iter().any(|control| pose.contains(&control.of));
    if moves && case.time.is_some() {
        return;
    }
    let (mesh, name) = (solid.mesh(), contact.name());
    let layer = solid.model().contacts().parameters().into_iter().find(|(own, _)| *own == name);
    let depths = mesh.points().iter().map(|x| (-shape.distance(x), x));
    let (Some((depth, place)), Some((_, layer))) = (depths.max_by(|a, b| a.0.total_cmp(&b.0)), layer) else { return };
    if depth > layer.thickness {
        let unit = context.units.length().symbol;
        let place: Vec<String> = place[..mesh.dim()].iter().map(|x| short(*x)).collect();
        let normal = if matches!(touched.shape, Shape::HalfSpace(_)) {
            "; its normal points to where the body belongs"
        } else {
            ""
        };
        let from = if moves { ", from where that is moved to its pose while loads grow" } else { "" };
        let message = format!(
            "the body at rest is {} {unit} inside of {} at ({}){from}: move one of them{normal}",
            short(depth),
            quoted(&touched.name),
            place.join(", ")
        );
        context.warn(&INSIDE_OBSTACLE, &contact.at.key("obstacle"), message);
    }
}

/// Of the surface's bounding box.
fn diagonal(mesh: &Mesh, surface: &GroupNames) -> f64 {
    let nodes = mesh.facets_of(surface).map(|facets| mesh.nodes_of_facets(&facets)).unwrap_or_default();
    let along = |i: usize| {
        let each = || nodes.iter().map(|&node| mesh.points()[node as usize][i]);
        each().fold(f64::NEG_INFINITY, f64::max) - each().fold(f64::INFINITY, f64::min)
    };
    (0..3).map(|i| along(i).powi(2)).sum::<f64>().sqrt()
}

/// Warns of an obstacle that races, or that may be through the body within a step.
fn check_course(touched: &Obstacle, reduced: &Reduced, context: &mut Context<'_>) {
    let Some((key, value)) = touched.pose().find(|(key, _)| *key == "translation") else { return };
    let (Some(timeline), Fixed::Vector(VectorField::Formulas(entries))) = (reduced.timeline(), value) else { return };
    let instants = timeline.instants();
    // what fails here is complained about where the values are set
    let Ok(moved) = instants.iter().map(|t| vector_at_time(entries, *t)).collect::<Result<Vec<_>, _>>() else { return };
    let at = touched.at.key(key);
    Course { mesh: reduced.solid().mesh(), at: &at, context }.check(instants, &moved, strides::width(&touched.shape));
}

/// Sets the poses that are no controls, of every contact of an obstacle; `None` after a complaint.
pub(super) fn fix(case: &Case, mut reduced: Reduced, context: &mut Context<'_>) -> Option<Reduced> {
    for touched in &case.obstacles {
        check_course(touched, &reduced, context);
        for (key, value) in touched.pose().filter(|(_, value)| !matches!(value, Fixed::Table(_))) {
            let at = touched.at.key(key);
            let name = format!("{}.{key}", touched.name);
            if let Some(control) = case.controls.iter().find(|own| own.of == name && own.direction.is_none()) {
                let message = format!(
                    "{} controls this: remove the fixed value, or give the control a \"direction\", along which it comes on top",
                    control.at
                );
                context.complain(&at, message);
                continue;
            }
            for contact in case.contact.iter().filter(|contact| contact.is_on(&touched.name)) {
                let controllable = reduced.solid().model().controllable();
                let Some(index) = controllable.iter().position(|own| own.name == contact.name()) else { continue };
                let first = controllable[index].slots.iter().position(|slot| slot.group == key)?;
                reduced = fix_number(&touched.name, &at, (key, false), value, (index, first), reduced, context)?;
            }
        }
    }
    Some(reduced)
}
