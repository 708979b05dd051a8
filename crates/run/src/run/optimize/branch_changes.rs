//! [`BranchChanges`]: iterations that led to another branch of equilibria.

use nastic_case::lower::{CaseMember, CaseProblem};
use nastic_case::warning::{BRANCH_CHANGE, BRANCH_UNKNOWN, Warning, WarningKind};
use nastic_control::Evaluated;
use nastic_ensemble::EnsemblePoint;
use nastic_fem::{Connection, SolveOptions, State, StateError};
use nastic_language::number::short;
use serde::{Deserialize, Serialize};
use std::sync::atomic::AtomicBool;

/// Members that one sentence names.
const NAMED: usize = 3;

/// An accepted point: its control vector and the states of the members.
#[derive(Debug, Clone)]
pub(crate) struct Before {
    m: Vec<f64>,
    /// By the member's number, of those that this rank has.
    states: Vec<(usize, State)>,
}

impl Before {
    pub fn new(point: &EnsemblePoint) -> Self {
        Self { m: point.m.clone(), states: point.held().map(|(index, at)| (index, at.state().clone())).collect() }
    }
}

/// What was found in the accepted trials of one start.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(crate) struct BranchChanges {
    changed: FirstChange,
    unknown: FirstChange,
}

/// How many iterations, and what happened in the first of them.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
struct FirstChange {
    count: usize,
    first: String,
}

impl BranchChanges {
    /// Whether an accepted trial left the branch of the point before; `None` where that is not known.
    ///
    /// # Errors
    /// The search was cancelled.
    pub(crate) fn add(
        &mut self,
        problem: &CaseProblem,
        cancel: &AtomicBool,
        before: &Before,
        point: &EnsemblePoint,
        iteration: usize,
    ) -> Result<Option<bool>, StateError> {
        let parallel = problem.members().nth(1).is_none();
        let how = SolveOptions { parallel, cancel: Some(cancel), ..SolveOptions::default() };
        let connection = |index: usize, at: &Evaluated| {
            let own = before.states.iter().find(|(known, _)| *known == index);
            let Some((_, before)) = own else { return Some(Connection::Unknown(0.0)) };
            match problem.member(index).solid().model().stability().connection(before, at.state(), &how) {
                Err(StateError::Cancelled) => None,
                found => Some(found.unwrap_or(Connection::Unknown(0.0))),
            }
        };
        let found = problem.ensemble.gathered(point, connection).map_err(|_| StateError::Cancelled)?;
        let found: Vec<Connection> = found.into_iter().collect::<Option<_>>().ok_or(StateError::Cancelled)?;
        let at = |share: f64| control_value(problem, &before.m, &point.m, share);
        let (mut changed, mut unknown) = (Vec::new(), Vec::new());
        for (member, connection) in problem.members().zip(found) {
            let shown = match connection {
                Connection::Connected => continue,
                Connection::Unknown(_) => &mut unknown,
                Connection::LimitPoint(_) | Connection::Elsewhere(_) => &mut changed,
            };
            shown.push(format!("{}{}", named(member), describe(connection, at)));
        }
        self.changed.add(iteration, &changed);
        self.unknown.add(iteration, &unknown);
        Ok(if unknown.is_empty() || !changed.is_empty() { Some(!changed.is_empty()) } else { None })
    }

    /// What there is to report of a start.
    pub(crate) fn warnings(&self, problem: &CaseProblem, index: usize) -> Vec<Warning> {
        let of = |kind: &'static WarningKind, shown: &FirstChange| {
            let more =
                if shown.count > 1 { format!(" (the first of {} iterations)", shown.count) } else { String::new() };
            (shown.count > 0)
                .then(|| Warning::new(kind, format!("{}{more}", shown.first)).of(run_place(problem, index)))
        };
        [of(&BRANCH_CHANGE, &self.changed), of(&BRANCH_UNKNOWN, &self.unknown)].into_iter().flatten().collect()
    }
}

impl FirstChange {
    fn add(&mut self, iteration: usize, members: &[String]) {
        if members.is_empty() {
            return;
        }
        self.count += 1;
        if self.count == 1 {
            let rest = members.len().saturating_sub(NAMED);
            let more = if rest > 0 { format!("; and {rest} more") } else { String::new() };
            let named: Vec<&str> = members.iter().take(NAMED).map(String::as_str).collect();
            self.first = format!("iteration {iteration}: {}{more}", named.join("; "));
        }
    }
}

/// What warnings call a start: "start", of several "start 2 of 4".
pub(crate) fn place(problem: &CaseProblem, index: usize) -> String {
    match problem.case.optimizer.starts {
        0 | 1 => "start".to_owned(),
        count => format!("start {} of {count}", index + 1),
    }
}

/// `start 2 of 4` where there are several.
fn run_place(problem: &CaseProblem, index: usize) -> String {
    if problem.case.optimizer.starts > 1 { place(problem, index) } else { String::new() }
}

/// `MEMBER: ` where there are several.
fn named(member: CaseMember<'_>) -> String {
    let name = member.name();
    if name.is_empty() { name } else { format!("{name}: ") }
}

/// ` (0.2 T)`, the value of the only control at this share of the way; nothing where there are more.
fn control_value(problem: &CaseProblem, before: &[f64], here: &[f64], share: f64) -> String {
    match (before, here, problem.controls.as_slice()) {
        ([from], [to], [field]) => {
            format!(" ({} = {} {})", field.name, short(from + share * (to - from)), field.unit)
        }
        _ => String::new(),
    }
}

/// Why two states do not lie on one branch.
fn describe(connection: Connection, at: impl Fn(f64) -> String) -> String {
    let percent = |share: f64| format!("{:.1} %", 100.0 * share);
    match connection {
        Connection::Connected => String::new(),
        Connection::LimitPoint(s) => {
            format!("the branch of the state before turns back at a limit point, {} of the way{}", percent(s), at(s))
        }
        Connection::Elsewhere(apart) => format!(
            "the branch of the state before leads to another state, whose displacement differs by {} of the change",
            percent(apart)
        ),
        Connection::Unknown(s) => {
            format!("the branch of the state before could not be followed beyond {} of the way{}", percent(s), at(s))
        }
    }
}
