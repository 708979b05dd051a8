//! Constraints in case files: what they reach, say and write, and what is wrong with them.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use crate::common;

use common::{CaseDirectory, Heard, problems, warnings, with};
use nastic_language::catalogue::Catalogue;
use nastic_language::schema::Command;
use nastic_mesh::{CellKind, Snapshot, box_mesh};
use nastic_run::console::Console;
use nastic_run::run::{Exit, Options, Outcome, resume};
use serde_json::Value;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

const KEEP_OUT: &str = include_str!("../../../examples/cases/keep_out.json");

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or(f64::NAN)
}

fn optimize(place: &CaseDirectory, set: &[&str]) -> (Outcome, String) {
    let heard = Heard::default();
    let outcome = place.run_with(Command::Optimize, KEEP_OUT, &Console::new(heard.clone()), &place.options(set));
    (outcome.unwrap(), heard.text())
}

/// Around the ball: feasible to 1e-8 of the diagonal, at a cost; without the constraint the body is within it.
#[test]
fn a_finger_reaches_around_a_ball() {
    let (place, free) = (CaseDirectory::new(), CaseDirectory::new());
    let (found, text) = optimize(&place, &[]);
    assert_eq!(found.exit, Exit::Done, "{text}");
    let constraints = &found.result["constraints"];
    let ball = &constraints["groups"]["ball"];
    let diagonal = (1.0f64 + 0.04 + 0.04).sqrt();
    assert!((number(&ball["scale"]) - diagonal).abs() < 1e-12);
    assert!(number(&constraints["violation"]) <= 1e-8 && number(&ball["violation"]) <= 1e-8 * diagonal);
    assert_eq!((&ball["sense"], &ball["unit"]), (&Value::from("at_most"), &Value::from("m")));
    let active = ball["active"].as_u64().unwrap();
    assert!(active > 0 && active < ball["count"].as_u64().unwrap());
    assert!(text.contains("\nconstraints ball: largest violation "), "{text}");
    assert!(text.contains(" violation ") && text.contains("new multipliers"), "{text}");

    let (unconstrained, text) = optimize(&free, &["constraints=[]", "expect={}"]);
    assert_eq!(unconstrained.exit, Exit::Done, "{text}");
    assert!(unconstrained.result["constraints"].is_null() && !text.contains("violation"));
    let cost = |outcome: &Outcome| number(&outcome.result["cost"]["total"]);
    assert!(cost(&found) > 5.0 * cost(&unconstrained), "{} and {}", cost(&found), cost(&unconstrained));

    // The history has the cost alone beside that with the penalty; both ends agree.
    let history = std::fs::read_to_string(place.path("out/history.jsonl")).unwrap();
    let lines: Vec<Value> = history.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let last = lines.iter().rfind(|line| line["accepted"] == true).unwrap();
    assert!((number(&last["objective"]) - cost(&found)).abs() <= 1e-12 * cost(&found));
    assert!(number(&last["violation"]) <= 1e-8 && number(&last["penalty"]) > 0.0);
    assert!(lines.iter().any(|line| line["reason"] == "multipliers"));
    // The ball is drawn: 11 x 11 x 6 faces more than without.
    let polygons = |place: &CaseDirectory| std::fs::read_to_string(place.path("out/picture.svg")).unwrap().len();
    assert!(polygons(&place) > polygons(&free) + 10_000, "{} and {}", polygons(&place), polygons(&free));
}

