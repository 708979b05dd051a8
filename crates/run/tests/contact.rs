//! Contact in case files.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use crate::common;

use common::{CaseDirectory, Heard, problems, warnings, with};
use nastic_language::number::short;
use nastic_language::schema::Command;
use nastic_opt::{Row, SecondOrder, TaylorDirection, Verdict};
use nastic_run::console::Console;
use nastic_run::result::find;
use nastic_run::run::{Analysis, GradientTest, Options};
use serde_json::Value;

/// A block of 4 g above a floor, which nothing but the floor holds in z.
pub const BLOCK: &str = r#"{ "nastic": 1, "units": "mm",
  "mesh": { "box": { "size": [20, 20, 10], "cells": [2, 2, 1], "element": "hex8" } },
  "materials": [ { "region": "body", "law": "neo_hooke", "young": "0.1 MPa", "poisson": 0.3, "density": "1000 kg/m^3" } ],
  "supports": [ { "surface": "x-", "fix": ["x"] }, { "surface": "y-", "fix": ["y"] } ],
  "loads": [ { "gravity": [0, 0, "-9.81 m/s^2"] } ],
  "obstacles": [ { "name": "floor", "shape": { "half_space": { "point": [0, 0, "-0.5 mm"], "normal": [0, 0, 1] } } } ],
  "contact": [ { "surface": "z-", "obstacle": "floor" } ],
  "probes": [ { "name": "corner", "point": [20, 20, 0] } ] }"#;

/// The same, free, pushed along a floor with friction by another weight.
pub const SLIDER: &str = r#"{ "nastic": 1, "units": "mm",
  "mesh": { "box": { "size": [20, 20, 10], "cells": [2, 2, 1], "element": "hex8" } },
  "materials": [ { "region": "body", "law": "neo_hooke", "young": "0.1 MPa", "poisson": 0.3, "density": "1000 kg/m^3" } ],
  "loads": [ { "gravity": ["4 m/s^2", 0, "-10 m/s^2"] } ],
  "time": { "end": "200 ms", "step": "4 ms", "scheme": "backward_euler", "start": "rest", "output": "40 ms" },
  "obstacles": [ { "name": "floor", "shape": { "half_space": { "point": [0, 0, 0], "normal": [0, 0, 1] } } } ],
  "contact": [ { "name": "feet", "surface": "z-", "obstacle": "floor", "friction": 0.3, "slip_speed": "1 mm/s" } ],
  "probes": [ { "name": "corner", "point": [20, 20, 10] } ] }"#;

/// A bar that a ball indents, whose place and stiffness are controls.
pub const INDENTED: &str = r#"{ "nastic": 1, "units": "mm",
  "mesh": { "box": { "size": [20, 20, 10], "cells": [4, 4, 2], "element": "hex8" } },
  "materials": [ { "region": "body", "law": "neo_hooke", "young": "0.1 MPa", "poisson": 0.3 } ],
  "supports": [ { "surface": "z-", "fix": "all" } ],
  "obstacles": [ { "name": "ball", "shape": { "sphere": { "center": [10, 10, 25], "radius": 15 } }, "translation": [0.5, 0, 0] } ],
  "contact": [ { "name": "dent", "surface": "z+", "obstacle": "ball", "thickness": 0.5 } ],
  "controls": [ { "of": "ball.translation", "name": "depth", "direction": [0, 0, -1], "space": "uniform", "lower": 0, "upper": 3, "start": 1.5 },
                { "of": "dent.stiffness", "space": "uniform", "lower": "1 MPa", "upper": "20 MPa" } ],
  "costs": [ { "kind": "position", "point": [10, 10, 10], "target": { "z": 8 } } ] }"#;

pub fn solve(case: &str) -> (CaseDirectory, Value) {
    let place = CaseDirectory::new();
    let found = place.run(Command::Solve, case, &[]).unwrap_or_else(|error| panic!("{error}")).result;
    (place, found)
}

pub fn number(found: &Value, path: &str) -> f64 {
    find(found, path).and_then(Value::as_f64).unwrap_or_else(|| panic!("{path} in {found}"))
}

