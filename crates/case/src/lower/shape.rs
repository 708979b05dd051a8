//! The shape of the body as unknown: where it starts, and loads that do not follow it.

use super::context::Context;
use super::variant::Variant;
use nastic_control::Reduced;
use nastic_energy::ShapeMode;
use nastic_fem::catalogue::FormValues;
use nastic_fem::{QuadraturePoints, Solid};
use nastic_language::number::short;
use nastic_language::schema::{Case, Load, Material};
use nastic_language::syntax::{At, quoted};
use nastic_mesh::GroupNames;

/// The change of shape that cells of a material have.
pub(super) fn of_material<'s>(solid: &'s Solid, material: &Material) -> Option<&'s str> {
    let (_, shape) = solid.body().shape()?;
    let cells = solid.mesh().cells_of(&material.region).ok()?;
    cells.iter().any(|cell| shape.cells.binary_search(cell).is_ok()).then_some(shape.name.as_str())
}

/// The surfaces of tractions among those that a free shape keeps: a dead force is that of the drawn area.
pub(super) fn keep_loaded(case: &Case, values: &mut FormValues) {
    let loaded = case.loads.iter().filter(|load| load.traction.is_some()).filter_map(|load| load.surface.as_ref());
    let names = loaded.flat_map(GroupNames::iter).map(str::to_owned);
    values.names.entry("keep").or_default().extend(names);
}

/// Refuses amplitudes to start from that turn cells over, of all members: `start_of` says with what a field of a member starts.
pub(super) fn check_starts<'s>(
    variants: &[Variant],
    bodies: &[Reduced],
    contexts: &mut [Context<'_>],
    start_of: impl Fn(&Variant, usize) -> Option<&'s Vec<f64>>,
) -> bool {
    let mut sound = true;
    for ((variant, body), context) in variants.iter().zip(bodies).zip(contexts) {
        let own = (0..body.layout().blocks().len()).filter_map(|k| start_of(variant, k));
        let start: Vec<f64> = own.flatten().copied().collect();
        sound &= check_start(&variant.case, body, &start, context).is_some();
    }
    sound
}

fn check_start(case: &Case, body: &Reduced, start: &[f64], context: &mut Context<'_>) -> Option<()> {
    let Some((_, shape)) = body.solid().body().shape() else { return Some(()) };
    let map = shape.law.strain_map()?;
    let controls = context.take(&At::root().key("controls"), body.layout().to_points(start))?;
    let worst = body.solid().body().shape_quality(&controls)?;
    if worst.least_volume > map.least_volume() {
        return Some(());
    }
    let [x, y, z] = body.solid().mesh().cell_centre(worst.cell as usize);
    let message = format!(
        "the shape to start from leaves {} of the volume of cell {} at ({}, {}, {}), where more than {} must be left: {}",
        short(worst.least_volume),
        worst.cell,
        short(x),
        short(y),
        short(z),
        short(map.least_volume()),
        map.limit()
    );
    let is_own = |of: &str| of == shape.name || of.starts_with(&format!("{}.", shape.name));
    let own = case.controls.iter().find(|control| is_own(&control.of));
    let at = own.map_or(At::root().key("controls"), |control| control.at.key("start"));
    context.complain(&at, message);
    None
}

/// Says of a load where the shape of the body changes that it stays that of the drawn body.
pub(super) fn note_of_load(load: &Load, sampling: &QuadraturePoints, solid: &Solid, context: &mut Context<'_>) {
    let Some((_, shape)) = solid.body().shape() else { return };
    let dim = solid.mesh().dim();
    let by_mode = |mode: &ShapeMode| sampling.interpolate(&mode.nodal, dim).iter().any(|phi| *phi != 0.0);
    let changes = match shape.shape_modes() {
        Some(modes) => modes.iter().any(by_mode),
        // what bears a traction stays
        None => load.surface.is_none() && sampling.cells().iter().any(|cell| shape.cells.binary_search(cell).is_ok()),
    };
    if changes {
        let per = if load.surface.is_some() { "area" } else { "volume" };
        let message = format!(
            "{}: the force is that per {per} of the drawn body, whatever {} makes of its shape; pressures and gravity follow it",
            load.at,
            quoted(&shape.name)
        );
        context.note(message);
    }
}
