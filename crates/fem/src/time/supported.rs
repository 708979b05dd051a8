//! Which motions a model goes with.

use super::scheme::Scheme;
use crate::error::FemError;
use crate::model::Model;
use crate::model::features::refuse;

/// A mode that no step resolves, `h w`, which a scheme has to damp beside constraints.
const UNRESOLVED: f64 = 1e6;
const DAMPED: f64 = 1.0 - 1e-3;

impl Model {
    /// Whether the model goes with steps of a scheme: asked once, before anything is computed.
    ///
    /// # Errors
    /// [`FemError::Unsupported`]: what, with which contribution or law it does not go, and what does instead.
    pub fn supports_motion(&self, scheme: &Scheme) -> Result<(), FemError> {
        self.refuse_ranks(scheme.name())?;
        self.refuse_further_fields(scheme.name())?;
        if scheme.exact_modes() > 0 {
            self.refuse_rigid_bodies(
                scheme.name(),
                "it is a rigid body, and the scheme takes modes: take backward_euler",
            )?;
            let instead = "it takes modes of a symmetric stiffness: take tr_bdf2";
            if self.has_history() {
                return refuse(
                    scheme.name(),
                    "viscous laws",
                    "it takes the modes of elastic bodies, with Rayleigh damping or none: take tr_bdf2",
                );
            }
            if let Some(moves) = self.prescribed_by() {
                return refuse(scheme.name(), moves, "which moves a surface: take tr_bdf2");
            }
            if let Some(other) = self.others.iter().find(|c| !c.has_potential() || c.path_dependence().is_some()) {
                return refuse(scheme.name(), other.name(), instead);
            }
        }
        self.supports_contact_in(scheme)?;
        let constraint = self.others.iter().find(|c| c.constrains().is_some());
        let Some(constraint) = constraint else { return Ok(()) };
        let why = if scheme.extrapolates() {
            "the end of its steps is extrapolated, where no constraint would hold: take bdf2 or tr_bdf2"
        } else if scheme.is_linearised() {
            "its steps are linear, and no constraint would hold at their end: take bdf2 or backward_euler"
        } else if !scheme.is_quasi_static() && scheme.amplification(UNRESOLVED, 0.0)?.modulus > DAMPED {
            "it damps nothing, and the multiplier of a constraint would oscillate and grow: take bdf2 or tr_bdf2"
        } else {
            return Ok(());
        };
        refuse(scheme.name(), constraint.name(), why)
    }

    /// Layers of contacts are thin: an end that no solve has seen may be deep in one, and throws the body off with a multiple of its energy.
    fn supports_contact_in(&self, scheme: &Scheme) -> Result<(), FemError> {
        let contact =
            |rubs: bool| self.others.iter().find(|c| c.touches().is_some() && (!rubs || c.path_dependence().is_some()));
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

    /// The same of the derivative of a functional of a motion.
    ///
    /// # Errors
    /// As [`supports_motion`](Self::supports_motion); of a scheme without adjoint.
    pub fn supports_motion_adjoint(&self, scheme: &Scheme) -> Result<(), FemError> {
        self.supports_motion(scheme)?;
        if !scheme.has_adjoint() {
            return refuse("the adjoint", scheme.name(), "it would take the derivatives of its modes: take tr_bdf2");
        }
        if scheme.is_linearised() && self.has_history() {
            let why = "it takes second derivatives of stresses, which these do not give: take backward_euler";
            return refuse("the adjoint of linearly_implicit_euler", "viscous laws", why);
        }
        Ok(())
    }
}
