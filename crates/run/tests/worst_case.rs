//! A worst case over scenarios is reported as it is; what is optimised in its place is smoothed.

#![allow(clippy::unwrap_used, clippy::panic)] // a test may

use crate::common;

use common::{CaseDirectory, Heard, bar_with};
use nastic_language::schema::Command;
use nastic_run::console::Console;

/// The exact worst case first, what is optimised below it.
#[test]
fn a_worst_case_without_its_smoothing() {
    let of = |young: &str| format!(r#"{{ "set": {{ "materials/0/young": "{young}" }} }}"#);
    let case = bar_with(&format!(
        r#", "actuation": [ {{ "name": "fibers", "kind": "fiber_tension", "region": "body", "direction": "x", "tension": "-5 kPa" }} ],
             "costs": [ {{ "kind": "position", "surface": "x+", "target": {{ "x": 19 }} }} ],
             "scenarios": [ {}, {}, {} ], "risk": {{ "worst_case": {{ "smoothing": 0.5 }} }}"#,
        of("100 kPa"),
        of("200 kPa"),
        of("300 kPa")
    ));
    let place = CaseDirectory::new();
    let heard = Heard::default();
    let options = place.options(&[]);
    let found = place.run_with(Command::Solve, &case, &Console::new(heard.clone()), &options).unwrap().result;
    let costs: Vec<f64> =
        found["scenarios"].as_object().unwrap().values().map(|one| one["cost"]["total"].as_f64().unwrap()).collect();
    let worst = costs.into_iter().fold(0.0, f64::max);
    let (risk, total) = (&found["risk"], found["cost"]["total"].as_f64().unwrap());
    assert_eq!((risk["exact"].as_f64(), risk["value"].as_f64()), (Some(worst), Some(total)));
    assert!(total < 0.99 * worst, "{risk}");
    let said = heard.text();
    let cost = said.lines().find(|line| line.starts_with("cost ")).unwrap();
    assert!(cost.ends_with("worst case over 3 scenarios"), "{said}");
    let told: f64 = cost.split_whitespace().nth(1).unwrap().trim_end_matches(',').parse().unwrap();
    assert!((told / worst - 1.0).abs() < 1e-8, "{cost}");
    let page = std::fs::read_to_string(place.path("out/report.html")).unwrap();
    assert!(page.contains("smoothed, as it is optimised"), "no footnote");
}
