//! The tables of keys that the program prints, and the schemas they are made of.

#![allow(clippy::unwrap_used, clippy::panic)] // a test may

use crate::common::{BAR, CaseDirectory};
use nastic_run::record::RunRecord;
use serde_json::Value;
use std::path::Path;

/// What the program prints with these arguments.
fn printed(arguments: &[&str]) -> String {
    let output = CaseDirectory::new(BAR).nastic(arguments);
    assert!(output.status.success(), "{output:?}");
    String::from_utf8(output.stdout).unwrap()
}

/// The cells of a row of a table; a bar within a cell is written `\\|`.
fn cells(row: &str) -> Vec<String> {
    let row = row.replace("\\|", "!");
    row.trim_matches('|').split('|').map(|cell| cell.trim().to_owned()).collect()
}

/// Keys at the top of a schema, and of every part of it, have a row with a sentence.
#[test]
fn tables_of_keys_are_well_formed() {
    for options in [["schema"].as_slice(), &["schema", "--results"]] {
        let schema: Value = serde_json::from_str(&printed(options)).unwrap();
        let page = printed(&[options, &["--markdown"]].concat());
        let rows: Vec<_> = page.lines().filter(|line| line.starts_with('|')).map(cells).collect();
        for row in &rows {
            let whole = row.len() == 3 && row.iter().all(|cell| !cell.is_empty() && cell.chars().count() <= 200);
            assert!(whole, "{options:?}: {row:?}");
        }
        let is_row_of = |key: &str, row: &[String]| row[0] == format!("`{key}`");
        let parts = schema["$defs"].as_object().unwrap().values().chain([&schema]);
        for key in parts.filter_map(|part| part["properties"].as_object()).flat_map(|keys| keys.keys()) {
            assert!(rows.iter().any(|row| is_row_of(key, row)), "{options:?}: no row of {key}");
        }
    }
}

/// Every key that a result has is one of its schema, and has a meaning there.
#[test]
fn results_have_the_keys_of_their_schema() {
    let schema: Value = serde_json::from_str(&printed(&["schema", "--results"])).unwrap();
    let output = CaseDirectory::new(BAR).nastic(&["optimize", "case.json", "--json", "--no-report"]);
    let result: Value = serde_json::from_slice(&output.stdout).unwrap();
    let keys = schema["properties"].as_object().unwrap();
    for key in result.as_object().unwrap().keys() {
        assert!(keys.contains_key(key), "{key}");
    }
    for (key, entry) in keys {
        let part = entry["$ref"].as_str().map(|part| part.trim_start_matches("#/$defs/"));
        let about = entry["description"].as_str().or_else(|| schema["$defs"][part?]["description"].as_str());
        assert!(about.is_some_and(|about| !about.is_empty()), "{key}: {entry}");
    }
    assert_eq!(schema["properties"]["threads"]["type"], "integer");
    assert_eq!(
        schema["properties"]["inertia"]["type"].as_array().unwrap().len(),
        2,
        "null where pivots were not counted"
    );
}

/// What is read of a result is written again as it was: no key is lost, none is read as another.
#[test]
fn results_are_read_as_they_were_written() {
    let cases = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/cases");
    let place = CaseDirectory::new(BAR);
    let mut commands: Vec<Vec<String>> = std::fs::read_dir(cases)
        .unwrap()
        .map(|entry| entry.unwrap().path().display().to_string())
        .filter(|file| file.ends_with(".json"))
        .map(|file| vec!["check".to_owned(), file])
        .collect();
    assert!(commands.len() > 20);
    for (command, options) in
        [("optimize", ""), ("gradient", ""), ("gradcheck", ""), ("solve", "--modes=2"), ("solve", "--path")]
    {
        let parts = [command, "case.json", options].into_iter().filter(|part| !part.is_empty());
        commands.push(parts.map(str::to_owned).collect());
    }
    for command in commands {
        let mut arguments: Vec<&str> = command.iter().map(String::as_str).collect();
        arguments.extend(["--json", "--out", "here"]);
        let output = place.nastic(&arguments);
        let Ok(result) = serde_json::from_slice::<Value>(&output.stdout) else { panic!("{command:?}: {output:?}") };
        assert_eq!(RunRecord::of(&result).unwrap().to_json().unwrap(), result, "{command:?}");
    }
}
