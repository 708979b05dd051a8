//! Tracking of the tip face: the bar of the reference case, nodal tension between -300 kPa and 0, the
//! end face to be turned by 0.55 rad and lifted.
//!
//! `cargo run --release --example tip_tracking [METHOD] [CELLS] [ITERATIONS]`: CELLS across (8 gives the 9,963 unknowns
//! of the published comparison, whose cost falls from 1.470e-3 to 2.4e-8 in 20 iterations of L-BFGS-B).

#![allow(clippy::print_stdout)] // programs talk, libraries do not

use nastic::opt::by_name;
use nastic::prelude::*;
use std::time::Instant;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut args = std::env::args().skip(1);
    let method = args.next().unwrap_or("lbfgs".to_owned());
    let across: usize = args.next().map_or(Ok(8), |n| n.parse())?;
    let iterations: usize = args.next().map_or(Ok(20), |n| n.parse())?;

    let began = Instant::now();
    let body = Solid::new(box_mesh([1.0, 0.2, 0.2], [5 * across, across, across], CellKind::Hex8)?)?
        .material("body", MooneyRivlin::new(1e5, 2e4, 1e6)?)?
        .actuate("body", "tension", FiberTension::along(Vec3::x())?)?
        .clamp("x-")?;
    let (s, c) = 0.55f64.sin_cos();
    let lifted = Target::position(move |x| [0.90 - s * (x[2] - 0.1), x[1], 0.35 + c * (x[2] - 0.1)]);
    let problem = Reduced::new(body).control("tension", Space::Node)?.cost(Tracking::surface("x+", lifted))?;
    println!("{} unknowns, {} controls", problem.solid().discretization().dofs(), problem.layout().len());

    let options = Options { max_iterations: iterations, tolerance: 1e-6, ..Options::default() };
    let optimizer = by_name(&method, options)
        .ok_or("METHOD is projected_gradient, spectral, lbfgs, mma, gauss_newton or newton_cg")?;
    let print = |trial: &Trial<'_, Evaluated>| {
        let work = |name| trial.summary.get(name).unwrap_or(0.0);
        let (newton, factorisations) = (work("newton"), work("factorisations"));
        println!("{trial}, newton {newton}, factorisations {factorisations} ({:.1} s)", began.elapsed().as_secs_f64());
    };
    let best = optimizer.within(Bounds::new(-3e5, 0.0)?).observe(print).minimize(&problem, 0.0)?;
    println!("{}", best.stop);
    let counts = best.counts;
    let (iterations, trials, products) = (counts.iterations, counts.trials, counts.products);
    println!("cost {:.3e} after {iterations} iterations, {trials} trials, {products} Hessian products", best.cost);
    Ok(())
}
