//! [`Feature`]: what commands ask a model for, and what it cannot give.

use super::Model;
use crate::contributions::Instant;
use crate::error::FemError;
use crate::time::scheme::Scheme;
use nastic_linear::Symmetry;

/// What a command is about to do with a model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Feature<'a> {
    /// One equilibrium: [`Model::solve`].
    Equilibrium,
    /// Eigenvalues and modes of the tangent, and of small vibrations: [`Model::modes`], [`Model::vibration_modes`].
    Modes,
    /// Equilibria between two sets of controls: [`Model::ramp`].
    Ramp,
    /// A path through limit points: [`Model::path`].
    Path,
    /// Further equilibria: [`Model::equilibria`].
    Deflation,
    /// Contacts without a layer: [`Model::exact_contact`].
    ExactContact,
    /// From a saddle to a minimum of the potential: [`Model::descend`].
    Descent,
    /// Steps in time: [`Model::advance`].
    Motion(&'a Scheme),
    /// The derivative of a functional of a motion: [`Model::reverse_sweep`].
    MotionAdjoint(&'a Scheme),
}

/// A mode that no step resolves, `h w`, which a scheme has to damp beside constraints.
const UNRESOLVED: f64 = 1e6;
const DAMPED: f64 = 1.0 - 1e-3;

impl Model {
    /// Whether the model goes with that: asked once by every command, before it computes anything.
    ///
    /// # Errors
    /// [`FemError::Unsupported`]: what, with which contribution or law it does not go, and what does instead.
    pub fn supports(&self, feature: Feature) -> Result<(), FemError> {
        let what = match feature {
            Feature::Equilibrium => "a static equilibrium",
            Feature::Ramp => "a ramp with its critical points",
            Feature::Path => "a path",
            Feature::Modes => "modes",
            Feature::Deflation => "other equilibria by deflation",
            Feature::Descent => "a descent from a saddle",
            Feature::ExactContact => "exact contact",
            Feature::Motion(scheme) | Feature::MotionAdjoint(scheme) => scheme.name(),
        };
        if feature != Feature::Equilibrium {
            self.refuse_ranks(what)?;
            self.refuse_further_fields(what)?;
        }
        if !matches!(feature, Feature::Motion(_) | Feature::MotionAdjoint(_))
            && let Some((other, why)) = self.others.iter().find_map(|c| Some((c, c.path_dependence()?)))
        {
            return refuse(what, other.name(), why);
        }
        if matches!(feature, Feature::Modes | Feature::Deflation | Feature::Descent) {
            self.refuse_rigid_bodies(
                what,
                "it is a rigid body, for which they are not built: take a stiff law in its place",
            )?;
        }
        match feature {
            Feature::Equilibrium | Feature::Ramp | Feature::Path => Ok(()),
            Feature::Modes => self.refuse_unsymmetric(
                "modes",
                "the number of Newton iterations and ramps still tell where states change",
            ),
            Feature::Deflation => self.refuse_unsymmetric(
                "other equilibria by deflation",
                "which starts along modes: try other starts by near",
            ),
            Feature::ExactContact => self.supports_exact_contact(),
            Feature::Descent => match self.others.iter().find(|c| !c.has_potential()) {
                None => Ok(()),
                Some(other) => refuse("a descent from a saddle", other.name(), "it has no potential to descend in"),
            },
            Feature::Motion(scheme) => self.supports_motion(scheme),
            Feature::MotionAdjoint(scheme) => self.supports_motion_adjoint(scheme),
        }
    }

    fn refuse_rigid_bodies(&self, what: &str, why: &str) -> Result<(), FemError> {
        match self.others.iter().find(|c| c.tied().is_some()) {
            None => Ok(()),
            Some(rigid) => refuse(what, rigid.name(), why),
        }
    }

    fn refuse_unsymmetric(&self, what: &'static str, why: &'static str) -> Result<(), FemError> {
        match self.others.iter().find(|c| c.symmetry() != Symmetry::Symmetric) {
            None => Ok(()),
            Some(other) => refuse(what, other.name(), why),
        }
    }

    fn supports_exact_contact(&self) -> Result<(), FemError> {
        let (rest, controls) = (vec![0.0; self.unknowns().len()], self.controls());
        let (mut found, mut without) = (false, None);
        self.each_touching(&Instant::new(&rest, &controls, 0.0), |name, touches, at| {
            found = true;
            if touches.exact(at).is_none() {
                without = without.take().or(Some(name.to_owned()));
            }
        });
        match without {
            Some(name) => refuse("exact contact", &name, "it is for obstacles with the cubic law, without friction"),
            None if !found => refuse("exact contact", "this body", "nothing touches it: give it a contact"),
            None => Ok(()),
        }
    }

    fn supports_motion(&self, scheme: &Scheme) -> Result<(), FemError> {
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

    fn supports_motion_adjoint(&self, scheme: &Scheme) -> Result<(), FemError> {
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

fn refuse(what: &str, with: &str, why: &str) -> Result<(), FemError> {
    Err(FemError::Unsupported { what: what.to_owned(), with: with.to_owned(), why: why.to_owned() })
}
