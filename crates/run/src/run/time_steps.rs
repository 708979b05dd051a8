//! Time steps of a case with a tolerance: found before a command solves anything, and held to the tolerance at its end.

use crate::run::error::RunError;
use crate::run::progress::watch;
use crate::run::session::{START_ACCURACY, Session};
use nastic_case::lower::{CaseMember, StepsError};
use nastic_case::warning::{STEP_ERROR, Warning};
use nastic_control::{AdaptiveSteps, Evaluated, StepError};
use nastic_ensemble::EnsemblePoint;
use nastic_language::number::{count, quantity, short};
use nastic_language::quantity::Dimension;
use nastic_language::schema::Time;
use nastic_report::record::{StepErrorRecord, TimeRecord};

/// Errors of steps beyond the tolerance by less are those of the solves, which optimisers do not ask for as exactly.
const SLACK: f64 = 1.1;

impl Session<'_> {
    /// Finds the time steps of a case with a tolerance, at its start controls; all that follows has these.
    pub fn find_steps(&mut self) -> Result<(), RunError> {
        if !self.input.problem.lacks_steps() {
            return Ok(());
        }
        let find = |session: &mut Self| {
            session.input.problem.with_adaptive_steps(START_ACCURACY, session.input.signal.clone())
        };
        let found = self.timed("steps", find);
        self.console.clear();
        let (problem, steps) = found.map_err(|error| match error {
            StepsError::Motion { member, error } => self.member_failed(member, error),
            StepsError::Input(problems) => problems.into(),
        })?;
        self.take_steps(problem, steps);
        Ok(())
    }

    /// Takes the steps that an earlier program found, if any.
    pub fn restore_steps(&mut self, steps: Vec<AdaptiveSteps>) -> Result<(), RunError> {
        if self.input.problem.lacks_steps() {
            let instants: Vec<Vec<f64>> = steps.iter().map(|steps| steps.instants.clone()).collect();
            let problem = self.input.problem.through(&instants, self.input.signal.clone())?;
            self.take_steps(problem, steps);
        }
        Ok(())
    }

    fn take_steps(&mut self, mut problem: nastic_case::lower::CaseProblem, steps: Vec<AdaptiveSteps>) {
        if self.input.command == nastic_language::schema::Command::Optimize {
            problem.refuse_unstable_if_asked();
        }
        watch(&mut problem, self.console);
        // what is wrong at instants that were not known before
        let known =
            |warning: &&Warning| !self.input.problem.warnings.iter().any(|known| known.message == warning.message);
        let new: Vec<Warning> = problem.warnings.iter().filter(known).cloned().collect();
        (self.input.problem, self.findings.steps) = (problem, steps);
        self.share_members();
        new.into_iter().for_each(|warning| self.warn(warning));
        for (member, steps) in self.input.problem.members().zip(&self.findings.steps) {
            self.console.say(format!("steps       {}", shown(member, steps)));
        }
    }

    /// Warns of the members whose motion needs shorter steps than those that were found at the start controls.
    pub fn check_step_errors(&mut self, point: &EnsemblePoint) {
        let members = self.input.problem.members().zip(&point.members);
        let found: Vec<Warning> = members.filter_map(|(member, at)| warning(member, at)).collect();
        found.into_iter().for_each(|warning| self.warn(warning));
    }
}

fn shown(member: CaseMember<'_>, steps: &AdaptiveSteps) -> String {
    let (units, (least, most)) = (member.problem().units(), steps.range());
    let time = |value: f64| quantity(value, Dimension::TIME, units);
    let report = &steps.report;
    let failed = if report.failed > 0 { format!(", {} without a solution", report.failed) } else { String::new() };
    let of = if member.name().is_empty() { String::new() } else { format!(" of {}", member.name()) };
    format!(
        "{}{of} from {} to {}, found at the start controls ({} rejected{failed})",
        count(steps.instants.len() - 1, "step"),
        time(least),
        time(most),
        report.rejected
    )
}

fn warning(member: CaseMember<'_>, at: &Evaluated) -> Option<Warning> {
    let tolerance = member.case().time.as_ref()?.tolerance?;
    let StepError { error, time } = at.solved.error.filter(|found| found.error > SLACK * tolerance)?;
    let units = member.problem().units();
    let message = format!(
        "a step of the motion has an estimated error of {}, {} times the tolerance, at t = {}: the steps are those of the start controls",
        quantity(error, Dimension::LENGTH, units),
        short(error / tolerance),
        quantity(time, Dimension::TIME, units)
    );
    Some(Warning::new(&STEP_ERROR, message).of(member.name()))
}

/// Of the result's entry `time`: the steps, and their largest estimated error.
pub(super) fn record(session: &Session<'_>, member: CaseMember<'_>, time: &Time, at: &Evaluated) -> TimeRecord {
    let mut out = match time.step {
        Some(step) => TimeRecord { step: step.into(), ..TimeRecord::default() },
        None => TimeRecord { tolerance: time.tolerance.into(), ..TimeRecord::default() },
    };
    if let (None, Some(steps)) = (time.step, session.findings.steps.get(member.index())) {
        let (least, most) = steps.range();
        (out.shortest, out.longest) = (least.into(), most.into());
        (out.rejected, out.failed) = (Some(steps.report.rejected), Some(steps.report.failed));
    }
    out.step_error =
        at.solved.error.map(|StepError { error, time }| StepErrorRecord { largest: error.into(), t: time.into() });
    out
}
