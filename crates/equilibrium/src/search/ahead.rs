//! [`Ahead`]: what stands on the path of equilibria from a state towards other controls.

use crate::linear_systems::workspace::Workspace;
use crate::model::Model;
use crate::model::views::Moves;
use crate::search::options::SolveOptions;
use crate::stability::path::{EventKind, PathEnd, PathOptions};
use nastic_body::controls::Controls;
use nastic_body::error::{Cause, StateError};
use nastic_body::state::{SolveReport, State};

/// Where the path of equilibria from a state straight towards other controls and another load leads.
#[derive(Debug, Clone)]
pub enum Ahead {
    /// To these controls, at this equilibrium, without a limit point.
    Clear(Box<State>),
    /// It turns back before.
    LimitPoint(Box<LimitAhead>),
    /// It could be followed to this share of the way only.
    Unknown(f64),
}

/// A limit point on the way.
#[derive(Debug, Clone)]
pub struct LimitAhead {
    /// The share of the way at which it is.
    pub share: f64,
    /// The equilibrium there.
    pub state: State,
    /// How the displacement changes along the path there, of any length: the direction in which the tangent is singular.
    pub direction: Vec<f64>,
    /// Equilibria before it, by their shares of the way, in order.
    pub passed: Vec<(f64, State)>,
}

/// Longest step of the path: its direction and Newton's method limit it, and a tenth of the body's diagonal in the root
/// mean square.
const MAX_PATH_STEP: f64 = 1.0;
/// Points of a path that is followed to explain why a solve failed.
const MAX_EXPLANATION_POINTS: usize = 30;
/// How far behind the load that failed a limit point may be the cause.
const MAX_LOAD_BEHIND_FAILURE: f64 = 1.0 / 64.0;
/// Points of a branch: one without limit points takes about ten.
const MAX_BRANCH_POINTS: usize = 60;
/// Lower end of the range of s, which is never reached: a path begins towards larger s, and stops at 1 or at its first limit point.
const PATH_RANGE_START: f64 = -1.0;

impl Model {
    /// The error of a solve that failed for an unknown cause, or at guides that meet, with the limit point as its cause where the path from the last
    /// equilibrium turns back before the load that failed, or just behind it.
    pub(crate) fn explained(&self, mut error: StateError, to: &Controls, how: &SolveOptions) -> StateError {
        let StateError::NoConvergence { cause, last, reached, load, newton, .. } = &mut error else { return error };
        if !matches!(cause, Cause::Unknown | Cause::GuidesMeet(_)) {
            return error;
        }
        let budget = how.budget.map(|budget| budget.saturating_sub(*newton));
        let how = SolveOptions { near: None, guess: None, budget, ..how.clone() };
        let (mut kept, mut report) = (Workspace::default(), SolveReport::default());
        let at = match self.ahead_within(MAX_EXPLANATION_POINTS, last, (to, 1.0), &how, &mut kept, &mut report) {
            Err(StateError::Cancelled) => return StateError::Cancelled,
            Ok(Ahead::LimitPoint(at)) => *reached + at.share * (1.0 - *reached),
            _ => return error,
        };
        *newton += report.newton;
        if at > *load + MAX_LOAD_BEHIND_FAILURE {
            return error;
        }
        match cause {
            Cause::GuidesMeet(guides) => guides.limit = Some(at),
            _ => *cause = Cause::LimitPoint { load: at },
        }
        error
    }

    fn ahead_within(
        &self,
        points: usize,
        from: &State,
        to: (&Controls, f64),
        how: &SolveOptions,
        workspace: &mut Workspace,
        report: &mut SolveReport,
    ) -> Result<Ahead, StateError> {
        let options = PathOptions { step: MAX_PATH_STEP, points, range: [PATH_RANGE_START, 1.0], to_limit: true };
        let mut path = self.stability().path(from, to, &options, how, workspace, &mut |point| {
            report.add_work(&point.state.report);
        })?;
        let limit = path.events.into_iter().find(|event| event.kind == EventKind::LimitPoint);
        let Some(last) = path.points.pop() else { return Ok(Ahead::Unknown(0.0)) };
        match (path.end, limit) {
            (PathEnd::Cancelled, _) => Err(StateError::Cancelled),
            (PathEnd::Stuck(error), _) if error.is_final() => Err(error),
            (_, Some(event)) => {
                let passed =
                    path.points.into_iter().take(event.point + 1).map(|point| (point.s, point.state)).collect();
                let (share, state, direction) = (event.s, event.state, event.direction);
                Ok(Ahead::LimitPoint(Box::new(LimitAhead { share, state, direction, passed })))
            }
            (PathEnd::Left, None) if last.s > 0.0 => Ok(Ahead::Clear(Box::new(last.state))),
            _ => Ok(Ahead::Unknown(last.s)),
        }
    }
}

impl Moves<'_> {
    /// Follows the [`path`](crate::model::views::Stability::path) from an equilibrium towards other controls and another load, in long steps, to its first limit point. What
    /// that takes is added to the work of `report`.
    ///
    /// # Errors
    /// As there; a cancelled path, a lack of memory.
    pub fn ahead(
        &self,
        from: &State,
        to: (&Controls, f64),
        how: &SolveOptions,
        workspace: &mut Workspace,
        report: &mut SolveReport,
    ) -> Result<Ahead, StateError> {
        self.model.ahead_within(MAX_BRANCH_POINTS, from, to, how, workspace, report)
    }
}
