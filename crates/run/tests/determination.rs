//! Optima whose control the cost does not determine.

#![allow(clippy::unwrap_used, clippy::panic)] // a test may

use crate::common;

use common::{CaseDirectory, bar_with, messages};
use nastic_language::schema::Command;

/// The mean of the end is brought to a place along x by cells of fibres: one number, three of them.
#[test]
fn controls_that_the_cost_does_not_determine() {
    let driven = |space: &str, more: &str| {
        bar_with(&format!(
            r#", "actuation": [ {{ "name": "fibers", "kind": "fiber_tension", "region": "body", "direction": "x" }} ],
                 "controls": [ {{ "of": "fibers", "space": "{space}", "start": "-1 kPa", "lower": "-20 kPa", "upper": 0 }} ],
                 "costs": [ {{ "kind": "position", "surface": "x+", "target": {{ "x": "19.8 mm" }} }}{more} ]"#
        ))
    };
    let optimize = |case: &str| {
        let found = CaseDirectory::new().run(Command::Optimize, case, &[]).unwrap_or_else(|error| panic!("{error}"));
        messages(&found.result, "undetermined")
    };
    let told = optimize(&driven("cell", ""));
    assert!(told.len() == 1 && told[0].contains("looks at 1 number of the body, and 3 control values"), "{told:?}");
    assert!(optimize(&driven("uniform", "")).is_empty());
    let settled = r#", { "kind": "control_norm", "of": "fibers", "weight": 1e-6 }"#;
    assert!(optimize(&driven("cell", settled)).is_empty());
}
