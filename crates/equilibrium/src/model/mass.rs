//! The mass of a [`Model`].

use crate::model::views::Energies;
use nastic_body::contribution::point::Need;
use nastic_body::contribution::sensitivities::Sensitivities;
use nastic_body::controls::Controls;
use nastic_body::error::{FemError, Inadmissible};
use nastic_body::instant::{Instant, TimeStep};
use nastic_body::state::State;
use nastic_linear::SparseMatrix;

impl Energies<'_> {
    /// The mass matrix of all contributions under controls at rest, supports not eliminated; zero of a body without inertia.
    ///
    /// # Errors
    /// [`FemError::NotCoupled`].
    pub fn mass(&self) -> Result<SparseMatrix, FemError> {
        self.mass_under(&self.model.controls())
    }

    /// The same under other controls, which a mass that follows a design depends on.
    ///
    /// # Errors
    /// [`FemError::NotCoupled`].
    pub fn mass_under(&self, controls: &Controls) -> Result<SparseMatrix, FemError> {
        let mut mass = SparseMatrix::zeros(self.model.structure().pattern().clone());
        let at = Instant::new(&[], controls, 1.0);
        for (contribution, at) in self.model.others.iter().zip(self.model.instants(&at)) {
            let named = |lacking| FemError::NotCoupled { contribution: contribution.name().to_owned(), lacking };
            self.model
                .add_matrix(contribution.as_ref(), &mut mass, |own| contribution.add_mass(&at, own))
                .map_err(named)?;
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
        self.mass_under(&state.controls)?.multiply(v, &mut image);
        Ok(0.5 * self.model.space.dot(v, &image))
    }

    /// Whether the mass follows a design.
    pub fn follows_design(&self) -> bool {
        self.model.others.iter().any(|contribution| contribution.mass_follows_controls())
    }

    /// `d/dm (v . M(m) v / 2)` of a state in motion at fixed v, of a mass that follows a design; `None` of others.
    ///
    /// # Errors
    /// [`Inadmissible`] where u is.
    pub fn kinetic_by_controls(&self, state: &State) -> Result<Option<Controls>, Inadmissible> {
        let Some(velocity) = state.velocity.as_ref().filter(|_| self.follows_design()) else { return Ok(None) };
        // the derivative of v . M a by m, with v in the place of a
        let step = TimeStep::between(state, &State { acceleration: Some(velocity.clone()), ..state.clone() });
        let at = Instant::of(state).in_step(&step);
        let half: Vec<f64> = velocity.iter().map(|v| 0.5 * v).collect();
        let mut found = Sensitivities::zero(self.model.controls(), &at);
        for (contribution, at) in self.model.others.iter().zip(self.model.instants(&at)) {
            if contribution.mass_follows_controls() {
                contribution.at(&at, Need::Residual)?.vjp(&at, &half, &mut found)?;
            }
        }
        Ok(Some(found.controls))
    }
}
