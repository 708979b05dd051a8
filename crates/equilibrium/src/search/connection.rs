//! [`Connection`]: whether two equilibria lie on one branch.

use crate::linear_systems::workspace::Workspace;
use crate::model::Model;
use crate::model::views::Stability;
use crate::search::ahead::Ahead;
use crate::search::gradient_fit::GradientFit;
use crate::search::options::SolveOptions;
use nastic_body::error::StateError;
use nastic_body::kernels::displaced::Displaced;
use nastic_body::state::{SolveReport, State};
use nastic_numeric::vector::{axpy, sub};
use serde::{Deserialize, Serialize};
use std::cell::OnceCell;
use std::sync::Arc;

/// Whether the branch of equilibria through one state, followed along the straight way to the controls of another, leads
/// to that other one.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum Connection {
    /// It does, without a limit point.
    Connected,
    /// It turns back at a limit point, at this share of the way: the body has snapped.
    LimitPoint(f64),
    /// It leads to another equilibrium, whose displacement differs by this share of the change.
    Elsewhere(f64),
    /// It could be followed to this share of the way only.
    Unknown(f64),
}

/// Displacements whose difference is below this share of the change between the two states are the same.
const SAME_STATE_TOLERANCE: f64 = 0.01;
/// Largest change of the displacement, relative to it, that is never a jump.
const MAX_CHANGE_WITHOUT_JUMP: f64 = 0.01;
/// Newton iterations from which a solve with positive definite tangents may have left its branch.
const MIN_ITERATIONS_OF_JUMP: usize = 5;
/// The first part of the way that is solved separately.
const FIRST_PART: f64 = 0.25;
/// Parts that may be refused before the path is followed.
const MAX_REFUSED_PARTS: usize = 2;
/// Where between the two displacements the tangent is evaluated.
const TANGENT_SHARES: [f64; 3] = [0.25, 0.5, 0.75];

impl Model {
    /// Whether the tangent was, or is between the two states, not positive definite.
    fn may_have_jumped(
        &self,
        from: &State,
        to: &State,
        how: &SolveOptions,
        workspace: &mut Workspace,
        fit: &OnceCell<Option<GradientFit>>,
    ) -> Result<bool, StateError> {
        let report = &to.report;
        if report.shifted > 0 || report.restarts > 0 {
            return Ok(true);
        }
        if report.newton < MIN_ITERATIONS_OF_JUMP {
            return Ok(false);
        }
        // what turns with the body is the displacement
        let turns = self.unknowns().has_one_nodal_field();
        let fit = fit.get_or_init(|| turns.then(|| GradientFit::new(self, how.parallel)).flatten());
        for share in TANGENT_SHARES {
            let between = self.between(from, to, share, fit.as_ref(), how.parallel);
            let at = self.instant(from, None, how.parallel);
            if !self.moves().admissible_move_of_others(&at, &between.u).is_ok_and(|share| share >= 1.0) {
                return Ok(true);
            }
            match self.negative_pivots_with(&between, how, workspace) {
                Ok(0) => {}
                Err(error) if error.is_final() => return Err(error),
                // Negative, singular, or inverted cells.
                Ok(_) | Err(_) => return Ok(true),
            }
        }
        Ok(false)
    }

    /// Whether solves at parts of the way, each of which can be trusted, lead from the one state to the other.
    fn is_reached_in_parts(
        &self,
        from: &State,
        to: &State,
        how: &SolveOptions,
        workspace: &mut Workspace,
        fit: &OnceCell<Option<GradientFit>>,
    ) -> Result<bool, StateError> {
        // Solves of parts are of the whole load.
        if from.load != 1.0 || to.load != 1.0 {
            return Ok(false);
        }
        let (mut here, mut share, mut part, mut refused) = (from.clone(), 0.0, FIRST_PART, 0);
        while refused <= MAX_REFUSED_PARTS {
            let next = f64::min(share + part, 1.0);
            let controls = from.controls.blend(&to.controls, next);
            match self.solve_with(&controls, &SolveOptions { near: Some(&here), guess: None, ..how.clone() }, workspace)
            {
                Ok(there) if !self.may_have_jumped(&here, &there, how, workspace, fit)? => {
                    (here, share, part) = (there, next, 2.0 * part);
                }
                Err(error) if error.is_final() => return Err(error),
                Ok(_) | Err(_) => (part, refused) = (0.5 * (next - share), refused + 1),
            }
            if share == 1.0 {
                return Ok(self.apart(&here, to) <= SAME_STATE_TOLERANCE * self.apart(to, from));
            }
        }
        Ok(false)
    }

