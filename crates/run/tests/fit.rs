//! `nastic fit`: a data file to parameters, files, and blocks that are a case.
#![allow(clippy::unwrap_used)] // a test may

use crate::common;

use common::Heard;
use nastic_fit::{Fibers, Law, Mode, Response, curve};
use nastic_language::schema::Command;
use nastic_run::console::Console;
use nastic_run::run::{Exit, Options, RunError, fit, run};
use serde_json::{Value, json};
use std::fs;
use std::path::{Path, PathBuf};

/// The law of a label.
fn named(label: &str) -> Law {
    Law::named(label).unwrap()
}

/// Neo-Hookean tension with mu = 0.4 MPa, in per cent and kPa, and a pressure that is 2 GPa times the change of volume.
fn write_data(directory: &Path) -> PathBuf {
    let mut bar = "# a bar\nname; strain [%]; nominal_stress [kPa]\n".to_owned();
    for (k, error) in [0.5, -0.4, 0.2, -0.3, 0.4, -0.1].iter().enumerate() {
        let l = 1.1 + 0.25 * k as f64;
        bar += &format!("p{k}; {}; {}\n", 100.0 * (l - 1.0), 400.0 * (l - l.powi(-2)) + error);
    }
    fs::write(directory.join("bar.csv"), bar).unwrap();
    let kappa = |j: f64| -1e9 * (j - 1.0 / j);
    let press: String = [0.99f64, 0.995, 1.01].iter().map(|j| format!("{j},{}\n", kappa(*j) / 1e6)).collect();
    fs::write(directory.join("press.csv"), format!("volume_ratio,pressure [MPa]\n{press}")).unwrap();
    let data = json!({
        "nastic_fit": 1,
        "title": "Bar and press",
        "tests": [{ "kind": "uniaxial", "file": "bar.csv" }, { "kind": "volumetric", "file": "press.csv" }],
        "laws": ["neo_hooke_isochoric", "gent", "ogden_1"],
    });
    let file = directory.join("data.json");
    fs::write(&file, data.to_string()).unwrap();
    file
}

fn error_of(data: &Path) -> String {
    match fit(data, None, &Console::silent()) {
        Err(RunError::Input(problems)) => problems.list().iter().map(|p| format!("{p}\n")).collect(),
        other => format!("{other:?}"),
    }
}

#[test]
fn from_tables_to_a_case_that_is_solved() {
    let directory = tempfile::tempdir().unwrap();
    let data = write_data(directory.path());
    let out = directory.path().join("out");
    let found = fit(&data, Some(out.clone()), &Console::silent()).unwrap();
    assert_eq!(found.exit, Exit::Done);
    let written: Value = serde_json::from_str(&fs::read_to_string(out.join("fit.json")).unwrap()).unwrap();
    assert_eq!(written, found.result);
    // one parameter suffices for data of such a material
    assert_eq!(written["best"], "neo_hooke_isochoric");
    let best = &written["laws"][0];
    let shear = &best["parameters"]["shear"];
    assert!((shear["value"].as_f64().unwrap() / 4e5 - 1.0).abs() < 1e-3, "{shear}");
    let interval: Vec<f64> = serde_json::from_value(shear["interval"].clone()).unwrap();
    assert!(interval[0] < 4e5 && 4e5 < interval[1] && interval[1] - interval[0] < 4e3, "{interval:?}");
    assert!((best["bulk"]["value"].as_f64().unwrap() / 2e9 - 1.0).abs() < 1e-6, "{}", best["bulk"]);
    assert_eq!(best["stable"]["uniaxial"]["ends_above"], false);
    assert!(best["aicc_above_best"] == 0.0 && written["laws"][1]["aicc_above_best"].as_f64().unwrap() > 0.0);
    for name in written["files"].as_array().unwrap() {
        assert!(out.join(name.as_str().unwrap()).exists(), "{name}");
    }
    assert_eq!(written["files"], json!(["fit.html", "fit.json", "fit.svg", "fit_volumetric.svg"]));
    let page = fs::read_to_string(out.join("fit.html")).unwrap();
    assert_eq!(page.matches("<svg").count(), 2);
    assert!(page.contains("<td>shear</td>") && page.contains(written["best"].as_str().unwrap()), "{page}");
    // the blocks are those of a case
    for one in written["laws"].as_array().unwrap() {
        let case = json!({
            "nastic": 1,
            "units": "mm",
            "mesh": { "box": { "size": [10, 10, 10], "cells": [1, 1, 1], "element": "hex27" } },
            "materials": one["materials"],
            "scenarios": one["scenarios"],
            "supports": [
                { "surface": "x-", "fix": "x" }, { "surface": "y-", "fix": "y" }, { "surface": "z-", "fix": "z" },
                { "surface": "x+", "displacement": { "x": 5 } },
            ],
        });
        let file = directory.path().join(format!("{}.json", one["law"].as_str().unwrap()));
        fs::write(&file, case.to_string()).unwrap();
        let options = Options { in_memory: true, ..Options::default() };
        let solved = run(Command::Solve, &file, &options, &Console::silent());
        let solved = solved.unwrap_or_else(|error| unreachable!("{}: {error}", one["law"]));
        // mu (l - 1/l^2) times 100 mm^2
        let first = solved.result["scenarios"].as_object().unwrap().values().next().unwrap();
        let force = first["reactions"]["x+"][0].as_f64().unwrap_or(f64::NAN);
        assert!((force / (0.4 * (1.5 - 1.5f64.powi(-2)) * 100.0) - 1.0).abs() < 0.02, "{}: {force}", one["law"]);
    }
}

