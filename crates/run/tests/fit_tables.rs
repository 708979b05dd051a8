//! `nastic fit` of tables alone, and of what a testing machine writes: forces and extensions.
#![allow(clippy::unwrap_used)] // a test may

use nastic_run::console::Console;
use nastic_run::run::{LoneTable, RunError, fit, fit_with};
use serde_json::{Value, json};
use std::fs;
use std::path::Path;

const AREA: f64 = 12.5e-6;
const LENGTH: f64 = 0.033;
const SHEAR: f64 = 60e3;

/// Neo-Hookean tension, as the machine says it (mm, N) or as stretch and stress.
fn rows(machine: bool) -> String {
    let of = |k: u32| {
        let l = 1.0 + 0.1 * f64::from(k);
        let stress = SHEAR * (l - l.powi(-2));
        if machine {
            format!("{k},{:?},{:?}\n", 1e3 * LENGTH * (l - 1.0), stress * AREA)
        } else {
            format!("{k},{l:?},{stress:?}\n")
        }
    };
    let head = if machine { "reading,extension [mm],force [N]" } else { "reading,stretch,nominal_stress [Pa]" };
    format!("{head}\n{}", (1..12).map(of).collect::<String>())
}

fn table(bulk: &str) -> LoneTable {
    LoneTable { bulk: Some(bulk.to_owned()), laws: vec!["neo_hooke_isochoric".to_owned()], ..LoneTable::default() }
}

fn of_machine() -> LoneTable {
    LoneTable { area: Some("12.5 mm^2".to_owned()), length: Some("33 mm".to_owned()), ..table("3 MPa") }
}

fn shear(found: &Value) -> f64 {
    found["laws"][0]["parameters"]["shear"]["value"].as_f64().unwrap()
}

fn refusal(file: &Path, table: &LoneTable) -> String {
    match fit_with(file, table, None, &Console::silent()) {
        Err(RunError::Input(problems)) => problems.list().iter().map(|problem| format!("{problem}\n")).collect(),
        other => format!("{other:?}"),
    }
}

#[test]
fn a_table_alone_is_a_test() {
    let directory = tempfile::tempdir().unwrap();
    let file = directory.path().join("bar.csv");
    fs::write(&file, rows(false)).unwrap();
    let found = fit_with(&file, &table("3 MPa"), None, &Console::silent()).unwrap().result;
    assert!((shear(&found) / SHEAR - 1.0).abs() < 1e-9, "{found}");
    assert_eq!((&found["tests"][0]["name"], &found["laws"][0]["bulk"]["value"]), (&json!("bar"), &json!(3e6)));
    assert!(directory.path().join("out/bar/fit.json").exists());
    // the planar test of the same numbers is another one: l - l^-3 of a wide strip
    let strip = LoneTable { kind: Some("planar".to_owned()), ..table("3 MPa") };
    assert!(shear(&fit_with(&file, &strip, None, &Console::silent()).unwrap().result) < 0.99 * SHEAR);
    let error = refusal(&file, &LoneTable::default());
    assert!(error.contains("bar.csv: bulk: a table alone has no bulk modulus: give --bulk"), "{error}");
    let data = directory.path().join("data.json");
    fs::write(&data, "{}").unwrap();
    assert!(refusal(&data, &table("1 GPa")).contains("--laws are of CSV files"), "{}", refusal(&data, &table("1 GPa")));
}

#[test]
fn forces_and_extensions_become_stresses_and_stretches() {
    let directory = tempfile::tempdir().unwrap();
    let file = directory.path().join("machine.csv");
    fs::write(&file, rows(true)).unwrap();
    let alone = fit_with(&file, &of_machine(), None, &Console::silent()).unwrap().result;
    assert!((shear(&alone) / SHEAR - 1.0).abs() < 1e-9, "{alone}");
    // the same in a data file
    let test = json!({ "kind": "uniaxial", "file": "machine.csv", "area": "12.5 mm^2", "length": "3.3 cm" });
    let data = json!({ "nastic_fit": 1, "tests": [test], "laws": ["neo_hooke_isochoric"], "bulk": "3 MPa" });
    let named = directory.path().join("data.json");
    fs::write(&named, data.to_string()).unwrap();
    let found = fit(&named, None, &Console::silent()).unwrap().result;
    assert!((shear(&found) / shear(&alone) - 1.0).abs() < 1e-12, "{found}");

    let error = refusal(&file, &table("3 MPa"));
    assert!(error.contains("machine.csv:1:24: \"force\" needs the area at rest of the cross-section"), "{error}");
    assert!(error.contains("machine.csv:1:9: \"extension\" needs the length at rest"), "{error}");
    fs::write(&file, "extension [N],force [mm]\n1,2\n").unwrap();
    let error = refusal(&file, &of_machine());
    assert!(
        error.contains("has the unit \"N\", but a length is wanted") && error.contains("a force is wanted"),
        "{error}"
    );
    fs::write(&file, rows(false)).unwrap();
    let error = refusal(&file, &LoneTable { length: None, ..of_machine() });
    assert!(
        error.contains("tests/0/area: ") && error.contains("has no column \"force\" that it would be for"),
        "{error}"
    );
}

/// Every law that was fitted is in the drawing.
#[test]
fn all_laws_are_drawn() {
    let directory = tempfile::tempdir().unwrap();
    let file = directory.path().join("bar.csv");
    fs::write(&file, rows(false)).unwrap();
    let laws = ["yeoh", "gent", "neo_hooke"].map(str::to_owned).to_vec();
    fit_with(&file, &LoneTable { laws: laws.clone(), ..table("3 MPa") }, None, &Console::silent()).unwrap();
    let drawn = fs::read_to_string(directory.path().join("out/bar/fit.svg")).unwrap();
    assert!(laws.iter().all(|law| drawn.contains(&format!(">{law}</text>"))), "{drawn}");
}
