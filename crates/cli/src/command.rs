//! From arguments to an exit code.

use crate::Ended;
use crate::arguments::{
    self, Arguments, Case, Command, Diagnosis, Fit, Identify, Modes, New, Optimize, Report, Resume, Running, Schema,
    StopAt, Sweep, SweptCommand,
};
use crate::key_tables;
use crate::output::{self, Output};
use crate::remesh::Remesh;
use nastic_language::catalogue::Catalogue;
use nastic_language::schema;
use nastic_language::syntax::Diagnostic;
use nastic_language::template::{Template, TemplateError};
use nastic_remesh::RemeshError;
use nastic_run::console::Console;
use nastic_run::record::{ErrorRecord, ProblemRecord, RunRecord};
use nastic_run::run;
use nastic_run::run::{
    Analysis, Exit, LoneTable, ModesRequest, Options, Outcome, Part, RunError, Share, SpectrumRequest, report, resume,
    run_with, sweep,
};
use nastic_run::signals::cancelled_by_signals;
use nastic_team::Team;
use serde::Serialize;
use std::io::{IsTerminal, Write, stderr};
use std::path::PathBuf;
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, OnceLock};
use std::time::Duration;

/// The program, on one rank of a team or alone.
pub(crate) struct Program<'c> {
    catalogue: &'c Catalogue,
    team: Option<Arc<dyn Team>>,
    /// Why there is no result.
    error: OnceLock<String>,
}

impl<'c> Program<'c> {
    pub fn new(catalogue: &'c Catalogue, team: Option<Arc<dyn Team>>) -> Self {
        Self { catalogue, team, error: OnceLock::new() }
    }

    pub fn run(&self, arguments: Arguments) -> Ended {
        let code = if self.leads() || is_shared(&arguments.command) { self.run_command(arguments) } else { 0 };
        // what stands in a buffer is lost silently otherwise
        let _ = Output.flush();
        let code = match output::failure() {
            Some(why) => {
                complain(&format!("standard output could not be written ({why}): what was printed is incomplete"));
                Exit::NotWritten.code()
            }
            None => code,
        };
        Ended { code, error: self.error.get().cloned() }
    }

    /// Whether it speaks.
    fn leads(&self) -> bool {
        self.team.as_ref().is_none_or(|team| team.leads())
    }

    fn run_command(&self, arguments: Arguments) -> u8 {
        let on_case = |command, case: &Case| self.on_case(command, case, Asked::default());
        match arguments.command {
            Command::New(new) => begin(&new),
            Command::Check(case) => on_case(schema::Command::Check, &case),
            Command::Solve(solve) => {
                let analysis = match analysis(&solve.analysis) {
                    Analysis::Path if solve.stop_at == Some(StopAt::Limit) => Analysis::PathToLimit,
                    other => other,
                };
                let asked = Asked { analysis, restart: solve.restart, ..Asked::default() };
                self.on_case(schema::Command::Solve, &solve.case, asked)
            }
            Command::Modes(Modes { case, count, undeformed }) => {
                let modes = ModesRequest { count: count.into(), undeformed };
                self.on_case(schema::Command::Modes, &case, Asked { modes, ..Asked::default() })
            }
            Command::Gradient(case) => on_case(schema::Command::Gradient, &case),
            Command::Gradcheck(case) => on_case(schema::Command::Gradcheck, &case),
            Command::Optimize(Optimize { case, restart, part, join, diagnosis }) => {
                let (spectrum, share) = (spectrum(&diagnosis), share(part, join));
                self.on_case(schema::Command::Optimize, &case, Asked { restart, spectrum, share, ..Asked::default() })
            }
            Command::Identify(Identify { case, restart }) => {
                self.on_case(schema::Command::Identify, &case, Asked { restart, ..Asked::default() })
            }
            Command::Gains(case) => on_case(schema::Command::Gains, &case),
            Command::Resume(interrupted) => self.on_directory(&interrupted),
            Command::Sweep(swept) => self.on_values(&swept),
            Command::Fit(data) => self.on_data(&data),
            Command::Remesh(asked) => self.on_design(&asked),
            Command::Report(folder) => on_results(&folder),
            Command::Figure(figure) => figure.draw(),
            Command::Compare(compare) => compare.run(),
            Command::Cloud(cloud) => cloud.run(),
            Command::Schema(wanted) => {
                say_schema(self.catalogue, &wanted);
                0
            }
        }
    }

