//! Sums over the cells of the fibre cantilever, one by one, as a line of JSON.
//!
//! `cargo bench --bench assembly -- element=hex27 n=6 repeat=20 threads=1`: the body of the bench `forward` in a bent
//! configuration that costs no solve. Times are the smallest of the repetitions, in seconds: on a machine that does other work too, that
//! is the figure that repeats itself. Cycles of multigrid are at rest, on entries and on products of cells.

#![allow(clippy::print_stdout)] // programs talk, libraries do not

mod common;

use common::{Arguments, cantilever};
use nastic::fem::Instant;
use nastic::linear::{Geometry, Multigrid, Preconditioner};
use nastic::prelude::*;
use rayon::prelude::*;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments = Arguments::read(&["element", "n", "repeat", "only", "threads"])?;
    let kind = arguments.element("element", CellKind::Hex27)?;
    let across = arguments.number("n", 6)?;
    let repeat = arguments.number("repeat", 20)?;
    arguments.use_threads()?;

    let solid = cantilever(kind, across)?;
    let controls = common::tension(&solid)?;
    let (body, disc) = (solid.body(), solid.discretization());
    let u = arc(solid.mesh());
    let v: Vec<f64> = (0..disc.dofs()).map(|i| f64::from(i as u32 % 7) - 3.0).collect();

    let mut matrix = solid.model().tangent_structure().matrix();
    let tangent = least(repeat, || {
        matrix.clear();
        body.evaluate_tangent(&u, &controls, &mut matrix, true).map(drop)
    })?;
    if arguments.text("only", "") == "tangent" {
        println!("{{\"tangent_s\": {tangent:.5}}}"); // for a profiler
        return Ok(());
    }
    let clear = least(repeat, || {
        matrix.clear();
        Ok::<(), std::convert::Infallible>(())
    })?;
    let force = least(repeat, || body.evaluate(&u, &controls, true, true).map(drop))?;
    let energy = least(repeat, || body.evaluate(&u, &controls, false, true).map(drop))?;
    let control_vjp = least(repeat, || body.control_vjp(&u, &controls, &v, true).map(drop))?;
    let threads = common::threads();
    let mut product = vec![0.0; disc.dofs()];
    let direct = least(repeat, || body.tangent_product(&u, &controls, &v, &mut product, true))?;
    let assembled = least(repeat, || {
        matrix.multiply(&v, &mut product);
        Ok::<(), std::convert::Infallible>(())
    })?;
    let instant = Instant::new(&u, &controls, 1.0);
    let products = solid.model().tangents().cell_products(&instant)?;
    let by_cells = match &products {
        None => f64::NAN,
        Some(products) => {
            let mut room = Vec::new();
            least(repeat, || {
                products.of_cells(&v, &mut room, threads > 1);
                let at = |node: usize| products.at_node(node, &room).iter().sum::<f64>();
                std::hint::black_box((0..disc.dofs() / 3).into_par_iter().with_min_len(512).map(at).sum::<f64>());
                Ok::<(), std::convert::Infallible>(())
            })?
        }
    };
    let rest = solid.rest();
    matrix.clear();
    body.evaluate_tangent(&rest.u, &rest.controls, &mut matrix, true)?;
    let products = solid.model().tangents().cell_products(&Instant::of(&rest))?;
    let diagonal = matrix.diagonal().iter().copied().fold(0.0, f64::max);
    matrix.eliminate(solid.supports().fixed(), diagonal);
    let cycle = |products| -> Result<f64, Box<dyn std::error::Error>> {
        let (points, fixed) = (solid.mesh().points(), solid.supports().fixed());
        let geometry = Geometry { points, fixed, corners: disc.corners(), products };
        let levels = Multigrid::new(&matrix, &geometry, threads > 1)?;
        let mut x = v.clone();
        solid.supports().clear(&mut x);
        Ok(least(repeat, || {
            levels.apply(&mut x);
            Ok::<(), std::convert::Infallible>(())
        })?)
    };
    let cycles = [cycle(None)?, cycle(products.as_ref())?];
    let max_step = least(repeat, || body.max_step(&u, &v, true).map(drop))?;
    let cells = solid.mesh().cells();
    println!(
        "{{\"element\": \"{}\", \"cells\": {cells}, \"ndof\": {}, \"threads\": {}, \"tangent_s\": {tangent:.5}, \
         \"of_which_clear_s\": {clear:.5}, \"force_s\": {force:.5}, \"energy_s\": {energy:.5}, \"pull_back_s\": {control_vjp:.5}, \
         \"product_s\": {direct:.5}, \"assembled_product_s\": {assembled:.5}, \"product_by_cells_s\": {by_cells:.5}, \"cycles_s\": {cycles:.5?}, \"max_step_s\": {max_step:.5}, \"tangent_us_per_cell\": {:.2}}}",
        kind.name(),
        disc.dofs(),
        common::threads(),
        tangent * 1e6 / cells as f64,
    );
    Ok(())
}

/// The bar bent into a circular arc of 60 degrees, its sections turned with it.
fn arc(mesh: &Mesh) -> Vec<f64> {
    let bent = |x: &[f64; 3]| {
        let (radius, angle) = (3.0 / std::f64::consts::PI, x[0] * std::f64::consts::PI / 3.0);
        let at = radius - (x[2] - 0.1);
        [at * angle.sin() - x[0], 0.01 * x[0] * x[1], radius - at * angle.cos() - (x[2] - 0.1)]
    };
    mesh.points().iter().flat_map(bent).collect()
}

fn least<E>(repeat: usize, mut work: impl FnMut() -> Result<(), E>) -> Result<f64, E> {
    let mut least = f64::INFINITY;
    for _ in 0..repeat.max(1) {
        let began = std::time::Instant::now();
        work()?;
        least = least.min(began.elapsed().as_secs_f64());
    }
    Ok(least)
}
