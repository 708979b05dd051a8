//! The command line program `nastic`.

mod arguments;
mod command;

use arguments::Arguments;
use clap::Parser;
use std::process::ExitCode;

fn main() -> ExitCode {
    command::run_arguments(Arguments::parse())
}
