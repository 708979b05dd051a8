//! A program that adds a law of its own to the command line.

#![allow(clippy::unwrap_used, clippy::panic)] // a test may

use std::path::PathBuf;
use std::process::{Command, Output};

const BAR: &str = include_str!("../../language/tests/cases/bar.json");

fn own_program(directory: &tempfile::TempDir, arguments: &[&str]) -> Output {
    let test = std::env::current_exe().unwrap();
    let folder: PathBuf = test.parent().and_then(std::path::Path::parent).unwrap().join("examples");
    let program = folder.join("own_program");
    let output = Command::new(&program).args(arguments).current_dir(directory.path()).output();
    output.unwrap_or_else(|e| panic!("{}: {e}; run the whole `cargo test -p nastic-cli`", program.display()))
}

/// The bar of the other tests, of the added law.
fn case() -> (tempfile::TempDir, String) {
    let law = r#""law": "log_volume", "mu": "120 kPa", "kappa": "1 MPa""#;
    let start = BAR.find(r#""law""#).unwrap();
    let end = start + BAR[start..].find('}').unwrap();
    let case = format!("{}{law} {}", &BAR[..start], &BAR[end..]);
    let directory = tempfile::tempdir().unwrap();
    std::fs::write(directory.path().join("case.json"), &case).unwrap();
    (directory, case)
}

#[test]
fn a_law_of_ones_own_is_solved_checked_and_described() {
    let (directory, _) = case();
    for command in ["check", "solve", "gradcheck"] {
        let output = own_program(&directory, &[command, "case.json"]);
        let said = String::from_utf8_lossy(&output.stderr).into_owned() + &String::from_utf8_lossy(&output.stdout);
        assert_eq!(output.status.code(), Some(0), "{command}: {said}");
    }
    let schema = own_program(&directory, &["schema"]).stdout;
    let schema = String::from_utf8(schema).unwrap();
    assert!(schema.contains("log_volume") && schema.contains("mooney_rivlin"));
    let output = own_program(&directory, &["check", "case.json", "--set", "materials/0/kapa=1"]);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.code() == Some(2) && said.contains("did you mean \"kappa\"?"), "{said}");
}

#[test]
fn the_program_itself_does_not_know_it() {
    let (directory, _) = case();
    let mut program = Command::new(env!("CARGO_BIN_EXE_nastic"));
    let output = program.args(["check", "case.json"]).current_dir(directory.path()).output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.code() == Some(2) && said.contains("unknown law \"log_volume\""), "{said}");
}
