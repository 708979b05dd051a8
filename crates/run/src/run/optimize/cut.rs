//! The optimum once more, with its designs cut.

use crate::run::session::{CommandContext, CommandFindings, START_ACCURACY};
use nastic_case::lower::CaseProblem;
use nastic_case::warning::{CUT_UNSOLVED, Warning};
use nastic_ensemble::{EnsemblePoint, EnsembleWorkspace};
use nastic_numeric::format::scientific;
use nastic_opt::{Best, Objective, Request};
use nastic_result::cut_design;

/// Solves the optimum with every density and mixture 0 or 1 in each cell, and tells what it costs; nothing of a case without them, of a team, or after a stop.
pub(super) fn solve(context: CommandContext<'_>, findings: &mut CommandFindings, best: &Best<EnsemblePoint>) {
    let CommandContext { input, console, .. } = context;
    if input.team.is_some() || best.stop.is_interrupted() {
        return;
    }
    let Some(document) = cut_design::cut_case(&input.problem, &best.m, best.stage) else { return };
    let cost = findings.timed(console, "solve", |_| {
        let cut = CaseProblem::lower(document, input.signal.clone()).map_err(|problems| problems.to_string())?;
        let how = Request { accuracy: START_ACCURACY, stage: best.stage, ..Request::default() };
        let point = cut.ensemble.evaluate(&best.m, &how, &mut EnsembleWorkspace::default());
        point.map(|point| cut.ensemble.value(&point)).map_err(|failed| failed.to_string())
    });
    console.clear();
    match cost {
        Ok(cost) => {
            findings.record.optimum.cut_cost = cost.into();
            console.say(format!("cut         cost {} with each cell 0 or 1", scientific(cost, 6)));
        }
        Err(why) => findings.warn(console, Warning::new(&CUT_UNSOLVED, why)),
    }
}
