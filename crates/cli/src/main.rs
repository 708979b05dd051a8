//! The command line program `nastic`.

use nastic_language::catalogue::Catalogue;
use std::process::ExitCode;

fn main() -> ExitCode {
    nastic_cli::run(&Catalogue::standard())
}
