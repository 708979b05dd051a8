//! Positions over the time from a file, against the formulas that say the same.

#![allow(clippy::unwrap_used, clippy::panic)] // a test may

use crate::common;

use common::{CaseDirectory, DRIVEN, problems, with};
use nastic_language::schema::Command;

const TARGET: &str = r#""target": { "x": "0.097" }"#;
const TABLE: &str = r#""target": { "file": "path.csv", "columns": ["px", "py", "pz"] }"#;
/// Linear between rows, as formulas with min are.
const FORMULAS: &str =
    r#""target": { "x": "0.1 - 0.3 / (1 s) * min(t, 10 ms)", "y": "0.005", "z": "0.005 + 0.1 / (1 s) * t" }"#;
const ROWS: &str = "t,px,py,pz\n0,0.1,0.005,0.005\n0.01,0.097,0.005,0.006\n0.02,0.097,0.005,0.007\n";

#[test]
fn a_table_is_the_path_of_its_formulas() {
    let cost = |target: &str| {
        let place = CaseDirectory::new();
        place.write("path.csv", ROWS);
        let solved = place.run(Command::Solve, &with(DRIVEN, TARGET, target), &[]).unwrap();
        solved.result["cost"]["total"].as_f64().unwrap()
    };
    let (table, formulas) = (cost(TABLE), cost(FORMULAS));
    assert!(formulas > 0.0 && (table / formulas - 1.0).abs() < 1e-12, "{table} {formulas}");
    // two columns leave z free
    let two = cost(r#""target": { "file": "path.csv", "columns": ["px", "py"] }"#);
    assert!(two < 0.999 * table, "{two} {table}");
    // null leaves x free
    let free = cost(r#""target": { "file": "path.csv", "columns": [null, "py", "pz"] }"#);
    let by_formulas = cost(r#""target": { "y": "0.005", "z": "0.005 + 0.1 / (1 s) * t" }"#);
    assert!(free < 0.999 * table && (free / by_formulas - 1.0).abs() < 1e-12, "{free} {by_formulas} {table}");
    let place = CaseDirectory::new();
    place.write("path.csv", ROWS);
    place.run(Command::Gradcheck, &with(DRIVEN, TARGET, TABLE), &[]).unwrap();
    let said = place.text(Command::Check, &with(DRIVEN, TARGET, TABLE), &[]);
    assert!(said.contains("x = px, y = py, z = pz of path.csv over the time"), "{said}");
}

#[test]
fn what_is_wrong_with_a_table_is_told() {
    let told = |table: &str, case: &str| {
        let place = CaseDirectory::new();
        place.write("path.csv", ROWS);
        place.run(Command::Check, &with(case, TARGET, table), &[]).unwrap_err().to_string()
    };
    let unknown = told(&TABLE.replace("py", "q"), DRIVEN);
    assert!(unknown.contains("costs/0/target/file") && unknown.contains("no column \"q\""), "{unknown}");
    let scalar = told(r#""target": { "file": "path.csv", "column": "px" }"#, DRIVEN);
    assert!(scalar.contains("a vector needs \"columns\""), "{scalar}");
    let none = told(r#""target": { "file": "path.csv", "columns": [null, null] }"#, DRIVEN);
    assert!(none.contains("no component has a column"), "{none}");
    let still = with(DRIVEN, r#""time": { "end": "20 ms", "step": "1 ms" }"#, r#""title": "bar""#);
    let still = problems(&with(&with(&still, r#""title": "bar","#, ""), TARGET, TABLE));
    assert!(still.contains("costs/0/target") && still.contains("the case is static"), "{still}");
    let bounded = r#""constraints": [ { "cost": { "kind": "position", "surface": "x+", "target": { "file": "path.csv", "columns": ["px", "py"] } }, "at_most": 1 } ],
        "costs""#;
    let bounded = told(TARGET, &with(DRIVEN, "\"costs\"", bounded));
    assert!(bounded.contains("does not change in time"), "{bounded}");
}

/// `sum_k W/2 d_k^2` over three instants: root mean square and largest distance over them, beside that at the end.
#[test]
fn distances_from_a_path_are_those_of_all_instants() {
    let place = CaseDirectory::new();
    place.write("path.csv", ROWS);
    let instants = r#""when": { "at": ["5 ms", "10 ms", "20 ms"] }"#;
    let case = with(&with(DRIVEN, TARGET, TABLE), r#""when": "integral""#, instants);
    let result = place.run(Command::Solve, &case, &[]).unwrap().result;
    let figure = |key: &str| result["figures"]["position"][key].as_f64().unwrap_or_else(|| panic!("{key}: {result}"));
    let [end, largest, rms] =
        ["", "_largest", "_root_mean_square"].map(|key| figure(&format!("position_distance{key}")));
    let cost = result["cost"]["total"].as_f64().unwrap();
    assert!((rms * rms * 3.0 * 0.5e6 / cost - 1.0).abs() < 1e-9, "{rms} {cost}");
    assert!(largest >= end && largest < 3.0_f64.sqrt() * rms && largest > rms, "{end} {largest} {rms}");
    let said = place.text(Command::Solve, &case, &[]);
    assert!(said.contains("position distance at the end") && said.contains("position distance largest"), "{said}");
}
