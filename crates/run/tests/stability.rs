//! `nastic solve` with `--modes`, `--ramp`, `--path`, `--equilibria` and `--minimum`: what is computed of the stability
//! of equilibria, and what is written about it.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use crate::common;

use common::{BAR, CaseDirectory, Heard};
use nastic_language::schema::Command;
use nastic_run::console::Console;
use nastic_run::run::{Analysis, Exit, Options};
use serde_json::Value;

const STRIP: &str = include_str!("../../language/tests/cases/swelling_strip.json");

/// The result of an analysis, how it ended and what it said.
fn analyse(place: &CaseDirectory, case: &str, analysis: Analysis, set: &[&str]) -> (Value, Exit, String) {
    let heard = Heard::default();
    let options = Options { analysis, ..place.options(set) };
    let outcome = place.run_with(Command::Solve, case, &Console::new(heard.clone()), &options);
    let outcome = outcome.unwrap_or_else(|error| panic!("{error}"));
    (outcome.result, outcome.exit, heard.text())
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().into_iter().flatten().filter_map(Value::as_f64).collect()
}

#[test]
fn modes_are_told_and_written() {
    let place = CaseDirectory::new();
    let (result, exit, said) = analyse(&place, STRIP, Analysis::Modes(3), &[]);
    assert_eq!(exit, Exit::Done);
    let lambda = numbers(&result["modes"]["eigenvalues"]);
    assert_eq!(lambda.len(), 3);
    assert!(lambda[0] < 0.0 && 0.0 < lambda[1] && lambda[1] < lambda[2], "{lambda:?}");
    assert_eq!(result["modes"]["negative"], result["inertia"]);
    assert_eq!(result["modes"]["unit"], "N/m^4");
    assert_eq!(said.lines().filter(|line| line.contains(" N/m^4")).count(), 3, "{said}");
    assert_eq!(said.lines().filter(|line| line.ends_with("unstable")).count(), 1, "{said}");
    let snapshot = nastic_io::read_snapshot(place.path("out/start.vtu")).unwrap();
    let middle = snapshot.mesh.points().iter().position(|x| *x == [0.5, 0.01, 0.0]).unwrap();
    for k in 1..=3 {
        let mode = snapshot.point_array(&format!("mode_{k}")).unwrap();
        let largest = mode.values.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        assert_eq!(largest, 1.0);
    }
    // the first mode bends to one side
    let first = snapshot.point_array("mode_1").unwrap().at(middle);
    assert!(first[1] > 0.99 && first[0].abs() < 0.01, "{first:?}");
}

#[test]
fn every_member_has_its_modes() {
    let place = CaseDirectory::new();
    let cases = r#""load_cases": [
        { "name": "calm", "set": { "materials/0/young": "2 MPa" } }, { "name": "pressed" } ], "probes""#;
    let case = common::with(STRIP, r#""probes""#, cases);
    let (result, ..) = analyse(&place, &case, Analysis::Modes(1), &[]);
    let first = |name: &str| result["load_cases"][name]["modes"]["eigenvalues"][0].as_f64().unwrap();
    assert!(first("calm") > 0.0 && first("pressed") < 0.0, "{result:#}");
    assert!(place.path("out/pressed_start.vtu").exists());
}

#[test]
fn more_modes_than_unknowns_are_refused() {
    let place = CaseDirectory::new();
    let options = Options { analysis: Analysis::Modes(1000), ..place.options(&[]) };
    let refused = place.run_with(Command::Solve, BAR, &Console::silent(), &options).unwrap_err();
    assert_eq!(refused.exit(), Exit::BadInput);
    assert!(refused.to_string().contains("ask for 1 to 48 modes"), "{refused}");
}

