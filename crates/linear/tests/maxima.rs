//! Matrices of a potential that has a maximum by some of its unknowns.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use crate::support;

use nalgebra::{DMatrix, DVector};
use nastic_linear::solver::{Configuration, Curvature, Definite, Shift, System};
use nastic_linear::{Corners, Field, LinearError, LinearWork, Rotations, Solver, Space, SparseMatrix};
use std::sync::Arc;
use support::case::{AtRest, Case, STRICT, solution};
use support::{Random, negative_eigenvalues, relative_difference};

/// A grid whose third component at every node, but at a fixed one, is one by which the potential has a maximum.
struct WithMaxima<'a> {
    at: &'a AtRest,
    space: Space,
    maxima: Vec<bool>,
}

impl Configuration for WithMaxima<'_> {
    fn positions(&self) -> &[[f64; 3]] {
        self.at.positions()
    }

    fn rotations(&self) -> &Arc<Rotations> {
        self.at.rotations()
    }

    fn corners(&self) -> Option<&Corners> {
        None
    }

    fn maxima(&self) -> &[bool] {
        &self.maxima
    }

    fn space(&self) -> &Space {
        &self.space
    }
}

/// Of `[A B; B^T -C]` the factor solves and counts what is left of A once the others are eliminated; a shift adds to A alone, and C that has no maximum is told.
#[test]
fn unknowns_of_a_maximum_count_apart() {
    let mut case = Case::new([3, 2, 2]);
    let n = case.pattern.dofs();
    case.fixed[..3].fill(true);
    let is_maximum = |dof: usize| dof % 3 == 2;
    let space = Space::new(n / 3, 12).with(Field::nodal("u", 2)).with(Field::saddle("phi", 1));
    let maxima: Vec<bool> = (0..n).map(|dof| is_maximum(dof) && !case.fixed[dof]).collect();
    let at = WithMaxima { at: &case.at, space, maxima };
    // of a definite matrix the sign of the rows of C
    let make = |shift: f64, sign: f64| {
        let mut matrix = SparseMatrix::zeros(case.pattern.clone());
        let mut random = Random::new(11);
        for nodes in case.grid.cliques() {
            let m = 3 * nodes.len();
            let b = DMatrix::from_fn(m, m, |_, _| random.next());
            let element = &b * b.transpose() + DMatrix::identity(m, m);
            let of = |i: usize, j: usize| {
                let both = is_maximum(i) && is_maximum(j);
                let minus = if i == j && !is_maximum(i) { shift } else { 0.0 };
                element[(i, j)] * if both { sign } else { 1.0 } - minus
            };
            let by_row: Vec<f64> = (0..m * m).map(|at| of(at / m, at % m)).collect();
            matrix.add_element(&case.pattern.scatter_map(nodes).unwrap(), &by_row);
        }
        matrix.eliminate(&case.fixed, 5.0);
        let dense = DMatrix::from_fn(n, n, |i, j| matrix.get(i, j));
        (matrix, dense)
    };
    let count = at.maxima.iter().filter(|is| **is).count();
    let mut b = Random::new(2).vector(n);
    b[..3].fill(0.0);
    let mut seen = Vec::new();
    for shift in [0.0, 8.0, 20.0] {
        let (matrix, dense) = make(shift, -1.0);
        let system = System { configuration: &at, ..case.system(&matrix) };
        let expected = negative_eigenvalues(&dense) - count;
        seen.push(expected);
        let mut own = Solver::DIRECT.make(&case.structure);
        let mut work = LinearWork::default();
        assert_eq!(own.inertia(&system).unwrap().map(|inertia| inertia.negative), Some(expected));
        let solved = own.solve(&system, &b, STRICT, &mut work).unwrap();
        assert_eq!(solved.negative, Some(expected));
        assert!(relative_difference(&solved.x, &solution(&dense, &b)) < 1e-9);
        let step = own.step(&system, &b, 1e-8, &mut work).unwrap();
        assert_eq!(step.curvature == Curvature::Positive, expected == 0);
        assert_eq!(own.solve_definite(&system, &b, Definite::Once, &mut work).is_ok(), expected == 0);
        let x = Shift::default().step(own.as_mut(), &system, &b, &mut work).unwrap();
        let left = DVector::from_column_slice(&b) - &dense * DVector::from_column_slice(&x);
        let shifts: Vec<f64> = (3..n).filter(|dof| !is_maximum(*dof)).map(|dof| left[dof] / x[dof]).collect();
        assert!((3..n).filter(|dof| is_maximum(*dof)).all(|dof| left[dof].abs() < 1e-9), "{left}");
        assert!(shifts.iter().all(|s| *s > 0.0 && (s / shifts[0] - 1.0).abs() < 1e-4), "{shifts:?}");
        let shifted = &dense + DMatrix::from_fn(n, n, |i, j| if i == j && !is_maximum(i) { shifts[0] } else { 0.0 });
        assert_eq!(negative_eigenvalues(&shifted), count);
    }
    assert!(seen[0] == 0 && seen[1] > 0 && seen[2] > seen[1], "{seen:?}");
    let (matrix, _) = make(0.0, 1.0);
    let told = Solver::DIRECT.make(&case.structure).inertia(&System { configuration: &at, ..case.system(&matrix) });
    assert_eq!(told, Err(LinearError::NoMaximum { negative: 0, maxima: count }));
}
