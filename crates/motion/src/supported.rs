//! Which motions a model goes with.

use crate::scheme::Scheme;
use nastic_body::error::FemError;
use nastic_equilibrium::model::features::refuse;
use nastic_equilibrium::model::{Feature, Model};

/// `h w` of a mode that no step resolves.
const UNRESOLVED_FREQUENCY: f64 = 1e6;
/// Largest amplification of such a mode, which a scheme has to damp beside constraints.
const MAX_AMPLIFICATION: f64 = 1.0 - 1e-3;

/// [`TimeStepping::supports_motion`](crate::TimeStepping::supports_motion).
pub(crate) fn supports_motion(model: &Model, scheme: &Scheme) -> Result<(), FemError> {
    model.ranks().refuse_ranks(scheme.name())?;
    model.properties().refuse_further_fields(Feature::Motion, scheme.name())?;
    if scheme.exact_modes() > 0 {
        model.properties().refuse_rigid_bodies(
            scheme.name(),
            "it is a rigid body, and the scheme takes modes: take backward_euler",
        )?;
        let instead = "it takes modes of a symmetric stiffness: take tr_bdf2";
        if model.memory().has_history() {
            return refuse(
                scheme.name(),
                "viscous laws",
                "it takes the modes of elastic bodies, with Rayleigh damping or none: take tr_bdf2",
            );
        }
        if let Some(moves) = model.prescribed_unknowns().prescribed_by() {
            return refuse(scheme.name(), moves, "which moves a surface: take tr_bdf2");
        }
        if let Some(other) = model.others.iter().find(|c| !c.has_potential() || c.path_dependence().is_some()) {
            return refuse(scheme.name(), other.name(), instead);
        }
    }
    supports_contact_in(model, scheme)?;
    let constraint = model.others.iter().find(|c| c.constrains().is_some());
    let Some(constraint) = constraint else { return Ok(()) };
    let why = if scheme.extrapolates() {
        "the end of its steps is extrapolated, where no constraint would hold: take bdf2 or tr_bdf2"
    } else if scheme.is_linearised() {
        "its steps are linear, and no constraint would hold at their end: take bdf2 or backward_euler"
    } else if !scheme.is_quasi_static() && scheme.amplification(UNRESOLVED_FREQUENCY, 0.0)?.modulus > MAX_AMPLIFICATION
    {
        "it damps nothing, and the multiplier of a constraint would oscillate and grow: take bdf2 or tr_bdf2"
    } else {
        return Ok(());
    };
    refuse(scheme.name(), constraint.name(), why)
}

/// Layers of contacts are thin: an end that no solve has seen may be deep in one, and throws the body off with a multiple of its energy.
fn supports_contact_in(model: &Model, scheme: &Scheme) -> Result<(), FemError> {
    let contact =
        |rubs: bool| model.others.iter().find(|c| c.touches().is_some() && (!rubs || c.path_dependence().is_some()));
    if let (true, Some(contact)) = (scheme.extrapolates(), contact(false)) {
        let why = "the end of its steps is extrapolated into the layer of the contact, which creates energy: take backward_euler or bdf2";
        return refuse(scheme.name(), contact.name(), why);
    }
    if let (true, Some(contact)) = (scheme.is_linearised(), contact(true)) {
        let why = "its steps are linear, and friction that begins to slide is not: take backward_euler";
        return refuse(scheme.name(), contact.name(), why);
    }
    Ok(())
}

/// [`TimeStepping::supports_motion_adjoint`](crate::TimeStepping::supports_motion_adjoint).
pub(crate) fn supports_motion_adjoint(model: &Model, scheme: &Scheme) -> Result<(), FemError> {
    supports_motion(model, scheme)?;
    if !scheme.has_adjoint() {
        return refuse("the adjoint", scheme.name(), "it would take the derivatives of its modes: take tr_bdf2");
    }
    if scheme.is_linearised() && model.memory().has_history() {
        let why = "it takes second derivatives of stresses, which these do not give: take backward_euler";
        return refuse("the adjoint of linearly_implicit_euler", "viscous laws", why);
    }
    Ok(())
}