#[test]
fn a_floor_carries_the_weight_of_a_block_that_nothing_else_holds() {
    let (place, found) = solve(BLOCK);
    let weight = 4e-3 * 9.81;
    let force = number(&found, "contributions/z- on floor/force_z");
    assert!((force - weight).abs() < 1e-8 * weight, "{force}");
    assert!((number(&found, "contributions/z- on floor/area") - 400.0).abs() < 1e-9);
    // it stands off by the layer, of 1/500 of the surface's diagonal
    let sunk = number(&found, "probes/corner/displacement/2");
    assert!((sunk + 0.5 - 800.0f64.sqrt() / 500.0).abs() < 1e-3, "{sunk}");
    assert_eq!(found["warnings"], serde_json::json!([]));
    let shown = std::fs::read_to_string(place.path("out").join("start.vtu")).unwrap();
    assert!(shown.contains("Name=\"contact_pressure\""), "{shown}");
    assert!(place.files().contains(&"obstacle_1.vtu".to_owned()));
    let heard = place.text(Command::Solve, BLOCK, &[]);
    assert!(heard.contains("contact     z- on floor pushes with (0, 0, 0.03924) N"), "{heard}");
    let heard = place.text(Command::Check, BLOCK, &[]);
    assert!(heard.contains("floor: a half-space, at rest") && heard.contains("gap at rest 0.5 mm"), "{heard}");
}

#[test]
fn what_is_free_beside_the_contact_is_named() {
    let supports = r#""supports": [ { "surface": "x-", "fix": ["x"] }, { "surface": "y-", "fix": ["y"] } ],"#;
    let free = &with(BLOCK, supports, "");
    let (place, found) = solve(free);
    assert_eq!(number(&found, "free_motion/count"), 3.0);
    let named = "nothing resists 3 rigid motion(s) of the body (shift along x, shift along y, rotation about z)";
    assert!(std::fs::read_to_string(place.path("out").join("report.html")).unwrap().contains(named));
    let heard = [Command::Solve, Command::Check].map(|command| place.text(command, free, &[])).concat();
    assert!(heard.contains(named) && heard.contains("contact alone holds what they leave free"), "{heard}");
}

