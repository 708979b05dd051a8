//! What `nastic identify` refuses before anything is solved.

use super::parameters::prior;
use crate::run::error::RunError;
use crate::run::session::CommandInput;
use nastic_case::lower::CaseProblem;
use nastic_language::number::count;
use nastic_language::schema::Command;
use nastic_language::syntax::Diagnostics;
use nastic_opt::{Constrained, NewtonCg, Optimizer};

/// Costs of controls alone, which stand for what is known beside the readings.
const OF_CONTROLS: [&str; 2] = ["control_norm", "control_smoothness"];
/// Parameters at most: their covariance is a full matrix.
const MOST_PARAMETERS: usize = 500;

/// Refuses what is known to be impossible before anything is solved.
pub(in crate::run::optimize) fn check(input: &CommandInput) -> Result<(), RunError> {
    if input.command != Command::Identify {
        return Ok(());
    }
    let problem = &input.problem;
    let refuse = |key: &str, message: String| Err(problem.complain(key, message).into());
    if problem.is_motion() {
        let message = "\"identify\" compares equilibria with readings, and the case moves in time: take states at rest as load cases";
        return refuse("time", message.to_owned());
    }
    if !problem.ensemble.constraints().is_empty() {
        let message =
            "\"identify\" takes no constraints, which are no readings: leave them out, or give bounds of controls";
        return refuse("constraints", message.to_owned());
    }
    if problem.ensemble.scenarios().len() > 1 {
        let message = "\"identify\" looks for the one material that was measured: leave the scenarios out; what was measured at other settings are load cases";
        return refuse("scenarios", message.to_owned());
    }
    let (method, wanted) = (problem.case.optimizer.method.name(), NewtonCg::gauss_newton().name());
    if method != wanted {
        let message = format!("\"identify\" takes \"{wanted}\", found \"{method}\": leave the key out");
        return refuse("optimizer/method", message);
    }
    Ok(check_readings(problem)?)
}

/// Enough readings, in every shot, and nothing that is none.
fn check_readings(problem: &CaseProblem) -> Result<(), Diagnostics> {
    let mut readings = 0;
    for member in problem.members() {
        let blocks = member.case().costs.iter().filter(|block| block.weight() != 0.0 && !block.is_of_motion());
        let mut own = 0;
        for (block, cost) in blocks.zip(member.reduced().costs()) {
            match cost.numbers() {
                Some(numbers) => own += numbers,
                None if OF_CONTROLS.contains(&block.kind()) => {}
                None => {
                    let message = format!(
                        "\"{}\" is no sum of squared readings: \"identify\" takes markers, position, reaction, volume and mean_radius, and {} for what else is known",
                        block.kind(),
                        OF_CONTROLS.join(" and ")
                    );
                    return Err(problem.document.complain(block.at(), message).into());
                }
            }
        }
        if own == 0 {
            let message = match member.load_case() {
                Some(name) => format!("the load case \"{name}\" has no readings: give it markers, or leave it out"),
                None => "there are no readings: give the costs markers".to_owned(),
            };
            return Err(problem.complain(if member.load_case().is_some() { "load_cases" } else { "costs" }, message));
        }
        readings += own;
    }
    let parameters = problem.start.len();
    let blocks = problem.ensemble.blocks().iter().zip(&problem.controls);
    let known = blocks.filter(|(_, field)| prior(problem, field).is_some()).map(|(block, _)| block.len);
    readings += known.sum::<usize>();
    if readings < parameters || parameters > MOST_PARAMETERS {
        let (read, wanted) = (count(readings, "reading"), count(parameters, "parameter"));
        let message = match readings < parameters {
            true => format!("{read} for {wanted}: give more markers or shots, priors, or fewer parameters"),
            false => format!("{wanted}; \"identify\" takes {MOST_PARAMETERS} at most: take a coarser grid, or regions"),
        };
        return Err(problem.complain("controls", message));
    }
    Ok(())
}
