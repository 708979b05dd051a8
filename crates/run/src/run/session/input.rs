//! [`CommandInput`]: what was asked of a command.

use crate::console::Console;
use crate::run::error::RunError;
use crate::run::options::Options;
use crate::run::terminal::say_warning;
use nastic_case::lower::CaseProblem;
use nastic_case::warning::Warning;
use nastic_ensemble::{EnsemblePoint, EnsembleWorkspace};
use nastic_language::schema::Command;
use nastic_opt::{Budget, Failed, Objective, Request};
use nastic_result::inspection::Inspection;
use nastic_team::Team;
use std::sync::{Arc, atomic::AtomicBool, atomic::Ordering};

/// Newton iterations after which the search of an equilibrium ends: hundreds are many.
const MOST_ITERATIONS: usize = 4000;

/// What was asked, and what stands fixed while the command runs.
///
/// [`time_steps`](crate::run::time_steps) alone changes it behind opening: the steps of a case with a tolerance are found by motions, a part
/// of the command's work, and the problem with these steps takes the place of the one without. Who is given `&CommandInput` sees one problem.
pub(crate) struct CommandInput {
    pub command: Command,
    pub problem: CaseProblem,
    /// What the user chose beside the case; `set` is what the case was changed by.
    pub options: Options,
    /// The ranks that run the same command; `None` where there is one.
    pub team: Option<Arc<dyn Team>>,
    pub cancel: Arc<AtomicBool>,
    /// The flag of this rank, which its solves look at: on a team that shares members out `cancel` is raised on all ranks behind the same evaluation.
    pub signal: Arc<AtomicBool>,
}

impl CommandInput {
    /// Looks into the states and says what deserves attention there; the caller keeps the warnings.
    pub fn look_into(&self, console: &Console, what: &str, point: &EnsemblePoint) -> (Vec<Inspection>, Vec<Warning>) {
        let found = Inspection::of_point(&self.problem, point);
        let members = self.problem.members().zip(&found);
        let warnings: Vec<Warning> = members.flat_map(|(member, found)| found.warnings(member, what)).collect();
        warnings.iter().for_each(|warning| say_warning(console, warning));
        (found, warnings)
    }

    /// The ensemble at a control vector.
    pub fn evaluate(
        &self,
        console: &Console,
        m: &[f64],
        accuracy: f64,
        workspace: &mut EnsembleWorkspace,
    ) -> Result<EnsemblePoint, Failed> {
        evaluate(&self.problem, console, m, Request { accuracy, ..Request::default() }, workspace)
    }

    /// Whether a stop was requested.
    pub fn is_cancelled(&self) -> bool {
        self.cancel.load(Ordering::Relaxed)
    }

    /// What this command needs and the case lacks.
    pub fn require(&self, controls: bool, costs: bool) -> Result<(), RunError> {
        let command = self.command.name();
        if controls && self.problem.start.is_empty() {
            let message = format!("\"{command}\" needs controls, and the case has none");
            return Err(self.problem.complain("controls", message).into());
        }
        if costs && !self.problem.has_costs() {
            let message = format!("\"{command}\" needs costs, and the case has none");
            return Err(self.problem.complain("costs", message).into());
        }
        if controls && costs { Ok(self.problem.check_adjoint()?) } else { Ok(()) }
    }
}

/// A problem at a control vector, with the budget that searches of equilibria have: how commands come by their states.
pub(crate) fn evaluate(
    problem: &CaseProblem,
    console: &Console,
    m: &[f64],
    how: Request<'_, EnsemblePoint>,
    workspace: &mut EnsembleWorkspace,
) -> Result<EnsemblePoint, Failed> {
    let budget = if problem.is_motion() { Budget::Unlimited } else { Budget::Of(MOST_ITERATIONS) };
    let point = problem.ensemble.evaluate(m, &Request { budget, ..how }, workspace);
    console.clear();
    point
}