/// Interrupted behind an update of the multipliers and resumed: the same bits.
#[test]
fn resumed_to_the_bit() {
    struct Watch(Arc<AtomicBool>, usize);
    impl std::io::Write for Watch {
        fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
            self.1 = self.1.saturating_sub(std::str::from_utf8(bytes).unwrap().matches("new multipliers").count());
            if self.1 == 0 {
                self.0.store(true, Ordering::Relaxed);
            }
            Ok(bytes.len())
        }

        fn flush(&mut self) -> std::io::Result<()> {
            Ok(())
        }
    }
    let short = ["output/checkpoint=3", "optimizer/max_iterations=40"];
    let (whole, pieces) = (CaseDirectory::new(), CaseDirectory::new());
    let (uninterrupted, _) = optimize(&whole, &short);
    let options = pieces.options(&short);
    let watch = Watch(options.cancel.clone(), 2);
    let broken = pieces.run_with(Command::Optimize, KEEP_OUT, &Console::new(watch), &options).unwrap();
    assert_eq!(broken.exit, Exit::NotConverged);
    let options = Options { threads: Some(1), ..Options::default() };
    let resumed = resume(&Catalogue::standard(), &pieces.path("out"), &options, &Console::silent()).unwrap();
    assert!(resumed.result["resumed"]["iteration"].as_u64().unwrap() > 0);
    for key in ["constraints", "cost", "controls", "iterations", "trials", "stop"] {
        assert_eq!(resumed.result[key], uninterrupted.result[key], "{key}");
    }
}

#[test]
fn bounds_on_functionals() {
    let bound = |of: &str| {
        let from = KEEP_OUT.find("\"constraints\": [").unwrap();
        let to = KEEP_OUT.find("\"optimizer\"").unwrap();
        format!("{}\"constraints\": [ {of} ], {}", &KEEP_OUT[..from], &KEEP_OUT[to..])
    };
    assert_eq!(
        problems(&bound("{ \"cost\": { \"kind\": \"control_norm\", \"of\": \"tension\" }, \"at_most\": 1e6 }")),
        ""
    );
    let wrong = |of: &str, what: &str| {
        let found = problems(&bound(of));
        assert!(found.contains(what), "{of}:\n{found}\nwanted: {what}");
    };
    wrong(
        "{ \"cost\": { \"kind\": \"control_norm\", \"of\": \"tension\" } }",
        "exactly one of \"at_most\", \"at_least\" and \"equal\"",
    );
    wrong("{ \"cost\": { \"kind\": \"control_norm\", \"of\": \"tension\" }, \"at_most\": 0 }", "needs a \"scale\"");
    wrong(
        "{ \"cost\": { \"kind\": \"control_norm\", \"of\": \"tension\" }, \"at_most\": \"2 kPa\" }",
        "constraints/0/at_most",
    );
    wrong(
        "{ \"obstacle\": { \"surface\": \"top\", \"shape\": { \"sphere\": { \"center\": [0, 0, 1], \"radius\": 0.1 } } } }",
        "constraints/0/obstacle/surface",
    );
    wrong(
        "{ \"obstacle\": { \"surface\": \"z+\", \"shape\": { \"sphere\": { \"center\": [0, 0, 1], \"radius\": 0.1 } } }, \"at_most\": 0 }",
        "\"clearance\" in its block",
    );
    wrong(
        "{ \"obstacle\": { \"surface\": \"z+\", \"shape\": { \"half_space\": { \"point\": [0, 0, 1], \"normal\": [0, 0, 0] } } } }",
        "the normal of a half-space is zero or not finite",
    );
    wrong("{ \"obstacle\": { \"surface\": \"z+\", \"shape\": { \"ball\": {} } } }", "sphere");
}

/// Without clearance the upper side enters a ball between nodes 50 mm apart, that all its nodes keep out of.
#[test]
fn what_the_body_does_between_nodes_is_told() {
    let codes = |outcome: &Outcome| -> Vec<String> {
        let all = outcome.result["warnings"].as_array().unwrap();
        all.iter().map(|warning| warning["code"].as_str().unwrap().to_owned()).collect()
    };
    let (found, text) = optimize(&CaseDirectory::new(), &["constraints/0/obstacle/clearance=0", "expect={}"]);
    let between = &found.result["constraints"]["groups"]["ball"]["between_nodes"];
    let (distance, x) = (number(&between["distance"]), &between["position"]);
    let from_center =
        [0.6, 0.1, 0.43].iter().zip(x.as_array().unwrap()).map(|(c, x)| (number(x) - c).powi(2)).sum::<f64>();
    assert!((from_center.sqrt() - 0.15 - distance).abs() < 1e-12, "{between}");
    // h^2/(8 R) with h = 0.05 m, R = 0.15 m is 2 mm.
    assert!(distance < -1e-5 && distance > -4e-3, "{between}");
    assert!(
        codes(&found).contains(&"between_nodes".to_owned()) && text.contains("inside of the obstacle, at ("),
        "{text}"
    );
    let (clear, text) = optimize(&CaseDirectory::new(), &[]);
    let between = &clear.result["constraints"]["groups"]["ball"]["between_nodes"];
    assert!(number(&between["distance"]) > 0.0, "{between}");
    assert!(!codes(&clear).contains(&"between_nodes".to_owned()), "{text}");
}

