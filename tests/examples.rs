//! The example programs run, and say what their heads promise.

#![allow(clippy::unwrap_used, clippy::panic)] // a test may

use std::path::{Path, PathBuf};
use std::process::Command;

/// The compiled example: `cargo test` builds them beside this test.
fn example(name: &str) -> PathBuf {
    let test = std::env::current_exe().unwrap();
    test.parent().and_then(Path::parent).unwrap().join("examples").join(name)
}

/// Its standard output; from the project's root, where the meshes are.
fn run(name: &str, args: &[&str]) -> String {
    let program = example(name);
    let output = Command::new(&program).args(args).current_dir(env!("CARGO_MANIFEST_DIR")).output();
    let output = output.unwrap_or_else(|e| panic!("{}: {e}; run the whole `cargo test`", program.display()));
    assert!(output.status.success(), "{name}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// The number that follows `before`.
fn number_after(text: &str, before: &str) -> f64 {
    let rest = &text[text.rfind(before).unwrap_or_else(|| panic!("no \"{before}\" in:\n{text}")) + before.len()..];
    let end = rest.find(|c: char| !(c.is_ascii_digit() || ".e+-".contains(c))).unwrap_or(rest.len());
    rest[..end].parse().unwrap()
}

#[test]
fn a_known_control_is_found_again() {
    let said = run("known_control", &[]);
    assert!(said.contains("converged"), "{said}");
    let (first, last) = (number_after(&said, "distance "), number_after(&said, "m -> "));
    assert!(first > 0.4 && last < 0.01 && last < first / 30.0, "{said}");
}

#[test]
fn the_arc_is_approached() {
    let said = run("fiber_cantilever", &[]);
    let (first, last) = (number_after(&said, "distance "), number_after(&said, "m -> "));
    assert!(last < first / 5.0, "{said}");
    for file in ["start.vtu", "optimum.vtu", "target.vtu", "picture.png"] {
        assert!(Path::new(env!("CARGO_MANIFEST_DIR")).join("out/fiber_cantilever").join(file).exists(), "{file}");
    }
}

#[test]
fn tip_tracking_falls_by_four_decades_in_twenty_iterations() {
    let said = run("tip_tracking", &["lbfgs", "4", "20"]);
    assert!(number_after(&said, "\ncost ") < 1.47e-7, "{said}");
}

#[test]
fn a_stem_lifts_itself_by_turgor() {
    let said = run("turgor_stem", &[]);
    assert!(said.contains("converged"), "{said}");
    let (first, last) = (number_after(&said, "tracked part "), number_after(&said, "mm -> "));
    assert!(first > 15.0 && last < first / 20.0, "{said}");
}

/// Eight scenarios; the sampling error of so few draws is large, so what is certain is asked: the rule's own costs.
#[test]
fn a_robust_control_is_better_on_average_where_it_was_found() {
    let said = run("robust_turgor", &["2", "4"]);
    let rule = said.split("on the 8 nodes").nth(1).and_then(|rest| rest.split("draws").next()).unwrap();
    let row = rule.lines().find(|line| line.starts_with("mean")).unwrap();
    let means: Vec<f64> = row.split_whitespace().skip(1).map(|word| word.parse().unwrap()).collect();
    assert!(means[1] < 0.95 * means[0], "{said}");
    for file in ["mean_shape_deterministic.vtu", "mean_shape_robust.vtu", "mean_material_robust.vtu", "costs.csv"] {
        assert!(Path::new(env!("CARGO_MANIFEST_DIR")).join("out/robust_turgor").join(file).exists(), "{file}");
    }
}

#[test]
fn the_shortest_program_ends_at_its_number() {
    let said = run("shortest", &[]);
    // With its default tolerance it ends by its limit of 100 iterations, at 4 % of the first projected gradient.
    assert!(said.contains("converged") || said.contains("stopped after 100 iterations"), "{said}");
    assert!((number_after(&said, "\ncost ") - 0.1357).abs() < 5e-4, "{said}");
}

#[test]
fn a_finger_is_bent_by_air_and_held_by_springs_of_ones_own() {
    let said = run("air_finger", &[]);
    assert!((number_after(&said, "free: ") - 41679.5).abs() < 10.0, "{said}");
    assert!((number_after(&said, "held by springs: ") - 45000.0).abs() < 1e-6, "{said}");
}

#[test]
fn a_law_of_ones_own_passes_the_contract_and_is_driven() {
    let said = run("own_energy", &[]);
    assert!(said.contains("verdict: right"), "{said}");
    assert!(number_after(&said, "tracking cost ") < 1e-6, "{said}");
}

#[test]
fn a_cost_of_ones_own_has_the_right_derivative_and_lifts_the_bar() {
    let said = run("own_cost", &[]);
    assert!(said.contains("verdict: right"), "{said}");
    let (free, kept) = (number_after(&said, "without the table: cost "), number_after(&said, "with the table: cost "));
    assert!(free < 0.01 && kept < 0.05, "{said}");
    let lowest: Vec<f64> =
        said.split("lowest node at ").skip(1).map(|rest| number_after(&format!("at {rest}"), "at ")).collect();
    assert!(lowest[0] < -20.0 && lowest[1] > -5.0, "{said}");
}
