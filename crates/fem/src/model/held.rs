//! Unknowns that contributions hold at values of their controls: surfaces that move.

use super::Model;
use crate::contributions::Contribution;
use crate::contributions::controls::Controls;
use crate::contributions::instant::Instant;
use crate::contributions::sensitivities::Sensitivities;
use crate::error::{FemError, InvertedAt};

impl Model {
    /// The displacement of all held unknowns under these controls and a multiple of the prescribed displacements; 0 elsewhere.
    pub(crate) fn prescribed(&self, controls: &Controls, load: f64) -> Vec<f64> {
        let mut u: Vec<f64> = self.supports.values().iter().map(|value| load * value).collect();
        self.each_held(&Instant::new(&[], controls, load), |contribution, at| contribution.prescribe(at, &mut u));
        u
    }

    /// The change of the [`prescribed`](Self::prescribed) displacement along a change of the controls; `None` where they prescribe none.
    pub(crate) fn prescribed_change(&self, controls: &Controls, v: &Controls) -> Option<Vec<f64>> {
        let mut du = vec![0.0; self.unknowns().len()];
        let mut any = false;
        self.each_held(&Instant::new(&[], controls, 1.0), |contribution, at| {
            any = true;
            contribution.add_prescribed_change(at, v, &mut du);
        });
        any.then_some(du)
    }

    /// What a functional with the partial derivative `by_u` and the adjoint lambda owes to the controls: `lambda . dr/dm`, and by those that
    /// move held unknowns D, `(by_u + K^T lambda)_D . du_D/dm`.
    ///
    /// # Errors
    /// [`InvertedAt`] where J <= 0.
    pub fn sensitivities(&self, at: &Instant, by_u: &[f64], lambda: &[f64]) -> Result<Sensitivities, InvertedAt> {
        let mut found = self.vjp(at, lambda)?;
        self.add_held_sensitivity(at, by_u, lambda, &mut found)?;
        Ok(found)
    }

    /// Refuses surfaces that controls move, whose accelerations steps in time do not know.
    pub(crate) fn refuse_motions(&self) -> Result<(), FemError> {
        let Some(moves) = self.others.iter().find(|contribution| !contribution.held().is_empty()) else {
            return Ok(());
        };
        let what = format!(
            "the motion \"{}\" is not there yet in steps in time; hold its surface by supports, or take springs to ground",
            moves.name()
        );
        Err(FemError::Meaningless { what })
    }

    fn add_held_sensitivity(
        &self,
        at: &Instant,
        by_u: &[f64],
        lambda: &[f64],
        into: &mut Sensitivities,
    ) -> Result<(), InvertedAt> {
        if self.others.iter().all(|contribution| contribution.held().is_empty()) {
            return Ok(());
        }
        let mut force = self.bordered_tangent(at)?.multiply_transposed(lambda, at.parallel);
        force.iter_mut().zip(by_u).for_each(|(f, j)| *f += j);
        self.each_held(at, |contribution, at| contribution.prescribed_vjp(at, &force, into));
        Ok(())
    }

    /// The name of a contribution whose held unknowns have a second derivative along a change of the controls.
    pub(crate) fn turning(&self, at: &Instant, v: &Controls) -> Option<String> {
        let mut found = None;
        self.each_held(at, |contribution, at| {
            if !contribution.prescribes_along_a_line(at, v) {
                found = Some(contribution.name().to_owned());
            }
        });
        found
    }

    fn each_held(&self, at: &Instant, mut call: impl FnMut(&dyn Contribution, &Instant)) {
        let mut block = self.body.actuations().len();
        for contribution in &self.others {
            if !contribution.held().is_empty() {
                call(contribution.as_ref(), &Instant { block, ..*at });
            }
            block += usize::from(!contribution.slots().is_empty());
        }
    }

    /// Asks every contribution whether its controls may be what they are.
    pub(crate) fn check_own_controls(&self, controls: &Controls) -> Result<(), FemError> {
        let own = self.others.iter().filter(|contribution| !contribution.slots().is_empty());
        own.zip(self.body.actuations().len()..)
            .try_for_each(|(contribution, block)| contribution.check_controls(controls.values(block)))
    }
}