#[test]
fn the_same_data_give_the_same_bytes() {
    let directory = tempfile::tempdir().unwrap();
    let data = write_data(directory.path());
    let read = |name: &str| {
        let out = directory.path().join(name);
        fit(&data, Some(out.clone()), &Console::silent()).unwrap();
        ["fit.json", "fit.html", "fit.svg"].map(|file| fs::read(out.join(file)).unwrap())
    };
    assert_eq!(read("one"), read("other"));
}

#[test]
fn mistakes_name_file_line_and_column() {
    let directory = tempfile::tempdir().unwrap();
    let data = write_data(directory.path());
    let table = directory.path().join("bar.csv");
    let with = |text: &str| {
        fs::write(&table, text).unwrap();
        error_of(&data)
    };
    let error = with("stretch,nominal_stress [MPa]\n1.2,0.1\n1.4,abc\n-1.5,0.3\n");
    assert!(error.contains("bar.csv:3:5: \"abc\" is no number; leave out rows without one"), "{error}");
    let error = with("stretch,nominal_stress [MPa]\n1.2,0.1\n-1.5,0.3\n");
    assert!(error.contains("bar.csv:3:1: test \"bar\", point 1: stretch = -1.5, but it must be positive"), "{error}");
    let error = with("stretch,nominal_stress\n1.2,0.1\n");
    assert!(error.contains("bar.csv:1:9: \"nominal_stress\" has no unit"), "{error}");
    let error = with("stretch,nominal_stress [mm]\n1.2,0.1\n");
    assert!(error.contains("has the unit \"mm\", but a pressure is wanted"), "{error}");
    let error = with("elongation,nominal_stress [MPa]\n1.2,0.1\n");
    assert!(
        error.contains(
            "no column \"stretch\" or \"strain\" or \"extension\" for a test of kind \"uniaxial\"; found: elongation"
        ),
        "{error}"
    );
    let error = with("stretch,nominal_stress [MPa]\n1.2\n");
    assert!(error.contains("bar.csv:2:4: the row has no column 2"), "{error}");
    let error = with("stretch,pressure [MPa]\n1.2,0.1\n");
    let wanted = "no column \"nominal_stress\" or \"cauchy_stress\" or \"force\" for a test of kind \"uniaxial\"; found: stretch, pressure";
    assert!(error.contains(wanted), "{error}");
    // a decimal comma, whether the first number has it or the second
    let error = with("stretch,nominal_stress [MPa]\n1.2,0.1\n1.3,0,25\n");
    assert!(
        error.contains("bar.csv:3:7: the row has 3 cells, but the line of columns has 2: are there decimal"),
        "{error}"
    );
    let error = with("stretch;nominal_stress [MPa]\n1.2;0.1;0.3\n");
    assert!(error.contains("bar.csv:2:9: the row has 3 cells") && !error.contains("decimal"), "{error}");
    let error = with("strain [%],nominal_stress [MPa]\n20,0.1\n-150,0.3\n");
    assert!(error.contains("bar.csv:3:1: test \"bar\", point 1: stretch = -0.5, but it must be positive"), "{error}");
    let error = with("stretch,nominal_stress [MPa],cauchy_stress [MPa]\n1.2,0.1,0.12\n");
    let wanted = "bar.csv:1:30: the columns \"nominal_stress\" and \"cauchy_stress\" are both there";
    assert!(error.contains(wanted), "{error}");
    let error = with("stretch,strain [%],nominal_stress [MPa]\n1.2,20,0.1\n");
    assert!(error.contains("bar.csv:1:9: the columns \"stretch\" and \"strain\" are both there"), "{error}");
    let error = with("stretch [1,nominal_stress [MPa]\n1.2,0.1\n");
    assert!(error.contains("bar.csv:1:1: \"stretch\" has a bracket that is not closed"), "{error}");
    assert!(with("").contains("the table is empty"));
    fs::remove_file(&table).unwrap();
    assert!(error_of(&data).contains("tests/0/file: ") && error_of(&data).contains("cannot be read"));
    let refused = |change: &dyn Fn(&mut Value)| {
        let mut text: Value = serde_json::from_str(&fs::read_to_string(write_data(directory.path())).unwrap()).unwrap();
        change(&mut text);
        fs::write(&data, text.to_string()).unwrap();
        error_of(&data)
    };
    assert!(refused(&|data| data["laws"] = json!(["yeho"])).contains("yeoh"));
    assert!(refused(&|data| data["bulk"] = json!("1 GPa")).contains("leave out one of both"));
    assert!(refused(&|data| data["tests"] = json!([data["tests"][0]])).contains("missing key \"bulk\""));
    assert!(refused(&|data| data["tests"] = json!([data["tests"][1]])).contains("a test that is not \"volumetric\""));
    assert!(refused(&|data| data["tests"][0]["kind"] = json!("inflation")).contains("thickness_to_radius"));
    assert!(refused(&|data| data["weights"] = json!(1)).contains("weights"));
}

