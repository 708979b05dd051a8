//! `nastic fit` of tables alone, and of what a testing machine writes: forces and extensions.
#![allow(clippy::unwrap_used, clippy::panic)] // a test may

use crate::common::Heard;
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

/// What machines export: the same numbers in other words, and one shear modulus.
#[test]
fn exports_of_machines_are_read() {
    let directory = tempfile::tempdir().unwrap();
    let file = directory.path().join("machine.csv");
    let numbers = |row: &dyn Fn(usize, f64, f64) -> String| -> String {
        let of = |k: usize| {
            let l = 1.0 + 0.1 * k as f64;
            row(k, 1e3 * LENGTH * (l - 1.0), SHEAR * (l - l.powi(-2)) * AREA)
        };
        (1..12).map(of).collect()
    };
    let comma = |x: f64| format!("{x:?}").replace('.', ",");
    let plain = |k, x, f| format!("{k},{x:?},{f:?}\n");
    let stress = |factor: f64, unit: &str| {
        format!(
            "Strain [mm/mm],Stress [{unit}]\n{}",
            numbers(&|_, x, f| format!("{:?},{:?}\n", x / (1e3 * LENGTH), f / AREA * factor))
        )
    };
    let tables = [
        format!(
            "\"Time\",\"Extension\",\"Load\"\n\"(s)\",\"(mm)\",\"(N)\"\n{}",
            numbers(&|k, x, f| format!("\"{k}\",\"{x:?}\",\"{f:?}\"\n"))
        ),
        format!(
            "Results Table 1\n,Specimen label\n1,Gel, soft\n\nTime,Extension,Load\n(sec),(mm),(N)\n{}",
            numbers(&plain)
        ),
        format!(
            "Time (s)\tExtension (mm)\tLoad (N)\n{}",
            numbers(&|k, x, f| format!("{k}\t{}\t{}\n", comma(x), comma(f)))
        ),
        format!("Zeit;EXTENSION [MM];FORCE [N]\n{}", numbers(&|k, x, f| format!("{k};{};{}\n", comma(x), comma(f)))),
        format!("reading,extension [mm],force [N],,\n{}", numbers(&|k, x, f| format!("{k},{x:?},{f:?},,\n"))),
        format!(
            "reading,Displacement (in),Load (lbf)\n{}",
            numbers(&|k, x, f| format!("{k},{:?},{:?}\n", x / 25.4, f / 4.4482216152605))
        ),
        format!("Standardweg (mm);Standardkraft (N)\n{}", numbers(&|_, x, f| format!("{};{}\n", comma(x), comma(f)))),
        format!(
            "\"Time (s)\",\"Extension (mm)\",\"Load (N)\"\n{}",
            numbers(&|k, x, f| format!("\"{k}\",\"{}\",\"{}\"\n", comma(x), comma(f)))
        ),
        stress(1e-6, "N/mm^2"),
        stress(0.0254 * 0.0254 / 4.4482216152605, "psi"),
    ];
    for (k, text) in tables.iter().enumerate() {
        fs::write(&file, text).unwrap();
        let given = if k < 8 { of_machine() } else { table("3 MPa") };
        let said = Heard::default();
        let found = fit_with(&file, &given, None, &Console::new(said.clone()));
        let found = found.unwrap_or_else(|_| panic!("{text}\n{}", refusal(&file, &given))).result;
        assert!((shear(&found) / SHEAR - 1.0).abs() < 1e-9, "{text}: {found}");
        let told = said.text().contains("the column \"Stress\" is taken as nominal stress");
        assert_eq!(told, k >= 8, "{}", said.text());
    }
}

#[test]
fn tables_that_are_none_are_answered_with_the_line_that_is_wanted() {
    let directory = tempfile::tempdir().unwrap();
    let file = directory.path().join("machine.csv");
    fs::write(&file, "Droga,Sila\n1,2\n").unwrap();
    let error = refusal(&file, &of_machine());
    assert!(error.lines().count() == 1 && error.contains("machine.csv:1:1: no column"), "{error}");
    assert!(error.contains("`stretch,nominal_stress [MPa]` or `extension [mm],force [N]`"), "{error}");
    // decimal commas between commas: once, with how many more
    let rows: String = (1..40).map(|k| format!("1,{k},0,{k}\n")).collect();
    fs::write(&file, format!("stretch,nominal_stress [MPa]\n{rows}")).unwrap();
    let error = refusal(&file, &table("3 MPa"));
    assert!(
        error.lines().count() == 1 && error.contains("decimal commas?") && error.contains("so do 38 more lines"),
        "{error}"
    );
    fs::write(&file, format!("stretch,nominal_stress [MPa]\n1.1,1\n{}", "1.2,x\n".repeat(40))).unwrap();
    assert_eq!(refusal(&file, &table("3 MPa")).lines().count(), 11);
    for (option, given) in [
        ("--area 12 has no unit: write --area \"12 mm^2\"", LoneTable { area: Some("12".to_owned()), ..of_machine() }),
        (
            "--length 33 has no unit: write --length \"25 mm\"",
            LoneTable { length: Some("33".to_owned()), ..of_machine() },
        ),
    ] {
        assert!(refusal(&file, &given).contains(option), "{}", refusal(&file, &given));
    }
}

