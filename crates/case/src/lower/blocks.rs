//! Entries of the case that add a contribution each to the body.

use super::context::Context;
use super::named::attempt;
use nastic_fem::Solid;
use nastic_language::schema::Case;

pub(super) fn add(case: &Case, solid: &mut Solid, context: &mut Context<'_>) {
    for block in case.blocks() {
        attempt(solid, block.at(), context, |solid| block.attach(solid));
    }
}
