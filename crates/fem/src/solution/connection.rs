//! [`Connection`]: whether two equilibria lie on one branch.

use crate::error::StateError;
use crate::model::Model;
use crate::solution::options::SolveOptions;
use crate::solution::path::{EventKind, PathEnd, PathOptions};
use crate::solution::state::State;
use crate::solution::workspace::Workspace;
use nastic_numeric::vector::{norm, sub};

/// How the path of equilibria from one state, along the straight way to the controls of another, comes to that one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Connection {
    /// It arrives there without a limit point: both lie on one branch.
    Connected,
    /// It turns back at this share of the way: the body has snapped.
    LimitPoint(f64),
    /// It arrives at another equilibrium under the same controls, farther from that state than this share of the
    /// change of the displacement.
    Elsewhere(f64),
    /// It could be followed to this share of the way only.
    Unknown(f64),
}

/// Equilibria that differ by less, relative to the change of the displacement, are one.
const SAME: f64 = 0.01;
/// A smaller change, relative to the displacement, is taken for this much: states are known to their accuracy only.
const LEAST: f64 = 0.1;
/// Steps of at most a quarter of the way.
const STEP: f64 = 0.25;
const POINTS: usize = 100;
/// Backwards no path goes before it has turned.
const BACKWARDS: f64 = -1e-3;

impl Model {
    /// Follows the [`path`](Self::path) of equilibria from one state towards the controls and the load of another, to
    /// see whether both lie on one branch. Newton's method may leave the branch it started on without meeting a
    /// failure: then the cost has a jump between the two states, and the derivative at one says nothing of the other.
    ///
    /// # Errors
    /// As [`path`](Self::path).
    pub fn connection(&self, from: &State, to: &State, how: &SolveOptions) -> Result<Connection, StateError> {
        self.check_state(to)?;
        let options = PathOptions { step: STEP, points: POINTS, range: [BACKWARDS, 1.0], to_limit: true };
        let target = (&*to.controls, to.load);
        let path = self.path(from, target, &options, how, &mut Workspace::default(), &mut |_| ())?;
        let limit = path.events.iter().find(|event| event.kind == EventKind::LimitPoint);
        let Some(end) = path.points.last() else { return Ok(Connection::Unknown(0.0)) };
        Ok(match (path.end, limit) {
            (PathEnd::Cancelled, _) => return Err(StateError::Cancelled),
            (_, Some(limit)) => Connection::LimitPoint(limit.s),
            (PathEnd::Left, None) if end.s == 1.0 => {
                let change = norm(&sub(&to.u, &from.u)).max(LEAST * norm(&to.u));
                let apart = norm(&sub(&end.state.u, &to.u));
                if apart <= SAME * change { Connection::Connected } else { Connection::Elsewhere(apart / change) }
            }
            _ => Connection::Unknown(end.s),
        })
    }
}
