//! `nastic solve --equilibria N`: several equilibria under the start controls, by deflation.

use crate::run::error::{Exit, RunError};
use crate::run::session::{CommandContext, CommandFindings};
use crate::run::solve::series::{Row, Series};
use nastic_control::ControlError;
use nastic_ensemble::EnsemblePoint;
use nastic_fem::{Equilibrium, Progress, SolveOptions, StateError, Workspace};
use nastic_report::record::EquilibriaRecord;

/// Bulk over shear modulus above which the search misses states: 6 of the 7 of a stretched cube at 1e4, all of them at 1e3
/// (docs/stability.md).
const HARD: f64 = 2e3;

/// Finds, says and writes the equilibria of every member, beginning with that of the point.
pub(super) fn run(
    context: CommandContext<'_>,
    findings: &mut CommandFindings,
    point: &EnsemblePoint,
    count: usize,
) -> Result<Exit, RunError> {
    let CommandContext { input, destination, console } = context;
    let mut files = Vec::new();
    for index in 0..point.members.len() {
        if input.is_cancelled() {
            break;
        }
        files.extend(
            findings.timed(console, "deflation", |findings| of_member(context, findings, point, index, count))?,
        );
    }
    if destination.out.is_some() {
        findings.say_files(console, files);
    }
    Ok(if input.is_cancelled() { Exit::NotConverged } else { Exit::Done })
}

fn of_member(
    context: CommandContext<'_>,
    findings: &mut CommandFindings,
    point: &EnsemblePoint,
    index: usize,
    count: usize,
) -> Result<Vec<String>, RunError> {
    let CommandContext { input, destination, console } = context;
    let at = &point.members[index];
    let member = input.problem.member(index);
    let mut series = Series::new(member, "equilibrium", ("equilibrium".to_owned(), String::new()));
    console.say(format!("equilibria  up to {count} under the same controls and loads{}", member.inside()));
    console.say(series.header());
    let progress = |now: &Progress| {
        let line = format!("Newton iteration {}, residual {:.1e}", now.newton, now.residual);
        console.progress(now.newton, line);
    };
    let how = SolveOptions { cancel: Some(&input.cancel), watch: Some(&progress), ..SolveOptions::default() };
    let mut found = |one: &Equilibrium| {
        let (parameter, state) = ((series.rows.len() + 1) as f64, one.state.clone());
        let row = Row { parameter, m: at.m.clone(), newton: state.report.newton, state, negative: one.negative };
        console.say(series.line(&row));
        series.rows.push(row);
    };
    let model = member.solid().model();
    let all = model.stability().equilibria(at.state(), count, &how, &mut Workspace::default(), &mut found);
    let (starts, newton) = match all {
        Ok(all) => (Some(all.starts), Some(all.newton)),
        // What was found before Ctrl-C is kept.
        Err(StateError::Cancelled) => (None, None),
        Err(error) => return Err(destination.member_failed(input, index, ControlError::from(error))),
    };
    let many = series.rows.len();
    if many < count {
        let from = starts.map_or_else(|| "before it was stopped".to_owned(), |starts| format!("from {starts} starts"));
        let ratio = model.properties().bulk_over_shear(&at.state().controls);
        let weak = match ratio > HARD {
            true => {
                format!(": the search is weak in nearly incompressible bodies (bulk over shear modulus {ratio:.0})")
            }
            false => String::new(),
        };
        console.say(format!("            {many} of {count} were found, {from}; others may exist{weak}"));
    }
    let warnings = series.inspect();
    let mut files = Vec::new();
    if let Some(out) = &destination.out {
        let stem = member.file("equilibrium_");
        for k in 0..series.rows.len() {
            files.extend(out.write_state(&format!("{stem}{:03}", k + 1), &series.snapshot(k)?)?);
        }
        out.remove_numbered(&stem, series.rows.len() + 1);
    }
    let found = series.points();
    let entry = EquilibriaRecord { asked: count, found, starts: starts.into(), newton_iterations: newton.into() };
    findings.entries_of(member).equilibria = Some(entry);
    findings.warn_all(console, warnings);
    Ok(files)
}
