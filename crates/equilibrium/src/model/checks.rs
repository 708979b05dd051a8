//! Whether a model is complete for what is asked of it.

use super::Model;
use crate::model::views::Checks;
use nastic_body::error::FemError;

impl Model {
    /// Checks that the problem is complete: every cell has a material, and every rigid motion is prevented, or contact may stop it.
    ///
    /// # Errors
    /// [`FemError::NoMaterial`], [`FemError::RigidMotion`], a contribution whose required supports are missing.
    pub fn check(&self) -> Result<(), FemError> {
        self.ranks().unless_parted(self.check_with(&self.may_resist()))
    }

    fn check_with(&self, springs: &[Vec<(u32, f64)>]) -> Result<(), FemError> {
        // A missing material is reported before missing supports.
        self.ranks().all_accept(self.check_laws())?;
        self.supports.check(self.discretization(), &springs.iter().collect::<Vec<_>>())?;
        self.ranks().all_accept(self.check_others())
    }

    fn check_laws(&self) -> Result<(), FemError> {
        self.body.check_complete()?;
        self.checks().check_shape()?;
        self.check_solver(None)
    }

    fn check_others(&self) -> Result<(), FemError> {
        self.others.iter().try_for_each(|contribution| contribution.check(&self.supports_of(contribution.as_ref())))
    }
}

impl Checks<'_> {
    /// The same for analyses that need a regular tangent: contacts resist only motions along their normals at rest.
    pub fn check_held(&self) -> Result<(), FemError> {
        let own = self.model.others.iter().flat_map(|contribution| contribution.resists().iter().cloned());
        self.model.ranks().unless_parted(self.model.check_with(&own.collect::<Vec<_>>()))
    }

    /// Whether supports and springs prevent all rigid motions of all parts; otherwise contact has to hold them.
    #[must_use]
    pub fn is_held_without_contact(&self) -> bool {
        let others = self.model.others.iter().filter(|contribution| contribution.touches().is_none());
        let springs = others.flat_map(|contribution| contribution.resists());
        self.model.supports.check(self.model.discretization(), &springs.collect::<Vec<_>>()).is_ok()
    }

    /// Checks that the problem is complete for motion and for modes, in which a body may be free.
    ///
    /// # Errors
    /// [`FemError::NoMaterial`], a contribution whose required supports are missing.
    pub fn check_in_motion(&self) -> Result<(), FemError> {
        self.model.check_laws()?;
        self.model.check_others()
    }
}