    fn on_case(&self, command: schema::Command, case: &Case, asked: Asked) -> u8 {
        let (name, running) = (command.name(), &case.running);
        let options = self.options(case, asked);
        let console = self.console(running);
        let outcome = run_with(self.catalogue, command, &case.case, &options, &console);
        console.finish();
        self.answer(name, running, outcome)
    }

    fn options(&self, case: &Case, asked: Asked) -> Options {
        let running = &case.running;
        Options {
            out: case.out.clone(),
            set: case.settings.clone(),
            analysis: asked.analysis,
            modes: asked.modes,
            restart: asked.restart,
            spectrum: asked.spectrum,
            share: asked.share,
            team: self.team.clone(),
            cancel: self.cancelled_by_signals(),
            ..running_options(running)
        }
    }

    /// Raised by Ctrl-C, which the first rank answers.
    fn cancelled_by_signals(&self) -> Arc<AtomicBool> {
        let leads = self.leads();
        cancelled_by_signals(move |shown| {
            if leads {
                complain(shown);
            }
        })
    }

    /// Runs a case for several values.
    fn on_values(&self, Sweep { case, command, warm, quantity, restart, part, join }: &Sweep) -> u8 {
        let command = match command {
            SweptCommand::Optimize => schema::Command::Optimize,
            SweptCommand::Solve => schema::Command::Solve,
        };
        let options = self.options(case, Asked { restart: *restart, share: share(*part, *join), ..Asked::default() });
        let asked = run::Sweep { command, warm: *warm, quantity: quantity.clone() };
        let console = self.console(&case.running);
        let outcome = sweep(self.catalogue, &asked, &case.case, &options, &console);
        console.finish();
        match outcome {
            Ok(outcome) => {
                if case.running.json && self.leads() {
                    print(&outcome.result);
                }
                outcome.exit.code()
            }
            Err(error) => self.failed("sweep", &case.running, &error),
        }
    }

    fn on_directory(&self, Resume { directory, diagnosis, running }: &Resume) -> u8 {
        let options = Options {
            spectrum: spectrum(diagnosis),
            team: self.team.clone(),
            cancel: self.cancelled_by_signals(),
            ..running_options(running)
        };
        let console = self.console(running);
        let outcome = resume(self.catalogue, directory, &options, &console);
        console.finish();
        self.answer("resume", running, outcome)
    }

    /// Meshes a cut design along its outline.
    fn on_design(&self, asked: &Remesh) -> u8 {
        let running = &asked.running;
        let options = Options { cancel: self.cancelled_by_signals(), ..running_options(running) };
        let console = self.console(running);
        let outcome = nastic_remesh::remesh(self.catalogue, &asked.request(options), &console);
        console.finish();
        match outcome {
            Ok((remeshed, exit)) => {
                if running.json {
                    print(&remeshed);
                }
                exit.code()
            }
            Err(RemeshError::Run(error)) => self.failed("remesh", running, &error),
            Err(error) => {
                let (exit, error) = (error.exit().code(), error.to_string());
                complain(&error);
                if running.json {
                    let command = "remesh".to_owned();
                    print(&ErrorRecord { command, exit, error, problems: None, last_good_state: None });
                }
                exit
            }
        }
    }

