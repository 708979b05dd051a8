//! Meshed obstacles whose distance is interpolated on a grid.

use super::context::Context;
use crate::warning::COARSE_GRID;
use nastic_fem::Solid;
use nastic_language::number::short;
use nastic_language::schema;
use nastic_language::syntax::quoted;
use nastic_mesh::Mesh;
use nastic_mesh::spatial::{DistanceGrid, LostWall, Obstacle};
use std::sync::Arc;

/// How much wider than what matters the grid is.
const MARGIN: f64 = 2.0;

/// Of a block with a spacing; distances up to a reach matter. Reports its size and what it loses of the solid.
pub(super) fn build(
    block: &schema::Obstacle,
    spacing: f64,
    mesh: &Arc<Mesh>,
    reach: f64,
    context: &mut Context<'_>,
) -> Option<Obstacle> {
    let margin = MARGIN * reach.max(0.0);
    let built = context.grid(mesh, [spacing, margin], || Obstacle::on_grid(mesh, spacing, margin));
    let built = context.take(&block.at.key("grid"), built)?;
    if let Obstacle::Grid(grid) = &built {
        let (unit, name) = (context.units.length().symbol, quoted(&block.name));
        let note = format!("{name}: its distance is interpolated {}", shown(grid, unit));
        if !context.found.notes.contains(&note) {
            context.note(note);
        }
        if let Some(LostWall { place, thickness }) = grid.lost() {
            let message = format!(
                "the grid of {name} is too coarse for a wall that is {} {unit} thick at ({}): bodies go through it; take a spacing of less than that",
                short(thickness),
                coordinates(&place[..mesh.dim()])
            );
            warn(block, message, context);
        }
    }
    Some(built)
}

/// Warns where the surface of an obstacle that a contact touches is off by more than the contact's layer is thick.
pub(super) fn check(
    block: &schema::Obstacle,
    contact: &str,
    shape: &Obstacle,
    solid: &Solid,
    context: &mut Context<'_>,
) {
    let layer = solid.model().contacts().parameters().into_iter().find(|(own, _)| own == contact);
    let (Obstacle::Grid(grid), Some((_, layer))) = (shape, layer) else { return };
    if grid.error() > layer.thickness {
        let unit = context.units.length().symbol;
        let message = format!(
            "on its grid the surface of {} is off by up to {} {unit}, more than the layer of contact {} is thick ({} {unit}): edges are rounded by as \
             much; take a smaller spacing if they matter",
            quoted(&block.name),
            short(grid.error()),
            quoted(contact),
            short(layer.thickness)
        );
        warn(block, message, context);
    }
}

/// Once, however many blocks name the obstacle.
fn warn(block: &schema::Obstacle, message: String, context: &mut Context<'_>) {
    let is_known = |known: &str| known == message;
    if !context.found.warnings.iter().any(|(_, known)| is_known(&known.message)) {
        context.warn(&COARSE_GRID, &block.at.key("grid"), message);
    }
}

fn shown(grid: &DistanceGrid, unit: &str) -> String {
    let nodes = grid.nodes().into_iter().filter(|nodes| *nodes > 1).map(|nodes| nodes.to_string());
    format!(
        "on {} nodes, {} {unit} apart, and its surface off by up to {} {unit}",
        nodes.collect::<Vec<_>>().join(" x "),
        short(grid.spacing()),
        short(grid.error())
    )
}

fn coordinates(place: &[f64]) -> String {
    place.iter().map(|x| short(*x)).collect::<Vec<_>>().join(", ")
}
