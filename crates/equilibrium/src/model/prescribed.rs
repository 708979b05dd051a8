//! Unknowns that contributions hold at values of their controls: surfaces that move.

use super::Model;
use super::restricted::Selection;
use crate::model::views::PrescribedUnknowns;
use nastic_body::contribution::Contribution;
use nastic_body::contribution::prescribes::Prescribes;
use nastic_body::contribution::sensitivities::Sensitivities;
use nastic_body::controls::Controls;
use nastic_body::error::{FemError, Inadmissible};
use nastic_body::instant::Instant;
use nastic_body::state::State;
use nastic_linear::Space;

/// Largest distance of a held surface from its prescribed position when a motion is resumed, as a share of the size of the body: rounding.
const POSITION_TOLERANCE: f64 = 1e-10;

/// The unknowns that a contribution moves among those of a space.
pub(super) fn unknowns_among(space: &Space, by: &dyn Contribution, moved: &dyn Prescribes) -> Vec<u32> {
    match Selection::of(space, by.fields()) {
        None => moved.unknowns(),
        Some(selection) => selection.places(moved.unknowns()),
    }
}

/// What a contribution moves, where its own fields are some of those of a model.
struct Moved<'a> {
    by: &'a dyn Contribution,
    moved: &'a dyn Prescribes,
    selection: Option<Selection>,
}

impl Moved<'_> {
    /// Adds to a vector of the model what is put into one of its own fields, which is zero.
    fn add(&self, into: &mut [f64], put: impl FnOnce(&mut [f64])) {
        let Some(selection) = &self.selection else { return put(into) };
        let mut own = selection.zero(into);
        put(&mut own);
        selection.scatter(&own, into);
    }
}

impl Model {
    /// The values of all held unknowns under these controls and a multiple of the prescribed ones; 0 elsewhere.
    pub(crate) fn prescribed(&self, controls: &Controls, load: f64) -> Vec<f64> {
        let mut u: Vec<f64> = self.supports.values().iter().map(|value| load * value).collect();
        self.each_prescribing(&Instant::new(&[], controls, load), |own, at| {
            own.add(&mut u, |u| own.moved.prescribe(at, u));
        });
        u
    }

    /// The change of the [`prescribed`](Self::prescribed) displacement along a change of the controls; `None` where they prescribe none.
    pub(crate) fn prescribed_change(&self, controls: &Controls, v: &Controls) -> Option<Vec<f64>> {
        let mut du = vec![0.0; self.unknowns().len()];
        let mut any = false;
        self.each_prescribing(&Instant::new(&[], controls, 1.0), |own, at| {
            any = true;
            own.add(&mut du, |du| own.moved.add_change(at, v, du));
        });
        any.then_some(du)
    }

    /// The name of a contribution whose held unknowns have a second derivative along a change of the controls.
    pub(crate) fn turning(&self, at: &Instant, v: &Controls) -> Option<String> {
        let mut found = None;
        self.each_prescribing(at, |own, at| {
            if !own.moved.is_straight_along(at, v) {
                found = Some(own.by.name().to_owned());
            }
        });
        found
    }

    fn each_prescribing(&self, at: &Instant, mut call: impl FnMut(&Moved, &Instant)) {
        let mut block = self.body.actuations().len();
        for contribution in &self.others {
            if let Some(moved) = contribution.prescribes() {
                let (by, selection) = (contribution.as_ref(), self.selection(contribution.as_ref()));
                call(&Moved { by, moved, selection }, &Instant { block, ..*at });
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

    /// Unknowns with the held ones where these controls hold them.
    pub fn placed(&self, u: &[f64], controls: &Controls) -> Vec<f64> {
        let (held, values) = (self.model.supports.fixed(), self.model.prescribed(controls, 1.0));
        let mut placed = u.to_vec();
        let unknowns = placed.iter_mut().zip(held).zip(values).filter(|((_, held), _)| **held);
        unknowns.for_each(|((u, _), value)| *u = value);
        placed
    }

    /// Refuses a state whose surfaces are not where its controls hold them.
    pub fn check_prescribed(&self, state: &State) -> Result<(), FemError> {
        let size = self.model.discretization().mesh().diagonal();
        let mut found = Ok(());
        let mut prescribed = vec![0.0; self.model.unknowns().len()];
        self.model.each_prescribing(&Instant::new(&[], &state.controls, 1.0), |own, at| {
            own.add(&mut prescribed, |u| own.moved.prescribe(at, u));
            let gap = |dof: &u32| (prescribed[*dof as usize] - state.u[*dof as usize]).abs();
            let largest =
                unknowns_among(self.model.unknowns(), own.by, own.moved).iter().map(gap).fold(0.0, f64::max);
            if found.is_ok() && largest > POSITION_TOLERANCE * size {
                let what = format!(
                    "at t = {} a node of the motion \"{}\" is {largest:.3e} away from where its controls hold it: begin at the equilibrium \
                     under the first controls, or with controls that hold it where the body is",
                    state.time,
                    own.by.name()
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
        self.model.each_prescribing(at, |own, at| match &own.selection {
            None => own.moved.vjp(at, force, into),
            Some(selection) => own.moved.vjp(at, &selection.gather(force), into),
        });
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
