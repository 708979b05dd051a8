//! [`BranchChanges`]: accepted trials whose states lie on another branch of equilibria than those before them.

use crate::lower::{CaseMember, CaseProblem};
use nastic_control::{EnsemblePoint, Evaluated};
use nastic_fem::{Connection, SolveOptions, State};
use nastic_opt::SavedRunError;
use nastic_opt::bytes::{Reader, Writer};

/// What was found in the accepted trials of one start.
#[derive(Debug, Clone, Default)]
pub(super) struct BranchChanges {
    /// How many iterations led to another branch.
    pub count: usize,
    /// What happened in the first of them.
    pub first: String,
    /// States of the last accepted trial, by member.
    before: Vec<State>,
}

impl BranchChanges {
    /// Goes on from these states.
    pub fn follow(&mut self, point: &EnsemblePoint) {
        self.before = point.members.iter().map(|at| at.state.clone()).collect();
    }

    /// Whether an accepted trial changed the branch. Asked where the solve that found its state met a tangent that was not
    /// positive definite, or had to begin at rest: all others are taken to lie on the branch they started from.
    pub fn add(&mut self, problem: &CaseProblem, point: &EnsemblePoint, iteration: usize) -> bool {
        let before = std::mem::take(&mut self.before);
        self.follow(point);
        if iteration == 0 {
            return false; // the start, which a resumed run tells of once more
        }
        let change = problem.members().zip(&before).zip(&point.members).find_map(|((member, before), at)| {
            doubtful(at).then_some(())?;
            let connection = member.solid().model().connection(before, &at.state, &SolveOptions::default());
            let how = match connection {
                Ok(connection) => describe(connection)?,
                Err(error) => format!("the branch of the state before could not be followed: {error}"),
            };
            Some(format!("iteration {iteration}{}: {how}", named(member)))
        });
        let Some(change) = change else { return false };
        self.count += 1;
        if self.count == 1 {
            self.first = change;
        }
        true
    }

    pub fn write(&self, out: &mut Writer) {
        out.count(self.count);
        out.bytes(self.first.as_bytes());
    }

    /// What [`write`](Self::write) wrote; the states are [followed](Self::follow) anew.
    pub fn read(input: &mut Reader<'_>) -> Result<Self, SavedRunError> {
        Ok(Self { count: input.number()?, first: input.text()?, before: vec![] })
    }
}

/// `, LOAD_CASE` where there are several members.
fn named(member: CaseMember<'_>) -> String {
    let name = member.name();
    if name.is_empty() { name } else { format!(", {name}") }
}

fn doubtful(at: &Evaluated) -> bool {
    at.work.shifted > 0 || at.work.restarts > 0
}

/// Why two states do not lie on one branch; `None` where they do.
fn describe(connection: Connection) -> Option<String> {
    Some(match connection {
        Connection::Connected => return None,
        Connection::LimitPoint(s) => {
            format!("the branch of the state before turns back at a limit point, {} of the way", percent(s))
        }
        Connection::Elsewhere(apart) => {
            format!("the branch of the state before leads to another state, {} of the change away", percent(apart))
        }
        Connection::Unknown(s) => {
            format!("the branch of the state before could not be followed beyond {} of the way", percent(s))
        }
    })
}

fn percent(share: f64) -> String {
    format!("{:.1} %", 100.0 * share)
}
