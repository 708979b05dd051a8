//! Value and derivative of a case at a sequence of controls, as a line of JSON: the least seconds of each control; `derivative`: the least
//! seconds of any derivative, its state at hand; `products`: the least seconds of a state's first, second and third product with the second
//! derivative. The first one uses what the state's solution left, the second one factorises the state's tangent, the third one has that factor
//! at hand.
//!
//! `cargo bench --bench gradient -- n=4 rounds=5 threads=2`: the bar of `examples/cases/tip_tracking.json` with 5n x n x n cells, seven controls one
//! after the other, each from the states before it, `rounds` times. `scripts/python-overhead.py` does the same from Python and compares.

#![allow(clippy::print_stdout)] // programs talk, libraries do not

mod common;

use common::Arguments;
use nastic::case::lower::CaseProblem;
use nastic::case::syntax::Document;
use nastic::control::{EnsemblePoint, EnsembleWorkspace};
use nastic::prelude::*;
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

/// Controls of the sequence.
const CONTROLS: usize = 7;
/// Products with the second derivative at each of them.
const PRODUCTS: usize = 3;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments = Arguments::read(&["n", "rounds", "threads"])?;
    let (n, rounds) = (arguments.number("n", 4)?, arguments.number("rounds", 5)?);
    arguments.use_threads()?;

    let mut document = Document::open(Path::new("examples/cases/tip_tracking.json"))?;
    document.set(&format!("mesh/box/cells=[{}, {n}, {n}]", 5 * n))?;
    let problem = CaseProblem::lower(document, Arc::default())?;
    let mut least = [f64::INFINITY; CONTROLS];
    let (mut derivative, mut products) = (f64::INFINITY, [f64::INFINITY; PRODUCTS]);
    let direction: Vec<f64> = (0..problem.start.len()).map(|i| (i as f64).sin()).collect();
    let mut workspace = EnsembleWorkspace::default();
    let mut last: Option<EnsemblePoint> = None;
    for _ in 0..rounds {
        for (k, least) in least.iter_mut().enumerate() {
            let m = vec![-1e4 * (1.0 + 0.1 * k as f64); problem.start.len()];
            let began = Instant::now();
            let how = Request { near: last.as_ref(), ..Request::default() };
            let mut point = problem.ensemble.evaluate(&m, &how, &mut workspace)?;
            let solved = began.elapsed().as_secs_f64();
            problem.ensemble.derivative(&mut point, &mut workspace)?;
            let differentiated = began.elapsed().as_secs_f64();
            *least = least.min(differentiated);
            derivative = derivative.min(differentiated - solved);
            for seconds in &mut products {
                let began = Instant::now();
                problem.ensemble.hessian_vector(&point, &direction, &mut workspace)?;
                *seconds = seconds.min(began.elapsed().as_secs_f64());
            }
            last = Some(point);
        }
    }
    let unknowns = problem.solid().discretization().dofs();
    let controls = problem.start.len();
    println!(
        "{{\"unknowns\": {unknowns}, \"controls\": {controls}, \"seconds\": {least:?}, \"derivative\": {derivative:?}, \
         \"products\": {products:?}}}"
    );
    Ok(())
}