/// Two iterations are too few; a ball that fits between the nodes is seen by none of them.
#[test]
fn ends_and_beginnings_inside_of_an_obstacle_are_told() {
    let (found, text) = optimize(&CaseDirectory::new(), &["optimizer/max_iterations=2", "expect={}"]);
    let violation = number(&found.result["constraints"]["groups"]["ball"]["violation"]);
    let message = found.result["warnings"].as_array().unwrap().iter().any(|warning| warning["code"] == "violated");
    assert!(violation > 1e-3 && message && text.contains("the constraints are not met: ball by "), "{text}");
    let small = with(
        KEEP_OUT,
        r#""center": [0.6, 0.1, 0.43], "radius": 0.15"#,
        r#""center": [0.55, 0.05, 0.2], "radius": 0.045"#,
    );
    let text = warnings(&with(&small, "\"2 mm\"", "0"));
    assert!(text.contains("the body at rest is inside of the obstacle between its nodes, at ("), "{text}");
}

/// A ball about the clamp: reported before anything is solved, and by the end, with the node.
#[test]
fn a_support_within_an_obstacle_is_told() {
    let close = with(KEEP_OUT, "\"2 mm\"", "\"0 mm\"");
    let at_clamp = with(&close, "[0.6, 0.1, 0.43]", "[0.0, 0.1, 0.3]");
    let message = warnings(&at_clamp);
    assert_eq!(warnings(KEEP_OUT), "");
    let held = "nodes that a support holds lie inside of the obstacle, node ";
    assert!(message.contains(held) && message.contains("(0, 0.1, 0.2) by 0.05 m: no control can meet"), "{message}");
    assert!(message.contains("of the body at rest lie inside of the obstacle, node "), "{message}");
    let place = CaseDirectory::new();
    let heard = Heard::default();
    let set = ["optimizer/max_iterations=5", "expect={}"];
    let options = place.options(&set);
    let found = place.run_with(Command::Optimize, &at_clamp, &Console::new(heard.clone()), &options).unwrap();
    let worst = &found.result["constraints"]["groups"]["ball"]["worst"];
    assert!((number(&worst["value"]) - 0.05).abs() < 1e-9 && worst["node"].is_u64(), "{worst}");
    let line = format!("ball: largest violation 0.05 m at node {} (0, 0.1, 0.2)", worst["node"]);
    assert!(heard.text().contains(&line), "{line} in\n{}", heard.text());
}