#[test]
fn too_few_points_for_every_law_is_an_error() {
    let directory = tempfile::tempdir().unwrap();
    let data = write_data(directory.path());
    fs::write(directory.path().join("bar.csv"), "stretch,nominal_stress [MPa]\n1.2,0.1\n").unwrap();
    let error = fit(&data, None, &Console::silent()).unwrap_err();
    assert_eq!(error.exit(), Exit::BadInput);
    assert!(error.to_string().contains("has 1 parameters, and there are 1 points"), "{error}");
}

/// A table in percent whose column does not say so is fitted, to a rubber a hundred times as long.
#[test]
fn strains_that_look_like_percent_are_told() {
    let directory = tempfile::tempdir().unwrap();
    let data = one("uniaxial", "neo_hooke", "1 GPa");
    let rows = "20,0.1\n40,0.15\n80,0.3\n";
    let (_, text) = message(directory.path(), &data, &format!("strain,nominal_stress [MPa]\n{rows}"));
    let wanted = "one.csv: \"strain\" reaches 80, which is 8000 %: if it is in percent, write \"strain [%]\"";
    assert!(text.contains("WARNING     ") && text.contains(wanted), "{text}");
    let (_, text) = message(directory.path(), &data, &format!("strain [%],nominal_stress [MPa]\n{rows}"));
    assert!(!text.contains("WARNING"), "{text}");
}

/// A data file with one table, its result and what is said.
fn message(directory: &Path, data: &Value, table: &str) -> (Value, String) {
    fs::write(directory.join("one.csv"), table).unwrap();
    let file = directory.join("one.json");
    fs::write(&file, data.to_string()).unwrap();
    let heard = Heard::default();
    let found = fit(&file, Some(directory.join("out")), &Console::new(heard.clone())).unwrap();
    (found.result, heard.text())
}

fn one(kind: &str, law: &str, bulk: &str) -> Value {
    json!({ "nastic_fit": 1, "tests": [{ "kind": kind, "file": "one.csv" }], "laws": [law], "bulk": bulk })
}

#[test]
fn a_failed_fit_leaves_no_results_of_an_earlier_one() {
    let directory = tempfile::tempdir().unwrap();
    let data = write_data(directory.path());
    let out = directory.path().join("out");
    fit(&data, Some(out.clone()), &Console::silent()).unwrap();
    fs::write(out.join("notes.txt"), "mine").unwrap();
    fs::write(directory.path().join("bar.csv"), "stretch,nominal_stress [MPa]\n1.2,0.1\n").unwrap();
    fit(&data, Some(out.clone()), &Console::silent()).unwrap_err();
    for name in ["fit.json", "fit.html", "fit.svg", "fit_volumetric.svg"] {
        assert!(!out.join(name).exists(), "{name}");
    }
    assert!(out.join("notes.txt").exists());
}

