//! `optimize --spectrum N`: what results, files, page and terminal say of the second derivative at the optimum.

#![allow(clippy::unwrap_used, clippy::panic)] // a test may

use crate::common;

use common::{BAR, CaseDirectory, Heard};
use nastic_io::read_snapshot;
use nastic_language::catalogue::Catalogue;
use nastic_language::schema::Command;
use nastic_run::console::Console;
use nastic_run::run::{Exit, Options, Outcome, RunError, SpectrumRefusal, SpectrumRequest, resume};
use serde_json::{Value, json};

const SET: [&str; 3] = ["optimizer/method=newton_cg", "optimizer/max_iterations=60", "optimizer/tolerance=1e-8"];

fn optimize(place: &CaseDirectory, set: &[&str], spectrum: SpectrumRequest) -> (Result<Outcome, RunError>, String) {
    let heard = Heard::default();
    let options = Options { spectrum: Some(spectrum), ..place.options(&[&SET[..], set].concat()) };
    let outcome = place.run_with(Command::Optimize, BAR, &Console::new(heard.clone()), &options);
    (outcome, heard.text())
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|value| value.as_f64().unwrap()).collect()
}

#[test]
fn eigenpairs_stand_in_result_files_page_and_terminal() {
    let place = CaseDirectory::new();
    let (outcome, text) = optimize(&place, &[], SpectrumRequest::leading(6));
    let outcome = outcome.unwrap();
    assert_eq!(outcome.exit, Exit::Done, "{text}");
    let found = &outcome.result["spectrum"];
    let (values, residuals) = (numbers(&found["eigenvalues"]), numbers(&found["residuals"]));
    assert_eq!((values.len(), residuals.len(), &found["negative"]), (6, 6, &json!(0)), "{found}");
    assert!(values.windows(2).all(|w| w[0] >= w[1]) && values[5] > 0.0);
    assert!(residuals.iter().all(|residual| *residual < 1e-6), "{residuals:?}");
    let (active, unknowns) = (&outcome.result["controls"]["tension"]["active"], 20);
    assert_eq!(found["free"].as_u64().unwrap() + active.as_u64().unwrap(), unknowns);
    assert!(found["products"].as_u64().unwrap() > 6 && found["most"].as_u64().unwrap() <= 6);
    // One control field has all of every eigenvector.
    assert!(numbers(&found["shares"]["tension"]).iter().all(|share| (share - 1.0).abs() < 1e-12));
    // A hundredth of the cost; half-widths by the formula.
    let rise = found["cost_rise"].as_f64().unwrap();
    assert!((rise / outcome.result["cost"]["total"].as_f64().unwrap() - 0.01).abs() < 1e-12);
    for (width, value) in numbers(&found["half_widths"]).iter().zip(&values) {
        assert!((width - (2.0 * rise / value).sqrt()).abs() < 1e-12 * width);
    }

    // Eigenvectors and half-width in full, and as fields of the same values.
    let file = place.json("spectrum.json");
    let vectors = file["eigenvectors"].as_array().unwrap();
    let width = numbers(&file["half_width"]["tension"]);
    assert_eq!((vectors.len(), width.len() as u64), (6, unknowns));
    for (i, width) in width.iter().enumerate() {
        let of = |(k, value): (usize, &f64)| numbers(&vectors[k]["tension"])[i].powi(2) * 2.0 * rise / value;
        let sum: f64 = values.iter().enumerate().map(of).sum();
        assert!((width - sum.sqrt()).abs() <= 1e-9 * width, "{i}");
    }
    let largest = width.iter().copied().fold(0.0, f64::max);
    assert_eq!(found["half_width"]["tension"]["max"], json!(largest));
    let shot = read_snapshot(place.path("out/spectrum.vtu")).unwrap();
    for (name, values) in [("eigenvector_6", numbers(&vectors[5]["tension"])), ("half_width", width)] {
        let array = shot.point_data.iter().find(|array| array.name == format!("tension_{name}")).unwrap();
        let largest = |values: &[f64]| values.iter().fold(0.0f64, |most, x| most.max(x.abs()));
        assert!((largest(&array.values) - largest(&values)).abs() < 1e-9 * largest(&values), "{name}");
    }
    let files = outcome.result["files"].as_array().unwrap();
    assert!(files.contains(&json!("spectrum.vtu")) && files.contains(&json!("spectrum.json")));

    assert!(text.contains("\nspectrum    6 directions of "), "{text}");
    assert!(text.contains("tension may differ by ") && !text.contains("SADDLE"), "{text}");
    let page = std::fs::read_to_string(place.path("out/report.html")).unwrap();
    assert!(page.contains("id=\"spectrum\"") && page.contains("share of tension"));
}

