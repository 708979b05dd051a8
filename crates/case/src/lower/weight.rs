//! Whether weight presses a body that nothing holds onto what it may lie on.

use super::context::Context;
use crate::warning::INPUT;
use nastic_fem::Solid;
use nastic_language::schema::{Case, Contact, Obstacle, Shape, VectorField, VectorInTime, vector_at};
use nastic_language::syntax::quoted;

/// Warns of gravity that takes a body without supports away from every half-space that it touches.
pub(super) fn check(case: &Case, solid: &Solid, context: &mut Context<'_>) {
    if solid.model().checks().is_held_without_contact() {
        return;
    }
    let touched = case.contact.iter().map(|contact: &Contact| {
        case.obstacles.iter().find(|obstacle| contact.is_on(&obstacle.name) && obstacle.pose().next().is_none())
    });
    // another body, or an obstacle that moves, may carry it
    let Some(touched) = touched.collect::<Option<Vec<&Obstacle>>>().filter(|all| !all.is_empty()) else { return };
    for load in &case.loads {
        let Some(VectorField::Formulas(entries)) = load.gravity.as_ref().and_then(VectorInTime::field) else {
            continue;
        };
        let Ok(gravity) = vector_at(entries, [0.0; 3]) else { continue };
        let away = |obstacle: &&Obstacle| match &obstacle.shape {
            Shape::HalfSpace(half) => half.normal.xyz().iter().zip(gravity).map(|(n, g)| n * g).sum::<f64>() > 0.0,
            _ => false,
        };
        if touched.iter().all(away) {
            let names: Vec<String> = touched.iter().map(|obstacle| quoted(&obstacle.name)).collect();
            let message = format!(
                "gravity takes the body away from {}, which it would lie on, and nothing else holds it: does its sign fit the normal?",
                names.join(", ")
            );
            context.warn(&INPUT, &load.at.key("gravity"), message);
        }
    }
}
