//! The end of a command: expectations judged, the result written.

use crate::result::Missed;
use crate::run::error::{Exit, RunError};
use crate::run::outcome::Outcome;
use crate::run::session::Session;
use crate::run::session::findings::CommandFindings;
use crate::run::session::input::CommandInput;
use crate::run::states::States;
use crate::run::{motion, optimize, report};
use nastic_case::expectation;
use nastic_control::ControlError;
use nastic_language::number;
use nastic_report::record::{ExpectRecord, MissRecord, number_of};
use nastic_result::failure;

pub(crate) fn conclude(
    session: Session<'_>,
    exit: Result<Exit, RunError>,
    usual: bool,
) -> Result<(Outcome, Option<States>), RunError> {
    session.console.clear();
    match exit {
        Ok(exit) => close(session, exit, usual),
        Err(error) => {
            note_failure(session, &error);
            Err(error)
        }
    }
}

/// What went wrong takes the place of a result, so that no older one is taken for it.
fn note_failure(mut session: Session<'_>, error: &RunError) {
    session.finish_clock();
    session.findings.interrupted |=
        session.is_cancelled() || error.is_lack_of_memory() || matches!(error, RunError::Team(_));
    session.close(error.exit());
    session.findings.record.error = Some(error.to_string());
    if let RunError::Forward { member, error, file, .. } = error.cause() {
        if file.is_some() {
            session.list_files(vec!["failure.vtu".to_owned()]);
        }
        if let ControlError::State(state) = error.as_ref() {
            let one = session.input.problem.members().find(|one| one.name() == *member);
            session.findings.record.failure = one.map(|one| failure::record(one, state)).unwrap_or_default();
        }
    }
    // one that goes on and was stopped before it had anything of its own leaves what was found before
    if !matches!(error, RunError::Cancelled) {
        session.destination.leaves_results = false;
    }
    // The error itself is what the caller hears of.
    let _ = report::write_result(&mut session);
}

/// Wall time and memory.
fn say_effort(session: &Session<'_>) {
    let result = &session.findings.record;
    let seconds = number_of(&result.seconds, "total").unwrap_or(f64::NAN);
    let memory = match *result.peak_memory {
        Some(bytes) => format!(", at most {:.0} MB of memory", bytes as f64 / 1e6),
        None => String::new(),
    };
    session.console.say(format!("time        {}{memory}", nastic_report::duration(seconds)));
}

/// Judges expectations and writes the result.
fn close(mut session: Session<'_>, exit: Exit, usual: bool) -> Result<(Outcome, Option<States>), RunError> {
    let mut exit = exit;
    session.finish_clock();
    // a signal that came while complete results were written has interrupted nothing
    session.findings.interrupted |= session.is_cancelled() && exit != Exit::Done;
    let expect = &session.input.problem.case.expect;
    // What was interrupted is not held to its expectations.
    let expect =
        if session.findings.interrupted || session.input.options.without_expect { &Default::default() } else { expect };
    let (checked, missed) =
        expectation::judge(expect, &session.input.command, usual, &session.findings.record.to_json()?);
    for miss in &missed {
        session.console.say(format!("MISSED      {miss}"));
    }
    // They hold for the case as it is written; who overrides them means them.
    if !missed.is_empty() && session.input.options.set.iter().any(|setting| !setting.starts_with("expect")) {
        let aside = "--set 'expect={}' leaves its values aside";
        session.console.say(format!("{:<12}the case was changed by --set; {aside}", ""));
    }
    if checked > 0 && missed.is_empty() {
        session.console.say(format!("expect      {checked} of {checked} values as expected"));
    }
    let miss = |m: &Missed| MissRecord { path: m.path.clone(), found: m.found.into(), expected: m.expected.into() };
    session.findings.record.expect = Some(ExpectRecord { checked, missed: missed.iter().map(miss).collect() });
    if !missed.is_empty() && matches!(exit, Exit::Done | Exit::NotConverged) {
        exit = Exit::ExpectMissed;
    }
    let warnings = session.findings.warnings.len();
    if session.input.options.strict && warnings > 0 && exit == Exit::Done {
        session.console.say(format!("strict      {} under --strict: exit code 8", number::count(warnings, "warning")));
        exit = Exit::Warned;
    }
    session.close(exit);
    report::write_result(&mut session)?;
    optimize::record_end(&session)?;
    motion::record_end(&session)?;
    if let Some(out) = &session.destination.out {
        session.console.say(format!("results     {}", out.path().display()));
        let page = out.file(nastic_report::FILE);
        if page.exists() {
            session.console.say(format!("page        {}", page.display()));
        }
    }
    say_effort(&session);
    let Session { input: CommandInput { problem, .. }, findings: CommandFindings { shown, record, .. }, .. } = session;
    let outcome = Outcome { exit, result: record.to_json()?, record, missed };
    Ok((outcome, shown.map(|shown| States::new(problem, shown))))
}
