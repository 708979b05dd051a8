//! Coordinates of a place, some of which may be left out.

use super::context::Context;
use nastic_language::schema::Coordinates;

/// The position of one point; coordinates that are not given are `None`.
pub(super) fn given(block: &Coordinates, context: &mut Context<'_>) -> Option<[Option<f64>; 3]> {
    let mut out = [None; 3];
    for ((value, formula), axis) in out.iter_mut().zip(block.entries()).zip(["x", "y", "z"]) {
        if let Some(formula) = formula {
            *value = Some(context.take(&block.at.key(axis), formula.at([0.0; 3]))?);
        }
    }
    Some(out)
}
