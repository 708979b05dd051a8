//! The end of a command: expectations judged, the result written.

use crate::console::Console;
use crate::result::Missed;
use crate::run::error::{Exit, RunError};
use crate::run::outcome::Outcome;
use crate::run::session::{CommandFindings, Opened};
use crate::run::states::States;
use crate::run::{motion, optimize, report};
use nastic_case::expectation;
use nastic_control::ControlError;
use nastic_language::number;
use nastic_report::record::{ExpectRecord, MissRecord, RunRecord, number_of};
use nastic_result::failure;

pub(crate) fn conclude(
    opened: Opened<'_>,
    exit: Result<Exit, RunError>,
    usual: bool,
) -> Result<(Outcome, Option<States>), RunError> {
    opened.console.clear();
    match exit {
        Ok(exit) => close(opened, exit, usual),
        Err(error) => {
            note_failure(opened, &error);
            Err(error)
        }
    }
}

/// What went wrong takes the place of a result, so that no older one is taken for it.
fn note_failure(opened: Opened<'_>, error: &RunError) {
    let Opened { input, mut destination, mut findings, .. } = opened;
    findings.finish_clock();
    findings.interrupted |= input.is_cancelled() || error.is_lack_of_memory() || matches!(error, RunError::Team(_));
    findings.close(error.exit());
    findings.record.error = Some(error.to_string());
    if let RunError::Forward { member, error, file, .. } = error.cause() {
        if file.is_some() {
            findings.list_files(vec!["failure.vtu".to_owned()]);
        }
        if let ControlError::State(state) = error.as_ref() {
            let one = input.problem.members().find(|one| one.name() == *member);
            findings.record.failure = one.map(|one| failure::record(one, state)).unwrap_or_default();
        }
    }
    // one that goes on and was stopped before it had anything of its own leaves what was found before
    if !matches!(error, RunError::Cancelled) {
        destination.leaves_results = false;
    }
    // The error itself is what the caller hears of.
    let _ = report::write_result(&input, &destination, &mut findings);
}

/// Wall time and memory.
fn say_effort(console: &Console, result: &RunRecord) {
    let seconds = number_of(&result.seconds, "total").unwrap_or(f64::NAN);
    let memory = match *result.peak_memory {
        Some(bytes) => format!(", at most {:.0} MB of memory", bytes as f64 / 1e6),
        None => String::new(),
    };
    console.say(format!("time        {}{memory}", nastic_report::duration(seconds)));
}

/// Judges expectations and writes the result.
fn close(opened: Opened<'_>, mut exit: Exit, usual: bool) -> Result<(Outcome, Option<States>), RunError> {
    let Opened { input, destination, console, mut findings } = opened;
    findings.finish_clock();
    // a signal that came while complete results were written has interrupted nothing
    findings.interrupted |= input.is_cancelled() && exit != Exit::Done;
    let expect = &input.problem.case.expect;
    // What was interrupted is not held to its expectations.
    let expect = if findings.interrupted || input.options.without_expect { &Default::default() } else { expect };
    let (checked, missed) = expectation::judge(expect, &input.command, usual, &findings.record.to_json()?);
    for miss in &missed {
        console.say(format!("MISSED      {miss}"));
    }
    // They hold for the case as it is written; who overrides them means them.
    if !missed.is_empty() && input.options.set.iter().any(|setting| !setting.starts_with("expect")) {
        let aside = "--set 'expect={}' leaves its values aside";
        console.say(format!("{:<12}the case was changed by --set; {aside}", ""));
    }
    if checked > 0 && missed.is_empty() {
        console.say(format!("expect      {checked} of {checked} values as expected"));
    }
    let miss = |m: &Missed| MissRecord { path: m.path.clone(), found: m.found.into(), expected: m.expected.into() };
    findings.record.expect = Some(ExpectRecord { checked, missed: missed.iter().map(miss).collect() });
    if !missed.is_empty() && matches!(exit, Exit::Done | Exit::NotConverged) {
        exit = Exit::ExpectMissed;
    }
    let warnings = findings.warnings.len();
    if input.options.strict && warnings > 0 && exit == Exit::Done {
        console.say(format!("strict      {} under --strict: exit code 8", number::count(warnings, "warning")));
        exit = Exit::Warned;
    }
    findings.close(exit);
    report::write_result(&input, &destination, &mut findings)?;
    optimize::record_end(&destination, &findings)?;
    motion::record_end(&input, &destination)?;
    if let Some(out) = &destination.out {
        console.say(format!("results     {}", out.path().display()));
        let page = out.file(nastic_report::FILE);
        if page.exists() {
            console.say(format!("page        {}", page.display()));
        }
    }
    say_effort(console, &findings.record);
    let CommandFindings { shown, record, .. } = findings;
    let outcome = Outcome { exit, result: record.to_json()?, record, missed };
    Ok((outcome, shown.map(|shown| States::new(input.problem, shown))))
}