/// Yeoh's law with a valley in the middle of the data, in each kind of test.
#[test]
fn instability_within_the_data_is_marked_in_every_kind_of_test() {
    let directory = tempfile::tempdir().unwrap();
    let law = named("yeoh").incompressible(&[1e6, -1.7e5, 1e4]).unwrap();
    for (mode, marked, to) in
        [(Mode::Uniaxial, "uniaxial", 4.5), (Mode::Equibiaxial, "equibiaxial", 3.0), (Mode::Planar, "planar", 4.0)]
    {
        for (from, side) in [(to, "above"), (1.0 / to, "below")] {
            let at: Vec<f64> = (1..=20).map(|k| 1.0 + (from - 1.0) * f64::from(k) / 20.0).collect();
            let rows = at.iter().zip(curve(&*law, mode, Fibers::Along, Response::Nominal, &at));
            let rows: String = rows.map(|(l, y)| format!("{l},{y}\n")).collect();
            let table = format!("stretch,nominal_stress [Pa]\n{rows}");
            let (result, text) = message(directory.path(), &one(marked, "yeoh", "1 GPa"), &table);
            for kind in ["uniaxial", "equibiaxial", "planar"] {
                let stable = &result["laws"][0]["stable"][kind];
                assert_eq!(stable["within_data"], kind == marked, "{marked} {side} {kind}: {stable}");
            }
            let lines: Vec<&str> = text.lines().filter(|line| line.contains("WITHIN THE DATA")).collect();
            let expected = format!("unstable (Drucker) in {marked} tests {side} stretch");
            assert!(lines.len() == 1 && lines[0].contains(&expected), "{lines:?}");
        }
    }
}

/// Tension of Gent's law to nine tenths of its limit: beyond there is no law, rather than an unstable one.
#[test]
fn the_limit_of_a_law_is_no_instability() {
    let directory = tempfile::tempdir().unwrap();
    let law = named("gent").incompressible(&[1e6, 10.0]).unwrap();
    let at: Vec<f64> = (1..=20).map(|k| 1.0 + 0.12 * f64::from(k)).collect();
    let rows = at.iter().zip(curve(&*law, Mode::Uniaxial, Fibers::Along, Response::Nominal, &at));
    let rows: String = rows.map(|(l, y)| format!("{l},{y}\n")).collect();
    let table = format!("stretch,nominal_stress [Pa]\n{rows}");
    let (result, text) = message(directory.path(), &one("uniaxial", "gent", "1 GPa"), &table);
    let stable = &result["laws"][0]["stable"]["uniaxial"];
    assert!(stable["ends_above"] == true && stable["limit_above"] == true, "{stable}");
    assert!(!text.contains("unstable") && text.contains("stable in uniaxial tests up to the limit of gent"), "{text}");
}

#[test]
fn what_is_left_out_and_not_decided_is_told() {
    let directory = tempfile::tempdir().unwrap();
    let table = "stretch,nominal_stress [MPa]\n1,0\n1.2,0.2\n1.5,0.43\n2,0.69\n";
    let mut data = one("uniaxial", "ogden_1", "1 GPa");
    data["laws"] = json!(["mooney_rivlin", "neo_hooke_isochoric", "ogden_1"]);
    let (result, text) = message(directory.path(), &data, table);
    assert!(text.contains("4 points (1 at rest left out)") && result["tests"][0]["at_rest"] == 1, "{text}");
    assert!(text.contains("laws        by BIC: AICc decides nothing") && text.contains("scatter, Pa"), "{text}");
    assert!(text.contains("16 starts: ") && !text.contains("inf") && !text.contains("NaN"), "{text}");
    let bic: Vec<f64> = result["laws"].as_array().unwrap().iter().map(|law| law["bic"].as_f64().unwrap()).collect();
    assert!(bic.is_sorted() && result["laws"][0]["aicc"].is_null(), "{bic:?}");
    assert!(!text.contains("WARNING"), "{text}");
    data["errors"] = json!("relative");
    data["bulk"] = json!("0.1 MPa");
    let (result, text) = message(directory.path(), &data, table);
    assert!(text.contains("scatter, 1") && result["laws"][0]["scatter_unit"] == "1", "{text}");
    assert!(text.contains("WARNING: the bulk modulus, 100000 Pa, is below 2/3 of the shear modulus"), "{text}");
    assert!(result["laws"][0]["poissons_ratio"].as_f64().unwrap() < 0.0);
}