    /// How far the displacements of two states are apart.
    fn apart(&self, a: &State, b: &State) -> f64 {
        self.unknowns().norm(&sub(&self.displacement(&a.u), &self.displacement(&b.u)))
    }

    /// A state on the way between two, which is no equilibrium: every part of the body turns and stretches evenly, since a
    /// straight line compresses whatever turns.
    fn between(&self, from: &State, to: &State, share: f64, fit: Option<&GradientFit>, parallel: bool) -> State {
        let (mut u, du) = (from.u.to_vec(), sub(&to.u, &from.u));
        axpy(share, &du, &mut u);
        if let Some(fit) = fit {
            let bent =
                fit.correction_between(self, Displaced::by(self.nodal(&from.u)), self.nodal(&du), share, parallel);
            u.iter_mut().zip(&bent).for_each(|(u, bent)| *u += bent);
        }
        let controls = Arc::new(from.controls.blend(&to.controls, share));
        State { u: Arc::new(u), controls, load: (1.0 - share) * from.load + share * to.load, ..to.clone() }
    }
}

impl Stability<'_> {
    /// Whether the solve that led from one equilibrium to another stayed on its branch. Newton's method may leave a branch
    /// without any failure: the cost then has a jump between the two states, and the derivative at one says nothing of the
    /// other.
    ///
    /// Between two stable states of different branches lies a region where the tangent stiffness is indefinite. So a solve is trusted,
    /// and the answer is [`Connected`](Connection::Connected), unless its [report](State::report) reports a shifted tangent or
    /// a restart, or it took five Newton iterations or more and the tangent has negative pivots at one of three states between the
    /// two. One that is not trusted is made again in parts of the way: where all of them are trusted and lead to the same state,
    /// the two are connected. Otherwise the [`path`](Self::path) from one to the other is followed by arc length.
    ///
    /// # Errors
    /// As [`path`](Self::path); a cancelled solve, a lack of memory.
    pub fn connection(&self, from: &State, to: &State, how: &SolveOptions) -> Result<Connection, StateError> {
        self.model.checks().check_state(from)?;
        self.model.checks().check_state(to)?;
        let change = self.model.apart(to, from);
        let (mut workspace, fit) = (Workspace::default(), OnceCell::new());
        if change <= MAX_CHANGE_WITHOUT_JUMP * self.model.unknowns().norm(&self.model.displacement(&to.u))
            || !self.model.may_have_jumped(from, to, how, &mut workspace, &fit)?
            || self.model.is_reached_in_parts(from, to, how, &mut workspace, &fit)?
        {
            return Ok(Connection::Connected);
        }
        let target = (&*to.controls, to.load);
        let ahead =
            self.model.moves().ahead(from, target, how, &mut Workspace::default(), &mut SolveReport::default())?;
        Ok(match ahead {
            Ahead::LimitPoint(limit) => Connection::LimitPoint(limit.share),
            Ahead::Clear(state) => {
                let unknowns = self.model.unknowns();
                let apart = match unknowns.has_one_nodal_field() {
                    true => unknowns.norm(&sub(&state.u, &to.u)),
                    false => self.model.apart(&state, to),
                } / change;
                if apart <= SAME_STATE_TOLERANCE { Connection::Connected } else { Connection::Elsewhere(apart) }
            }
            Ahead::Unknown(share) => Connection::Unknown(share),
        })
    }
}
