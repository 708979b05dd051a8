//! `nastic new`: cases that check without warnings and optimise, and nothing replaced.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use crate::common;

use common::{BAR, CaseDirectory, code, text};

const TEMPLATES: [&str; 10] = [
    "finger",
    "chamber",
    "gripper",
    "grasp_3d",
    "tendon_finger",
    "fiber_reinforced",
    "magnet",
    "layout",
    "growth",
    "robust",
];

#[test]
fn every_template_checks_without_a_warning() {
    let place = CaseDirectory::new(BAR);
    for name in TEMPLATES {
        let made = place.nastic(&["new", &format!("robots/my_{name}"), "--template", name]);
        assert_eq!(code(&made), 0, "{name}: {}", text(&made.stderr));
        let case = format!("robots/my_{name}/my_{name}.json");
        let message = text(&made.stdout);
        let expected =
            format!("written     {case}\nnext        nastic check {case}\n            nastic optimize {case}\n");
        assert_eq!(message, expected);
        let checked = place.nastic(&["check", &case, "--strict"]);
        assert_eq!(code(&checked), 0, "{name}: {}{}", text(&checked.stdout), text(&checked.stderr));
        assert!(!text(&checked.stdout).contains("WARNING"), "{name}: {}", text(&checked.stdout));
    }
}

/// The chamber takes seconds an iteration where the code is not optimised; it is the case `finger.json`, which other tests run.
#[test]
fn templates_optimise_without_a_warning() {
    let place = CaseDirectory::new(BAR);
    for name in TEMPLATES.into_iter().filter(|name| *name != "chamber") {
        assert_eq!(code(&place.nastic(&["new", name, "--template", name])), 0);
        let case = format!("{name}/{name}.json");
        let out = format!("out_{name}");
        let output = place.nastic(&["optimize", &case, "--strict", "--no-report", "--json", "--out", &out]);
        assert_eq!(code(&output), 0, "{name}: {}{}", text(&output.stdout), text(&output.stderr));
        let result: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        let cost = |at: &serde_json::Value| at["cost"]["total"].as_f64().unwrap();
        let (from, to) = (cost(&result["start"]), cost(&result));
        assert!(to < 0.5 * from && result["converged"] == true, "{name}: {from} {to}");
        assert!(place.path(&out).join("picture.png").exists(), "{name}: no picture");
    }
    assert_eq!(code(&place.nastic(&["new", "air", "--template", "chamber"])), 0);
    let set = ["--set", "optimizer/max_iterations=1"];
    let output = place.nastic(&[&["optimize", "air/air.json", "--no-report"][..], &set].concat());
    assert_eq!(code(&output), 4, "{}{}", text(&output.stdout), text(&output.stderr));
}

#[test]
fn nothing_is_replaced() {
    let place = CaseDirectory::new(BAR);
    std::fs::create_dir(place.path("mine")).unwrap();
    let output = place.nastic(&["new", "mine"]);
    assert_eq!(code(&output), 2);
    assert!(text(&output.stderr).contains("mine exists already and is left as it is"), "{}", text(&output.stderr));
    assert_eq!(std::fs::read_dir(place.path("mine")).unwrap().count(), 0);
    let output = place.nastic(&["new", "case.json", "--template", "magnet"]);
    assert_eq!(code(&output), 2);
    assert_eq!(std::fs::read_to_string(place.path("case.json")).unwrap(), BAR);
    let output = place.nastic(&["new", "case.json/deeper"]);
    assert_eq!(code(&output), 7, "{}", text(&output.stderr));
    let output = place.nastic(&["new", "other", "--template", "hand"]);
    assert_eq!(code(&output), 2);
    assert!(
        text(&output.stderr).contains(
            "finger, chamber, gripper, grasp_3d, tendon_finger, fiber_reinforced, magnet, layout, growth, robust"
        ),
        "{}",
        text(&output.stderr)
    );
}
