//! Builder calls whose errors belong to a place of the case.

use super::context::Context;
use nastic_energy::{EnergyError, Entry};
use nastic_fem::{FemError, Solid};
use nastic_language::syntax::At;

/// One builder call on the body; if it fails the body stays as it was.
pub(super) fn attempt(
    solid: &mut Solid,
    at: &At,
    context: &mut Context<'_>,
    call: impl FnOnce(Solid) -> Result<Solid, FemError>,
) {
    match call(solid.clone()) {
        Ok(changed) => *solid = changed,
        Err(error) => context.complain(at, error),
    }
}

/// Complains that a law cannot be built. What was reported when the block was read is not said again: a parameter that is missing, as it is there and cannot be
/// read, and a constant direction that is no unit vector.
pub(super) fn complain_of_law(at: &At, error: &EnergyError, context: &mut Context<'_>) {
    if !matches!(error, EnergyError::Missing { .. } | EnergyError::Direction { entry: Entry::Uniform, .. }) {
        context.complain(&key_of(at, error), error);
    }
}

/// The key an error of a law speaks of.
fn key_of(at: &At, error: &EnergyError) -> At {
    match error {
        EnergyError::Parameter { name, .. }
        | EnergyError::Direction { name, .. }
        | EnergyError::Length { name, .. }
        | EnergyError::Missing { name, .. }
        | EnergyError::Kind { name, .. } => at.key(name),
        EnergyError::Formula(_) => at.key("energy"),
        EnergyError::Network(_) => at.key("network"),
        _ => at.clone(),
    }
}