    /// Fits laws to test data.
    fn on_data(&self, Fit { data, table, out, quiet, json }: &Fit) -> u8 {
        let (quiet, json) = (*quiet, *json);
        let running =
            Running { threads: None, strict: false, no_report: true, figure: false, explain: false, quiet, json };
        let arguments::Table { kind, bulk, area, length, laws } = table.clone();
        let table = LoneTable { kind, bulk, area, length, laws };
        let console = self.console(&running);
        let outcome = run::fit_with(data, &table, out.clone(), &console);
        console.finish();
        match outcome {
            Ok(outcome) => {
                if json {
                    print(&outcome.result);
                }
                outcome.exit.code()
            }
            Err(error) => self.failed("fit", &running, &error),
        }
    }

    /// Prints what is asked for and gives the exit code.
    fn answer(&self, command: &str, running: &Running, outcome: Result<Outcome, RunError>) -> u8 {
        match outcome {
            Ok(_) if !self.leads() => 0,
            Ok(outcome) => {
                if running.json {
                    print(&outcome.result);
                } else if running.quiet {
                    outcome.missed.iter().for_each(|missed| complain(&format!("expectation missed: {missed}")));
                }
                if let (true, Some(error)) = (running.json || running.quiet, outcome.result["error"].as_str()) {
                    complain(error);
                }
                outcome.exit.code()
            }
            Err(error) => self.failed(command, running, &error),
        }
    }

    /// Says why a command has no result.
    fn failed(&self, command: &str, running: &Running, error: &RunError) -> u8 {
        if self.leads() {
            if running.json {
                print(&record(command, error));
            }
            print_error(error);
        }
        let _ = self.error.set(error.to_string());
        error.exit().code()
    }

    /// Text for people goes to standard output, what passes to a terminal on standard error.
    fn console(&self, running: &Running) -> Console {
        if running.quiet || !self.leads() {
            return Console::silent();
        }
        with_progress(if running.json { Console::silent() } else { Console::new(Output) })
    }
}

/// A console that shows on standard error what is done at the moment: on a terminal a line that passes, elsewhere one a minute.
fn with_progress(console: Console) -> Console {
    const MINUTE: Duration = Duration::from_secs(60);
    match stderr().is_terminal() {
        true => console.with_passing(stderr()).refreshed(),
        false => console.with_log(stderr(), MINUTE),
    }
}

/// Does something that reads or draws results, and shows that while it lasts.
pub(crate) fn while_shown<T>(what: &str, work: impl FnOnce(&Console) -> T) -> T {
    let console = with_progress(Console::silent());
    console.phase(what);
    let out = work(&console);
    console.finish();
    out
}

/// Whether all ranks have a part in it; else they get the message that they have none.
fn is_shared(command: &Command) -> bool {
    use Command::{Gains, Gradcheck, Gradient, Identify, Modes, Optimize, Resume, Solve, Sweep};
    matches!(
        command,
        Optimize(_) | Identify(_) | Gains(_) | Resume(_) | Sweep(_) | Solve(_) | Modes(_) | Gradient(_) | Gradcheck(_)
    )
}

/// The JSON Schema of cases or of results, or its tables of keys.
fn say_schema(catalogue: &Catalogue, &Schema { results, markdown }: &Schema) {
    let (schema, title, how) = match results {
        true => (RunRecord::schema(), "Keys of results", "nastic schema --results --markdown"),
        false => (schema::json_schema(catalogue), "Keys of case files", "nastic schema --markdown"),
    };
    if markdown {
        let _ = write!(Output, "{}", key_tables::markdown(&schema, title, how));
    } else {
        print(&schema);
    }
}

/// Writes a case to begin with, and says what to type next.
fn begin(New { directory, template }: &New) -> u8 {
    match Template::named(template).and_then(|template| template.write(directory)) {
        Ok(case) => {
            let case = case.display();
            let _ = writeln!(
                Output,
                "written     {case}\nnext        nastic check {case}\n            nastic optimize {case}"
            );
            0
        }
        Err(error) => {
            complain(&error.to_string());
            let exit = if matches!(error, TemplateError::Write(_)) { Exit::NotWritten } else { Exit::BadInput };
            exit.code()
        }
    }
}

