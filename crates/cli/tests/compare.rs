//! `nastic compare` and `nastic cloud` on runs.

#![allow(clippy::unwrap_used)] // a test may

use crate::common;

use common::{BAR, CaseDirectory, code, text};
use serde_json::Value;

fn solved(place: &CaseDirectory, out: &str, tension: &str) {
    let set = format!("controls/0/start={tension}");
    let output = place.nastic(&["solve", "case.json", "--out", out, "--quiet", "--set", &set]);
    assert_eq!(code(&output), 0, "{}", text(&output.stderr));
}

fn compared(place: &CaseDirectory, arguments: &[&str]) -> Value {
    let output = place.nastic(&[&["compare", "--json"], arguments].concat());
    assert_eq!(code(&output), 0, "{}", text(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

#[test]
fn two_runs_and_the_clouds_of_their_states() {
    let place = CaseDirectory::new(BAR);
    solved(&place, "soft", "\"1 kPa\"");
    solved(&place, "hard", "\"8 kPa\"");
    let found = compared(&place, &["soft", "hard"]);
    let apart = found["node_by_node"]["largest"].as_f64().unwrap();
    assert!(apart > 1e-5 && found["unit"].is_string(), "{found}");
    assert_eq!(compared(&place, &["soft/start", "hard/start.vtu"])["node_by_node"], found["node_by_node"]);
    assert_eq!(compared(&place, &["soft", "soft"])["hausdorff"], 0.0);
    for ending in ["csv", "npy", "ply"] {
        let file = format!("clouds/hard.{ending}");
        let output = place.nastic(&["cloud", "hard", "--out", &file]);
        assert_eq!((code(&output), text(&output.stdout).trim()), (0, file.as_str()), "{}", text(&output.stderr));
        // all nodes lie in the body itself, those within it off its boundary
        let own = compared(&place, &["hard", &file]);
        assert!(own["a_to_b"]["largest"].as_f64().unwrap() < 1e-12, "{own}");
        let output = place.nastic(&["cloud", "hard", "--state", "start", "--surface", "x+", "--out", &file]);
        assert_eq!(code(&output), 0, "{}", text(&output.stderr));
        let face = compared(&place, &["hard", &file, "--surface", "x+"]);
        assert!(
            face["b_to_a"]["largest"].as_f64().unwrap() < 1e-12 && face["chamfer"].as_f64().unwrap() < 1e-12,
            "{face}"
        );
    }
}

#[test]
fn refusals_say_what_there_is() {
    let place = CaseDirectory::new(BAR);
    solved(&place, "out", "\"1 kPa\"");
    let refused = |arguments: &[&str]| {
        let output = place.nastic(arguments);
        assert_eq!(code(&output), 2, "{arguments:?}");
        text(&output.stderr)
    };
    assert!(refused(&["compare", "out", "nowhere"]).contains("is no shape"));
    assert!(refused(&["compare", "out", "out/optimum"]).contains("there is no state \"optimum\"; there is: start"));
    assert!(refused(&["cloud", "out", "--surface", "lid", "--out", "a.csv"]).contains("\"lid\""));
    assert!(refused(&["cloud", "out", "--state", "motion_0001", "--out", "a.csv"]).contains("there is: start"));
    let output = place.nastic(&["cloud", "out", "--out", "a.obj"]);
    assert_eq!(code(&output), 7, "{}", text(&output.stderr));
    assert!(text(&output.stderr).contains(".csv, .npy or .ply"));
}
