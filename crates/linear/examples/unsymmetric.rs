//! Time and memory of the solvers for matrices that are not symmetric, on a block of hexahedra.
//!
//! `cargo run --release -p nastic-linear --example unsymmetric -- lu 0.4 30 30 32`: solver, size of the skew part, cells.
//! Every solver in a process of its own, since the peak of the memory is that of the process.

#![allow(clippy::print_stdout)] // programs talk, libraries do not

use nastic_linear::solver::{Accuracy, Configuration, System};
use nastic_linear::{Corners, LinearWork, Pattern, Rotations, Solver, SparseMatrix, Structure, Symmetry, memory};
use nastic_numeric::Random;
use nastic_tensor::Mat3;
use std::sync::Arc;
use std::time::Instant;

struct AtRest(Vec<[f64; 3]>, Arc<Rotations>);

impl Configuration for AtRest {
    fn positions(&self) -> &[[f64; 3]] {
        &self.0
    }

    fn rotations(&self) -> &Arc<Rotations> {
        &self.1
    }

    fn corners(&self) -> Option<&Corners> {
        None
    }
}

/// Nodes and hexahedra of a grid.
fn grid(cells: [usize; 3]) -> (Vec<[f64; 3]>, Vec<Vec<u32>>) {
    let each =
        |n: [usize; 3]| (0..n[2]).flat_map(move |k| (0..n[1]).flat_map(move |j| (0..n[0]).map(move |i| [i, j, k])));
    let nodes = cells.map(|n| n + 1);
    let id = |at: [usize; 3]| (at[0] + nodes[0] * (at[1] + nodes[1] * at[2])) as u32;
    let corners = |cell: [usize; 3]| each([2; 3]).map(|at| id([0, 1, 2].map(|k| cell[k] + at[k]))).collect();
    (each(nodes).map(|at| at.map(|x| x as f64)).collect(), each(cells).map(corners).collect())
}

/// A vector Laplacian with a skew part of a relative size in every element.
fn matrix(pattern: &Arc<Pattern>, elements: &[Vec<u32>], skew: f64) -> Result<SparseMatrix, nastic_linear::NotCoupled> {
    let mut matrix = SparseMatrix::with_symmetry(pattern.clone(), Symmetry::General);
    let mut random = Random::new(3);
    for nodes in elements {
        let noise: Vec<f64> = (0..24 * 24).map(|_| random.symmetric()).collect();
        let entry = |i: usize, j: usize| {
            let laplacian = if i / 3 == j / 3 { 7.0 } else { -1.0 } * if i % 3 == j % 3 { 1.0 } else { 0.3 };
            laplacian + if i == j { 0.01 } else { 0.0 } + skew * (noise[24 * i + j] - noise[24 * j + i])
        };
        matrix.add_pairs(nodes, &(0..24 * 24).map(|at| entry(at / 24, at % 24)).collect::<Vec<_>>())?;
    }
    Ok(matrix)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [name, skew, cells @ ..] = &arguments[..] else {
        return Err("solver, skew part, three numbers of cells".into());
    };
    let factory = Solver::named(name).ok_or("the solver is direct, multigrid, general or lu")?;
    let cells: Vec<usize> = cells.iter().map(|n| n.parse()).collect::<Result<_, _>>()?;
    let (points, elements) = grid(cells.try_into().map_err(|_| "three numbers of cells")?);
    let pattern = Arc::new(Pattern::of_elements(&points, 3, elements.iter().map(Vec::as_slice))?);
    let (structure, n) = (Structure::new(pattern.clone()), pattern.dofs());
    let matrix = matrix(&pattern, &elements, skew.parse()?)?;
    let rotations = Arc::new(Rotations(vec![Mat3::identity(); points.len()]));
    let (at, fixed) = (AtRest(points, rotations), vec![false; n]);
    let system = System {
        matrix: &matrix,
        products: None,
        fixed: &fixed,
        configuration: &at,
        transposed: false,
        parallel: true,
    };
    let mut random = Random::new(1);
    let b: Vec<f64> = (0..n).map(|_| random.symmetric()).collect();
    let megabytes = |bytes: Option<usize>| bytes.map_or(f64::NAN, |bytes| bytes as f64 * 1e-6);
    println!("{name}, skew part {skew}, {n} unknowns; {:.0} MB before", megabytes(memory::peak()));
    let (mut solver, accuracy) = (factory.make(&structure), Accuracy { error: 1e-9, residual: 1e-10 });
    for what in ["first", "second", "transposed"] {
        let (mut work, began) = (LinearWork::default(), Instant::now());
        let system = System { transposed: what == "transposed", ..system };
        let solved = solver.solve(&system, &b, accuracy, &mut work);
        let seconds = began.elapsed().as_secs_f64();
        let outcome = solved.map_or_else(|error| error.to_string(), |_| format!("by {}", solver.state().name));
        println!(
            "  {what}: {seconds:.2} s, {} factorisations, {} iterations; peak {:.0} MB, {outcome}",
            work.factorisations,
            work.back_substitutions,
            megabytes(memory::peak())
        );
    }
    Ok(())
}