/// The strip with turgor buckles where `p = pi^2 E h^2 / (3 L^2)`, 1316 Pa.
#[test]
fn a_ramp_tells_every_point_and_the_critical_value() {
    let place = CaseDirectory::new();
    let (result, exit, said) = analyse(&place, STRIP, Analysis::Ramp("swelling=0 Pa:2 kPa:5".to_owned()), &[]);
    assert_eq!(exit, Exit::Done);
    let ramp = &result["ramp"];
    assert_eq!((ramp["control"].as_str(), ramp["unit"].as_str()), (Some("swelling"), Some("Pa")));
    let points = ramp["points"].as_array().unwrap();
    let of = |key: &str| points.iter().map(|point| point[key].as_f64().unwrap()).collect::<Vec<_>>();
    assert_eq!(of("value"), [0.0, 500.0, 1000.0, 1500.0, 2000.0]);
    assert_eq!(of("inertia"), [0.0, 0.0, 0.0, 1.0, 1.0]);
    let critical = &ramp["critical"][0];
    let value = critical["value"].as_f64().unwrap();
    assert!((value / 1316.0 - 1.0).abs() < 0.02, "{value}");
    assert!(critical["error"].as_f64().unwrap() <= 0.25);
    assert_eq!((&critical["before"], &critical["after"]), (&0.into(), &1.into()));
    assert_eq!(said.lines().filter(|line| line.starts_with("critical")).count(), 1, "{said}");
    // the files say the same
    let csv = std::fs::read_to_string(place.path("out/ramp.csv")).unwrap();
    let rows: Vec<&str> = csv.lines().collect();
    let head = "swelling,middle.x,middle.y,min_J,negative_pivots,potential,newton_iterations,reactions.";
    assert!(rows[0].starts_with(head) && rows[0].ends_with(",energy.elastic,energy.contact"), "{}", rows[0]);
    assert_eq!(rows.len(), 6);
    assert!(rows[4].starts_with("1500.0,") && rows[4].split(',').nth(4) == Some("1"), "{}", rows[4]);
    let pvd = std::fs::read_to_string(place.path("out/ramp.pvd")).unwrap();
    assert!(pvd.contains("timestep=\"1500.0\"") && pvd.contains("ramp_0003.vtu"), "{pvd}");
    let shot = nastic_io::read_snapshot(place.path("out/ramp_0003.vtu")).unwrap();
    assert!(shot.cell_array("swelling").unwrap().values.iter().all(|p| *p == 1500.0));
    let svg = std::fs::read_to_string(place.path("out/ramp.svg")).unwrap();
    assert!(svg.contains("swelling (Pa)") && svg.contains("0 &gt; 1"), "{svg}");
    // a shorter one leaves no snapshot of the longer one behind
    analyse(&place, STRIP, Analysis::Ramp("swelling=0:1000:2".to_owned()), &[]);
    assert!(place.path("out/ramp_0001.vtu").exists() && !place.path("out/ramp_0003.vtu").exists());
}

/// A control by cell is set everywhere; its points are the equilibria of their values.
#[test]
fn a_control_of_another_space_goes_everywhere() {
    let place = CaseDirectory::new();
    let (result, ..) = analyse(&place, BAR, Analysis::Ramp("tension=-20 kPa:10 kPa:2".to_owned()), &[]);
    let last = result["ramp"]["points"][1]["probes"]["tip"]["displacement"][0].as_f64().unwrap();
    let (alone, ..) = analyse(&place, BAR, Analysis::Equilibrium, &["controls/0/start=10 kPa"]);
    let expected = alone["probes"]["tip"]["displacement"][0].as_f64().unwrap();
    assert!(expected.abs() > 1e-3 && (last - expected).abs() < 1e-9, "{last} and {expected}");
}

#[test]
fn a_ramp_that_fails_keeps_its_points_and_says_where() {
    let place = CaseDirectory::new();
    let (result, exit, said) = analyse(&place, BAR, Analysis::Ramp("tension=0:2 MPa:4".to_owned()), &[]);
    assert_eq!(exit, Exit::ForwardFailed);
    assert_eq!(exit.code(), 3);
    let points = result["ramp"]["points"].as_array().unwrap();
    assert!((1..4).contains(&points.len()), "{result:#}");
    let failed = &result["ramp"]["failed"];
    assert!(failed["at"].as_str().unwrap().ends_with(" Pa"), "{failed:#}");
    // where it failed is a value of the control, between the last row and the one that was sought
    let number = |key: &str| failed[key].as_f64().unwrap_or_else(|| panic!("no {key} in {failed:#}"));
    let last = points[points.len() - 1]["value"].as_f64().unwrap();
    let sought: f64 = failed["at"].as_str().unwrap().trim_end_matches(" Pa").parse().unwrap();
    assert!(last + 1e3 < number("last_value") && number("last_value") < number("value"), "{failed:#}");
    assert!(number("value") <= sought && sought - last > 1e5, "{failed:#}");
    assert!(failed["load"].is_null() && failed["reached"].is_null(), "{failed:#}");
    assert_eq!((&failed["kind"], &failed["cause"]), (&"no_convergence".into(), &"convexity_bound".into()));
    assert!(failed["why"].as_str().unwrap().contains(" Pa, the last one at "), "{failed:#}");
    assert_eq!(failed["worst_cells"].as_array().unwrap().len(), 4, "{failed:#}");
    let shot = nastic_io::read_snapshot(place.path("out/failure.vtu")).unwrap();
    let tension = shot.point_array("tension").unwrap().values.clone();
    assert!(tension.iter().all(|t| (t - number("last_value")).abs() < 1e-6), "{tension:?}");
    assert!(result["error"].as_str().unwrap().contains("the ramp stops at"), "{result:#}");
    assert!(said.contains("STOPPED"), "{said}");
    // it took no five seconds, so that a log has nothing of the iterations
    assert!(number("newton_iterations") >= 50.0 && !said.contains("            Newton iteration "), "{said}");
    assert_eq!(std::fs::read_to_string(place.path("out/ramp.csv")).unwrap().lines().count(), 1 + points.len());
}

