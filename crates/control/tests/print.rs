//! The lines that [`Print`] writes of a run: the columns of the command line, with what a problem knows of its points.

#![allow(clippy::unwrap_used)] // a test may

use nastic_control::{Evaluated, Reduced, SmoothedHausdorff, Space, Target, Tracking};
use nastic_energy::{FiberTension, MooneyRivlin};
use nastic_fem::Solid;
use nastic_mesh::{CellKind, box_mesh};
use nastic_opt::{Bounds, Lbfgs, Objective, Optimizer, Print, TRUE_DISTANCE, Trial};
use nastic_tensor::Vec3;

fn bar() -> Reduced {
    let mesh = box_mesh([1.0, 0.2, 0.2], [4, 1, 1], CellKind::Hex8).unwrap();
    let solid = Solid::new(mesh).unwrap().material("body", MooneyRivlin::new(1e5, 2e4, 1e6).unwrap()).unwrap();
    let solid = solid.actuate("body", "tension", FiberTension::along(Vec3::x()).unwrap()).unwrap();
    Reduced::new(solid.clamp("x-").unwrap()).control("tension", Space::Cell).unwrap()
}

fn printed(problem: &Reduced) -> Vec<String> {
    let mut text = Vec::new();
    let mut search = Lbfgs::default().within(Bounds::new(-1e5, 1e5).unwrap()).max_iterations(3).gradient_check(false);
    search = search.tolerance(1e-6);
    search.observe(Print::of(problem, &mut text)).minimize(problem, 0.0).unwrap();
    String::from_utf8(text).unwrap().lines().map(str::to_owned).collect()
}

#[test]
fn a_line_per_trial_in_the_columns_of_the_command_line() {
    let target = Target::position(|x| [0.95 * x[0], x[1], x[2]]);
    let problem = bar().cost(Tracking::surface("x+", target)).unwrap();
    let lines = printed(&problem);
    let header: Vec<&str> = lines[0].split_whitespace().collect();
    let expected = ["trial", "iter", "cost", "gradient", "step", "newton", "factor", "min", "J", "active", "seconds"];
    assert_eq!(header, expected);

    let mut trials: Vec<(usize, f64, usize)> = vec![];
    let note = |trial: &Trial<'_, Evaluated>| {
        trials.push((trial.trial, trial.cost.unwrap(), trial.summary.get("newton").unwrap() as usize));
    };
    let mut search = Lbfgs::default().within(Bounds::new(-1e5, 1e5).unwrap()).max_iterations(3).gradient_check(false);
    search = search.tolerance(1e-6);
    search.observe(note).minimize(&problem, 0.0).unwrap();
    assert_eq!(lines.len(), 1 + trials.len());
    for (line, (trial, cost, newton)) in lines[1..].iter().zip(trials) {
        let cells: Vec<&str> = line.split_whitespace().collect();
        assert_eq!(cells[0].parse::<usize>().unwrap(), trial);
        let printed: f64 = cells[2].parse().unwrap();
        assert!((printed - cost).abs() <= 1e-6 * cost, "{line}: {cost}");
        assert_eq!(cells[5].parse::<usize>().unwrap(), newton);
    }
}

#[test]
fn stages_and_distances_have_columns_where_the_cost_has_them() {
    let target = box_mesh([0.9, 0.2, 0.2], [3, 1, 1], CellKind::Hex8).unwrap();
    let cost = SmoothedHausdorff::to(target).exponential(0.1).stages([(1.0, 4.0, 4.0), (2.0, 8.0, 8.0)]);
    let problem = bar().cost(cost).unwrap();
    let lines = printed(&problem);
    let header: Vec<&str> = lines[0].split_whitespace().collect();
    assert_eq!(header[..7], ["trial", "iter", "stage", "cost", "gradient", "step", "distance"]);
    let start = problem.at(&[0.0; 4]).unwrap();
    let distance = problem.figures(&start).get(TRUE_DISTANCE).unwrap();
    assert!((distance - 0.1).abs() < 1e-9, "the bar is a tenth too long: {distance}");
    let cells: Vec<&str> = lines[1].split_whitespace().collect();
    assert_eq!((cells[2], cells[6]), ("1", "1.0000e-01"), "{}", lines[1]);
}
