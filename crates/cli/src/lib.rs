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
mod figure;
mod key_tables;
mod output;

use arguments::Arguments;
use clap::Parser;
use nastic_language::catalogue::Catalogue;
use std::process::ExitCode;

/// Runs what was typed, with the names of this catalogue: the whole of the program `nastic`. Arguments that cannot be
/// understood end the process with code 2, `--help` and `--version` with 0.
pub fn run(catalogue: &Catalogue) -> ExitCode {
    command::run_arguments(Arguments::parse(), catalogue)
}
