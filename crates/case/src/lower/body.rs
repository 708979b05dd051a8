//! One member of a problem before its costs: body, fixed values, control fields.

use super::context::Context;
use super::variant::Variant;
use super::{actuation, control, load, material, optimizer, spring, support};
use crate::syntax::At;
use nastic_control::Reduced;
use nastic_fem::{Discretization, FemError, Solid};
use std::sync::Arc;

/// Builds the body of a variant; `None` after a complaint.
pub(super) fn lower(variant: &Variant, disc: &Arc<Discretization>, context: &mut Context<'_>) -> Option<Reduced> {
    let case = &variant.case;
    let mut solid = Solid::on(disc.clone());
    material::add(case, &mut solid, context);
    actuation::add(case, &mut solid, context);
    support::add(case, &mut solid, context);
    spring::add(case, &mut solid, context);
    load::add(case, &mut solid, context);
    if context.is_sound() {
        check_complete(&solid, context);
    }
    let reduced = Reduced::new(solid).metric(optimizer::metric(case));
    let reduced = actuation::fix(case, reduced, context)?;
    let reduced = control::add(case, reduced, context)?;
    context.is_sound().then_some(reduced)
}

/// Every cell has a material, no rigid motion is left free.
fn check_complete(solid: &Solid, context: &mut Context<'_>) {
    if let Err(error) = solid.check() {
        let block = match &error {
            FemError::RigidMotion { .. } => "supports",
            FemError::NoMaterial { .. } => "materials",
            _ => "mesh",
        };
        context.complain(&At::root().key(block), error);
    }
}
