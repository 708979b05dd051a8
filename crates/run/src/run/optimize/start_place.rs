//! Names and seeds of starts.

use crate::run::session::Session;

/// What warnings call a start: "start", of several "start 2 of 4".
pub(crate) fn place(session: &Session<'_>, index: usize) -> String {
    match session.problem.case.optimizer.starts {
        0 | 1 => "start".to_owned(),
        count => format!("start {} of {count}", index + 1),
    }
}

/// The seed of a start; the first is as written.
pub(crate) fn seed(session: &Session<'_>, index: usize) -> Option<u64> {
    // Seeds of neighbouring cases shall not share their starts.
    let of = |index: usize| session.problem.case.optimizer.seed.wrapping_mul(1_000_003).wrapping_add(index as u64);
    (index > 0).then(|| of(index))
}