/// The same conditions as `nastic check` states: with the growth that is implied.
#[test]
fn existence_is_stated_as_for_a_case() {
    let directory = tempfile::tempdir().unwrap();
    let table = "stretch,nominal_stress [MPa]\n1.2,0.2\n1.5,0.43\n2,0.69\n";
    let (result, _) = message(directory.path(), &one("uniaxial", "neo_hooke_isochoric", "1 GPa"), table);
    let law = &result["laws"][0];
    let case = json!({
        "nastic": 1, "units": "mm",
        "mesh": { "box": { "size": [1, 1, 1], "cells": [1, 1, 1], "element": "hex8" } },
        "materials": law["materials"], "supports": [{ "surface": "x-", "fix": "all" }],
    });
    let file = directory.path().join("case.json");
    fs::write(&file, case.to_string()).unwrap();
    let options = Options { in_memory: true, ..Options::default() };
    let checked = run(Command::Check, &file, &options, &Console::silent()).unwrap().result;
    assert!(law["existence"].is_object());
    assert_eq!(law["existence"], checked["existence"][0]["conditions"], "{checked}");
}

/// The shipped data: Ogden's law of three terms wins, and is stable over the data.
#[test]
fn treloar() {
    let directory = tempfile::tempdir().unwrap();
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/fit/treloar.json");
    let found = fit(&data, Some(directory.path().join("out")), &Console::silent()).unwrap().result;
    assert_eq!((&found["best"], found["laws"].as_array().unwrap().len()), (&json!("ogden_3"), 7));
    let best = &found["laws"][0];
    // the published set has a scatter of 0.24 MPa
    assert!(best["scatter"].as_f64().unwrap() < 8e4 && best["points"] == 53, "{}", best["scatter"]);
    assert!(best["stable"]["uniaxial"]["to"].as_f64().unwrap() > 7.6, "{}", best["stable"]);
}

/// Two families of fibres in a soft matrix, in bars and strips along and across.
fn write_tissue(directory: &Path) -> PathBuf {
    let law = named("holzapfel_gasser_ogden_2").incompressible(&[2e4, 1e5, 2.0, 0.1, 30.0]).unwrap();
    let mut tests = vec![];
    for (mode, kind) in [(Mode::Uniaxial, "uniaxial"), (Mode::Planar, "planar")] {
        for (fibers, name) in [(Fibers::Along, "along"), (Fibers::Across, "across")] {
            let at: Vec<f64> = (1..=12).map(|k| 1.0 + 0.03 * f64::from(k)).collect();
            let rows = at.iter().zip(curve(&*law, mode, fibers, Response::Cauchy, &at));
            // errors of a thousandth, of either sign
            let noisy = |k: usize, y: f64| y * (1.0 + 1e-3 * [1.0, -1.0, -1.0, 1.0][k % 4]);
            let rows: String = rows.enumerate().map(|(k, (l, y))| format!("{l},{}\n", noisy(k, y))).collect();
            let file = format!("{kind}_{name}.csv");
            fs::write(directory.join(&file), format!("stretch,cauchy_stress [Pa]\n{rows}")).unwrap();
            tests.push(json!({ "kind": kind, "file": file, "fibers": name }));
        }
    }
    let file = directory.join("tissue.json");
    let data = json!({ "nastic_fit": 1, "tests": tests, "bulk": "200 MPa" });
    fs::write(&file, data.to_string()).unwrap();
    file
}