/// Walls and balls are files of their own, and the page shows them.
#[test]
fn obstacles_are_drawn() {
    let place = CaseDirectory::new();
    let wall = r#"{ "half_space": { "point": [0, 0, -0.3], "normal": [0, 0, 2] } }"#;
    let wall = format!(r#""costs": [ {{ "kind": "obstacle", "surface": "z-", "shape": {wall} }},"#);
    let walled = with(KEEP_OUT, "\"costs\": [", &wall);
    let options = place.options(&["optimizer/max_iterations=1", "expect={}"]);
    let found = place.run_with(Command::Optimize, &walled, &Console::silent(), &options).unwrap();
    let names = ["obstacle_1.vtu", "obstacle_2.vtu"];
    assert_eq!(found.result["members"][0]["obstacles"], serde_json::json!(names));
    let read = |name: &str| nastic_io::read_snapshot(place.path("out").join(name)).unwrap().mesh;
    let points = [read(names[0]), read(names[1])].map(|mesh| mesh.points().to_vec());
    let ball = points[0].iter().map(|x| ((x[0] - 0.6).powi(2) + (x[1] - 0.1).powi(2) + (x[2] - 0.43).powi(2)).sqrt());
    assert!((ball.fold(0.0, f64::max) - 0.15).abs() < 1e-9);
    let top = points[1].iter().map(|x| x[2]).fold(f64::NEG_INFINITY, f64::max);
    assert!((top + 0.3).abs() < 1e-9, "the wall ends at its plane: {top}");
    let page = std::fs::read_to_string(place.path("out/report.html")).unwrap();
    assert_eq!(page.matches(r#""label":"obstacle""#).count(), 2);
}

/// A box from a mesh file is the box by its corners, and is drawn; other files are refused where they stand.
#[test]
fn an_obstacle_may_be_a_mesh() {
    let ball = r#"{ "sphere": { "center": [0.6, 0.1, 0.43], "radius": 0.15 } }"#;
    let run = |shape: &str, element: CellKind| {
        let place = CaseDirectory::new();
        let at = |x: [f64; 3]| [x[0] + 0.5, x[1] - 0.1, x[2] + 0.3];
        let rock = box_mesh([0.2, 0.4, 0.2], [2, 3, 2], element).unwrap().mapped(at).unwrap();
        nastic_io::write_vtu(place.path("rock.vtu"), &Snapshot::new(rock)).unwrap();
        let options = place.options(&["optimizer/max_iterations=3", "expect={}"]);
        let case = with(KEEP_OUT, ball, shape);
        place.run_with(Command::Optimize, &case, &Console::silent(), &options).map(|found| (found.result, place))
    };
    let formula = r#"{ "box": { "low": [0.5, -0.1, 0.3], "high": [0.7, 0.3, 0.5] } }"#;
    let (by_formula, _) = run(formula, CellKind::Tet4).unwrap();
    let (by_mesh, place) = run(r#"{ "mesh": "rock.vtu" }"#, CellKind::Tet4).unwrap();
    let cost = |result: &Value| number(&result["cost"]["total"]);
    assert!((cost(&by_mesh) / cost(&by_formula) - 1.0).abs() < 1e-9, "{} {}", cost(&by_mesh), cost(&by_formula));
    let violation = |result: &Value| number(&result["constraints"]["groups"]["ball"]["violation"]);
    assert!(violation(&by_mesh) > 0.0 && (violation(&by_mesh) - violation(&by_formula)).abs() < 1e-9);
    let drawn = nastic_io::read_snapshot(place.path("out/obstacle_1.vtu")).unwrap().mesh;
    assert_eq!(drawn.cells(), 72);
    let scaled = r#"{ "mesh": { "file": "rock.vtu", "scale": 0.5 } }"#;
    assert!(cost(&run(scaled, CellKind::Hex8).unwrap().0) != cost(&by_mesh));
    let Err(curved) = run(r#"{ "mesh": "rock.vtu" }"#, CellKind::Hex20) else { panic!("curved") };
    let message = curved.to_string();
    assert!(message.contains("constraints/0/obstacle/shape/mesh") && message.contains("linear cells"), "{message}");
    let Err(missing) = run(r#"{ "mesh": "stone.vtu" }"#, CellKind::Hex8) else { panic!("missing") };
    assert!(missing.to_string().contains("stone.vtu"), "{missing}");
}

/// A rock in millimetres beside a body in metres would be far away, and the constraint would hold for nothing.
#[test]
fn the_size_of_an_obstacle_from_a_mesh_is_told() {
    let ball = r#"{ "sphere": { "center": [0.6, 0.1, 0.43], "radius": 0.15 } }"#;
    let place = CaseDirectory::new();
    let rock = box_mesh([0.2, 0.4, 0.3], [2, 3, 2], CellKind::Tet4).unwrap();
    let rock = rock.mapped(|x| [x[0] + 0.5, x[1] - 0.1, x[2] + 0.3]).unwrap();
    nastic_io::write_vtu(place.path("rock.vtu"), &Snapshot::new(rock)).unwrap();
    let message = |command: Command, scale: f64| {
        let shape = format!(r#"{{ "mesh": {{ "file": "rock.vtu", "scale": {scale} }} }}"#);
        place.text(command, &with(KEEP_OUT, ball, &shape), &["expect={}"])
    };
    for command in [Command::Check, Command::Solve] {
        let said = message(command, 1.0);
        assert!(said.contains("obstacle rock.vtu: 72 cells, size 0.2 x 0.4 x 0.3 m\n"), "{said}");
        assert!(!said.contains("[units]"), "{said}");
    }
    assert_eq!(place.json("result.json")["notes"][0], "obstacle rock.vtu: 72 cells, size 0.2 x 0.4 x 0.3 m");
    let said = message(Command::Check, 1000.0);
    let wanted = "constraints/0/obstacle/shape/mesh: the body measures 1 x 0.2 x 0.2 m, this obstacle 200 x 400 x 300 m: \
                  are both drawn in the same unit?";
    assert!(said.contains("WARNING     [units]") && said.contains(wanted), "{said}");
}

/// Taylor tests of the constraint beside those of the cost, whatever the size of the cost.
#[test]
fn constraints_have_taylor_tests() {
    let weighed = with(KEEP_OUT, r#""kind": "tracking","#, r#""kind": "tracking", "weight": 1e12,"#);
    for case in [KEEP_OUT, &weighed] {
        let found = CaseDirectory::new().run(Command::Gradcheck, case, &[]).unwrap();
        assert_eq!(found.exit, Exit::Done, "{:#}", found.result["gradcheck"]);
        let tests = found.result["gradcheck"]["tests"].as_array().unwrap();
        let ball = tests.iter().find(|test| test["term"] == "constraint ball").unwrap();
        assert_eq!((&ball["verdict"], &ball["second"]), (&Value::from("right"), &Value::from("right")), "{ball:#}");
    }
}

/// At the start controls nothing holds the body out of the ball: said by every command that computes that state, for constraints and costs.
#[test]
fn a_state_inside_of_an_obstacle_is_said_to_be() {
    let inside = r#"controls/0/start="-250e3 * (Z > 0.1)""#;
    let ball = r#""shape": { "sphere": { "center": [0.6, 0.1, 0.43], "radius": 0.15 } }"#;
    let weighed =
        with(KEEP_OUT, "\"costs\": [", &format!(r#""costs": [ {{ "kind": "obstacle", "surface": "z+", {ball} }},"#));
    for command in [Command::Solve, Command::Gradient] {
        let place = CaseDirectory::new();
        let found = place.run(command.clone(), &weighed, &[inside, "expect={}"]).unwrap();
        let said: Vec<_> =
            found.result["warnings"].as_array().unwrap().iter().filter(|one| one["code"] == "violated").collect();
        let text = |k: usize| said[k]["message"].as_str().unwrap();
        assert!(
            said.len() == 2 && said.iter().all(|one| one["message"].as_str().unwrap().contains("no force")),
            "{said:?}"
        );
        assert!(text(0).contains("ball by 0.") && text(0).contains(" at node "), "{}", text(0));
        assert!(text(1).contains("inside of the obstacle of cost obstacle"), "{}", text(1));
        let group = &found.result["constraints"]["groups"]["ball"];
        assert!(number(&group["violation"]) > 0.01, "{group}");
        let outside = place.run(command.clone(), &weighed, &["expect={}"]).unwrap();
        assert!(outside.result["warnings"].as_array().unwrap().iter().all(|one| one["code"] != "violated"));
        assert_eq!(number(&outside.result["constraints"]["groups"]["ball"]["violation"]), 0.0);
        // a bound on a functional has nothing to do with forces of obstacles
        let bound = r#"{"cost":{"kind":"position","point":[1,0.1,0.1],"target":{"x":0.7,"z":0.5}},"at_most":1e-6}"#;
        let both = format!(r#"constraints=[{{"obstacle":{{"surface":"z+",{ball}}}}},{bound}]"#);
        let far = place.run(command.clone(), KEEP_OUT, &[&both, "expect={}"]).unwrap();
        let said = far.result["warnings"].as_array().unwrap().iter().find(|one| one["code"] == "violated").unwrap();
        let message = said["message"].as_str().unwrap();
        assert!(message.contains("position by ") && !message.contains("no force"), "{message}");
    }
}
