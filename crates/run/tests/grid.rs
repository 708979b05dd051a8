//! Controls on a grid of their own in case files: keys, results, starts from coarser grids.

#![allow(clippy::unwrap_used, clippy::panic)] // a test may

use crate::common;

use common::{BAR, CaseDirectory, problems, with};
use nastic_control::{Reduced, Space, Target, Tracking};
use nastic_energy::{FiberTension, NeoHooke};
use nastic_fem::Solid;
use nastic_io::read_snapshot;
use nastic_language::schema::Command;
use nastic_mesh::{CellKind, box_mesh};
use nastic_opt::{Bounds, Lbfgs, Options as Stops};
use nastic_run::run::Study;
use nastic_tensor::Vec3;
use serde_json::json;

const MAGNET: &str = include_str!("../../language/tests/cases/magnet_pair.json");

/// Space and start of the bar's control.
const START: &str = r#""space": "node", "start": "-50 kPa * Z / 0.25 m""#;

fn grid(cells: &str) -> String {
    with(BAR, r#""space": "node""#, &format!(r#""space": {{ "grid": {cells} }}"#))
}

#[test]
fn a_grid_is_read_and_told() {
    let place = CaseDirectory::new();
    let described = place.text(Command::Check, &grid("[2, 1, 3]"), &[]);
    assert!(described.contains("tension: by grid of 2 x 1 x 3 cells, 24 unknowns"), "{described}");
    let outcome = place.run(Command::Optimize, &grid("[2, 1]"), &["optimizer/max_iterations=3"]).unwrap();
    let control = &outcome.result["controls"]["tension"];
    assert_eq!(
        (&control["space"], &control["grid"], &control["unknowns"]),
        (&json!("grid"), &json!([2, 1, 1]), &json!(12))
    );
    assert!(control["total_variation"].as_f64().unwrap() > 0.0, "{control}");
    // The field stands in cells, between the least and the largest value.
    let shot = read_snapshot(place.path("out/optimum.vtu")).unwrap();
    let cells = shot.cell_data.iter().find(|array| array.name == "tension").unwrap();
    let (min, max) = (control["min"].as_f64().unwrap(), control["max"].as_f64().unwrap());
    assert!(cells.values.iter().all(|x| (min..=max).contains(x)) && cells.values.iter().any(|x| *x != cells.values[0]));
    assert!(std::fs::read_to_string(place.path("out/report.html")).unwrap().contains("total variation"));
}

#[test]
fn what_is_no_grid_is_refused() {
    for (cells, word) in [
        ("[2]", "two or three entries"),
        ("[0, 1]", "at least 1"),
        ("4", "a list"),
        ("[1.5, 1]", "whole number"),
        ("[5000000000, 1, 1]", "numbers of cells"),
        ("[70000, 70000, 1]", "grid of [70000, 70000, 1] cells"),
    ] {
        let described = problems(&grid(cells));
        assert!(described.contains(word), "{cells}: {described}");
    }
    let start = with(BAR, START, r#""space": "node", "start": { "file": "a.json", "grid": [1, 1] }"#);
    let described = problems(&start);
    assert!(described.contains("is no grid"), "{described}");
}

/// The optimum on a coarse grid is the same field on a finer one, whose first cost is the last one of the coarse run; a file without the
/// cells of its grid is refused with a hint.
#[test]
fn a_run_starts_from_the_optimum_on_a_coarser_grid() {
    let (coarse, fine) = (CaseDirectory::new(), CaseDirectory::new());
    let first = coarse.run(Command::Optimize, &grid("[2, 1, 1]"), &["optimizer/max_iterations=4"]).unwrap();
    let file = coarse.path("out/controls.json");
    let start = |more: &str| {
        let keys = format!(
            r#""space": {{ "grid": [4, 2, 2] }}, "start": {{ "file": {:?}{more} }}"#,
            file.display().to_string()
        );
        with(BAR, START, &keys)
    };
    let described = problems(&start(""));
    assert!(described.contains("beside \"file\"") && described.contains("45 are needed"), "{described}");
    let second =
        fine.run(Command::Optimize, &start(r#", "grid": [2, 1, 1]"#), &["optimizer/max_iterations=4"]).unwrap();
    let (end, begin) =
        (first.result["cost"]["total"].as_f64().unwrap(), second.result["start"]["cost"]["total"].as_f64().unwrap());
    assert!((end - begin).abs() < 1e-6 * end, "{end} and {begin}");
    assert!(second.result["cost"]["total"].as_f64().unwrap() < begin);
}

/// Lengths of the remanence at the quadrature points, at the optimum.
fn problem_points(case: &str, place: &CaseDirectory) -> Vec<f64> {
    let problem = common::lower(case).unwrap();
    let owner = problem.ensemble.members()[0].problem();
    let block = owner.layout().block("magnet.remanence").unwrap();
    let mut m = vec![0.0; owner.layout().len()];
    let values = place.json("controls.json")["design"].as_array().unwrap().clone();
    m[block.first..].iter_mut().zip(&values).for_each(|(m, value)| *m = value.as_f64().unwrap());
    let controls = owner.layout().to_points(&m).unwrap();
    let vectors = controls.values(block.targets[0].actuation).chunks_exact(controls.slots(block.targets[0].actuation));
    vectors.map(|v| v[block.targets[0].slot..][..3].iter().map(|x| x * x).sum::<f64>().sqrt()).collect()
}

/// Vectors of one length have it between the nodes of a grid too.
#[test]
fn vectors_of_one_length_keep_it_between_the_nodes() {
    let place = CaseDirectory::new();
    let case = with(MAGNET, r#""space": "cell""#, r#""space": { "grid": [3, 1, 1] }"#);
    place.run(Command::Optimize, &case, &["optimizer/max_iterations=3"]).unwrap();
    let result = place.json("result.json");
    let (name, control) = result["controls"].as_object().unwrap().iter().find(|(_, c)| c["space"] == "grid").unwrap();
    // At every point, so that the means over cells fall short of it by what the field turns in them alone, not by interpolation.
    assert!((control["min"].as_f64().unwrap() - 0.1).abs() < 1e-12, "{name}: {control}");
    let points = problem_points(&case, &place);
    assert!(points.len() > 8 && points.iter().all(|length| (length - 0.1).abs() < 1e-12), "{points:?}");
}

/// The control of a program is looked at as that of a case.
#[test]
fn a_program_is_warned_of_a_grid_finer_than_its_mesh() -> Result<(), Box<dyn std::error::Error>> {
    for (cells, described) in [([4, 1, 2], 0), ([8, 1, 2], 1)] {
        let body = Solid::new(box_mesh([0.4, 0.1, 0.1], [4, 1, 2], CellKind::Hex8)?)?
            .material("body", NeoHooke::from_young_poisson(1e5, 0.3)?)?
            .actuate("body", "top", FiberTension::along(Vec3::x())?)?
            .clamp("x-")?;
        let target = Target::position(|x| [0.99 * x[0], x[1], x[2]]);
        let problem = Reduced::new(body).control("top", Space::Grid(cells))?.cost(Tracking::surface("x+", target))?;
        let start = vec![-1e3; problem.layout().len()];
        let study = Study::new(problem)?.within("top", Bounds::new(-1e4, 0.0)?).start("top", start);
        let few = Stops { max_iterations: 1, ..Stops::default() };
        let result = study.optimize(&Lbfgs { options: few, ..Lbfgs::default() })?.outcome.result;
        let all = result["warnings"].as_array().cloned().unwrap_or_default();
        let found = all.iter().filter(|one| one["code"] == "grid_resolution");
        let found: Vec<&str> = found.filter_map(|one| one["message"].as_str()).collect();
        assert_eq!(found.len(), described, "{all:?}");
        assert!(found.iter().all(|m| m.starts_with("top: ") && m.ends_with("at most 4 x 1 x 2")), "{all:?}");
    }
    Ok(())
}
