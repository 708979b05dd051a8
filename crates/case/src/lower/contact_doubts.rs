//! Contacts that can be solved but are hardly meant.

use super::context::Context;
use crate::warning::INPUT;
use nastic_language::number::short;
use nastic_language::schema::{Case, Contact, Shape};
use nastic_language::syntax::quoted;

/// Coefficient of friction above which nothing is known: rubber on rubber or on rough glass has 1 to 2.
const ROUGHEST: f64 = 2.0;
/// Thickness of a layer, as a share of the diagonal of the surface, above which it is no layer: left out it is 1/500.
const THICKEST: f64 = 0.1;

/// Warns of a contact of a surface whose diagonal is `size`.
pub(super) fn warn(case: &Case, contact: &Contact, size: f64, context: &mut Context<'_>) {
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
    if let Some(other) = before.into_iter().find(|other| is_of_the_same(contact, other)) {
        let message = format!(
            "{} and {} are contacts of the same pair, which acts with the force of both",
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

fn is_of_the_same(one: &Contact, other: &Contact) -> bool {
    let pair = |contact: &Contact| (contact.surface.clone(), contact.with.clone());
    let swapped =
        one.with.as_ref().is_some_and(|with| (Some(&one.surface), with) == (other.with.as_ref(), &other.surface));
    let same_obstacle = one.with.is_none() && other.with.is_none() && one.obstacle == other.obstacle;
    (same_obstacle || one.with.is_some()) && pair(one) == pair(other) || swapped
}
