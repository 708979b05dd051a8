//! The command line program `nastic`.

use nastic_case::catalogue::Catalogue;
use std::process::ExitCode;

fn main() -> ExitCode {
    nastic_cli::run(&Catalogue::standard())
}