/// s = a t (t + h) / 2 of backward Euler, a = 4 - 0.3 * 10 m/s^2, from the floor that it touches at rest.
#[test]
fn a_slider_slides_against_its_friction_and_says_so() {
    let (place, found) = solve(SLIDER);
    let weight = 4e-3 * 10.0;
    let of = |name: &str| number(&found, &format!("contributions/feet/{name}"));
    assert!((of("force_z") - weight).abs() < 1e-3 * weight, "{}", of("force_z"));
    assert!((of("force_x") + 0.3 * weight).abs() < 1e-3 * weight, "{}", of("force_x"));
    assert_eq!(of("sticking"), 0.0);
    assert!((of("sliding_speed") - 200.0).abs() < 5.0, "{}", of("sliding_speed"));
    let table = std::fs::read_to_string(place.path("out").join("motion.csv")).unwrap();
    assert!(table.starts_with("t,") && table.lines().next().unwrap().contains("feet.sticking"), "{table}");
    let last = table.lines().last().unwrap().split(',').map(|x| x.parse::<f64>().unwrap()).collect::<Vec<_>>();
    let column = table.lines().next().unwrap().split(',').position(|name| name == "feet.force_x").unwrap();
    assert_eq!(last[column], of("force_x"));
    let widths: Vec<usize> = table.lines().map(|line| line.split(',').count()).collect();
    assert!(widths.iter().all(|width| *width == widths[0]), "{widths:?}");
    // more friction than it needs: it stays, and creeps at e (1 - sqrt(1 - 4/(0.8 10)))
    let (_, held) = solve(&with(SLIDER, r#""friction": 0.3"#, r#""friction": 0.8"#));
    let speed = number(&held, "contributions/feet/sliding_speed");
    assert!((speed - (1.0 - f64::sqrt(0.5))).abs() < 1e-2, "{speed}");
    assert_eq!(number(&held, "contributions/feet/sticking"), 1.0);
}

/// A hold whose forces grow by 6 % a step, at 95 % of the cone: friction by the normal forces of the step before slips at
/// `v = sum_n h (g_n sin - mu g_(n-1) cos)`, `g_0 = 0`, as nothing presses before, `mu = tan / 0.95`; with those of the step itself it creeps below the
/// slip speed.
#[test]
fn lagged_friction_slips_where_forces_grow() {
    let growing = with(
        SLIDER,
        r#""gravity": ["4 m/s^2", 0, "-10 m/s^2"]"#,
        r#""gravity": ["3.8 m/s^2 * 1.06^(t / (4 ms))", 0, "-10 m/s^2 * 1.06^(t / (4 ms))"]"#,
    );
    let growing = with(&growing, r#""friction": 0.3"#, r#""friction": 0.4"#);
    let lagged = with(&growing, r#""friction": 0.4"#, r#""friction": 0.4, "lagged": true"#);
    let speed = |case: &str| number(&solve(case).1, "contributions/feet/sliding_speed");
    assert!(speed(&growing) < 1.0, "{}", speed(&growing));
    // mm/s, backward Euler
    let before = |n: i32| if n == 1 { 0.0 } else { 1.06f64.powi(n - 1) };
    let expected: f64 = (1..=50).map(|n| 4.0 * (3.8 * 1.06f64.powi(n) - 0.4 * 10.0 * before(n))).sum();
    let found = speed(&lagged);
    assert!((found / expected - 1.0).abs() < 0.02, "{found} {expected}");
    let heard = CaseDirectory::new().text(Command::Check, &lagged, &[]);
    assert!(heard.contains("friction 0.4, with the normal forces of the instant before, slip speed 1 mm/s"), "{heard}");
}

#[test]
fn friction_needs_time() {
    let case = with(BLOCK, r#""obstacle": "floor""#, r#""obstacle": "floor", "friction": 0.3"#);
    let message = problems(&case);
    assert!(message.contains("contact/0/friction") && message.contains("quasi_static"), "{message}");
    let message = problems(&with(SLIDER, r#", "start": "rest""#, ""));
    assert!(message.contains("the motion would begin at one: give \"start\": \"rest\""), "{message}");
}

#[test]
fn a_pose_and_a_stiffness_are_controls_with_exact_derivatives() {
    let place = CaseDirectory::new();
    let found = place.run(Command::Gradcheck, INDENTED, &[]).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(found.exit.code(), 0, "{}", found.result);
    // the stiffness starts from what the contact takes, the given part of the pose stays
    let heard = place.text(Command::Check, INDENTED, &[]);
    assert!(heard.contains("start 10 MPa"), "{heard}");
    let solved = place.run(Command::Solve, INDENTED, &[]).unwrap().result;
    assert!(number(&solved, "contributions/dent/force_x").abs() > 1e-6, "{}", solved["contributions"]);
    let best = place.run(Command::Optimize, INDENTED, &["optimizer/max_iterations=40"]).unwrap().result;
    assert!(number(&best, "cost/total") < 1e-6, "{}", best["cost"]);
    assert!(place.files().contains(&"optimum_obstacles.vtu".to_owned()), "{:?}", place.files());
}

/// The ball shall press with 5 mN, or at 2 kPa in the smoothed maximum; and it goes as deep as a bound on its force lets it.
#[test]
fn force_and_pressure_of_a_contact_are_costs_and_bounds() {
    let place = CaseDirectory::new();
    for cost in [
        r#"{ "kind": "contact_force", "contact": "dent" }"#,
        r#"{ "kind": "contact_pressure", "contact": "dent", "exponent": 3 }"#,
    ] {
        let case = with(INDENTED, r#"{ "kind": "position", "point": [10, 10, 10], "target": { "z": 8 } }"#, cost);
        let found = place.run(Command::Gradcheck, &case, &[]).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(found.exit.code(), 0, "{cost}: {}", found.result);
    }
    let bounded = with(
        INDENTED,
        r#""costs""#,
        r#""constraints": [ { "cost": { "kind": "contact_force", "contact": "dent" }, "at_most": 0.5 } ], "costs""#,
    );
    let bounded = with(&bounded, r#""start": 1.5"#, r#""start": 0.8"#);
    let best = place.run(Command::Optimize, &bounded, &["optimizer/max_iterations=60"]).unwrap().result;
    let force = -number(&best, "contributions/dent/force_z");
    assert!((force - 0.5).abs() < 0.05, "{force} {}", best["constraints"]);
    let wrong = with(
        INDENTED,
        r#"{ "kind": "position", "point": [10, 10, 10], "target": { "z": 8 } }"#,
        r#"{ "kind": "contact_force", "contact": "dint" }"#,
    );
    assert!(problems(&wrong).contains("no contact \"dint\"; \"dent\""), "{}", problems(&wrong));
}

#[test]
fn an_obstacle_that_moves_is_written_at_every_instant() {
    let moving = with(SLIDER, r#""floor", "shape""#, r#""floor", "translation": [0, 0, "1 mm * t / (1 s)"], "shape""#);
    let (place, found) = solve(&moving);
    let lifted = number(&found, "probes/corner/displacement/2");
    assert!((lifted - 0.2).abs() < 0.01, "{lifted}");
    let files = place.files();
    assert!(files.contains(&"motion_0000_obstacles.vtu".to_owned()), "{files:?}");
    assert!(!files.contains(&"obstacle_1.vtu".to_owned()), "{files:?}");
    let series = std::fs::read_to_string(place.path("out").join("motion.pvd")).unwrap();
    assert!(series.contains("part=\"1\" file=\"motion_0000_obstacles.vtu\""), "{series}");
    let page = std::fs::read_to_string(place.path("out").join("report.html")).unwrap();
    assert!(page.contains("moved"), "the page shows obstacles that move");
}

#[test]
fn mistakes_get_answers() {
    for (from, to, message) in [
        (r#""obstacle": "floor""#, r#""obstacle": "flor""#, "contact/0/obstacle"),
        (r#""surface": "z-", "obs"#, r#""surface": "zmin", "obs"#, "surface \"zmin\" not found"),
        (r#""obstacle": "floor""#, r#""obstacle": "floor", "thickness": 0"#, "contact/0/thickness"),
        (r#""obstacle": "floor""#, r#""obstacle": "floor", "law": "linear""#, "contact/0/law"),
        (r#""name": "floor""#, r#""name": "z- on floor""#, "z- on floor"),
        (r#", "obstacle": "floor""#, "", "exactly one of \"obstacle\", \"with\""),
        (r#""obstacle": "floor""#, r#""obstacle": "floor", "with": "z+""#, "exactly one of"),
        (r#""obstacle": "floor""#, r#""with": "z+", "friction": 0.3"#, "contact/0/friction"),
        (r#""obstacle": "floor""#, r#""with": "zmax""#, "surface \"zmax\" not found"),
        (r#""obstacle": "floor""#, r#""with": "z+", "thickness": 6"#, "apart at rest"),
    ] {
        let answer = problems(&with(BLOCK, from, to));
        assert!(answer.contains(message), "{to}: {answer}");
    }
    for (key, message) in [
        (r#""friction": 0.3, "obstacles""#, "pushes it by \"contact\""),
        (r#""self_contact": true, "obstacles""#, "\"with\": \"skin\""),
        (r#""rigid_bodies": [], "obstacles""#, "no rigid bodies that move freely yet"),
    ] {
        let answer = problems(&with(BLOCK, r#""obstacles""#, key));
        assert!(answer.contains(message), "{key}: {answer}");
    }
    let answer = problems(&with(BLOCK, r#""obstacle": "floor""#, r#""obstacle": "floor", "mu": 0.3"#));
    assert!(answer.contains("Coulomb's coefficient stands under \"friction\""), "{answer}");
    let flipped = with(BLOCK, r#""normal": [0, 0, 1]"#, r#""normal": [0, 0, -1]"#);
    assert!(warnings(&flipped).contains("10.5 mm inside of \"floor\""), "{}", warnings(&flipped));
    let table = with(BLOCK, r#""contact": [ { "surface": "z-", "obstacle": "floor" } ],"#, "");
    let table = with(&table, r#""supports": ["#, r#""supports": [ { "surface": "z-", "fix": ["z"] }, "#);
    let table = with(&table, r#""floor", "shape""#, r#""floor", "translation": [0, 0, 1], "shape""#);
    assert!(warnings(&table).contains("no contact touches \"floor\""), "{}", warnings(&table));
}

#[test]
fn a_console_says_how_the_contact_slides() {
    let (place, heard) = (CaseDirectory::new(), Heard::default());
    place.run_with(Command::Solve, SLIDER, &Console::new(heard.clone()), &place.options(&[])).unwrap();
    assert!(heard.text().contains("0 % of its pressure sticks"), "{}", heard.text());
}

/// The shipped case of two fingers and a berry, by other costs.
fn berry(costs: &str) -> String {
    let meshes = concat!(env!("CARGO_MANIFEST_DIR"), "/../../meshes/");
    let case = include_str!("../../../examples/cases/berry.json").replace("../../meshes/", meshes);
    let (before, rest) = case.split_once("\"costs\"").unwrap();
    let (_, after) = rest.split_once("\"output\"").unwrap();
    format!("{before}{costs}, \"output\"{after}")
}

/// What the fingers press the berry with its stalk holds; the forces have exact derivatives by pressures and the stiffness of a contact.
#[test]
fn surfaces_of_bodies_touch_each_other() {
    let case = berry(r#""costs": [ { "kind": "contact_force", "contact": "right_grip" } ]"#);
    let place = CaseDirectory::new();
    let found = place.run(Command::Solve, &case, &[]).unwrap_or_else(|error| panic!("{error}")).result;
    let force = |name: &str| number(&found, &format!("contributions/{name}/force_x"));
    let pressing = number(&found, "contributions/left_grip/pressing");
    assert!(pressing > 1e-3, "{pressing}");
    // the fingers are pushed apart
    assert!(force("left_grip") < -0.99 * pressing && force("right_grip") > 1e-3, "{}", found["contributions"]);
    assert_eq!(found["warnings"], serde_json::json!([]));
    let heard = place.text(Command::Check, &case, &[]);
    assert!(heard.contains("left_grip: layer") && heard.contains("smallest gap at rest 1.91"), "{heard}");
    let heard = place.text(Command::Solve, &case, &["controls/0/start=\"5 kPa\"", "controls/1/start=\"5 kPa\""]);
    assert!(heard.contains("left_grip does not act"), "{heard}");
    let by_stiffness = with(
        &case,
        r#""controls": ["#,
        r#""controls": [ { "of": "left_grip.stiffness", "space": "uniform", "lower": "1 MPa", "upper": "20 MPa" },"#,
    );
    let found = place.run(Command::Gradcheck, &by_stiffness, &[]).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(found.exit.code(), 0, "{}", found.result);
}

/// The shipped case of two fingers that carry a ball, until the lift has begun.
fn carry() -> String {
    let meshes = concat!(env!("CARGO_MANIFEST_DIR"), "/../../meshes/");
    let case = include_str!("../../../examples/cases/carry.json").replace("../../meshes/", meshes);
    with(&case, r#""end": "0.9 s""#, r#""end": "0.4 s""#)
}

/// Surfaces of bodies with friction report it as an obstacle does; its coefficient is a control.
#[test]
fn surfaces_of_bodies_stick_and_slide() {
    let place = CaseDirectory::new();
    let found = place.run(Command::Solve, &carry(), &[]).unwrap_or_else(|error| panic!("{error}")).result;
    let of = |key: &str| number(&found, &format!("contributions/grip/{key}"));
    assert!(of("force_y") > 1e-3 && of("sticking") == 1.0 && of("sliding_speed") < 1.0, "{}", found["contributions"]);
    let heard = place.text(Command::Check, &carry(), &[]);
    assert!(heard.contains("friction 0.5, slip speed 1 mm/s"), "{heard}");
    // 1/100 of the diagonal of the smaller surface, a polygon in a ball of 17 mm, over the end
    let heard = place.text(Command::Check, &with(&carry(), r#", "slip_speed": "1 mm/s""#, ""), &[]);
    assert!(heard.contains("friction 0.5, slip speed 0.600797 mm/s"), "{heard}");
    let by_friction = with(
        &carry(),
        r#""controls": ["#,
        r#""controls": [ { "of": "grip.friction", "space": "uniform", "lower": 0.3, "upper": 1 },"#,
    );
    let found = place.run(Command::Gradient, &by_friction, &[]).unwrap_or_else(|error| panic!("{error}")).result;
    let message = number(&found, "controls/grip.friction/max");
    assert!(message == 0.5 && number(&found, "derivative_norm/euclidean") > 0.0, "{found}");
}

/// Beside the equilibrium with its layer the one without: what is reported of it, and its file.
#[test]
fn exact_contact_tells_how_much_the_layer_changes() {
    let (place, heard) = (CaseDirectory::new(), Heard::default());
    let options = Options { analysis: Analysis::ExactContact, ..place.options(&[]) };
    let found = place.run_with(Command::Solve, INDENTED, &Console::new(heard.clone()), &options).unwrap().result;
    let of = |what: &str| number(&found, &format!("exact_contact/{what}"));
    assert!(of("contacts/dent/smallest_gap").abs() < 1e-6 * 0.5, "{found}");
    let [layered, exact] = [number(&found, "contributions/dent/pressing"), of("contacts/dent/pressing")];
    // it touches at rest, so that its layer lies inside of the ball
    assert!(layered < 0.99 * exact && exact > 1.0, "{layered} {exact}");
    assert!(of("largest_change") > 0.01 && of("violation") <= 1e-6 && of("rounds") >= 2.0, "{found}");
    assert!(place.files().contains(&"exact_contact.vtu".to_owned()), "{:?}", place.files());
    let text = heard.text();
    let line = text.lines().find(|line| line.contains("its layer changes what it presses with by")).unwrap();
    assert!(line.ends_with(&format!("by {} %", short((1e4 * (layered / exact - 1.0)).round() / 100.0))), "{line}");
    let sliding = with(INDENTED, r#""thickness": 0.5"#, r#""thickness": 0.5, "law": "log", "stiffness": "2 MPa""#);
    let error = place.run_with(Command::Solve, &sliding, &Console::silent(), &options).unwrap_err().to_string();
    assert!(
        error.contains("exact contact does not go with \"dent\": it is for obstacles with the cubic law"),
        "{error}"
    );
}

/// Twice the gap of a block on its floor is that of a layer twice as thick: `d = delta (1 - sqrt(p/k))` of the same pressure and stiffness.
#[test]
fn half_the_thickness_halves_the_gap_and_keeps_the_force() {
    let of = |case: &str| {
        let (place, heard) = (CaseDirectory::new(), Heard::default());
        let options = Options { analysis: Analysis::HalfThickness, ..place.options(&[]) };
        let found = place.run_with(Command::Solve, case, &Console::new(heard.clone()), &options);
        let page = std::fs::read_to_string(place.path("out/report.html")).unwrap_or_default();
        (found.map(|found| found.result).map_err(|error| error.to_string()), heard.text(), page)
    };
    let (found, heard, page) = of(BLOCK);
    assert!(page.contains("z- on floor, its layer half as thick"));
    let found = found.unwrap();
    let [whole, half] = ["contributions", "half_thickness/contacts"]
        .map(|place| ["force_z", "mean_gap"].map(|name| number(&found, &format!("{place}/z- on floor/{name}"))));
    assert!((half[0] / whole[0] - 1.0).abs() < 1e-8 && (2.0 * half[1] / whole[1] - 1.0).abs() < 1e-4, "{found}");
    let moved = number(&found, "half_thickness/largest_change");
    assert!((moved / half[1] - 1.0).abs() < 1e-3, "{moved} {half:?}");
    let line = heard.lines().find(|line| line.starts_with("half ")).unwrap();
    assert!(line.contains("layers half as thick: displacements, 0.4"), "{line}");
    assert!(heard.contains("z- on floor: normal forces sum to 0.03924 N, changed by 0 %, smallest gap"), "{heard}");
    // every scenario with the stiffness that it has
    let young = |name: &str, value: &str| {
        format!(r#"{{ "name": "{name}", "probability": 0.5, "set": {{ "materials/0/young": "{value}" }} }}"#)
    };
    let scenarios =
        format!(r#""scenarios": [ {}, {} ], "obstacles":"#, young("soft", "0.05 MPa"), young("hard", "0.2 MPa"));
    let found = of(&with(BLOCK, r#""obstacles":"#, &scenarios)).0.unwrap();
    for name in ["soft", "hard"] {
        let [whole, half] = ["contributions", "half_thickness/contacts"]
            .map(|place| number(&found, &format!("scenarios/{name}/{place}/z- on floor/mean_gap")));
        assert!((2.0 * half / whole - 1.0).abs() < 1e-4, "{name}: {whole} {half}");
    }
    // a motion: friction at its end
    let (found, _, _) = of(SLIDER);
    let found = found.unwrap();
    let force = number(&found, "half_thickness/contacts/feet/force_x");
    assert!((force + 0.3 * 4e-3 * 10.0).abs() < 1e-3 * 0.012, "{force}");
    let contact = r#""contact": [ { "name": "feet", "surface": "z-", "obstacle": "floor", "friction": 0.3, "slip_speed": "1 mm/s" } ],"#;
    let without = with(SLIDER, contact, "");
    let error = of(&without).0.unwrap_err();
    assert!(error.contains("--half-thickness looks at the layers of contacts, and the case has none"), "{error}");
}

/// `siere` takes modes of a symmetric stiffness, which lagged friction has, but modes know no step.
#[test]
fn modes_that_move_exactly_know_no_friction_lagged_or_not() {
    for lagged in ["false", "true"] {
        let rubs = with(SLIDER, r#""slip_speed": "1 mm/s""#, &format!(r#""slip_speed": "1 mm/s", "lagged": {lagged}"#));
        let message = problems(&with(&rubs, r#""scheme": "backward_euler""#, r#""scheme": "siere""#));
        assert!(message.contains("siere") && message.contains("take tr_bdf2"), "{lagged}: {message}");
    }
}

/// What only the longest of the judged steps leads over does not excuse the others.
#[test]
fn a_wrong_second_derivative_is_no_kink_where_steps_lead_over_no_onset() {
    let row = |k: i32| Row { t: 10f64.powi(-k), cost: Some(1.0), r0: 0.0, r1: 0.0, used: true };
    let second = |verdict| SecondOrder {
        curvature: 1.0,
        remainders: vec![1.0; 5],
        used: vec![0, 1, 2, 3, 4],
        order: 2.0,
        verdict,
    };
    let of = |verdict, changed: [usize; 5]| GradientTest {
        control: "push".to_owned(),
        term: "total".to_owned(),
        directions: vec![TaylorDirection {
            seed: 1,
            direction: vec![1.0],
            slope: 1.0,
            observed: 1.0,
            noise: 0.0,
            rows: (0..5).map(row).collect(),
            order0: 1.0,
            order1: 2.0,
            verdict: Verdict::Right,
            second: Some(second(verdict)),
        }],
        without_second: None,
        changed: vec![changed.to_vec()],
    };
    assert!(!of(Verdict::Wrong, [3, 0, 0, 0, 0]).is_kink(0, true));
    assert_eq!(of(Verdict::Wrong, [3, 0, 0, 0, 0]).second_verdict(), Some(Verdict::Wrong));
    assert!(of(Verdict::Wrong, [3, 3, 2, 1, 1]).is_kink(0, true));
    assert!(of(Verdict::Undecided, [3, 0, 0, 0, 0]).is_kink(0, true));
    assert!(!of(Verdict::Right, [3, 3, 2, 1, 1]).is_kink(0, true));
}

/// Where a ball comes to a body, the second derivative jumps: to one side of that there is no force, to the other one that grows as the square
/// of the depth. The remainders behind the second derivative fall as t^2 there, as those of a wrong one.
#[test]
fn a_kink_where_a_contact_begins_is_told_as_one() {
    let place = CaseDirectory::new();
    let touching = ["controls/0/start=0", "obstacles/0/translation=[0, 0, 0]"];
    let found = place.run(Command::Gradcheck, INDENTED, &touching).unwrap();
    let of = |path: &str| found.result["gradcheck"].pointer(path).cloned().unwrap_or_default();
    assert_eq!(found.exit.code(), 0, "{}", found.result["gradcheck"]);
    assert!(of("/second/verdict").as_str().unwrap().starts_with("a kink in 1 of 2"), "{}", of("/second"));
    assert!(of("/near_onset").as_u64().unwrap() >= 1, "{}", of("/near_onset"));
    assert_eq!((of("/tests/0/kink"), of("/tests/1/kink")), (Value::from(true), Value::from(false)));
    assert!(of("/tests/0/directions/0/rows/0/changed").as_u64().unwrap() >= 1, "{}", of("/tests/0/directions/0"));
    let heard = place.text(Command::Gradcheck, INDENTED, &touching);
    assert!(heard.contains("do not touch, or slip, as at the start: second derivatives jump between"), "{heard}");
    // well within a contact there is none
    let found = place.run(Command::Gradcheck, INDENTED, &[]).unwrap();
    assert_eq!(found.result["gradcheck"]["tests"][0]["kink"], false, "{}", found.result["gradcheck"]);
}
