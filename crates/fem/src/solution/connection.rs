//! [`Connection`]: whether two equilibria lie on one branch.

use crate::error::StateError;
use crate::model::Model;
use crate::solution::options::SolveOptions;
use crate::solution::path::{EventKind, PathEnd, PathOptions};
use crate::solution::state::State;
use crate::solution::workspace::Workspace;
use nastic_numeric::vector::{axpy, norm, sub};
use std::sync::Arc;

/// Whether the branch of equilibria through one state, followed along the straight way to the controls of another, comes
/// to that other one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Connection {
    /// It does, without a limit point.
    Connected,
    /// It turns back at a limit point, at this share of the way: the body has snapped.
    LimitPoint(f64),
    /// It comes to another equilibrium, whose displacement differs by this share of the change.
    Elsewhere(f64),
    /// It could be followed to this share of the way only.
    Unknown(f64),
}

/// Displacements that differ by less, relative to the change between the two states, are one.
const SAME: f64 = 0.01;
/// So small a change of the displacement, relative to it, is no jump.
const SMALL: f64 = 0.01;
/// A solve of fewer Newton iterations, all with a positive definite tangent, has not left its branch.
const FEW: usize = 5;
/// Where on the straight line between the two displacements the tangent is looked at.
const BETWEEN: [f64; 3] = [0.25, 0.5, 0.75];
/// Steps of the path: as long as its direction and Newton's method allow, at most a tenth of the body's diagonal in the
/// root mean square.
const STEP: f64 = 1.0;
/// A branch without limit points takes some ten points; one that takes more is given up.
const POINTS: usize = 60;
/// A path begins towards larger s, and ends at 1 or at its first limit point: this end is never reached.
const BEHIND: f64 = -1.0;

impl Model {
    /// Whether the solve that led from one equilibrium to another stayed on its branch. Newton's method may leave a branch
    /// without any failure: the cost then has a jump between the two states, and the derivative at one says nothing of the
    /// other.
    ///
    /// Between two stable states of different branches lies a region where the tangent stiffness is indefinite. So the
    /// [`path`](Self::path) from one state to the other is followed only where the [report](State::report) of the second
    /// tells of a shifted tangent or a restart, or where its solve took five Newton iterations or more and the tangent has
    /// negative pivots at one of three states on the straight line between the two; elsewhere the answer is
    /// [`Connected`](Connection::Connected).
    ///
    /// # Errors
    /// As [`path`](Self::path); a cancelled solve, a lack of memory.
    pub fn connection(&self, from: &State, to: &State, how: &SolveOptions) -> Result<Connection, StateError> {
        self.check_state(from)?;
        self.check_state(to)?;
        let change = norm(&sub(&to.u, &from.u));
        if change <= SMALL * norm(&to.u) || !self.may_have_jumped(from, to, how)? {
            return Ok(Connection::Connected);
        }
        let options = PathOptions { step: STEP, points: POINTS, range: [BEHIND, 1.0], to_limit: true };
        let target = (&*to.controls, to.load);
        let path = self.path(from, target, &options, how, &mut Workspace::default(), &mut |_| ())?;
        let limit = path.events.iter().find(|event| event.kind == EventKind::LimitPoint);
        let Some(last) = path.points.last() else { return Ok(Connection::Unknown(0.0)) };
        Ok(match (path.end, limit) {
            (PathEnd::Cancelled, _) => return Err(StateError::Cancelled),
            (PathEnd::Stuck(error), _) if error.is_final() => return Err(error),
            (_, Some(limit)) => Connection::LimitPoint(limit.s),
            (PathEnd::Left, None) if last.s > 0.0 => {
                let apart = norm(&sub(&last.state.u, &to.u)) / change;
                if apart <= SAME { Connection::Connected } else { Connection::Elsewhere(apart) }
            }
            _ => Connection::Unknown(last.s),
        })
    }

    /// Whether the tangent was, or is between the two states, not positive definite.
    fn may_have_jumped(&self, from: &State, to: &State, how: &SolveOptions) -> Result<bool, StateError> {
        let report = &to.report;
        if report.shifted > 0 || report.restarts > 0 {
            return Ok(true);
        }
        if report.newton < FEW {
            return Ok(false);
        }
        let mut workspace = Workspace::default();
        for share in BETWEEN {
            match self.negative_pivots_with(&between(from, to, share), how, &mut workspace) {
                Ok(0) => {}
                Err(error) if error.is_final() => return Err(error),
                // Negative, singular, or turned inside out on the straight line.
                Ok(_) | Err(_) => return Ok(true),
            }
        }
        Ok(false)
    }
}

/// A state on the straight line between two, which is no equilibrium.
fn between(from: &State, to: &State, share: f64) -> State {
    let mut u = from.u.to_vec();
    axpy(share, &sub(&to.u, &from.u), &mut u);
    let controls = Arc::new(from.controls.blend(&to.controls, share));
    State { u: Arc::new(u), controls, load: (1.0 - share) * from.load + share * to.load, ..to.clone() }
}
