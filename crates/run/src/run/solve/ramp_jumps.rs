//! Neighbouring rows of a ramp that lie on different branches of equilibria.

use crate::run::solve::series::Series;
use nastic_case::warning::{BRANCH_CHANGE, BRANCH_UNKNOWN, Warning};
use nastic_fem::{Connection, SolveOptions};
use nastic_language::number::short;
use nastic_report::record::JumpRecord;
use rayon::prelude::*;
use std::sync::atomic::Ordering;

/// Their parameters as an entry of the result, and what there is to report of them: the first, and how many there are.
pub(super) fn jumps(series: &Series<'_>, how: &SolveOptions) -> (Vec<JumpRecord>, Vec<Warning>) {
    if how.cancel.is_some_and(|cancelled| cancelled.load(Ordering::Relaxed)) {
        return (vec![], vec![]); // nothing is known, and the ramp ends by it
    }
    let model = series.member.solid().model();
    let how = SolveOptions { parallel: false, watch: None, ..how.clone() };
    let connection = |rows: &[crate::run::solve::series::Row]| {
        let [before, here] = rows else { return Connection::Connected };
        model.stability().connection(&before.state, &here.state, &how).unwrap_or(Connection::Unknown(0.0))
    };
    let found: Vec<Connection> = series.rows.par_windows(2).with_max_len(1).map(connection).collect();
    let ends = |k: usize| (series.rows[k].parameter, series.rows[k + 1].parameter);
    let is_jump = |at: &Connection| matches!(at, Connection::LimitPoint(_) | Connection::Elsewhere(_));
    let of = |wanted: &dyn Fn(&Connection) -> bool| -> Vec<usize> {
        (0..found.len()).filter(|k| wanted(&found[*k])).collect()
    };
    let (jumps, unknown) = (of(&is_jump), of(&|at| matches!(at, Connection::Unknown(_))));
    let entries = jumps.iter().map(|k| JumpRecord { from: ends(*k).0.into(), to: ends(*k).1.into() }).collect();
    let warning_of = |kind, rows: &[usize], what: &str| {
        let (from, to) = ends(*rows.first()?);
        let more = if rows.len() > 1 { format!(" (the first of {} such steps)", rows.len()) } else { String::new() };
        let message = format!("{what} from {} to {} {}{more}", short(from), short(to), series.parameter.1);
        Some(Warning::new(kind, message).of("ramp".to_owned()))
    };
    let shown = [
        warning_of(&BRANCH_CHANGE, &jumps, "the body leaves its branch of equilibria on the step"),
        warning_of(&BRANCH_UNKNOWN, &unknown, "the branch could not be followed on the step"),
    ];
    (entries, shown.into_iter().flatten().collect())
}
