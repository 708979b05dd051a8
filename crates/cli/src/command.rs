//! From arguments to an exit code.

use crate::arguments::{self, Arguments, Case, Command};
use nastic_case::catalogue::Catalogue;
use nastic_case::console::Console;
use nastic_case::run::{Analysis, Exit, Options, RunError, run_with};
use nastic_case::schema;
use serde_json::{Value, json};
use std::io::{IsTerminal, Write, stderr, stdout};
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Exit code of a program killed by Ctrl-C, by convention.
const KILLED: i32 = 130;

pub(crate) fn run_arguments(arguments: Arguments, catalogue: &Catalogue) -> ExitCode {
    let on_case = |command, case: &Case| on_case(catalogue, command, case, Analysis::default());
    match arguments.command {
        Command::Check(case) => on_case(schema::Command::Check, &case),
        Command::Solve(solve) => {
            self::on_case(catalogue, schema::Command::Solve, &solve.case, analysis(&solve.analysis))
        }
        Command::Gradient(case) => on_case(schema::Command::Gradient, &case),
        Command::Gradcheck(case) => on_case(schema::Command::Gradcheck, &case),
        Command::Optimize(case) => on_case(schema::Command::Optimize, &case),
        Command::Schema => {
            print(&schema::json_schema(catalogue));
            ExitCode::SUCCESS
        }
    }
}

/// What solve is asked for.
fn analysis(asked: &arguments::Analysis) -> Analysis {
    match asked {
        arguments::Analysis { modes: Some(count), .. } => Analysis::Modes((*count).into()),
        arguments::Analysis { ramp: Some(ramp), .. } => Analysis::Ramp(ramp.clone()),
        arguments::Analysis { path: true, .. } => Analysis::Path,
        arguments::Analysis { minimum: true, .. } => Analysis::Minimum,
        arguments::Analysis { equilibria: Some(count), .. } => Analysis::Equilibria((*count).into()),
        _ => Analysis::Equilibrium,
    }
}

fn on_case(catalogue: &Catalogue, command: schema::Command, case: &Case, analysis: Analysis) -> ExitCode {
    let name = command.name();
    let options = Options {
        out: case.out.clone(),
        threads: case.threads.map(usize::from),
        set: case.settings.clone(),
        analysis,
        cancel: cancelled_by_ctrl_c(),
    };
    let outcome = run_with(catalogue, command, &case.case, &options, &console(case));
    match outcome {
        Ok(outcome) => {
            if case.json {
                print(&outcome.result);
            } else if case.quiet {
                outcome.missed.iter().for_each(|missed| complain(&format!("expectation missed: {missed}")));
            }
            if let (true, Some(error)) = (case.json || case.quiet, outcome.result["error"].as_str()) {
                complain(error);
            }
            ExitCode::from(outcome.exit.code())
        }
        Err(error) => {
            if case.json {
                print(&as_json(name, &error));
            }
            tell(&error);
            ExitCode::from(error.exit().code())
        }
    }
}

/// Text for people goes to standard output, what passes to a terminal on standard error.
fn console(case: &Case) -> Console {
    if case.quiet {
        return Console::silent();
    }
    let console = if case.json { Console::silent() } else { Console::new(stdout()) };
    if stderr().is_terminal() { console.with_passing(stderr()) } else { console }
}

/// A flag that the first Ctrl-C raises; the second ends the program.
fn cancelled_by_ctrl_c() -> Arc<AtomicBool> {
    let flag = Arc::new(AtomicBool::new(false));
    let raised = flag.clone();
    let handler = move || {
        if raised.swap(true, Ordering::Relaxed) {
            std::process::exit(KILLED);
        }
        complain("stopping after the step at hand; press Ctrl-C again to stop at once");
    };
    // Without a handler Ctrl-C ends the program, which is what it did before.
    let _ = ctrlc::set_handler(handler);
    flag
}

fn tell(error: &RunError) {
    match error {
        RunError::Input(problems) => {
            problems.list().iter().for_each(|problem| complain(&problem.to_string()));
            if let n @ 2.. = problems.list().len() {
                complain(&format!("{n} problems"));
            }
        }
        other => complain(&other.to_string()),
    }
}

fn as_json(command: &str, error: &RunError) -> Value {
    let mut out = json!({ "command": command, "exit": error.exit().code(), "error": error.to_string() });
    if let RunError::Input(problems) = error {
        let list = problems.list().iter().map(
            |p| json!({ "file": p.file, "path": p.path, "line": p.line, "column": p.column, "message": p.message }),
        );
        out["problems"] = list.collect();
    }
    if error.exit() == Exit::ForwardFailed
        && let RunError::Forward { file: Some(file), .. } = error
    {
        out["last_good_state"] = json!(file.display().to_string());
    }
    out
}

/// Writes JSON to standard output; a reader who left does not matter.
fn print(value: &Value) {
    let _ = writeln!(stdout().lock(), "{value:#}");
}

fn complain(message: &str) {
    let _ = writeln!(stderr().lock(), "nastic: {message}");
}
