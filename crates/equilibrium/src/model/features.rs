//! [`Feature`]: what commands ask a model for, and what it cannot give.

use super::Model;
use crate::model::views::Properties;
use nastic_body::error::FemError;
use nastic_body::instant::Instant;
use nastic_linear::Symmetry;

/// What a command is about to do with a model.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Feature {
    /// One equilibrium: [`Model::solve`].
    Equilibrium,
    /// Eigenvalues and modes of the tangent: [`Stability::modes`](crate::model::views::Stability::modes); of small vibrations too.
    Modes,
    /// Equilibria between two sets of controls: [`Stability::ramp`](crate::model::views::Stability::ramp).
    Ramp,
    /// A path through limit points: [`Stability::path`](crate::model::views::Stability::path).
    Path,
    /// Further equilibria: [`Stability::equilibria`](crate::model::views::Stability::equilibria).
    Deflation,
    /// Contacts without a layer: [`Stability::exact_contact`](crate::model::views::Stability::exact_contact).
    ExactContact,
    /// From a saddle to a minimum of the potential: [`Stability::descend`](crate::model::views::Stability::descend).
    Descent,
    /// Steps in time, modes of vibration and their adjoint.
    Motion,
    /// [`Energies::rayleigh_damping`](crate::model::views::Energies::rayleigh_damping).
    RayleighDamping,
}

/// Why something does not go with nodal fields beside the displacement; `None` where it does. Optimal control of equilibria needs their adjoint alone.
fn beside_fields(feature: Feature) -> Option<&'static str> {
    match feature {
        Feature::Equilibrium | Feature::Ramp | Feature::Path => None,
        Feature::Modes | Feature::Deflation | Feature::Descent => {
            Some("modes are those of the displacement alone: ramps and paths count where equilibria change")
        }
        Feature::ExactContact => Some("its steps are those of the displacement alone: take a contact with a layer"),
        Feature::Motion => Some("it is solved for in statics alone, by solve, adjoint, ramp and path"),
        Feature::RayleighDamping => Some("the damping is one of displacements alone"),
    }
}

impl Model {
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
}

/// That a model does not go with what it is asked for.
///
/// # Errors
/// [`FemError::Unsupported`], always.
pub fn refuse(what: &str, with: &str, why: &str) -> Result<(), FemError> {
    Err(FemError::Unsupported { what: what.to_owned(), with: with.to_owned(), why: why.to_owned() })
}

impl Properties<'_> {
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
            Feature::Motion => "a motion",
            Feature::RayleighDamping => "Rayleigh damping",
        };
        if feature != Feature::Equilibrium {
            self.model.ranks().refuse_ranks(what)?;
            self.refuse_further_fields(feature, what)?;
        }
        let in_time = matches!(feature, Feature::Motion | Feature::RayleighDamping);
        if let Some((other, why)) = self.model.others.iter().find_map(|c| Some((c, c.path_dependence()?)))
            && !in_time
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
            Feature::Equilibrium | Feature::Ramp | Feature::Path | Feature::Motion | Feature::RayleighDamping => Ok(()),
            Feature::Modes => self.model.refuse_unsymmetric(
                "modes",
                "the number of Newton iterations and ramps still tell where states change",
            ),
            Feature::Deflation => self.model.refuse_unsymmetric(
                "other equilibria by deflation",
                "which starts along modes: try other starts by near",
            ),
            Feature::ExactContact => self.model.supports_exact_contact(),
            Feature::Descent => match self.model.others.iter().find(|c| !c.has_potential()) {
                None => Ok(()),
                Some(other) => refuse("a descent from a saddle", other.name(), "it has no potential to descend in"),
            },
        }
    }

    /// Refuses what does not go with fields beside the displacement; `what` it is called.
    ///
    /// # Errors
    /// [`FemError::Unsupported`]: what, with which contribution and field, and why.
    pub fn refuse_further_fields(&self, feature: Feature, what: &str) -> Result<(), FemError> {
        match self.model.further().zip(beside_fields(feature)) {
            None => Ok(()),
            Some(((field, owner), why)) => refuse(what, owner, &format!("beside its field \"{field}\": {why}")),
        }
    }

    /// Refuses what is not built for rigid bodies, with what to take instead.
    ///
    /// # Errors
    /// [`FemError::Unsupported`] of a model that has one.
    pub fn refuse_rigid_bodies(&self, what: &str, why: &str) -> Result<(), FemError> {
        match self.model.others.iter().find(|c| c.tied().is_some()) {
            None => Ok(()),
            Some(rigid) => refuse(what, rigid.name(), why),
        }
    }
}
