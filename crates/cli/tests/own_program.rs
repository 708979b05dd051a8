//! A program that adds a law, an actuation and a contribution of its own to the command line.

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

/// The bar bent by fibres that the program adds, at the angle 0 those of the other tests; and held back by a band.
#[test]
fn an_actuation_and_a_contribution_of_ones_own_act_as_the_built_in_ones() {
    let (directory, _) = case();
    let fibers = r#""kind": "fiber_tension", "region": "body", "direction": [1, 0, 0]"#;
    let turned =
        |angle: &str| BAR.replace(fibers, &format!(r#""kind": "turned_fibers", "region": "body", "angle": {angle}"#));
    let band = r#"{ "name": "strap", "kind": "band", "points": [[0, 0, 0.25], [1, 0, 0.25]], "stiffness": "10 kN/m" }"#;
    let banded = turned("0").replace(r#""actuation": ["#, &format!(r#""actuation": [ {band},"#));
    let solve = |text: &str| {
        assert!(text != BAR, "nothing was replaced");
        std::fs::write(directory.path().join("case.json"), text).unwrap();
        let output = own_program(&directory, &["solve", "case.json", "--json"]);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(0), "{said}");
        serde_json::from_slice::<serde_json::Value>(&output.stdout).unwrap()
    };
    let known = solve(&format!("{BAR}\n"));
    let tip = |result: &serde_json::Value| result["probes"]["tip"]["displacement"].to_string();
    assert_eq!(tip(&solve(&turned("0"))), tip(&known));
    assert_ne!(tip(&solve(&turned("0.3"))), tip(&known));
    let held = solve(&banded);
    let strap = &held["contributions"]["strap"];
    let [force, length] = ["force", "length"].map(|what| strap[what].as_f64().unwrap());
    assert!(force != 0.0 && (force - 1e4 * (length - 1.0)).abs() < 1e-9 * force.abs().max(1.0), "{strap}");
    assert_ne!(tip(&held), tip(&known));
    let said = String::from_utf8(own_program(&directory, &["schema"]).stdout).unwrap();
    assert!(said.contains("turned_fibers") && said.contains("an elastic band between two points"));
    let alone = banded.replace("[0, 0, 0.25], [1, 0, 0.25]", "[0, 0, 0.25]");
    std::fs::write(directory.path().join("case.json"), alone).unwrap();
    let refused = own_program(&directory, &["check", "case.json"]);
    let said = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert!(refused.status.code() == Some(2) && said.contains("strap has 1 points; a band has two"), "{said}");
}

#[test]
fn the_program_itself_does_not_know_it() {
    let (directory, _) = case();
    let mut program = Command::new(env!("CARGO_BIN_EXE_nastic"));
    let output = program.args(["check", "case.json"]).current_dir(directory.path()).output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.code() == Some(2) && said.contains("unknown law \"log_volume\""), "{said}");
}
