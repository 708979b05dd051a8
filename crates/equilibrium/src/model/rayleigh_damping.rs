//! The Rayleigh damping of a [`Model`].

use crate::model::Feature;
use crate::model::views::Energies;
use nastic_body::error::{FemError, Inadmissible};
use nastic_forces::rayleigh_damping::RayleighDamping;
use nastic_linear::StructureError;

impl Energies<'_> {
    /// The damping `(a0 M + a1 K(0)) v` of a model whose materials and masses are complete.
    ///
    /// # Errors
    /// A coefficient that is negative or not finite; no mass where a0 needs one; cells without material.
    pub fn rayleigh_damping(&self, a0: f64, a1: f64) -> Result<RayleighDamping, FemError> {
        if [a0, a1].iter().any(|a| !(a.is_finite() && *a >= 0.0)) {
            let what = format!("Rayleigh damping with a0 = {a0}, a1 = {a1}; both must be finite and at least zero");
            return Err(FemError::Meaningless { what });
        }
        self.model.properties().refuse_further_fields(Feature::RayleighDamping, RayleighDamping::NAME)?;
        self.model.body.check_complete()?;
        let mass = self.mass()?;
        if a0 > 0.0 && mass.values.iter().all(|&m| m == 0.0) {
            let what = "Rayleigh damping with a0 > 0 needs a mass: add the inertia before it".to_owned();
            return Err(FemError::Meaningless { what });
        }
        if a0 > 0.0 && self.follows_design() {
            let what = "Rayleigh damping with a0 > 0 beside a mass that follows a design: give a0 = 0".to_owned();
            return Err(FemError::Meaningless { what });
        }
        let rest = self.model.rest();
        let mut stiffness = self.model.tangent_structure().matrix();
        let inverted = |at: Inadmissible| FemError::Meaningless { what: format!("no stiffness at rest: {at}") };
        self.model
            .body
            .without(&self.model.rigid_cells())?
            .add_tangent(&rest.u, &rest.controls, &mut stiffness, true)
            .map_err(inverted)?;
        let mut matrix = self.model.tangent_structure().matrix();
        matrix.add_scaled(a0, &mass).map_err(StructureError::from)?;
        matrix.add_scaled(a1, &stiffness).map_err(StructureError::from)?;
        Ok(RayleighDamping::new(matrix))
    }
}
