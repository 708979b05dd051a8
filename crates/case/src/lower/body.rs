//! One member of a problem before its costs: body, fixed values, control fields.

use super::context::Context;
use super::variant::Variant;
use super::{
    actuation, blocks, contact, control, gravity, inertia, load, material, optimizer, support, time, uncertain,
};
use nastic_control::Reduced;
use nastic_fem::{Discretization, FemError, Solid, Solver};
use nastic_language::schema::{Beginning, Case, LinearSolver, Time};
use nastic_language::syntax::At;
use std::sync::Arc;

/// Builds the body of a variant; `None` after a complaint.
pub(super) fn lower(variant: &Variant, disc: &Arc<Discretization>, context: &mut Context<'_>) -> Option<Reduced> {
    let case = &variant.case;
    let mut solid = Solid::on(disc.clone());
    material::add(case, &variant.uncertain, &mut solid, context);
    actuation::add(case, &mut solid, context);
    support::add(case, &mut solid, context);
    blocks::add(case, &mut solid, context);
    material::add_rigid(case, &mut solid, context);
    load::add(case, &mut solid, context);
    contact::add(case, &mut solid, context);
    inertia::add(case, &mut solid, context);
    solid = match case.linear_solver {
        None => solid,
        Some(LinearSolver::Direct) => solid.solver(Solver::DIRECT),
        Some(LinearSolver::Multigrid) => solid.solver(Solver::MULTIGRID),
    };
    if context.is_sound() {
        check_complete(case, &solid, context);
    }
    let reduced = Reduced::new(solid).metric(optimizer::metric(case)).may_float(context.free);
    let reduced = time::apply(case, variant.instants.as_deref(), reduced, context)?;
    let reduced = actuation::fix(case, reduced, context)?;
    let reduced = contact::fix(case, reduced, context)?;
    let reduced = load::fix(case, reduced, context)?;
    let reduced = gravity::fix(case, reduced, context)?;
    let reduced = control::add(case, reduced, context)?;
    let reduced = uncertain::add(&variant.uncertain, reduced, context)?;
    // members in one process, or on all ranks, have most of their vectors in common
    context.is_sound().then(|| reduced.share_equal_parts())
}

/// Every cell has a material, no rigid motion is left free unless the body begins to move from rest or nothing is solved.
fn check_complete(case: &Case, solid: &Solid, context: &mut Context<'_>) {
    let moves = |time: &Time| time.built_scheme().is_ok_and(|scheme| !scheme.is_quasi_static());
    let from_rest = case.time.as_ref().is_some_and(|time| time.start == Beginning::Rest && moves(time));
    if let Err(error) = solid.model().checks().check_shape() {
        let modes = case.actuation.iter().find(|own| own.modes().is_some()).map(|own| own.at.key("modes"));
        context.complain(&modes.unwrap_or(At::root().key("actuation")), error);
        return;
    }
    if let Err(error) = solid.check() {
        if (from_rest || context.free) && matches!(error, FemError::RigidMotion { .. }) {
            return;
        }
        let block = match &error {
            FemError::RigidMotion { .. } => "supports",
            FemError::NoMaterial { .. } => "materials",
            FemError::Unsupported { .. } if case.linear_solver.is_some() => "linear_solver",
            _ => "mesh",
        };
        let message = match (&error, &case.time) {
            (FemError::RigidMotion { .. }, Some(_)) => {
                format!("{error}; or let it move from rest: \"start\": \"rest\" in \"time\", by a scheme with inertia")
            }
            (FemError::RigidMotion { .. }, None) => {
                format!("{error}; vibrations of a free body: nastic modes CASE --undeformed")
            }
            (FemError::Unsupported { what, with, .. }, _) if case.linear_solver.is_some() => {
                format!(
                    "{what} does not go with {with}; leave \"linear_solver\" out, and the solver that does is taken"
                )
            }
            _ => error.to_string(),
        };
        context.complain(&At::root().key(block), message);
    }
}