/// How to run.
fn running_options(running: &Running) -> Options {
    Options {
        threads: running.threads.map(usize::from),
        strict: running.strict,
        no_report: running.no_report,
        figure: running.figure,
        explain: running.explain,
        ..Options::default()
    }
}

/// What solve is asked for.
fn analysis(asked: &arguments::Analysis) -> Analysis {
    match asked {
        arguments::Analysis { modes: Some(count), .. } => Analysis::Modes((*count).into()),
        arguments::Analysis { ramp: Some(ramp), .. } => Analysis::Ramp(ramp.clone()),
        arguments::Analysis { path: true, .. } => Analysis::Path,
        arguments::Analysis { minimum: true, .. } => Analysis::Minimum,
        arguments::Analysis { exact_contact: true, .. } => Analysis::ExactContact,
        arguments::Analysis { half_thickness: true, .. } => Analysis::HalfThickness,
        arguments::Analysis { equilibria: Some(count), .. } => Analysis::Equilibria((*count).into()),
        _ => Analysis::Equilibrium,
    }
}

/// What is to be found of an optimum.
fn spectrum(asked: &Diagnosis) -> Option<SpectrumRequest> {
    asked.spectrum.map(|count| SpectrumRequest { count: count.into(), cost_rise: asked.cost_rise })
}

/// What single commands are asked for.
#[derive(Default)]
struct Asked {
    analysis: Analysis,
    modes: ModesRequest,
    restart: bool,
    spectrum: Option<SpectrumRequest>,
    share: Share,
}

/// What of several runs is done.
fn share(part: Option<Part>, join: bool) -> Share {
    match part {
        Some(part) => Share::Part(part),
        None if join => Share::Join,
        None => Share::Whole,
    }
}

/// Makes the page of a result directory and says where it is.
fn on_results(Report { directory, out }: &Report) -> u8 {
    written(while_shown("making the page", |_| report(directory, out.as_deref())))
}

/// Says where a file went, or why there is none.
pub(crate) fn written(file: Result<PathBuf, RunError>) -> u8 {
    answered(file, |file| {
        let _ = writeln!(Output, "{}", file.display());
    })
}

/// Says what there is, or why there is nothing.
pub(crate) fn answered<T>(found: Result<T, RunError>, say: impl FnOnce(T)) -> u8 {
    match found {
        Ok(found) => {
            say(found);
            0
        }
        Err(error) => {
            print_error(&error);
            error.exit().code()
        }
    }
}

fn print_error(error: &RunError) {
    match error {
        RunError::Input(problems) => {
            problems.list().iter().for_each(|problem| complain(&problem.to_string()));
            match problems.list().len() {
                n if problems.has_more() => complain(&format!("the first {n} problems; there are more")),
                0 | 1 => {}
                n => complain(&format!("{n} problems")),
            }
        }
        other => complain(&other.to_string()),
    }
}

fn record(command: &str, error: &RunError) -> ErrorRecord {
    let problem = |p: &Diagnostic| {
        let Diagnostic { file, path, line, column, message } = p.clone();
        ProblemRecord { file, path, line, column, message }
    };
    let problems = match error {
        RunError::Input(problems) => Some(problems.list().iter().map(problem).collect()),
        _ => None,
    };
    let last_good_state = match error.cause() {
        RunError::Forward { file: Some(file), .. } if error.exit() == Exit::ForwardFailed => {
            Some(file.display().to_string())
        }
        _ => None,
    };
    let (command, exit) = (command.to_owned(), error.exit().code());
    ErrorRecord { command, exit, error: error.to_string(), problems, last_good_state }
}

/// Writes JSON to standard output; a reader who left does not matter.
fn print(value: &impl Serialize) {
    let text = serde_json::to_string_pretty(value).unwrap_or_default();
    let _ = writeln!(Output, "{text}");
}

fn complain(message: &str) {
    let _ = writeln!(stderr().lock(), "nastic: {message}");
}
