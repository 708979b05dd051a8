//! Targets that lie far away from the body.

use super::context::Context;
use super::target_shape::TargetShape;
use crate::warning::UNITS;
use nastic_control::{Cost, CostContext, FigureKind, Reduced};
use nastic_language::number::short;
use nastic_language::schema::Cost as Block;
use nastic_mesh::Mesh;

/// A body that is held reaches no target so many of its sizes away.
const HELD: f64 = 10.0;
/// One that is not may be thrown farther.
const FREE: f64 = 100.0;

/// Warns of a target that the body at rest is many times its size away from.
pub(super) fn check(
    block: &Block,
    cost: &dyn Cost,
    shape: Option<&TargetShape>,
    reduced: &Reduced,
    context: &mut Context<'_>,
) {
    let solid = reduced.solid();
    let mesh = solid.mesh();
    let distance = match shape {
        Some(shape) if shape.displacement.is_empty() => Some(apart(mesh, &shape.mesh)),
        Some(shape) => {
            let length = |u: &[f64; 3]| u.iter().map(|x| x * x).sum::<f64>().sqrt();
            shape.displacement.iter().filter(|(_, matters)| *matters).map(|(u, _)| length(u)).reduce(f64::min)
        }
        None => position(cost, reduced),
    };
    let most = if solid.model().checks().is_held_without_contact() { HELD } else { FREE };
    let Some((distance, sizes)) = distance.map(|distance| (distance, distance / mesh.diagonal())) else { return };
    if sizes > most {
        let unit = context.units.length().symbol;
        let message = format!(
            "the target is {} {unit} away from the body at rest, {} times its size: is it in another unit, or about another origin?",
            short(distance),
            short(sizes.round())
        );
        context.warn(&UNITS, &block.at().key("target"), message);
    }
}

/// The distance of two bounding boxes.
fn apart(a: &Mesh, b: &Mesh) -> f64 {
    let ((low, high), (from, to)) = (a.bounds(), b.bounds());
    let gap = |i: usize| (from[i] - high[i]).max(low[i] - to[i]).max(0.0);
    (0..3).map(|i| gap(i).powi(2)).sum::<f64>().sqrt()
}

/// The distance that a `position` reports of the body at rest.
fn position(cost: &dyn Cost, reduced: &Reduced) -> Option<f64> {
    let (solid, layout) = (reduced.solid(), reduced.layout());
    let (rest, m) = (solid.rest(), vec![0.0; layout.len()]);
    let at = CostContext { solid, layout, u: &rest.u, state: None, m: &m, stage: 0, step: None };
    // without a position it has no such figure, and others may not be defined at rest
    if cost.name() != "position" {
        return None;
    }
    let figures = cost.at(&at).ok()?.figures().ok()?;
    let distance = figures.iter().find(|figure| figure.kind == FigureKind::PositionDistance)?;
    Some(distance.value)
}
