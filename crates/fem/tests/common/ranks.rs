//! A linear solver that spans ranks, of the simplest kind: conjugate gradients with the diagonal.

use nastic_fem::SolverFactory;
use nastic_linear::solver::{Accuracy, Curvature, Definite, Solution, SolverState, Step, System};
use nastic_linear::{LinearError, LinearSolver, LinearWork, Structure, Symmetry};
use std::sync::Arc;

#[derive(Clone, Debug)]
pub struct Simple;

impl SolverFactory for Simple {
    fn name(&self) -> &'static str {
        "simple"
    }

    fn about(&self) -> &'static str {
        "conjugate gradients with the diagonal"
    }

    fn takes(&self) -> Symmetry {
        Symmetry::Symmetric
    }

    fn spans_ranks(&self) -> bool {
        true
    }

    fn make(&self, _: &Arc<Structure>) -> Box<dyn LinearSolver> {
        Box::new(Simple)
    }
}

/// Iterations, far beyond what any of these bodies takes.
const MOST: usize = 20_000;

/// The solution; `None` where the curvature is not positive, sums are no numbers, or nothing comes of it.
fn solve(system: &System, b: &[f64], tolerance: f64) -> Option<Vec<f64>> {
    let space = system.space();
    let mut diagonal = system.matrix.diagonal();
    space.add_up(&mut diagonal);
    let scaled = |r: &[f64]| -> Vec<f64> { r.iter().zip(&diagonal).map(|(r, d)| r / d).collect() };
    let (mut x, mut r) = (vec![0.0; b.len()], b.to_vec());
    let mut p = scaled(&r);
    let (mut rz, aim) = (space.dot(&r, &p), tolerance * space.norm(b));
    let mut product = vec![0.0; b.len()];
    for _ in 0..MOST {
        if space.norm(&r) <= aim {
            return Some(x);
        }
        system.multiply(&p, &mut product);
        let curvature = space.dot(&p, &product);
        if curvature.is_nan() || curvature <= 0.0 {
            return None;
        }
        let length = rz / curvature;
        x.iter_mut().zip(&p).for_each(|(x, p)| *x += length * p);
        r.iter_mut().zip(&product).for_each(|(r, q)| *r -= length * q);
        let z = scaled(&r);
        let before = std::mem::replace(&mut rz, space.dot(&r, &z));
        p = z.iter().zip(&p).map(|(z, p)| z + rz / before * p).collect();
    }
    None
}

impl LinearSolver for Simple {
    fn state(&self) -> SolverState {
        SolverState { name: "simple", takes_products: false, bytes: 0 }
    }

    fn restart(&mut self) {}

    fn clear(&mut self) {}

    fn prepare(&mut self, _: &System, _: &mut LinearWork) -> Result<(), LinearError> {
        Ok(())
    }

    fn step(&mut self, system: &System, b: &[f64], tolerance: f64, _: &mut LinearWork) -> Result<Step, LinearError> {
        let x = solve(system, b, tolerance).ok_or(LinearError::Indefinite { quotient: None })?;
        Ok(Step::new(x, Curvature::Positive))
    }

    fn solve(&mut self, system: &System, b: &[f64], _: Accuracy, _: &mut LinearWork) -> Result<Solution, LinearError> {
        let x = solve(system, b, 1e-12).ok_or(LinearError::Indefinite { quotient: None })?;
        Ok(Solution { x, negative: None })
    }

    fn solve_definite(
        &mut self,
        system: &System,
        b: &[f64],
        _: Definite,
        _: &mut LinearWork,
    ) -> Result<Vec<f64>, LinearError> {
        solve(system, b, 1e-13).ok_or(LinearError::Indefinite { quotient: None })
    }

    fn anew(&self, _: &Arc<Structure>) -> Box<dyn LinearSolver> {
        Box::new(Simple)
    }
}
