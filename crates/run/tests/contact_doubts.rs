//! What contacts warn of.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use crate::common;
use crate::contact::{BLOCK, INDENTED, SLIDER, number, solve};

use common::with;
use serde_json::Value;

/// A largest pressure that one facet carries is one of the mesh; whether anybody asks for it or not.
#[test]
fn a_pressure_of_few_facets_is_told() {
    let asked = with(
        INDENTED,
        r#"{ "kind": "position", "point": [10, 10, 10], "target": { "z": 8 } }"#,
        r#"{ "kind": "contact_pressure", "contact": "dent" }"#,
    );
    let told = |case: &str, deep: &str| {
        let found = solve(&with(case, r#""start": 1.5"#, deep)).1;
        common::messages(&found, "few_facets")
    };
    let shallow = told(&asked, r#""start": 0.1"#);
    assert!(shallow.len() == 1 && shallow[0].contains("its largest pressure is one of the mesh"), "{shallow:?}");
    assert!(told(INDENTED, r#""start": 0.1"#).is_empty());
}

fn codes(found: &Value) -> Vec<&str> {
    found["warnings"].as_array().unwrap().iter().map(|warning| warning["code"].as_str().unwrap()).collect()
}

#[test]
fn contacts_warn_of_what_is_doubtful_in_them() {
    let held = with(
        BLOCK,
        r#""surface": "y-", "fix": ["y"] }"#,
        r#""surface": "y-", "fix": ["y"] }, { "surface": "z+", "fix": ["z"] }"#,
    );
    let (_, far) = solve(&held);
    assert_eq!(codes(&far), ["no_contact"], "{}", far["warnings"]);
    let soft = with(BLOCK, r#""obstacle": "floor""#, r#""obstacle": "floor", "stiffness": "50 Pa""#);
    let (_, soft) = solve(&soft);
    assert_eq!(codes(&soft), ["input", "penetrated"], "{}", soft["warnings"]);
    let shallow = with(INDENTED, r#""start": 1.5"#, r#""start": 0.2"#);
    let shallow = with(&shallow, r#""thickness": 0.5"#, r#""thickness": 0.5, "stiffness": "0.5 MPa""#);
    let (_, shallow) = solve(&with(&shallow, r#""lower": "1 MPa""#, r#""lower": "0.1 MPa""#));
    assert_eq!(codes(&shallow), ["thick_layer"], "{}", shallow["warnings"]);
    let bounce = with(SLIDER, "\"backward_euler\"", "\"tr_bdf2\"");
    let bounce = with(&bounce, "\"point\": [0, 0, 0]", "\"point\": [0, 0, -5]");
    let (_, bounce) = solve(&with(&bounce, "\"4 ms\"", "\"10 ms\""));
    assert!(codes(&bounce).contains(&"steps_per_contact"), "{}", bounce["warnings"]);
    let creeps = with(&with(SLIDER, r#""friction": 0.3"#, r#""friction": 0.42"#), "\"1 mm/s\"", "\"20 mm/s\"");
    let (_, creeps) = solve(&creeps);
    assert_eq!(codes(&creeps), ["creeps"], "{}", creeps["warnings"]);
}

/// A punch whose edges lie between nodes, in an equilibrium and in a motion; more samples see more of them. A ball has none.
#[test]
fn edges_between_samples_are_told() {
    let punch = with(
        INDENTED,
        r#""sphere": { "center": [10, 10, 25], "radius": 15 }"#,
        r#""box": { "low": [4, 4, 10], "high": [16, 16, 20] }"#,
    );
    let punch = with(&punch, r#""thickness": 0.5"#, r#""thickness": 0.05, "refine": 1"#);
    let (_, found) = solve(&punch);
    let told = found["warnings"].as_array().unwrap().iter().find(|warning| warning["code"] == "between_nodes");
    let message = told.unwrap_or_else(|| panic!("{}", found["warnings"]))["message"].as_str().unwrap();
    assert!(message.contains("between its samples the body is") && message.contains("% of the 1.5 mm"), "{message}");
    let depth = -number(&found, "contributions/dent/gap_between");
    let gap = number(&found, "contributions/dent/smallest_gap");
    assert!(depth > 0.15 && gap > -0.01 * depth, "{depth}, {gap}");
    let (_, seen) = solve(&with(&punch, r#""refine": 1"#, r#""refine": 4"#));
    let (_, round) = solve(INDENTED);
    assert!(!codes(&round).contains(&"between_nodes"), "{}", round["warnings"]);
    assert!(number(&seen, "contributions/dent/gap_between") > -0.5 * depth);

    let moved = with(&punch, r#""translation": [0.5, 0, 0]"#, r#""translation": [0.5, 0, "-3 mm * t / 1 s"]"#);
    let begin = moved.find(r#""controls""#).unwrap();
    let moved = format!(r#"{}"time": {{ "end": 1, "step": 0.25, "scheme": "quasi_static" }} }}"#, &moved[..begin]);
    let (_, moved) = solve(&moved);
    let told = moved["warnings"].as_array().unwrap().iter().find(|warning| warning["code"] == "between_nodes");
    let message = told.unwrap_or_else(|| panic!("{}", moved["warnings"]))["message"].as_str().unwrap();
    assert!(message.contains("at t = 1 s"), "{message}");
}
