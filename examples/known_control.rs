//! The answer is known: the target is the same bar bent by a control of ours, on a different mesh. The true Hausdorff
//! distance must fall at least thirtyfold and end below 1 % of the bar's length.
//!
//! The control is m = -3e5 (Z - 0.1)/0.1 Pa above mid-height and +1e5 Pa below it, both for X < 0.6 m, zero beyond; with
//! fibres at 45 degrees the bar bends and twists. The target's mesh has 15 x 3 x 6 cells, the body's 10 x 2 x 4.
//!
//! `cargo run --release --example known_control [METHOD]` with METHOD one of projected_gradient, spectral, lbfgs, gauss_newton,
//! newton_cg; it also writes the target as `out/known_control/target.vtu`, which is `meshes/known_target.vtu` of the case
//! `examples/cases/known_control.json`.

#![allow(clippy::print_stdout)] // programs talk, libraries do not

use nastic::opt::by_name;
use nastic::prelude::*;

fn bar(cells: [usize; 3]) -> Result<Solid, Box<dyn std::error::Error>> {
    let fiber = Vec3::new(1.0, 1.0, 0.0).normalize();
    Ok(Solid::new(box_mesh([1.0, 0.2, 0.2], cells, CellKind::Hex20)?)?
        .material("body", TransverseMooneyRivlin::new(1e5, 0.2e5, 3e5, 10e5, fiber)?)?
        .actuate("body", "tension", FiberTension::along(Vec3::x())?)?
        .clamp("x-")?)
}

fn known_tension(x: &[f64; 3]) -> f64 {
    match (x[0] < 0.6, x[2] > 0.1) {
        (true, true) => -3e5 * (x[2] - 0.1) / 0.1,
        (true, false) => 1e5,
        _ => 0.0,
    }
}

/// The bar under the known control, as a mesh of its own.
fn target() -> Result<Mesh, Box<dyn std::error::Error>> {
    let maker = bar([15, 3, 6])?;
    let at = maker.discretization().points().positions(maker.mesh(), None);
    let mut controls = maker.controls();
    controls.set(0, 0, &at.iter().map(known_tension).collect::<Vec<_>>())?;
    let state = maker.solve(&controls, &Default::default())?;
    let moved = maker.mesh().points().iter().zip(state.u.chunks_exact(3));
    let moved = moved.map(|(x, u)| [x[0] + u[0], x[1] + u[1], x[2] + u[2]]).collect();
    Ok(maker.mesh().as_ref().clone().with_points(moved)?.named("known target"))
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let method = std::env::args().nth(1).unwrap_or("lbfgs".to_owned());
    let target = target()?;
    nastic::io::write_vtu("out/known_control/target.vtu", &Snapshot::new(target.clone()))?;

    let body = bar([10, 2, 4])?;
    let cost = SmoothedHausdorff::to(target).exponential(0.1).stages([(1.0, 4.0, 4.0), (4.0, 16.0, 8.0)]);
    let distance = cost.clone().bind_to(&body)?;
    let problem = Reduced::new(body).control("tension", Space::Cell)?.cost(cost)?;

    let options = Options { tolerance: 1e-2, max_iterations: 300, ..Options::default() };
    let optimizer = by_name(&method, options)
        .ok_or("METHOD is projected_gradient, spectral, lbfgs, mma, gauss_newton or newton_cg")?;
    let truth =
        |point: &Evaluated| distance.true_distance(problem.solid(), &point.state().u).map(|found| found.distance);
    let print = |trial: &Trial<'_, Evaluated>| {
        let Some(Ok(distance)) = trial.point.filter(|_| trial.accepted).map(truth) else { return };
        println!("{trial}, true distance {distance:.5} m");
    };
    let start = problem.at(&vec![0.0; problem.layout().len()])?;
    let best = optimizer.within(Bounds::new(-4e5, 1.9e5)?).observe(print).minimize(&problem, &start)?;
    let (first, last) = (truth(&start)?, truth(&best.point)?);
    println!("{}", best.stop);
    println!("true Hausdorff distance {first:.4} m -> {last:.5} m, {:.0} times smaller", first / last);
    Ok(())
}