/// The bar of the case is pulled as that of the test: with the pasted law and its scenarios it answers as measured.
#[test]
fn fibres_are_fitted_and_pasted() {
    let directory = tempfile::tempdir().unwrap();
    let data = write_tissue(directory.path());
    let heard = Heard::default();
    let found = fit(&data, Some(directory.path().join("out")), &Console::new(heard.clone())).unwrap().result;
    let text = heard.text();
    assert_eq!(found["best"], "holzapfel_gasser_ogden_2", "{text}");
    assert_eq!(found["laws"].as_array().unwrap().len(), 12);
    let best = &found["laws"][0];
    let angle = &best["parameters"]["fiber_angle"];
    assert!((angle["value"].as_f64().unwrap() - 30.0).abs() < 0.5 && angle["unit"] == "deg", "{angle}");
    assert!(text.contains("fiber_angle = ") && text.contains(" deg +- "), "{text}");
    assert!(text.contains("uniaxial along the fibres, a Cauchy stress") || text.contains("uniaxial along the fibres"));
    assert!(best["stable"]["uniaxial_across"]["from"].is_f64() && found["tests"][1]["fibers"] == "across");
    let along = curve(
        &*named("holzapfel_gasser_ogden_2").build(&[2e4, 1e5, 2.0, 0.1, 30.0], 2e8).unwrap(),
        Mode::Uniaxial,
        Fibers::Along,
        Response::Nominal,
        &[1.3],
    )[0];
    for one in found["laws"].as_array().unwrap().iter().filter(|one| one["materials"][0]["fiber"].is_array()) {
        let case = json!({
            "nastic": 1,
            "units": "mm",
            "mesh": { "box": { "size": [10, 10, 10], "cells": [1, 1, 1], "element": "hex27" } },
            "materials": one["materials"],
            "scenarios": one["scenarios"],
            "supports": [
                { "surface": "x-", "fix": "x" }, { "surface": "y-", "fix": "y" }, { "surface": "z-", "fix": "z" },
                { "surface": "x+", "displacement": { "x": 3 } },
            ],
        });
        let file = directory.path().join("pasted.json");
        fs::write(&file, case.to_string()).unwrap();
        let options = Options { in_memory: true, ..Options::default() };
        let solved = run(Command::Solve, &file, &options, &Console::silent());
        let solved = solved.unwrap_or_else(|error| unreachable!("{}: {error}", one["law"]));
        let scenarios = solved.result["scenarios"].as_object().unwrap();
        println!("{}: {} scenarios", one["law"], scenarios.len());
        if one["law"] == "holzapfel_gasser_ogden_2" {
            for scenario in scenarios.values() {
                let force = scenario["reactions"]["x+"][0].as_f64().unwrap_or(f64::NAN);
                assert!((force / (along * 1e-4) - 1.0).abs() < 0.05, "{force} {along}");
            }
        }
    }
}

#[test]
fn how_fibres_lie_is_asked_of_every_test_or_of_none() {
    let directory = tempfile::tempdir().unwrap();
    let data = write_tissue(directory.path());
    let refused = |change: &dyn Fn(&mut Value)| {
        let mut text: Value = serde_json::from_str(&fs::read_to_string(&data).unwrap()).unwrap();
        change(&mut text);
        let file = directory.path().join("changed.json");
        fs::write(&file, text.to_string()).unwrap();
        error_of(&file)
    };
    let error = refused(&|data| {
        data["tests"][2].as_object_mut().unwrap().remove("fibers");
    });
    assert!(
        error.contains("tests/2") && error.contains("missing key \"fibers\"") && error.contains("another test has it"),
        "{error}"
    );
    let error = refused(&|data| {
        data["laws"] = json!(["transverse_mooney_rivlin"]);
        data["tests"]
            .as_array_mut()
            .unwrap()
            .iter_mut()
            .for_each(|test| drop(test.as_object_mut().unwrap().remove("fibers")));
    });
    assert!(error.contains("transverse_mooney_rivlin has fibres"), "{error}");
    let error = refused(&|data| data["tests"][0]["fibers"] = json!("oblique"));
    assert!(error.contains("one of: along, across"), "{error}");
    let error = refused(&|data| data["tests"][0]["kind"] = json!("volumetric"));
    assert!(error.contains("takes no \"fibers\""), "{error}");
    // one direction alone hardly distinguishes fibres from matrix: said
    let mut text: Value = serde_json::from_str(&fs::read_to_string(&data).unwrap()).unwrap();
    text["tests"] = json!([text["tests"][0], text["tests"][2]]);
    text["laws"] = json!(["transverse_mooney_rivlin"]);
    fs::write(directory.path().join("along.json"), text.to_string()).unwrap();
    let heard = Heard::default();
    fit(&directory.path().join("along.json"), Some(directory.path().join("out")), &Console::new(heard.clone()))
        .unwrap();
    assert!(heard.text().contains("no test across the fibres"), "{}", heard.text());
}
