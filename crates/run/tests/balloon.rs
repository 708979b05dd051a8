//! A balloon: an inflated cylinder whose pressure has a maximum, which an optimisation is to pass.

#![allow(clippy::unwrap_used, clippy::panic)] // a test may

use crate::common;

use common::{CaseDirectory, Heard};
use nastic_language::schema::Command;
use nastic_run::console::Console;
use nastic_run::run::{Analysis, Exit, Options, Outcome};
use serde_json::Value;
use std::f64::consts::PI;
use std::fmt::Write;

/// Cells across the wall and along the quarter.
const CELLS: [usize; 2] = [1, 4];

/// A quarter of a ring of radii 10 and 13, second order, as Gmsh writes it: "wall", its sides "inner", "x axis", "y axis".
pub fn ring() -> String {
    let [across, along] = CELLS;
    let node = |i: usize, j: usize| 1 + i + (2 * across + 1) * j;
    let mut nodes = String::new();
    for j in 0..=2 * along {
        for i in 0..=2 * across {
            let r = 10.0 + 3.0 * i as f64 / (2 * across) as f64;
            let (sin, cos) = (0.5 * PI * j as f64 / (2 * along) as f64).sin_cos();
            // exactly on the axes
            let x = if j == 2 * along { 0.0 } else { r * cos };
            writeln!(nodes, "{} {x} {} 0", node(i, j), r * sin).unwrap();
        }
    }
    let mut elements = Vec::new();
    for j in 0..along {
        let line = [(0, 2 * j), (0, 2 * j + 2), (0, 2 * j + 1)].map(|(i, j)| node(i, j).to_string());
        elements.push(format!("8 2 1 1 {}", line.join(" ")));
        for i in 0..across {
            let at = [(0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1), (1, 1)];
            let at = at.map(|(a, b)| node(2 * i + a, 2 * j + b).to_string());
            elements.push(format!("10 2 4 4 {}", at.join(" ")));
        }
    }
    for (tag, j) in [(2, 0), (3, 2 * along)] {
        for i in 0..across {
            let line = [2 * i, 2 * i + 2, 2 * i + 1].map(|i| node(i, j).to_string());
            elements.push(format!("8 2 {tag} {tag} {}", line.join(" ")));
        }
    }
    let numbered: String = elements.iter().enumerate().map(|(k, one)| format!("{} {one}\n", k + 1)).collect();
    format!(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n4\n1 1 \"inner\"\n1 2 \"x axis\"\n1 3 \"y axis\"\n2 4 \"wall\"\n$EndPhysicalNames\n\
         $Nodes\n{}\n{nodes}$EndNodes\n$Elements\n{}\n{numbered}$EndElements\n",
        nodes.lines().count(),
        elements.len()
    )
}

const CASE: &str = r#"{ "nastic": 1, "units": "mm", "mesh": "ring.msh",
    "materials": [ { "region": "wall", "law": "yeoh", "c10": "10 kPa", "c20": "-2 kPa", "c30": "0.2 kPa", "bulk": "1 MPa" } ],
    "supports": [ { "surface": "x axis", "fix": ["y"] }, { "surface": "y axis", "fix": ["x"] } ],
    "actuation": [ { "name": "air", "kind": "cavity", "surface": "inner", "symmetry": ["x axis", "y axis"] } ],
    "controls": [ { "of": "air", "name": "breath", "space": "uniform", "start": "1 kPa", "lower": 0, "upper": "30 kPa" } ],
    "costs": [ { "kind": "tracking", "surface": "inner", "target": ["2 * X", "2 * Y"] } ],
    "optimizer": { "max_iterations": 6 } }"#;

fn run(place: &CaseDirectory, command: Command, options: &Options) -> (Outcome, String) {
    place.write("ring.msh", &ring());
    let heard = Heard::default();
    let outcome = place.run_with(command, CASE, &Console::new(heard.clone()), options);
    (outcome.unwrap_or_else(|error| panic!("{error}")), heard.text())
}

fn number(value: &Value, at: &str) -> f64 {
    value.pointer(at).and_then(Value::as_f64).unwrap_or_else(|| panic!("no {at} in {value:#}"))
}

/// The path names the control at its limit point, with value and unit, as the result does.
#[test]
fn a_path_names_the_control_at_its_limit_point() {
    let place = CaseDirectory::new();
    let options = Options { analysis: Analysis::PathToLimit, ..place.options(&["controls/0/start=30 kPa"]) };
    let (outcome, said) = run(&place, Command::Solve, &options);
    let line = said.lines().find(|line| line.starts_with("critical")).unwrap_or_else(|| panic!("{said}"));
    let event = &outcome.result["path"]["events"][0];
    let (s, p) = (number(event, "/value"), number(event, "/controls/breath/max"));
    assert!((p / (s * 0.03) - 1.0).abs() < 1e-12 && event["controls"]["breath"]["unit"] == "MPa", "{event:#}");
    let message = format!("limit point at s = {s:.6}, breath = {} MPa: from 0 to 1", nastic_language::number::short(p));
    assert!(line.contains(&message), "{line} without {message}");
}

/// Every trial is cut, names the limit point that the path finds, and the advice is to control the volume: which passes it.
#[test]
fn a_trial_behind_the_limit_point_is_cut_and_the_volume_is_advised() {
    let place = CaseDirectory::new();
    let path = Options { analysis: Analysis::PathToLimit, ..place.options(&["controls/0/start=30 kPa"]) };
    let limit = number(&run(&place, Command::Solve, &path).0.result, "/path/events/0/controls/breath/max");
    let (outcome, said) = run(&place, Command::Optimize, &place.options(&[]));
    assert_eq!(outcome.exit, Exit::NotConverged, "{said}");
    let met = &outcome.result["limit_points"];
    assert!(number(met, "/trials") >= 1.0, "{said}");
    let found = number(met, "/last/controls/breath/max");
    assert!((found / limit - 1.0).abs() < 1e-4, "{found} and {limit} by the path");
    let failed = said
        .lines()
        .find(|line| line.contains("failed: limit point at breath = 0.00"))
        .unwrap_or_else(|| panic!("{said}"));
    assert!(failed.contains(" MPa ("), "{failed}");
    assert!(said.contains("limits      ") && said.contains("met a limit point"), "{said}");
    let history = std::fs::read_to_string(place.path("out/history.jsonl")).unwrap();
    let trials: Vec<Value> = history.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let most = trials.iter().filter_map(|trial| trial["newton"].as_f64()).fold(0.0, f64::max);
    assert!(most <= 140.0, "{most} iterations: {said}");
    let reason =
        trials.iter().find_map(|trial| trial["reason"].as_str().filter(|why| why.starts_with("failed"))).unwrap();
    assert!(reason.contains("breath = ") && reason.contains("the volume of a cavity"), "{reason}");

    let advice = said.lines().skip_while(|line| !line.contains("control the added volume")).nth(1);
    let advice = advice.unwrap_or_else(|| panic!("{said}"));
    let set: Vec<&str> = advice.split(" --set ").skip(1).map(|one| one.trim().trim_matches('\'')).collect();
    assert!(set.contains(&"controls/0/of=air.volume"), "{advice}");
    let by_volume = [&set[..], &["optimizer/max_iterations=30"]].concat();
    let (passed, said) = run(&place, Command::Optimize, &place.options(&by_volume));
    assert_eq!(passed.exit, Exit::Done, "{said}");
    assert!(number(&passed.result, "/cost/total") < 0.1 * number(&outcome.result, "/cost/total"), "{said}");
    assert!(passed.result["limit_points"].is_null(), "{said}");
}
