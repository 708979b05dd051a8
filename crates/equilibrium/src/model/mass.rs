//! The mass of a [`Model`].

use crate::model::views::Energies;
use nastic_body::error::FemError;
use nastic_body::state::State;
use nastic_linear::SparseMatrix;

impl Energies<'_> {
    /// The mass matrix of all contributions, supports not eliminated; zero of a body without inertia.
    ///
    /// # Errors
    /// [`FemError::NotCoupled`].
    pub fn mass(&self) -> Result<SparseMatrix, FemError> {
        let mut mass = SparseMatrix::zeros(self.model.structure().pattern().clone());
        for contribution in &self.model.others {
            let named = |lacking| FemError::NotCoupled { contribution: contribution.name().to_owned(), lacking };
            self.model.add_matrix(contribution.as_ref(), &mut mass, |own| contribution.add_mass(own)).map_err(named)?;
        }
        Ok(mass)
    }

    /// `v . M v / 2` of a state in motion; 0 without a velocity.
    ///
    /// # Errors
    /// [`FemError::NotCoupled`].
    pub fn kinetic_energy(&self, state: &State) -> Result<f64, FemError> {
        let Some(velocity) = &state.velocity else { return Ok(0.0) };
        let v = self.model.nodal(velocity);
        let mut image = vec![0.0; v.len()];
        self.mass()?.multiply(v, &mut image);
        Ok(0.5 * self.model.space.dot(v, &image))
    }
}