/// The text of spreadsheets, by its mark, and of machines that know no UTF-8.
#[test]
fn other_encodings_are_read() {
    let directory = tempfile::tempdir().unwrap();
    let file = directory.path().join("bar.csv");
    let text = rows(false).replace("reading", "Pr\u{fc}fung");
    let utf16 = |mark: u16, bytes: fn(u16) -> [u8; 2]| -> Vec<u8> {
        std::iter::once(mark).chain(text.encode_utf16()).flat_map(bytes).collect()
    };
    let latin: Vec<u8> = text.chars().map(|letter| u8::try_from(letter).unwrap()).collect();
    for bytes in [utf16(0xfeff, u16::to_le_bytes), utf16(0xfeff, u16::to_be_bytes), latin] {
        fs::write(&file, bytes).unwrap();
        let found = fit_with(&file, &table("3 MPa"), None, &Console::silent()).unwrap().result;
        assert!((shear(&found) / SHEAR - 1.0).abs() < 1e-9, "{found}");
    }
}

/// `1,207` among `941` is 1207 or 1.207; where all have decimals it is one.
#[test]
fn commas_that_may_separate_thousands_are_refused() {
    let directory = tempfile::tempdir().unwrap();
    let file = directory.path().join("bar.csv");
    fs::write(&file, "stretch;nominal_stress [kPa]\n1,1;320\n1,2;598\n1,3;941\n1,4;1,207\n").unwrap();
    let error = refusal(&file, &table("3 MPa"));
    assert!(error.contains("bar.csv:5:5: \"1,207\" may be 1207 or 1.207"), "{error}");
    // between quotes, with points elsewhere or not
    fs::write(&file, "stretch,nominal_stress [kPa]\n\"1\",\"0\"\n\"1.2\",\"1,517\"\n\"1.3\",\"2,125\"\n").unwrap();
    let error = refusal(&file, &table("3 MPa"));
    assert!(error.contains("bar.csv:3:7: \"1,517\" may be 1517 or 1.517"), "{error}");
    // the other column settles it
    fs::write(&file, "stretch;nominal_stress [kPa]\n1;0,00\n1,125;20,09\n1,375;50,77\n1,5;63,33\n").unwrap();
    assert!(fit_with(&file, &table("3 MPa"), None, &Console::silent()).is_ok());
    let of = |k: u32| {
        let l = 1.0 + 0.1 * f64::from(k);
        format!("{l:.3};{:.3}\n", 60.0 * (l - l.powi(-2))).replace('.', ",")
    };
    let decimals: String = (1..12).map(of).collect();
    fs::write(&file, format!("stretch;nominal_stress [kPa]\n{decimals}")).unwrap();
    let found = fit_with(&file, &table("3 MPa"), None, &Console::silent()).unwrap().result;
    assert!((shear(&found) / SHEAR - 1.0).abs() < 1e-3, "{found}");
}

/// What a law cannot have: a stress at rest, two branches.
#[test]
fn offsets_and_unloading_are_told() {
    let directory = tempfile::tempdir().unwrap();
    let file = directory.path().join("bar.csv");
    let of = |k: u32, offset: f64| {
        let l = 1.0 + 0.1 * f64::from(k);
        format!("{l},{}\n", SHEAR * (l - l.powi(-2)) + offset)
    };
    let said = |rows: String| {
        fs::write(&file, format!("stretch,nominal_stress [Pa]\n{rows}")).unwrap();
        let heard = Heard::default();
        fit_with(&file, &table("3 MPa"), None, &Console::new(heard.clone())).unwrap();
        let text = heard.text();
        [
            text.contains("the stress is 12000 Pa at rest, 10 % of the largest"),
            text.contains("the specimen is unloaded once"),
        ]
    };
    let up = |offset: f64| (0..12).map(|k| of(k, offset)).collect::<String>();
    let down: String = (0..12).rev().map(|k| of(k, -5e3)).collect();
    assert_eq!(said(up(0.0)), [false, false]);
    assert_eq!(said(up(12e3)), [true, false]);
    assert_eq!(said(up(0.0) + &down), [false, true]);
    // one loading behind the other is no unloading
    assert_eq!(said(up(0.0) + &up(-2e3)), [false, false]);
}

/// A softening that Yeoh's law could follow by parameters alone that it excludes.
#[test]
fn a_parameter_at_the_end_of_its_range_is_told() {
    let directory = tempfile::tempdir().unwrap();
    let file = directory.path().join("bar.csv");
    let row = |k: u32| {
        let l = 1.0 + 0.1 * f64::from(k);
        let i1 = l * l + 2.0 / l - 3.0;
        format!("{l:?},{:?}\n", 2.0 * (l - l.powi(-2)) * (1e5 + 2.0 * 1e3 * i1 - 3.0 * 2e3 * i1 * i1))
    };
    fs::write(&file, format!("stretch,nominal_stress [Pa]\n{}", (1..12).map(row).collect::<String>())).unwrap();
    let said = Heard::default();
    let given = LoneTable { laws: vec!["yeoh".to_owned()], ..table("10 MPa") };
    fit_with(&file, &given, None, &Console::new(said.clone())).unwrap();
    assert!(
        said.text().contains("c20 is the least that the law admits: the data ask for less, which is excluded"),
        "{}",
        said.text()
    );
}
