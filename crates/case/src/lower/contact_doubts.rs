//! Contacts that can be solved but are hardly meant.

use super::context::Context;
use super::pressures;
use crate::warning::INPUT;
use nastic_fem::Solid;
use nastic_language::number::short;
use nastic_language::quantity::Dimension;
use nastic_language::schema::{Case, Contact, PressureLaw, Shape};
use nastic_language::syntax::quoted;
use nastic_mesh::{GroupNames, Mesh};
use std::collections::BTreeSet;

/// Coefficient of friction above which nothing is known: rubber on rubber or on rough glass has 1 to 2.
const ROUGHEST: f64 = 2.0;
/// Thickness of a layer, as a share of the diagonal of the surface, above which it is no layer: left out it is 1/500.
const THICKEST: f64 = 0.1;

/// Share of Young's modulus of the softest material below which a contact gives way before the body does.
const SOFTEST: f64 = 0.01;

/// Warns of a contact of a surface whose diagonal is `size`.
pub(super) fn warn(case: &Case, contact: &Contact, solid: &Solid, size: f64, context: &mut Context<'_>) {
    let mesh = solid.mesh();
    let young = pressures::softest(solid);
    // by the log law no pressure closes the gap
    if let (Some(stiffness), Some(young), PressureLaw::Cubic) = (contact.stiffness, young, &contact.law)
        && stiffness < SOFTEST * young
    {
        let unit = context.units.label(Dimension::PRESSURE);
        let message = format!(
            "the pressure that closes the gap, {} {unit}, is below a hundredth of Young's modulus of the softest material, {young:.3e} {unit}: \
             beyond it the surfaces go through each other; left out it follows from the body",
            short(stiffness)
        );
        context.warn(&INPUT, &contact.at.key("stiffness"), message);
    }
    if let Some(friction) = contact.friction.filter(|friction| *friction > ROUGHEST) {
        let message = format!("a coefficient of friction of {}: rubber on rubber has 1 to 2", short(friction));
        context.warn(&INPUT, &contact.at.key("friction"), message);
    }
    if let Some(thickness) = contact.thickness.filter(|thickness| *thickness > THICKEST * size) {
        let unit = context.units.length().symbol;
        let message = format!(
            "the layer is {} {unit} thick and the surface {} {unit} large: it pushes from afar; left out it is 1/500 of that",
            short(thickness),
            short(size)
        );
        context.warn(&INPUT, &contact.at.key("thickness"), message);
    }
    let before = case.contact.iter().take_while(|other| other.at != contact.at);
    if let Some(other) = before.into_iter().find(|other| is_of_the_same(mesh, contact, other)) {
        let message = format!(
            "{} and {} are contacts of the same pair, or have a part of it in common, which acts with the force of both",
            quoted(&contact.name()),
            quoted(&other.name())
        );
        context.warn(&INPUT, &contact.at, message);
    }
    let is_round = |shape: &Shape| matches!(shape, Shape::Sphere(_) | Shape::Capsule(_) | Shape::HalfSpace(_));
    let touched = case.obstacles.iter().filter(|own| contact.is_on(&own.name));
    for touched in touched.filter(|own| own.rounding > 0.0 && is_round(&own.shape)) {
        let message = "the shape has no edges: a rounding makes it larger by that radius, or does nothing".to_owned();
        context.warn(&INPUT, &touched.at.key("rounding"), message);
    }
}

/// Whether both have facets of the same two sides, whatever their names and order.
fn is_of_the_same(mesh: &Mesh, one: &Contact, other: &Contact) -> bool {
    let common = |a: &GroupNames, b: &GroupNames| {
        let [a, b] = [a, b].map(|names| mesh.facets_of(names).unwrap_or_default());
        let b: BTreeSet<_> = b.iter().map(|facet| (facet.cell, facet.face)).collect();
        a.iter().any(|facet| b.contains(&(facet.cell, facet.face)))
    };
    match (&one.with, &other.with) {
        (None, None) => one.obstacle == other.obstacle && common(&one.surface, &other.surface),
        (Some(with), Some(other_with)) => {
            common(&one.surface, &other.surface) && common(with, other_with)
                || common(&one.surface, other_with) && common(with, &other.surface)
        }
        _ => false,
    }
}
