//! Products of cells in the place of entries: of which matrices a solver asks for them.

#![allow(clippy::unwrap_used)] // a helper of tests

use crate::support;

use nastic_linear::solver::{Configuration, Shift, System};
use nastic_linear::{CellProducts, Corners, LinearWork, Rotations, Solver};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use support::Random;
use support::case::Case;

/// A body that has no products, and counts how often it was asked for them.
struct Asked<'a> {
    case: &'a Case,
    times: AtomicUsize,
}

impl Configuration for Asked<'_> {
    fn positions(&self) -> &[[f64; 3]] {
        self.case.at.positions()
    }

    fn rotations(&self) -> &Arc<Rotations> {
        self.case.at.rotations()
    }

    fn corners(&self) -> Option<&Corners> {
        None
    }

    fn products(&self) -> Option<Arc<dyn CellProducts>> {
        self.times.fetch_add(1, Ordering::Relaxed);
        None
    }
}

/// Those of the matrix itself, never those of a shifted one, which are others.
#[test]
fn a_shifted_matrix_has_no_products() {
    let case = Case::new([4, 3, 3]);
    let matrix = case.grid.laplacian(&case.pattern, 0.4);
    let asked = Asked { case: &case, times: AtomicUsize::new(0) };
    let system =
        System { matrix: &matrix, fixed: &case.fixed, configuration: &asked, has_products: true, parallel: false };
    let b = Random::new(5).vector(case.pattern.dofs());
    let mut work = LinearWork::default();
    let mut solver = Solver::MULTIGRID.make(&case.structure);
    solver.step(&system, &b, 1e-2, &mut work).unwrap();
    assert_eq!(asked.times.load(Ordering::Relaxed), 1);
    Shift::default().step(solver.as_mut(), &system, &b, &mut work).unwrap();
    assert_eq!((asked.times.load(Ordering::Relaxed), work.hierarchies > 1), (1, true));
    let unknown = System { has_products: false, ..system };
    Solver::MULTIGRID.make(&case.structure).step(&unknown, &b, 1e-2, &mut work).unwrap();
    assert_eq!(asked.times.load(Ordering::Relaxed), 1);
}
