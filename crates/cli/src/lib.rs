//! The command line of nastic as a function, so that a program of your own can add laws, actuations and costs to it:
//!
//! ```no_run
//! use nastic_language::catalogue::Catalogue;
//!
//! fn main() -> std::process::ExitCode {
//!     nastic_cli::run(&Catalogue::standard()) // .with_material(&MY_LAW)
//! }
//! ```
//!
//! `examples/own_program.rs` is such a program.

mod arguments;
mod command;
mod compare;
mod figure;
mod key_tables;
mod output;
mod remesh;

use arguments::Arguments;
use clap::Parser;
use command::Program;
use nastic_language::catalogue::Catalogue;
use nastic_team::Team;
use std::process::ExitCode;
use std::sync::Arc;

/// How a rank has ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Ended {
    /// The exit code; 0 of any rank but the first, unless it has failed, and of a sweep that of the first.
    pub code: u8,
    /// Why it has no result. The first rank has said it.
    pub error: Option<String>,
}

/// Runs what was typed, with the names of this catalogue: the whole of the program `nastic`. Arguments that cannot be
/// understood end the process with code 2, `--help` and `--version` with 0.
pub fn run(catalogue: &Catalogue) -> ExitCode {
    ExitCode::from(Program::new(catalogue, None).run(Arguments::parse()).code)
}

/// The same on one rank of a team, all of which were given the same arguments. The first one speaks and writes; commands that are not shared out
/// over ranks are run by it alone, or refused.
pub fn run_on(catalogue: &Catalogue, team: Arc<dyn Team>) -> Ended {
    match Arguments::try_parse() {
        Ok(arguments) => Program::new(catalogue, Some(team)).run(arguments),
        Err(error) => {
            if team.leads() {
                let _ = error.print();
            }
            let code = if !team.leads() { 0 } else { u8::try_from(error.exit_code()).unwrap_or(2) };
            Ended { code, error: None }
        }
    }
}
