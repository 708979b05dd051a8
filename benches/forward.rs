//! One equilibrium of the fibre cantilever and one gradient there, part by part, as a line of JSON.
//!
//! `cargo bench --bench forward -- element=hex27 n=6 repeat=3 threads=2`: the bar [0,1] x [0,0.2]^2 with 5n x n x n
//! cells (hex8: n = 12 is 30,927 unknowns, 18 is 98,553, 30 is 435,333; hex27 has as many at half of n), Mooney-Rivlin
//! (1e5, 2e4, 1e6) Pa, tension -1.5e5 Z/0.2 Pa at the points, all at once; solver=direct|multigrid in the place of the cheaper one. Times are medians, in seconds.

#![allow(clippy::print_stdout)] // programs talk, libraries do not

mod common;

use common::{Arguments, cantilever, median, peak_memory};
use nastic::fem::{SolveOptions, Solver, Workspace};
use nastic::linear::Pivots;
use nastic::prelude::*;
use std::time::Instant;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments = Arguments::read(&["element", "n", "repeat", "threads", "solver"])?;
    let kind = arguments.element("element", CellKind::Hex8)?;
    let across = arguments.number("n", 12)?;
    let repeat = arguments.number("repeat", 3)?;
    arguments.use_threads()?;

    let began = Instant::now();
    let body = cantilever(kind, across)?;
    let controls = common::tension(&body)?;
    let setup = began.elapsed().as_secs_f64();

    let disc = body.discretization().clone();
    let structure = body.model().tangent_structure();
    let how = SolveOptions { solver: arguments.solver()?.map(|own| own as _), ..SolveOptions::default() };
    let mut workspace = Workspace::default();
    let state = &body.solve_with(&controls, &how, &mut workspace)?;
    let solve_memory = peak_memory();
    let forward = median(repeat, || body.solve(&controls, &how).map(drop))?;

    let wish: Vec<f64> = (0..disc.dofs()).map(|i| f64::from(i as u32 % 7) - 3.0).collect();
    let mut substitutions = 0;
    let gradient = median(repeat, || {
        let adjoint = body.adjoint_with(state, &[&wish], &how, &mut workspace)?;
        substitutions = adjoint.report.back_substitutions;
        body.body()
            .control_vjp(&state.u, &controls, &adjoint.lambda[0], true)
            .map_err(Box::<dyn std::error::Error>::from)?;
        Ok::<(), Box<dyn std::error::Error>>(())
    })?;
    let memory = peak_memory();

    let mut tangent = structure.matrix();
    let assembly = median(repeat, || {
        tangent.values.fill(0.0);
        body.body().evaluate_tangent(&state.u, &controls, &mut tangent, true).map(drop)
    })?;
    let force = median(repeat, || body.body().evaluate(&state.u, &controls, true, true).map(drop))?;
    let diagonal = tangent.diagonal().iter().copied().fold(0.0, f64::max);
    tangent.eliminate(body.supports().fixed(), diagonal);
    // In the precision that served; on a body solved by multigrid there is no factor to time.
    let direct = state.report.solver == Solver::DIRECT.name();
    let single = workspace.factor_bytes() < structure.factor_bytes();
    drop(workspace);
    let (mut factorisation, mut substitution) = (f64::NAN, f64::NAN);
    if direct {
        let mut factor = structure.symbolic().approximate(&tangent, true)?;
        factorisation = median(repeat, || match single {
            true => factor.approximate(&tangent, true),
            false => factor.refactorize(&tangent, Pivots::Positive, true),
        })?;
        let mut x = vec![1.0; disc.dofs()];
        substitution = median(repeat, || {
            factor.solve(&mut x, 1);
            x.fill(1.0);
            Ok::<(), std::convert::Infallible>(())
        })?;
    }
    let bytes = if single { 4e-6 } else { 8e-6 };
    let told = |x: f64| if x.is_nan() { "null".to_owned() } else { format!("{x:.4}") };

    let tip =
        body.mesh().points().iter().position(|x| (x[0] - 1.0).abs() + (x[1] - 0.2).abs() + (x[2] - 0.2).abs() < 1e-9);
    let tip = tip.map(|node| state.u[3 * node..3 * node + 3].to_vec()).unwrap_or_default();
    let r = &state.report;
    println!(
        "{{\"peer\": \"nastic\", \"element\": \"{}\", \"n\": {across}, \"ndof\": {}, \"threads\": {}, \"solver\": \"{}\", \
         \"single\": {single}, \"setup_s\": {setup:.4}, \"forward_s\": {forward:.4}, \"newton\": {}, \"factorisations\": {}, \
         \"reused\": {}, \"back_substitutions\": {}, \"cycles\": {}, \"cells\": {}, \"tangent_s\": {assembly:.4}, \
         \"force_s\": {force:.4}, \"factor_s\": {}, \"solve_s\": {}, \"gradient_s\": {gradient:.4}, \
         \"gradient_substitutions\": {substitutions}, \"factor_mb\": {:.1}, \"factor_gflop\": {:.3}, \"solve_mb\": {solve_memory:.1}, \"rss_mb\": {:.1}, \
         \"tip_corner\": {tip:?}}}",
        kind.name(),
        disc.dofs(),
        common::threads(),
        r.solver,
        r.newton,
        r.factorisations,
        r.reused,
        r.back_substitutions,
        r.cycles,
        body.mesh().cells(),
        told(factorisation),
        told(substitution),
        structure.symbolic().nonzeros() as f64 * bytes,
        structure.symbolic().flops() * 1e-9,
        memory,
    );
    Ok(())
}
