//! Which moves every contribution bears.

use crate::model::views::Moves;
use nastic_body::contribution::point::Need;
use nastic_body::error::{Inadmissible, StateError};
use nastic_body::instant::Instant;
use nastic_body::state::State;

impl Moves<'_> {
    /// The longest share of the straight move from a displacement, that of `from`, to another one which every contribution bears: of
    /// the body no point loses more than nine tenths of its volume.
    ///
    /// Every displacement that a solver accepts was reached by such moves. Where it is no straight step (a curved one, a guess, a
    /// prediction, an extrapolation) the body may turn by any angle, and is asked at the end alone, the other contributions all the way.
    ///
    /// # Errors
    /// [`Inadmissible`] where the move begins outside of the admissible set.
    pub fn admissible_move(&self, from: &Instant, to: &[f64]) -> Result<f64, Inadmissible> {
        self.model.at(from, Need::Residual)?.admissible_move(from, to)
    }

    /// The same of the contributions beside the body.
    pub fn admissible_move_of_others(&self, from: &Instant, to: &[f64]) -> Result<f64, Inadmissible> {
        self.model.at(from, Need::Residual)?.admissible_move_of_others(from, to)
    }

    /// The longest share of a straight change of controls and displacement, to those of another instant, that every contribution bears at once.
    pub fn admissible_change(&self, at: &Instant, to: &Instant) -> Result<f64, Inadmissible> {
        let mut share = Ok(1.0_f64);
        for ((contribution, at), to) in
            self.model.others.iter().zip(self.model.instants(at)).zip(self.model.instants(to))
        {
            let contribution = contribution.as_ref();
            let own = self.model.among_fields(contribution, &at, |at| {
                self.model.among_fields(contribution, &to, |to| contribution.max_change(at, to))
            });
            share = share.and_then(|least| own.map(|own| least.min(own)));
        }
        Ok(self.model.unknowns().least(self.model.agreed(share)?))
    }

    /// Refuses to begin at a state outside of the admissible set.
    pub fn check_start(&self, state: &State, parallel: bool) -> Result<(), StateError> {
        let at = self.model.instant(state, None, parallel);
        let rests = !self.model.unknowns().any(state.u.iter().any(|u| *u != 0.0));
        let found =
            if rests { self.admissible_move_of_others(&at, &state.u) } else { self.admissible_move(&at, &state.u) };
        let begins = || self.model.each_other(&at, |contribution, at| contribution.check_start(at));
        self.model.agreed(found.and_then(|_| begins())).map_err(|at| StateError::Start { at })
    }
}
