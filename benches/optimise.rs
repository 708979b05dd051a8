//! Twenty iterations of a quasi-Newton method on the tracking problem that other programs are timed on, as a line of JSON.
//!
//! `cargo bench --bench optimise -- method=lbfgs n=8 iterations=20 threads=2`: the bar of `benches/forward.rs` with element=hex8
//! (n = 8: 9,963 unknowns) or another, solver=direct|multigrid in the place of the cheaper one, nodal tension in [-3e5, 0] Pa from zero, the end face turned by 0.55 rad and lifted.

#![allow(clippy::print_stdout)] // programs talk, libraries do not

mod common;

use common::{Arguments, cantilever, peak_memory, threads};
use nastic::opt::by_name;
use nastic::prelude::*;
use std::time::Instant;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments = Arguments::read(&["element", "n", "method", "iterations", "accuracy", "threads", "solver"])?;
    let across = arguments.number("n", 8)?;
    let method = arguments.text("method", "lbfgs");
    let options = Options {
        max_iterations: arguments.number("iterations", 20)?,
        tolerance: 1e-12,
        accuracy: arguments.text("accuracy", "1e-8").parse()?,
        ..Options::default()
    };
    arguments.use_threads()?;

    let (s, c) = 0.55f64.sin_cos();
    let lifted = Target::position(move |x| [0.90 - s * (x[2] - 0.1), x[1], 0.35 + c * (x[2] - 0.1)]);
    let body = cantilever(arguments.element("element", CellKind::Hex8)?, across)?;
    let body = arguments.solver()?.into_iter().fold(body, Solid::solver);
    let problem = Reduced::new(body).control("tension", Space::Node)?.cost(Tracking::surface("x+", lifted))?;
    let optimizer = by_name(&method, options)
        .ok_or("method is projected_gradient, spectral, lbfgs, mma, gauss_newton or newton_cg")?;

    let set = Bounds::new(-3e5, 0.0)?;
    let began = Instant::now();
    let mut work = [("newton", 0.0), ("factorisations", 0.0), ("back_substitutions", 0.0)];
    let mut first = None;
    let count = |trial: &Trial<'_, Evaluated>| {
        first = first.or(trial.cost);
        work.iter_mut().for_each(|(name, sum)| *sum += trial.summary.get(name).unwrap_or(0.0));
    };
    let best = optimizer.within(set).gradient_check(false).observe(count).minimize(&problem, 0.0)?;
    let seconds = began.elapsed().as_secs_f64();
    let work: Vec<String> = work.iter().map(|(name, sum)| format!("\"{name}\": {sum}")).collect();
    println!(
        "{{\"peer\": \"nastic\", \"method\": \"{method}\", \"ndof\": {}, \"ncontrol\": {}, \"threads\": {}, \"opt_s\": {seconds:.3}, \
         \"opt_iters\": {}, \"opt_evals\": {}, \"products\": {}, \"J0\": {:e}, \"J1\": {:e}, {}, \"stop\": \"{}\", \"rss_mb\": {:.1}}}",
        problem.solid().discretization().dofs(),
        problem.layout().len(),
        threads(),
        best.counts.iterations,
        best.counts.trials,
        best.counts.products,
        first.unwrap_or(f64::NAN),
        best.cost,
        work.join(", "),
        best.stop,
        peak_memory(),
    );
    Ok(())
}
