//! Unknowns that contributions hold at values of their controls: surfaces that move.

use super::Model;
use crate::model::views::PrescribedUnknowns;
use nastic_body::contribution::prescribes::Prescribes;
use nastic_body::contribution::sensitivities::Sensitivities;
use nastic_body::controls::Controls;
use nastic_body::error::{FemError, Inadmissible};
use nastic_body::instant::Instant;
use nastic_body::state::State;

/// Largest distance of a held surface from its prescribed position when a motion is resumed, as a share of the size of the body: rounding.
const POSITION_TOLERANCE: f64 = 1e-10;

impl Model {
    /// The displacement of all held unknowns under these controls and a multiple of the prescribed displacements; 0 elsewhere.
    pub(crate) fn prescribed(&self, controls: &Controls, load: f64) -> Vec<f64> {
        let mut u: Vec<f64> = self.supports.values().iter().map(|value| load * value).collect();
        self.each_prescribing(&Instant::new(&[], controls, load), |_, moved, at| moved.prescribe(at, &mut u));
        u
    }

    /// The change of the [`prescribed`](Self::prescribed) displacement along a change of the controls; `None` where they prescribe none.
    pub(crate) fn prescribed_change(&self, controls: &Controls, v: &Controls) -> Option<Vec<f64>> {
        let mut du = vec![0.0; self.unknowns().len()];
        let mut any = false;
        self.each_prescribing(&Instant::new(&[], controls, 1.0), |_, moved, at| {
            any = true;
            moved.add_change(at, v, &mut du);
        });
        any.then_some(du)
    }

    /// The name of a contribution whose held unknowns have a second derivative along a change of the controls.
    pub(crate) fn turning(&self, at: &Instant, v: &Controls) -> Option<String> {
        let mut found = None;
        self.each_prescribing(at, |name, moved, at| {
            if !moved.is_straight_along(at, v) {
                found = Some(name.to_owned());
            }
        });
        found
    }

    fn each_prescribing(&self, at: &Instant, mut call: impl FnMut(&str, &dyn Prescribes, &Instant)) {
        let mut block = self.body.actuations().len();
        for contribution in &self.others {
            if let Some(moved) = contribution.prescribes() {
                call(contribution.name(), moved, &Instant { block, ..*at });
            }
            block += usize::from(!contribution.slots().is_empty());
        }
    }
}

impl PrescribedUnknowns<'_> {
    /// The derivative by the controls of a functional with the partial derivative `by_u` and the adjoint lambda: `lambda . dr/dm`, and by those that
    /// move held unknowns D, `(by_u + K^T lambda)_D . du_D/dm`.
    ///
    /// # Errors
    /// [`Inadmissible`] where u is.
    pub fn sensitivities(&self, at: &Instant, by_u: &[f64], lambda: &[f64]) -> Result<Sensitivities, Inadmissible> {
        let mut found = self.model.vjp(at, lambda)?;
        if let Some(force) = self.prescribed_force(at, by_u, lambda)? {
            self.add_prescribed_vjp(at, &force, &mut found);
        }
        Ok(found)
    }

    /// Refuses a state whose surfaces are not where its controls hold them.
    pub fn check_prescribed(&self, state: &State) -> Result<(), FemError> {
        let size = self.model.discretization().mesh().diagonal();
        let mut found = Ok(());
        let mut prescribed = vec![0.0; self.model.unknowns().len()];
        self.model.each_prescribing(&Instant::new(&[], &state.controls, 1.0), |name, moved, at| {
            moved.prescribe(at, &mut prescribed);
            let gap = |dof: &u32| (prescribed[*dof as usize] - state.u[*dof as usize]).abs();
            let largest = moved.unknowns().iter().map(gap).fold(0.0, f64::max);
            if found.is_ok() && largest > POSITION_TOLERANCE * size {
                let what = format!(
                    "at t = {} a node of the motion \"{name}\" is {largest:.3e} away from where its controls hold it: begin at the equilibrium \
                     under the first controls, or with controls that hold it where the body is",
                    state.time
                );
                found = Err(FemError::Meaningless { what });
            }
        });
        found
    }

    /// The derivative of a functional by the held unknowns D, whole over ranks, `(by_u + K^T lambda)_D` and zero elsewhere; `None` where controls hold none.
    ///
    /// # Errors
    /// [`Inadmissible`] where u is.
    pub fn prescribed_force(
        &self,
        at: &Instant,
        by_u: &[f64],
        lambda: &[f64],
    ) -> Result<Option<Vec<f64>>, Inadmissible> {
        if self.prescribed_by().is_none() {
            return Ok(None);
        }
        let mut force = self.model.tangents().bordered_tangent(at)?.multiply_transposed(lambda, at.parallel);
        // over ranks a tangent is a share, a partial derivative is whole
        self.model.unknowns().add_up(&mut force);
        force.iter_mut().zip(by_u).for_each(|(f, j)| *f += j);
        force.iter_mut().zip(self.model.supports.fixed()).filter(|(_, fixed)| !**fixed).for_each(|(f, _)| *f = 0.0);
        Ok(Some(force))
    }

    /// Adds their derivative by the controls of an instant, `force . du_D/dm`.
    pub fn add_prescribed_vjp(&self, at: &Instant, force: &[f64], into: &mut Sensitivities) {
        self.model.each_prescribing(at, |_, moved, at| moved.vjp(at, force, into));
    }

    /// The name of a contribution that holds unknowns at values of its controls, if there is one.
    pub fn prescribed_by(&self) -> Option<&str> {
        self.model
            .others
            .iter()
            .find(|contribution| contribution.prescribes().is_some())
            .map(|contribution| contribution.name())
    }

    /// Asks every contribution whether its controls may be what they are, as every solve does.
    ///
    /// # Errors
    /// [`FemError::Meaningless`]: a pose beyond the plane of a plane body, say.
    pub fn check_own_controls(&self, controls: &Controls) -> Result<(), FemError> {
        let own = self.model.others.iter().filter(|contribution| !contribution.slots().is_empty());
        own.zip(self.model.body.actuations().len()..)
            .try_for_each(|(contribution, block)| contribution.check_controls(controls.values(block)))
    }
}
