//! Warnings: each is raised by a case that deserves it, reaches the result, and fails the command under `--strict`.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use crate::common;

use common::{BAR, CaseDirectory, Heard, warnings, with};
use nastic_case::warning::WARNINGS;
use nastic_language::schema::Command;
use nastic_run::console::Console;
use nastic_run::run::{Analysis, Exit, Options, Outcome};

/// A strip in plane strain, clamped at the left, with room for a load or an actuation.
fn strip(size: &str, cells: &str, more: &str) -> String {
    format!(
        r#"{{ "nastic": 1,
  "mesh": {{ "box": {{ "size": {size}, "cells": {cells}, "element": "quad9" }} }},
  "materials": [ {{ "region": "body", "law": "neo_hooke", "young": "100 kPa", "poisson": 0.3 }} ],
  "supports": [ {{ "surface": "x-", "fix": ["x", "y"] }} ]{more} }}"#
    )
}

/// A column that a dead load compresses beyond its buckling load, E h^3 / 12 (1 - nu^2) (pi / 2)^2 = 2.8 N/m.
fn column(traction: &str) -> String {
    let load = format!(r#", "loads": [ {{ "surface": "x+", "traction": ["{traction}", 0] }} ]"#);
    strip("[1.0, 0.05]", "[10, 1]", &load)
}

/// The codes in a result, in their order.
fn codes(outcome: &Outcome) -> Vec<String> {
    let all = outcome.result["warnings"].as_array().unwrap();
    all.iter().map(|warning| warning["code"].as_str().unwrap().to_owned()).collect()
}

fn run(command: Command, case: &str) -> Outcome {
    CaseDirectory::new().run(command, case, &[]).unwrap_or_else(|error| panic!("{error}"))
}

fn message(outcome: &Outcome, code: &str) -> String {
    let all = outcome.result["warnings"].as_array().unwrap();
    let one = all.iter().find(|warning| warning["code"] == code).unwrap_or_else(|| panic!("no {code} in {all:?}"));
    format!("{}: {}", one["place"].as_str().unwrap(), one["message"].as_str().unwrap())
}

#[test]
fn locking_elements() {
    let tets = warnings(&with(BAR, r#""element": "hex8""#, r#""element": "tet4""#));
    assert!(tets.contains("[locking]") && tets.contains("tet4 cells of \"body\" at Poisson's ratio"), "{tets}");
    let soft = strip("[1.0, 0.1]", "[16, 2]", "");
    assert_eq!(warnings(&soft), "");
    for (element, poisson, locks) in
        [("quad4", "0.39", false), ("quad4", "0.41", true), ("quad9", "0.49", false), ("tri3", "0.1", true)]
    {
        let case = with(&with(&soft, "quad9", element), r#""poisson": 0.3"#, &format!(r#""poisson": {poisson}"#));
        assert_eq!(warnings(&case).contains("[locking]"), locks, "{element} at {poisson}: {}", warnings(&case));
    }
    // what helps is named, and then there is nothing to report
    let nearly = with(&soft, r#""poisson": 0.3"#, r#""poisson": 0.499"#);
    for element in ["quad4", "tri6", "tri3"] {
        let case = with(&nearly, "quad9", element);
        let described = warnings(&case);
        assert!(
            described.contains("take \"formulation\": \"mean_dilatation\" in the material"),
            "{element}: {described}"
        );
        let cured = with(&case, r#""poisson": 0.499"#, r#""poisson": 0.499, "formulation": "mean_dilatation""#);
        assert_eq!(warnings(&cured), "", "{element}");
    }
}

/// Two unit cells side by side that do not share their nodes, the second with a corner drawn out to a point.
const TWO_CELLS: &str = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n2 1 \"body\"\n1 2 \"left\"\n$EndPhysicalNames\n\
$Nodes\n8\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 1 0 0\n6 2 0 0\n7 1.52 0.52 0\n8 1 1 0\n$EndNodes\n\
$Elements\n4\n1 3 2 1 1 1 2 3 4\n2 3 2 1 1 5 6 7 8\n3 1 2 2 2 4 1\n4 1 2 2 2 5 6\n$EndElements\n";

#[test]
fn cells_that_are_badly_shaped_or_not_connected() {
    let place = CaseDirectory::new();
    place.write("two.msh", TWO_CELLS);
    let case = r#"{ "nastic": 1, "mesh": "two.msh",
        "materials": [ { "region": "body", "law": "neo_hooke", "young": "100 kPa", "poisson": 0.3 } ],
        "supports": [ { "surface": "left", "fix": ["x", "y"] } ] }"#;
    let outcome = place.run(Command::Check, case, &[]).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(codes(&outcome), ["cell_shape", "unmatched_interface"]);
    assert!(message(&outcome, "unmatched_interface").contains("2 nodes lie on others"));
}

/// As meshio writes 4.1: names of groups, but no `$Entities` that say which elements they are of.
#[test]
fn names_of_regions_that_no_cell_bears() {
    let place = CaseDirectory::new();
    let lost = TWO_CELLS.replace(" 3 2 1 1 ", " 3 2 0 1 ").replace("7 1.52 0.52 0", "7 2 1 0");
    let case = r#"{ "nastic": 1, "mesh": "two.msh",
        "materials": [ { "region": "REGION", "law": "neo_hooke", "young": "100 kPa", "poisson": 0.3 } ],
        "supports": [ { "surface": "left", "fix": ["x", "y"] } ] }"#;
    for (name, mesh) in [("ungrouped", lost.clone()), ("body", lost.replace("\"body\"", "\"cap\""))] {
        place.write("two.msh", &mesh);
        let case = case.replace("REGION", name);
        let outcome = place.run(Command::Check, &case, &[]).unwrap_or_else(|error| panic!("{error}"));
        assert!(codes(&outcome).iter().any(|code| code == "lost_groups"), "{:?}", codes(&outcome));
        let told = message(&outcome, "lost_groups");
        assert!(told.ends_with(&format!("but no cell bears one: its regions are \"{name}\"")), "{told}");
    }
}

#[test]
fn bounds_far_beyond_the_material() {
    assert!(warnings(&with(BAR, "-200 kPa", "-200 MPa")).contains("[bounds]"), "{BAR}");
}

#[test]
fn an_unstable_equilibrium() {
    assert_eq!(codes(&run(Command::Solve, &column("-40 Pa"))), [""; 0]);
    let place = CaseDirectory::new();
    let outcome = place.run(Command::Solve, &column("-80 Pa"), &[]).unwrap();
    assert_eq!((codes(&outcome), outcome.exit), (vec!["unstable".to_owned()], Exit::Done));
    assert!(message(&outcome, "unstable").contains("1 negative pivot"), "{}", outcome.result["warnings"]);
    assert_eq!(outcome.result["inertia"], 1);
    assert!(std::fs::read_to_string(place.path("out/picture.svg")).unwrap().contains("WARNING: unstable"));
    // The same under --strict, and where unstable states are refused.
    let strict = Options { strict: true, ..place.options(&[]) };
    let heard = Heard::default();
    let outcome = place.run_with(Command::Solve, &column("-80 Pa"), &Console::new(heard.clone()), &strict).unwrap();
    assert_eq!((outcome.exit, outcome.exit.code()), (Exit::Warned, 8));
    assert!(heard.text().contains("WARNING     [unstable] equilibrium: 1 negative pivot"), "{}", heard.text());
    // Optimisations alone refuse them.
    let optimised = r#""nastic": 1, "optimizer": { "unstable": "refuse" },
        "actuation": [ { "name": "tension", "kind": "fiber_tension", "region": "body", "direction": [1, 0] } ],
        "controls": [ { "of": "tension", "space": "uniform", "start": 0, "lower": -10, "upper": 10 } ],
        "costs": [ { "kind": "tracking", "surface": "x+", "target": ["X", "Y + 0.01"] } ],"#;
    let refused = with(&column("-80 Pa"), r#""nastic": 1,"#, optimised);
    assert_eq!(codes(&place.run(Command::Solve, &refused, &[]).unwrap()), ["unstable"]);
    let error = place.run(Command::Optimize, &refused, &[]).unwrap_err();
    assert!(error.to_string().contains("unstable: 1 negative pivots"), "{error}");
    assert_eq!(error.exit(), Exit::ForwardFailed);
}

/// Ramps and paths are looked into as single states are.
#[test]
fn a_path_into_unstable_states() {
    let along = |analysis: Analysis| {
        let place = CaseDirectory::new();
        let options = Options { analysis, ..place.options(&[]) };
        place.run_with(Command::Solve, &column("-80 Pa"), &Console::silent(), &options).unwrap()
    };
    let path = along(Analysis::Path);
    assert_eq!(codes(&path), ["unstable"], "{}", path.result["warnings"]);
    let described = message(&path, "unstable");
    assert!(
        described.starts_with("path at ")
            && described.contains("1 negative pivot")
            && described.contains(" such states among "),
        "{described}"
    );
    assert_eq!(codes(&along(Analysis::Minimum)), [""; 0]);
}

/// So are ramps, and further equilibria.
#[test]
fn ramps_and_equilibria_into_unstable_states() {
    const STRIP: &str = include_str!("../../language/tests/cases/swelling_strip.json");
    let of = |analysis: Analysis| {
        let place = CaseDirectory::new();
        let options = Options { analysis, ..place.options(&[]) };
        place.run_with(Command::Solve, STRIP, &Console::silent(), &options).unwrap()
    };
    let ramp = of(Analysis::Ramp("swelling=0 Pa:2 kPa:5".to_owned()));
    assert_eq!(codes(&ramp), ["unstable"], "{}", ramp.result["warnings"]);
    let described = message(&ramp, "unstable");
    assert!(
        described.starts_with("ramp at 1500: ") && described.contains("(the first of 2 such states among 5)"),
        "{described}"
    );
    // the first is reported with the equilibrium, and again among the three
    let three = of(Analysis::Equilibria(3));
    assert_eq!(codes(&three), ["unstable", "unstable"], "{}", three.result["warnings"]);
    let described = three.result["warnings"][1]["message"].as_str().unwrap();
    assert!(described.contains("(the first of 1 such states among 3)"), "{described}");
}

/// A strip whose fibres shorten above and lengthen below rolls up.
#[test]
fn a_body_that_intersects_itself() {
    let rolled = |tension: &str| {
        let fixed = format!(
            r#", "actuation": [ {{ "name": "tension", "kind": "fiber_tension", "region": "body", "direction": [1, 0],
               "tension": "{tension} * (1 - Y / 0.01)" }} ]"#
        );
        strip("[1.0, 0.02]", "[60, 1]", &fixed)
    };
    let place = CaseDirectory::new();
    let open = place.run(Command::Solve, &rolled("5 kPa"), &[]).unwrap_or_else(|error| panic!("{error}"));
    assert!(codes(&open).is_empty(), "{}", open.result["warnings"]);
    assert_eq!(open.result["self_intersection"]["cells"], 0);
    let closed = place.run(Command::Solve, &rolled("9 kPa"), &[]).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(codes(&closed), ["self_intersection"], "{}", closed.result["warnings"]);
    assert!(closed.result["self_intersection"]["volume"].as_f64().unwrap() > 0.0);
    let marked = nastic_io::read_snapshot(place.path("out/start.vtu")).unwrap();
    let marks = &marked.cell_array("intersecting").unwrap().values;
    assert_eq!(closed.result["self_intersection"]["cells"], marks.iter().sum::<f64>());
}

const TARGET: &str = r#""target": ["X - 0.1", "Y", "Z + 0.1"]"#;

/// The bar, started without tension, with another target.
fn from_rest(target: &str) -> String {
    with(&with(BAR, "-50 kPa * Z / 0.25 m", "0 Pa"), TARGET, target)
}

#[test]
fn an_optimisation_in_which_nothing_moves() {
    let outcome = run(Command::Optimize, &from_rest(r#""target": ["X", "Y", "Z"]"#));
    assert_eq!(codes(&outcome), ["no_movement"], "{}", outcome.result["warnings"]);
    assert!(message(&outcome, "no_movement").contains("exactly zero"), "{}", outcome.result["warnings"]);
}

/// Sideways, where the fibres cannot bend the bar.
#[test]
fn an_optimisation_whose_cost_hardly_falls() {
    let case = from_rest(r#""target": ["X - 0.001", "Y + 1000", "Z"]"#);
    let outcome = CaseDirectory::new().run(Command::Optimize, &case, &["optimizer/max_iterations=1"]).unwrap();
    assert!(message(&outcome, "no_movement").contains("of itself alone"), "{}", outcome.result["warnings"]);
    let fine = CaseDirectory::new().run(Command::Optimize, BAR, &["optimizer/max_iterations=1"]).unwrap();
    assert!(!codes(&fine).contains(&"no_movement".to_owned()), "{}", fine.result["warnings"]);
}

#[test]
fn bounds_that_decide() {
    let shorter = from_rest(r#""target": ["X - 0.1", "Y", "Z"]"#);
    let narrow = with(&shorter, "-200 kPa", "-1 Pa");
    let outcome = run(Command::Optimize, &narrow);
    assert_eq!(codes(&outcome)[0], "all_on_bounds", "{}", outcome.result["warnings"]);
    let outcome = run(Command::Optimize, &with(&shorter, "-200 kPa", "0 Pa"));
    assert_eq!(codes(&outcome), ["other_sign"], "{}", outcome.result["warnings"]);
    assert!(message(&outcome, "other_sign").contains("the lower bound, and the cost falls below it"));
}

#[test]
fn a_term_that_does_not_count() {
    let case = with(BAR, r#""weight": 1e-14"#, r#""weight": 1e-30"#);
    let outcome = run(Command::Optimize, &case);
    assert!(codes(&outcome).contains(&"negligible_term".to_owned()), "{}", outcome.result["warnings"]);
    assert!(message(&outcome, "negligible_term").contains("control_norm is at most"));
}

/// Solved again from rest, the optimum of a stable body is the same state.
#[test]
fn an_optimum_that_is_verified() {
    let verified = with(BAR, r#""optimizer": {"#, r#""optimizer": { "verify": true,"#);
    assert_eq!(codes(&run(Command::Optimize, &verified)), [""; 0]);
}

/// A strip between clamps that its turgor has made buckle upwards; a field whose torques turn its halves against each other lifts
/// or lowers its middle. It snaps to the other side at about -0.5 mT, so that from -0.5 to 0.5 mT there are two stable states.
const SNAPPING: &str = include_str!("../../language/tests/cases/snapping_strip.json");

/// An optimum on the upper branch at a field that pulls downwards: from rest the strip buckles downwards.
#[test]
fn an_optimum_that_depends_on_the_path() {
    let outcome = run(Command::Optimize, SNAPPING);
    let field = outcome.result["controls"]["field"]["min"].as_f64().unwrap();
    assert!((-5e-4..0.0).contains(&field), "{field}");
    assert_eq!(codes(&outcome), ["not_verified"], "{}", outcome.result["warnings"]);
    let described = message(&outcome, "not_verified");
    assert!(described.contains("of their norm, the cost is"), "{described}");
}

/// A target below: the first step takes the strip from the upper branch, which ends at about -0.5 mT, to the lower one.
#[test]
fn an_optimum_on_another_branch() {
    let lower = with(SNAPPING, "Y + 0.024", "Y - 0.05");
    let place = CaseDirectory::new();
    let outcome = place.run(Command::Optimize, &lower, &[]).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(codes(&outcome), ["branch_change"], "{}", outcome.result["warnings"]);
    let described = message(&outcome, "branch_change");
    assert!(
        described.contains("iteration 1: the branch of the state before turns back at a limit point"),
        "{described}"
    );
    let history = std::fs::read_to_string(place.path("out/history.jsonl")).unwrap();
    let changed: Vec<bool> = history.lines().map(|line| line.contains("\"branch_changed\":true")).collect();
    assert!(changed.iter().enumerate().all(|(trial, changed)| *changed == (trial == 1)), "{history}");
    // Of several starts each has its own.
    let outcome = CaseDirectory::new().run(Command::Optimize, &lower, &["optimizer/starts=2"]).unwrap();
    let places: Vec<&str> =
        outcome.result["warnings"].as_array().unwrap().iter().filter_map(|w| w["place"].as_str()).collect();
    assert!(codes(&outcome).iter().all(|code| code == "branch_change"), "{}", outcome.result["warnings"]);
    assert_eq!(places[0], "start 1 of 2", "{places:?}");
    // A start below is on that branch.
    let below = with(&lower, r#""start": "1 mT""#, r#""start": "-2 mT""#);
    assert_eq!(codes(&run(Command::Optimize, &below)), [""; 0]);
}

/// Also where no tangent had to be shifted, on whatever mesh, and back upwards.
#[test]
fn optima_on_other_branches_without_a_shifted_tangent() {
    for (cells, start, target) in
        [("[20, 1]", "-5 mT", "Y + 0.1"), ("[60, 1]", "-5 mT", "Y + 0.1"), ("[60, 1]", "1 mT", "Y - 0.05")]
    {
        let case = with(SNAPPING, "Y + 0.024", target);
        let set = [&format!("mesh/box/cells={cells}"), &format!("controls/0/start={start}"), "optimizer/verify=false"];
        let outcome = CaseDirectory::new().run(Command::Optimize, &case, &set.map(|x| x as &str)).unwrap();
        assert_eq!(codes(&outcome)[0], "branch_change", "{cells}, {start}: {}", outcome.result["warnings"]);
    }
}

/// Rows of a ramp between which the strip snaps; the field there is that at which a path turns back.
#[test]
fn a_ramp_over_a_jump() {
    let place = CaseDirectory::new();
    let options = Options { analysis: Analysis::Ramp("field=1 mT:-2 mT:13".to_owned()), ..place.options(&[]) };
    let outcome = place.run_with(Command::Solve, SNAPPING, &Console::silent(), &options).unwrap();
    assert_eq!(codes(&outcome), ["branch_change"], "{}", outcome.result["warnings"]);
    let jumps = outcome.result["ramp"]["jumps"].as_array().unwrap();
    assert_eq!(jumps.len(), 1, "{jumps:?}");
    let at = |key: &str| jumps[0][key].as_f64().unwrap();
    assert!(at("from") > at("to") && (at("to")..at("from")).contains(&-5.5e-4), "{jumps:?}");
}

/// At its buckling load, which ramps bisect, the tangent of a straight strip is singular to working precision.
#[test]
fn a_state_at_a_bifurcation() {
    const STRIP: &str = include_str!("../../language/tests/cases/swelling_strip.json");
    let solve = |analysis: Analysis, start: f64| {
        let place = CaseDirectory::new();
        let options = Options { analysis, ..place.options(&[&format!("controls/0/start={start:?}")]) };
        place.run_with(Command::Solve, STRIP, &Console::silent(), &options).unwrap_or_else(|error| panic!("{error}"))
    };
    let (mut value, mut error) = (1300.0, 100.0);
    for _ in 0..6 {
        let ramp = Analysis::Ramp(format!("swelling={:?}:{:?}:2", value - error, value + error));
        let critical = solve(ramp, 0.0).result["ramp"]["critical"][0].clone();
        let Some(found) = critical["value"].as_f64() else { break };
        (value, error) = (found, critical["error"].as_f64().unwrap().max(4e-16 * found));
    }
    // Bisection ends where the inertia is no longer counted: the singular states lie just above.
    let at = solve(Analysis::Equilibrium, value + error);
    assert_eq!(codes(&at), ["nearly_singular"], "at {value} +- {error}: {}", at.result["warnings"]);
    assert!(message(&at, "nearly_singular").contains("singular to working precision"), "{}", at.result["warnings"]);
    assert!(at.result["inertia"].is_null());
    // A thousandth off the state is clearly of one kind or the other.
    assert_eq!(codes(&solve(Analysis::Equilibrium, 0.999 * value)), [""; 0]);
    assert_eq!(codes(&solve(Analysis::Equilibrium, 1.001 * value)), ["unstable"]);
}

/// Every accepted trial is reported with its negative pivots.
#[test]
fn the_history_has_the_inertia_of_accepted_trials() {
    let place = CaseDirectory::new();
    place.run(Command::Optimize, BAR, &[]).unwrap();
    let history = std::fs::read_to_string(place.path("out/history.jsonl")).unwrap();
    let lines: Vec<serde_json::Value> = history.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert!(lines.len() > 2 && lines.iter().all(|line| (line["accepted"] == true) == (line["inertia"] == 0)));
}

/// The page of warnings names every code, and no others.
#[test]
fn the_page_of_warnings_is_complete() {
    let page = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/warnings.md")).unwrap();
    let described: Vec<&str> = page.lines().filter_map(|line| line.strip_prefix("## `")?.strip_suffix('`')).collect();
    let known: Vec<&str> = WARNINGS.iter().map(|kind| kind.code).collect();
    assert_eq!(described, known);
}

/// `mu/2 |F|^2` outweighs no pressure on a volume; `lambda/2 (J - 1)^2` does.
#[test]
fn a_turgor_that_nothing_balances() {
    for (poisson, described) in [("0", true), ("0.1", false)] {
        let case = format!(
            r#"{{ "nastic": 1, "mesh": {{ "box": {{ "size": [1.0, 0.5, 0.5], "cells": [2, 1, 1], "element": "hex20" }} }},
              "materials": [ {{ "region": "body", "law": "neo_hooke", "young": "1 MPa", "poisson": {poisson} }} ],
              "supports": [ {{ "surface": "x-", "fix": "all" }} ],
              "actuation": [ {{ "name": "swelling", "kind": "turgor", "region": "body", "pressure": "1 kPa" }} ] }}"#
        );
        let outcome = run(Command::Check, &case);
        assert_eq!(codes(&outcome).contains(&"unbalanced_turgor".to_owned()), described, "{poisson}");
        let stated = &outcome.result["existence"][0];
        assert_eq!((&stated["cells"], &stated["conditions"]["polyconvex"]), (&2.into(), &true.into()), "{stated}");
        assert_eq!(stated["conditions"]["balances_pressure"], !described, "{stated}");
        // nothing bounds the cofactor of a neo-Hookean body
        assert_eq!(stated["conditions"]["holds"], false, "{stated}");
    }
}

/// Loads and pressures of many times the modulus have equilibria, which no material has.
#[test]
fn a_body_deformed_beyond_any_material() {
    let solve = |swelling: &str, traction: &str| {
        let case = format!(
            r#"{{ "nastic": 1, "mesh": {{ "box": {{ "size": [1.0, 0.5], "cells": [2, 1], "element": "quad9" }} }},
              "materials": [ {{ "region": "body", "law": "neo_hooke", "young": "1 MPa", "poisson": 0.3 }} ],
              "supports": [ {{ "surface": "x-", "fix": "all" }} ],
              "loads": [ {{ "surface": "x+", "traction": ["{traction}", 0] }} ],
              "actuation": [ {{ "name": "swelling", "kind": "turgor", "region": "body", "pressure": "{swelling}" }} ] }}"#
        );
        run(Command::Solve, &case)
    };
    let compressed = solve("-8 MPa", "0 Pa");
    assert_eq!(codes(&compressed), ["extreme_deformation"], "{}", compressed.result["warnings"]);
    assert!(message(&compressed, "extreme_deformation").contains("the smallest J is 0."));
    let stretched = solve("0.1 MPa", "20 MPa");
    let described = message(&stretched, "extreme_deformation");
    assert!(described.contains("times the size of the body"), "{described}");
    assert_eq!(codes(&solve("-0.2 MPa", "0.3 MPa")), [""; 0]);
}

/// Cells of 0.25 m know nothing of a correlation length of a millimetre.
#[test]
fn a_random_field_that_is_cut_off() {
    let check = |length: &str| {
        let random = format!(
            r#""scenarios": {{ "random": [ {{ "path": "materials/0/young",
              "lognormal": {{ "mean": "1 MPa", "deviation": "0.2 MPa", "length": "{length}", "modes": 2 }} }} ],
              "rule": {{ "gauss": 2 }} }}, "costs": ["#
        );
        run(Command::Check, &with(SNAPPING, r#""costs": ["#, &random))
    };
    let short = check("1 mm");
    assert_eq!(codes(&short), ["truncated_field"], "{}", short.result["warnings"]);
    assert!(message(&short, "truncated_field").contains("2 modes hold 10.0 % of the field's variance"));
    assert_eq!(codes(&check("1 m")), [""; 0]);
}

/// Points of the target 0.05 m apart, at a resolution of 0.3 mm and of 0.2 m.
#[test]
fn a_distance_that_sees_separate_points() {
    let distance = |length: f64| {
        format!(
            r#"{{ "kind": "smoothed_hausdorff", "quadrature": 1,
        "target": {{ "box": {{ "size": [1.0, 0.25, 0.25], "cells": [20, 5, 5], "element": "hex8" }} }},
        "phi": {{ "exponential": {{ "length": {length} }} }}, "stages": [ {{ "alpha": 2, "beta": 2, "gamma": 2 }} ] }}"#
        )
    };
    let tracking = r#"{ "kind": "tracking", "surface": "x+", "target": ["X - 0.1", "Y", "Z + 0.1"] }"#;
    let coarse = warnings(&with(BAR, tracking, &distance(6e-4)));
    assert!(coarse.contains("[hausdorff_length]") && coarse.contains("it sees separate points"), "{coarse}");
    assert!(!warnings(&with(BAR, tracking, &distance(2.0))).contains("hausdorff_length"));
}

/// A strip of 32 x 4 cells resolves a grid of as many, in its own words (a plane grid has two numbers of cells).
#[test]
fn a_control_grid_finer_than_the_mesh() {
    let case = |cells: &str| {
        let control = format!(
            r#", "actuation": [ {{ "name": "muscle", "kind": "fiber_tension", "region": "body", "direction": [1, 0] }} ],
            "controls": [ {{ "of": "muscle", "space": {{ "grid": {cells} }}, "start": 0, "lower": -10, "upper": 10 }} ]"#
        );
        strip("[1.0, 0.125]", "[32, 4]", &control)
    };
    let coarse = case("[32, 4]");
    assert_eq!(codes(&run(Command::Check, &coarse)), [""; 0]);
    let described = CaseDirectory::new().text(Command::Check, &coarse, &[]);
    assert!(described.contains("muscle: by grid of 32 x 4 cells, 165 unknowns"), "{described}");
    let fine = run(Command::Check, &case("[64, 16]"));
    assert_eq!(codes(&fine), ["grid_resolution"]);
    let described = message(&fine, "grid_resolution");
    assert!(described.contains("controls/0/space") && described.contains("grid of 64 x 16"), "{described}");
    assert!(described.contains("a grid of at most 32 x 4"), "{described}");
}

/// Pa for kPa, and a body of which no part is soft; a stiff part beside soft ones is none of it.
#[test]
fn moduli_of_no_soft_matter() {
    let of = |young: &str| warnings(&with(&strip("[0.1, 0.02]", "[5, 1]", ""), "100 kPa", young));
    let soft = of("100 Pa");
    assert!(
        soft.contains("[units]") && soft.contains("Young's modulus is 100 Pa") && soft.contains("factor of 1000"),
        "{soft}"
    );
    let stiff = of("34 MPa");
    assert!(stiff.contains("[units]") && stiff.contains("34000 Pa would be usual"), "{stiff}");
    let steel = of("200 GPa");
    assert!(steel.contains("[units]") && steel.contains("is a factor of 1e+06 too many?"), "{steel}");
    for usual in ["1 kPa", "20 MPa"] {
        assert_eq!(of(usual), "", "{usual}");
    }
}
