//! The optimum once more, with its designs cut.

use crate::run::progress;
use crate::run::session::{CommandContext, CommandFindings, START_ACCURACY, evaluate};
use nastic_case::lower::CaseProblem;
use nastic_case::warning::{CUT_UNSOLVED, Warning};
use nastic_ensemble::{EnsemblePoint, EnsembleWorkspace};
use nastic_language::syntax::Document;
use nastic_numeric::format::scientific;
use nastic_opt::{Best, Objective, Request};
use nastic_result::cut_design;

/// Solves the optimum with every density and mixture 0 or 1 in each cell, and tells what it costs, or why that is not done; nothing of a case without them, or
/// after a stop.
pub(super) fn solve(context: CommandContext<'_>, findings: &mut CommandFindings, best: &Best<EnsemblePoint>) {
    let CommandContext { input, console, .. } = context;
    if input.is_cancelled() || best.stop.is_interrupted() {
        return;
    }
    let not_solved = |why: &dyn std::fmt::Display| console.say(format!("cut         not solved once more: {why}"));
    let document = match cut_design::cut_case(&input.problem, &best.m, best.stage) {
        Ok(Some(document)) => document,
        Ok(None) => return,
        Err(why) => return not_solved(&why),
    };
    if input.team.is_some() {
        return not_solved(&"on a team of ranks; \"cut\" in the control and \"solve\" do it");
    }
    if input.problem.case.time.as_ref().is_some_and(|time| time.tolerance.is_some()) {
        return not_solved(&"its time steps would have to be found anew; \"cut\" in the control and \"solve\" do it");
    }
    findings.timed(console, "cut", |findings| match lowered(context, document) {
        Ok(problem) => evaluated(&problem, context, findings, best),
        Err(why) => not_solved(&why),
    });
}

fn lowered(context: CommandContext<'_>, document: Document) -> Result<CaseProblem, String> {
    let CommandContext { input, console, .. } = context;
    let mut problem = CaseProblem::lower(document, input.signal.clone()).map_err(|problems| problems.to_string())?;
    problem.refuse_unstable_if_asked();
    progress::watch(&mut problem, console);
    Ok(problem)
}

fn evaluated(
    problem: &CaseProblem,
    CommandContext { input, console, .. }: CommandContext<'_>,
    findings: &mut CommandFindings,
    best: &Best<EnsemblePoint>,
) {
    let how = Request { accuracy: START_ACCURACY, stage: best.stage, ..Request::default() };
    match evaluate(problem, console, &best.m, how, &mut EnsembleWorkspace::default()) {
        Ok(point) => {
            let cost = problem.ensemble.value(&point);
            findings.record.optimum.cut_cost = cost.into();
            console.say(format!("cut         cost {} with each cell 0 or 1", scientific(cost, 6)));
        }
        Err(_) if input.is_cancelled() => {}
        Err(why) => findings.warn(console, Warning::new(&CUT_UNSOLVED, why.to_string())),
    }
}