#[test]
fn a_ramp_that_cannot_be_is_bad_input() {
    let place = CaseDirectory::new();
    for (text, message) in [
        ("swelling", "is not CONTROL=FROM:TO:N"),
        ("swelling=0:1", "is not CONTROL=FROM:TO:N"),
        ("swelling=0:1:1", "N must be a whole number from 2 to 10000"),
        ("swelling=0:1 m:3", "is a length, a pressure is wanted"),
        ("swelling=0:X * 1 Pa:3", "varies over the body"),
        ("air=0:1:3", "control \"air\" not found; there are: swelling"),
    ] {
        let options = Options { analysis: Analysis::Ramp(text.to_owned()), ..place.options(&[]) };
        let refused = place.run_with(Command::Solve, STRIP, &Console::silent(), &options).unwrap_err();
        assert_eq!(refused.exit(), Exit::BadInput);
        assert!(refused.to_string().contains(message), "{refused}");
    }
}

/// A cantilever under a dead axial load of one and a half times Euler's, `E' I pi^2 / (4 L^2)`.
#[test]
fn a_path_tells_its_points_and_where_the_body_buckles() {
    let place = CaseDirectory::new();
    let load = r#""loads": [ { "surface": "x+", "traction": ["-123.37 Pa", "0 Pa"] } ], "probes""#;
    let supports = r#", { "surface": "x+", "fix": ["x", "y"] }"#;
    let case = common::with(&common::with(STRIP, r#""probes""#, load), supports, "").replace("2 kPa", "0 Pa");
    let (result, exit, said) = analyse(&place, &case, Analysis::Path, &[]);
    assert_eq!(exit, Exit::Done);
    let path = &result["path"];
    let points = path["points"].as_array().unwrap();
    assert_eq!(points[0]["value"], 0.0);
    assert_eq!(points[points.len() - 1]["value"], 1.0);
    assert!(path["stopped"].is_null());
    let events = path["events"].as_array().unwrap();
    assert_eq!(events.len(), 1, "{path:#}");
    assert_eq!(
        (&events[0]["kind"], &events[0]["before"], &events[0]["after"]),
        (&"bifurcation".into(), &0.into(), &1.into())
    );
    let value = events[0]["value"].as_f64().unwrap();
    assert!((value / (2.0 / 3.0) - 1.0).abs() < 0.02, "{value}");
    assert!(said.contains("critical    bifurcation at s = 0.6"), "{said}");
    let csv = std::fs::read_to_string(place.path("out/path.csv")).unwrap();
    assert!(csv.starts_with("s,middle.x,middle.y,min_J,"), "{csv}");
    assert_eq!(csv.lines().count(), points.len() + 1);
    assert!(std::fs::read_to_string(place.path("out/path.pvd")).unwrap().contains("path_0001.vtu"));
    assert!(std::fs::read_to_string(place.path("out/path.svg")).unwrap().contains("displacement (m)"));
}

#[test]
fn other_equilibria_stand_beside_the_first() {
    let place = CaseDirectory::new();
    let (result, exit, said) = analyse(&place, STRIP, Analysis::Equilibria(3), &[]);
    assert_eq!(exit, Exit::Done);
    assert_eq!(result["inertia"], 1);
    let found = result["equilibria"]["found"].as_array().unwrap();
    let of = |path: &str| found.iter().map(|one| one.pointer(path).unwrap().as_f64().unwrap()).collect::<Vec<_>>();
    assert_eq!(of("/inertia"), [1.0, 0.0, 0.0]);
    let heights = of("/probes/middle/displacement/1");
    assert!(
        heights[0].abs() < 1e-9 && heights[1].abs() > 0.01 && (heights[1] + heights[2]).abs() < 1e-6,
        "{heights:?}"
    );
    let potentials = of("/potential");
    assert!(potentials[1] < potentials[0], "{potentials:?}");
    assert!(said.contains("equilibria  up to 3 under the same controls"), "{said}");
    let shot = nastic_io::read_snapshot(place.path("out/equilibrium_003.vtu")).unwrap();
    let middle = shot.mesh.points().iter().position(|x| *x == [0.5, 0.01, 0.0]).unwrap();
    assert_eq!(shot.point_array("displacement").unwrap().at(middle)[1], heights[2]);
    assert!(place.path("out/start.vtu").exists());
    let files = result["files"].as_array().unwrap();
    assert!(files.contains(&"start.vtu".into()) && files.contains(&"equilibrium_001.vtu".into()), "{files:?}");
}

/// The shipped arch: its expectations hold along the path, and those of a single state do not count there.
#[test]
fn the_arch_has_the_limit_points_it_expects() {
    let place = CaseDirectory::new();
    let case = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/cases/arch.json");
    let options = Options { analysis: Analysis::Path, ..place.options(&[]) };
    let run =
        |options: &Options| nastic_run::run::run(Command::Solve, case.as_ref(), options, &Console::silent()).unwrap();
    let outcome = run(&options);
    assert_eq!((outcome.exit, outcome.missed.len()), (Exit::Done, 0), "{:?}", outcome.missed);
    assert_eq!(outcome.result["expect"]["checked"], 2);
    let kinds: Vec<_> =
        outcome.result["path"]["events"].as_array().unwrap().iter().map(|e| e["kind"].clone()).collect();
    assert_eq!(kinds, ["limit point", "bifurcation", "limit point", "bifurcation"]);
    let plain = run(&place.options(&[]));
    assert_eq!((plain.exit, &plain.result["expect"]["checked"]), (Exit::Done, &1.into()), "{:?}", plain.missed);
    // the same, to the first limit point
    let short = Options { analysis: Analysis::PathToLimit, set: vec!["expect={}".to_owned()], ..options.clone() };
    let first = run(&short);
    assert_eq!(first.exit, Exit::Done);
    let path = |outcome: &nastic_run::run::Outcome, key: &str| outcome.result["path"][key].as_array().unwrap().clone();
    assert_eq!(path(&first, "events")[..], path(&outcome, "events")[..1]);
    let points = path(&first, "points");
    assert!(points.len() < path(&outcome, "points").len() && path(&outcome, "points").starts_with(&points));
    assert!(first.result["path"]["stopped"].is_null());
    // another material has other limit points
    let softer = Options { set: vec!["materials/0/young=0.9 MPa".to_owned()], ..options };
    assert_eq!(run(&softer).exit, Exit::ExpectMissed);
}

/// The result is that of the stable state: its inertia, probes, costs and files.
#[test]
fn an_unstable_equilibrium_goes_on_to_a_minimum() {
    let place = CaseDirectory::new();
    let cost = r#""costs": [ { "kind": "tracking", "region": "body", "target": ["X", "Y"] } ], "probes""#;
    let case = common::with(STRIP, r#""probes""#, cost);
    let (straight, ..) = analyse(&place, &case, Analysis::Equilibrium, &[]);
    let (bent, exit, said) = analyse(&place, &case, Analysis::Minimum, &[]);
    assert_eq!((exit, &straight["inertia"], &bent["inertia"]), (Exit::Done, &1.into(), &0.into()));
    assert!(said.contains("descent     potential from"), "{said}");
    let number = |result: &Value, at: &str| result.pointer(at).unwrap().as_f64().unwrap();
    assert!(number(&bent, "/potential") < number(&straight, "/potential"));
    let height = number(&bent, "/probes/middle/displacement/1");
    assert!(height.abs() > 0.01, "{height}");
    assert!(number(&bent, "/newton_iterations") > number(&straight, "/newton_iterations"));
    // half the integral of the squared displacement, a sine-like bow
    let (low, high) = (number(&straight, "/cost/total"), number(&bent, "/cost/total"));
    assert!(
        high > 1e3 * low && (high / (0.5 * 0.02 * 0.375 * height * height) - 1.0).abs() < 0.05,
        "{low:e}, {high:e}"
    );
    let shot = nastic_io::read_snapshot(place.path("out/start.vtu")).unwrap();
    let middle = shot.mesh.points().iter().position(|x| *x == [0.5, 0.01, 0.0]).unwrap();
    assert_eq!(shot.point_array("displacement").unwrap().at(middle)[1], height);
}
