//! Value and derivative of a case at a sequence of controls, as a line of JSON: the least seconds of each control.
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

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments = Arguments::read(&["n", "rounds", "threads"])?;
    let (n, rounds) = (arguments.number("n", 4)?, arguments.number("rounds", 5)?);
    arguments.use_threads()?;

    let mut document = Document::open(Path::new("examples/cases/tip_tracking.json"))?;
    document.set(&format!("mesh/box/cells=[{}, {n}, {n}]", 5 * n))?;
    let problem = CaseProblem::lower(document, Arc::default())?;
    let mut least = [f64::INFINITY; CONTROLS];
    let mut workspace = EnsembleWorkspace::default();
    let mut last: Option<EnsemblePoint> = None;
    for _ in 0..rounds {
        for (k, least) in least.iter_mut().enumerate() {
            let m = vec![-1e4 * (1.0 + 0.1 * k as f64); problem.start.len()];
            let began = Instant::now();
            let how = Request { near: last.as_ref(), ..Request::default() };
            let mut point = problem.ensemble.evaluate(&m, &how, &mut workspace)?;
            problem.ensemble.derivative(&mut point, &mut workspace)?;
            *least = least.min(began.elapsed().as_secs_f64());
            last = Some(point);
        }
    }
    let unknowns = problem.solid().discretization().dofs();
    println!("{{\"unknowns\": {unknowns}, \"controls\": {}, \"seconds\": {least:?}}}", problem.start.len());
    Ok(())
}