/// An optimisation that has ended is diagnosed without being run again, to the same bits; the rise of the cost scales half-widths by its root.
#[test]
fn of_an_optimisation_that_has_ended() {
    let (place, whole) = (CaseDirectory::new(), CaseDirectory::new());
    let outcome = place.run(Command::Optimize, BAR, &SET).unwrap();
    assert!(outcome.result["spectrum"].is_null() && !place.path("out/spectrum.vtu").exists());
    let (first, _) = optimize(&whole, &[], SpectrumRequest::leading(3));
    let first = first.unwrap().result["spectrum"].clone();
    let rise = first["cost_rise"].as_f64().unwrap();
    let spectrum = Some(SpectrumRequest { count: 3, cost_rise: Some(4.0 * rise) });
    let options = Options { spectrum, threads: Some(1), ..Options::default() };
    let later = resume(&Catalogue::standard(), &place.path("out"), &options, &Console::silent()).unwrap();
    let later = &later.result["spectrum"];
    for key in ["eigenvalues", "residuals", "free", "products", "shares"] {
        assert_eq!(later[key], first[key], "{key}");
    }
    for (later, first) in numbers(&later["half_widths"]).iter().zip(numbers(&first["half_widths"])) {
        assert!((later / first - 2.0).abs() < 1e-12);
    }
}

/// Far from an unreachable target, where a run ends at its start, the second derivative is indefinite.
#[test]
fn a_saddle_is_told() {
    let place = CaseDirectory::new();
    let costs = r#"costs=[{ "kind": "tracking", "surface": "x+", "target": ["X", "Y", "Z + 300"] }]"#;
    let start = ["controls/0/start=0", "optimizer/absolute_tolerance=1e9", costs];
    let (outcome, text) = optimize(&place, &start, SpectrumRequest::leading(2));
    let found = &outcome.unwrap().result["spectrum"];
    assert!(found["negative"].as_u64().unwrap() > 0 && found["lowest"].as_f64().unwrap() < 0.0, "{found} {text}");
    assert!(text.contains("SADDLE: at least "), "{text}");
    let page = std::fs::read_to_string(place.path("out/report.html")).unwrap();
    assert!(page.contains("the control is a saddle within the free directions"));
}

#[test]
fn what_cannot_be_is_refused_before_the_run() {
    let refused = |set: &[&str], request: SpectrumRequest| {
        let place = CaseDirectory::new();
        let (outcome, text) = optimize(&place, set, request);
        let error = outcome.unwrap_err();
        assert_eq!(error.exit(), Exit::BadInput);
        assert!(!text.contains("\n   1 ") && !place.path("out/optimum.vtu").exists(), "{text}");
        match error {
            RunError::Spectrum(why) => why,
            other => panic!("{other}"),
        }
    };
    assert!(matches!(refused(&[], SpectrumRequest::leading(0)), SpectrumRefusal::Count));
    let rise = SpectrumRequest { count: 2, cost_rise: Some(-1.0) };
    assert!(matches!(refused(&[], rise), SpectrumRefusal::Rise(_)));
    let ball = r#"constraints=[{ "obstacle": { "surface": "z+", "shape": { "sphere": { "center": [3, 0, 0], "radius": 0.1 } } } }]"#;
    assert!(matches!(refused(&[ball], SpectrumRequest::leading(2)), SpectrumRefusal::Constraints));
}
