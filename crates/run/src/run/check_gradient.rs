//! The short gradient check at every start of an optimisation, and of `nastic gradient`.

use crate::console::Console;
use crate::run::error::RunError;
use crate::run::session::{CommandFindings, CommandInput};
use nastic_ensemble::{EnsemblePoint, EnsembleWorkspace};
use nastic_opt::{Base, Certificate, TaylorError, Verdict};
use nastic_report::record::GradientCheckRecord;

/// Checks the derivative at an evaluated control; what it finds is said.
pub(super) fn check(
    input: &CommandInput,
    console: &Console,
    at: &EnsemblePoint,
    derivative: &[f64],
    workspace: &mut EnsembleWorkspace,
) -> Result<Certificate, RunError> {
    console.phase("gradient check");
    let problem = &input.problem;
    let size = crate::run::gradcheck::size(problem);
    let base = Base { m: &at.m, point: at, derivative, stage: 0 };
    let found = Certificate::of(&problem.ensemble, &problem.set, &base, workspace, size, problem.case.optimizer.seed);
    console.clear();
    if input.is_cancelled() {
        return Err(RunError::Cancelled);
    }
    let certificate = match found {
        Ok(certificate) => certificate,
        // The run itself will say what it needs a scale for.
        Err(TaylorError::NoDirection) => Certificate::undecided(),
        Err(error) => return Err(error.into()),
    };
    console.say(format!("gradient    {certificate}"));
    if certificate.verdict == Verdict::Wrong {
        if let Some(full) = &certificate.full {
            console.say(full);
        }
        let how = match input.problem.case_file() {
            Some(_) => "nastic gradcheck shows which term is at fault",
            None => "test each cost alone with Taylor::test",
        };
        console.say(format!("The derivative does not belong to the cost here: {how}."));
        console.say("A cost with a kink at the start (target and body on the same points) fails this check too.");
    }
    Ok(certificate)
}

/// As [`check`], at the start as written: noted in the result.
pub(super) fn of_start(
    input: &CommandInput,
    console: &Console,
    findings: &mut CommandFindings,
    start: &EnsemblePoint,
    derivative: &[f64],
    workspace: &mut EnsembleWorkspace,
) -> Result<Certificate, RunError> {
    let check = |_: &mut CommandFindings| check(input, console, start, derivative, workspace);
    let certificate = findings.timed(console, "gradient_check", check)?;
    findings.record.gradient_check = record(&certificate);
    Ok(certificate)
}

/// The entry of a result.
pub(super) fn record(certificate: &Certificate) -> GradientCheckRecord {
    GradientCheckRecord { verdict: Some(certificate.verdict.to_string()), mismatch: certificate.mismatch.into() }
}
