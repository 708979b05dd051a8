//! What `nastic gains` refuses before anything is solved.

use crate::run::error::RunError;
use crate::run::session::CommandInput;
use nastic_case::lower::{Admitted, CaseProblem};
use nastic_language::number::count;
use nastic_language::syntax::Diagnostics;

/// Costs that compare numbers with targets.
pub(super) const AIMING: [&str; 7] =
    ["position", "markers", "volume", "mean_radius", "reaction", "curvature", "orientation"];
/// Control values and outputs at most: S and L are full matrices, of 0.5 MB each, and every output has a vector as long as the state.
const MOST: usize = 256;

pub(super) fn check(input: &CommandInput) -> Result<(), RunError> {
    let problem = &input.problem;
    let refuse = |key: &str, message: String| Err(problem.complain(key, message).into());
    if problem.is_motion() {
        let message = "\"gains\" is of equilibria, and the case moves in time: leave \"time\" out, the law waits for rest between its steps";
        return refuse("time", message.to_owned());
    }
    let one_rank = problem.solid().model().ranks().refuse_ranks("\"gains\"");
    one_rank.map_err(|error| problem.complain("mesh", error.to_string()))?;
    input.require(true, true)?;
    if problem.case.load_cases.len() > 1 {
        let message = format!(
            "\"gains\" is of one state, and the case has {}: leave one of them",
            count(problem.case.load_cases.len(), "load case")
        );
        return refuse("load_cases", message);
    }
    let values = problem.start.len();
    if values > MOST {
        let message = format!(
            "{}; \"gains\" takes {MOST} at most, for a matrix that a controller holds: take the space \"uniform\" or \"region\", or a coarser grid",
            count(values, "control value")
        );
        return refuse("controls", message);
    }
    let costs = problem.member(0).reduced().costs();
    if !problem.member(0).case().costs.iter().any(|cost| AIMING.contains(&cost.kind())) {
        let message = format!("\"gains\" needs outputs with targets: costs of the kind {}", AIMING.join(", "));
        return refuse("costs", message);
    }
    let outputs = costs.iter().filter_map(|cost| cost.numbers()).sum::<usize>() + 3 * problem.probes.len();
    if outputs > MOST {
        let message =
            format!("{} and more; \"gains\" takes {MOST} at most: fewer markers or probes", count(outputs, "output"));
        return refuse("costs", message);
    }
    Ok(check_controls(problem)?)
}

/// Controls that a law of plain steps and bounds does not serve.
fn check_controls(problem: &CaseProblem) -> Result<(), Diagnostics> {
    for field in &problem.controls {
        let complain = |key: &str, message: &str| Err(problem.document.complain(&field.at.key(key), message).into());
        if field.log {
            return complain(
                "log",
                "the steps of \"gains\" are those of the value, the unknown is its logarithm: leave \"log\" out",
            );
        }
        match field.admitted {
            Admitted::Norm(_) => {
                return complain(
                    "norm",
                    "the steps of \"gains\" keep no length: take an amplitude, with \"direction\"",
                );
            }
            Admitted::MaxNorm(_) => {
                return complain(
                    "max_norm",
                    "\"gains\" keeps to bounds of components, not of lengths: give \"lower\" and \"upper\"",
                );
            }
            Admitted::Between { .. } | Admitted::Any => {}
        }
    }
    Ok(())
}
