//! Iterations of every optimiser on finer and finer meshes, in the L2 inner product of the control field and in the Euclidean one of its
//! values; a line of JSON for each run.
//!
//! `cargo bench --bench meshes -- sizes=5,8,12,18 grading=2 methods=lbfgs,gauss_newton products=l2,euclidean iterations=60 threads=1`: the
//! bar of `benches/forward.rs` with 5n x n x n hex8 cells (n = 5: 2,808 unknowns, 18: 98,553), the nodes moved to x^grading, so that with a
//! grading above 1 cells are smaller towards the clamp and differ the more in size the more there are. Nodal tension m in [-3e5, 0] Pa from
//! zero, the end face turned by 0.55 rad and lifted, j = tracking + (M/2) int m^2 dX with M = 1e-13 m/Pa^2, whose minimiser is a function of
//! space that no mesh decides.
//!
//! J* is the cost at which `gauss_newton` ends in L2 with 1e-5 of the first projected gradient. Counted are iterations, trials and products
//! with second derivatives until the cost is at most J* + share (J0 - J*), `shares=1e-3,1e-6`: the stopping tests of two inner products differ,
//! this one does not. `null`: not within the limit of iterations.

#![allow(clippy::print_stdout)] // programs talk, libraries do not

mod common;

use common::{Arguments, cantilever_on};
use nastic::opt::{CATALOGUE, Counts, Euclidean, by_name};
use nastic::prelude::*;
use serde_json::{Value, json};
use std::collections::BTreeMap;

const REFERENCE: &str = "gauss_newton";

type Failure = Box<dyn std::error::Error>;

fn main() -> Result<(), Failure> {
    let arguments = Arguments::read(&["sizes", "grading", "methods", "products", "shares", "iterations", "threads"])?;
    let sizes = arguments.text("sizes", "5,8,12,18");
    let grading: f64 = arguments.text("grading", "2").parse()?;
    let iterations = arguments.number("iterations", 60)?;
    let methods = arguments.text("methods", &CATALOGUE.iter().map(|row| row.name).collect::<Vec<_>>().join(","));
    let products = arguments.text("products", "l2,euclidean");
    let shares = arguments.text("shares", "1e-3,1e-6");
    let shares = shares.split(',').map(|share| Ok((share, share.parse()?))).collect::<Result<Vec<_>, Failure>>()?;
    let finest = shares.iter().fold(1.0, |finest: f64, (_, share)| finest.min(*share));
    arguments.use_threads()?;

    for n in sizes.split(',') {
        let across: usize = n.parse().map_err(|_| format!("sizes are numbers with commas between, not {n:?}"))?;
        let problem = problem(across, grading)?;
        let reference = descend(&problem, REFERENCE, "l2", iterations, |_| false)?;
        let (first, least) = (reference[0].0, reference.iter().fold(f64::INFINITY, |least, at| least.min(at.0)));
        let goal = |share: f64| least + share * (first - least);
        for product in products.split(',') {
            for method in methods.split(',') {
                let steps = match (method, product) {
                    (REFERENCE, "l2") => reference.clone(),
                    _ => descend(&problem, method, product, iterations, |cost| cost <= goal(finest))?,
                };
                let reached: BTreeMap<_, _> =
                    shares.iter().map(|(name, s)| (name, reached(&steps, goal(*s)))).collect();
                println!(
                    "{}",
                    json!({
                        "ndof": problem.solid().discretization().dofs(),
                        "ncontrol": problem.layout().len(),
                        "grading": grading,
                        "product": product,
                        "method": method,
                        "J0": first,
                        "J*": least,
                        "reached": reached,
                        "active": steps.last().map(|at| at.2),
                    })
                );
            }
        }
    }
    Ok(())
}

fn problem(across: usize, grading: f64) -> Result<Reduced, Failure> {
    let mesh = box_mesh([1.0, 0.2, 0.2], [5 * across, across, across], CellKind::Hex8)?;
    let (s, c) = 0.55f64.sin_cos();
    let lifted = Target::position(move |x| [0.90 - s * (x[2] - 0.1), x[1], 0.35 + c * (x[2] - 0.1)]);
    Ok(Reduced::new(cantilever_on(mesh.mapped(|[x, y, z]| [x.powf(grading), y, z])?)?)
        .control("tension", Space::Node)?
        .cost(Tracking::surface("x+", lifted))?
        .cost(ControlNorm::of("tension", 1e-13)?)?)
}

/// Cost, counts and active bounds of a run at the start and after every iteration, until the cost is `low_enough` or the run ends.
fn descend(
    problem: &Reduced,
    method: &str,
    product: &str,
    iterations: usize,
    low_enough: impl Fn(f64) -> bool,
) -> Result<Vec<(f64, Counts, usize)>, Failure> {
    let options = Options { max_iterations: iterations, tolerance: 1e-5, ..Options::default() };
    let optimizer = by_name(method, options).ok_or_else(|| format!("no method {method:?}"))?;
    let mut search = optimizer.within(Bounds::new(-3e5, 0.0)?);
    match product {
        "l2" => {}
        "euclidean" => search = search.metric(Euclidean::new(problem.layout().len())),
        _ => return Err(format!("products are l2 and euclidean, not {product:?}").into()),
    }
    let mut run = search.start(problem, 0.0)?;
    let at_bounds = |m: &[f64]| m.iter().filter(|m| **m == 0.0 || **m == -3e5).count();
    let mut steps = vec![(run.cost(), run.progress().counts, at_bounds(run.m()))];
    while !low_enough(run.cost()) && run.step(&mut ()) == Outcome::Iterated {
        steps.push((run.cost(), run.progress().counts, at_bounds(run.m())));
    }
    Ok(steps)
}

fn reached(steps: &[(f64, Counts, usize)], goal: f64) -> Value {
    let hit = steps.iter().find(|(cost, ..)| *cost <= goal);
    hit.map_or(Value::Null, |(_, counts, _)| {
        json!({ "iterations": counts.iterations, "trials": counts.trials, "products": counts.products })
    })
}
