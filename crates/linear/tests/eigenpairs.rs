//! Smallest eigenpairs against a dense solver: definite, indefinite, multiple eigenvalues, fixed unknowns.

#![allow(clippy::unwrap_used)]

mod support;

use nalgebra::{DMatrix, DVector, SymmetricEigen};
use nastic_linear::{Eigenpairs, Eigenproblem, LinearError, SparseMatrix, Symbolic, smallest_eigenpairs};
use nastic_numeric::vector::dot;
use std::sync::Arc;
use support::{Grid, Random};

/// All eigenvalues of the free part of `A x = lambda M x`, ascending.
fn dense_eigenvalues(matrix: &SparseMatrix, mass: &[f64], fixed: &[bool]) -> Vec<f64> {
    let free: Vec<usize> = (0..mass.len()).filter(|&i| !fixed[i]).collect();
    let entry = |i: usize, k: usize| matrix.get(free[i], free[k]) / (mass[free[i]] * mass[free[k]]).sqrt();
    let dense = DMatrix::from_fn(free.len(), free.len(), entry);
    let mut values: Vec<f64> = SymmetricEigen::new(dense).eigenvalues.iter().copied().collect();
    values.sort_by(f64::total_cmp);
    values
}

fn find(matrix: &SparseMatrix, mass: &[f64], fixed: &[bool], count: usize) -> Result<Eigenpairs, LinearError> {
    let symbolic = Arc::new(Symbolic::new(matrix.pattern()).unwrap());
    let problem = Eigenproblem { matrix, mass, fixed, symbolic: &symbolic, parallel: false };
    smallest_eigenpairs(&problem, count)
}

/// Values against the dense ones, residuals, orthogonality.
fn check(matrix: &SparseMatrix, mass: &[f64], fixed: &[bool], count: usize) -> Eigenpairs {
    let found = find(matrix, mass, fixed, count).unwrap();
    let expected = dense_eigenvalues(matrix, mass, fixed);
    let size = expected.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
    let negative = expected.iter().filter(|&&value| value < 0.0).count();
    assert_eq!(found.negative, negative);
    assert_eq!(found.values.len(), count.max(negative));
    for (value, expected) in found.values.iter().zip(&expected) {
        assert!((value - expected).abs() <= 1e-12 * size, "{value:e} instead of {expected:e}");
    }
    for (i, (value, x)) in found.values.iter().zip(&found.vectors).enumerate() {
        let mut residual = DVector::zeros(mass.len());
        matrix.multiply(x, residual.as_mut_slice());
        let mx: Vec<f64> = x.iter().zip(mass).map(|(x, m)| x * m).collect();
        residual -= DVector::from_column_slice(&mx) * *value;
        assert!(residual.norm() <= 1e-8 * size, "pair {i}: residual {:e}", residual.norm());
        for (k, y) in found.vectors.iter().enumerate() {
            let expected = f64::from(u8::from(i == k));
            assert!((dot(y, &mx) - expected).abs() < 1e-8, "{i}, {k}");
        }
        assert!(x.iter().zip(fixed).all(|(x, fixed)| !fixed || *x == 0.0));
    }
    found
}

fn masses(n: usize) -> Vec<f64> {
    let mut random = Random::new(3);
    (0..n).map(|_| 1.5 + random.next()).collect()
}

#[test]
fn definite_and_indefinite_matrices_agree_with_a_dense_solver() {
    let grid = Grid::hexahedra([3, 3, 2], 1);
    let pattern = grid.pattern(3);
    let n = pattern.dofs();
    let fixed: Vec<bool> = (0..n).map(|i| i % 17 == 0).collect();
    for shift in [-3.0, 0.0, 3.0, 10.0] {
        let (mut matrix, _) = grid.random_matrix(&pattern, shift, &mut Random::new(11));
        matrix.eliminate(&fixed, 1.0);
        let found = check(&matrix, &masses(n), &fixed, 5);
        assert_eq!(found.negative > 0, shift > 0.0, "{shift}: {}", found.negative);
    }
}

/// A cube: eigenvalues come in pairs and triples, of which one Krylov space has one vector each.
#[test]
fn every_vector_of_a_multiple_eigenvalue_is_found() {
    let grid = Grid::hexahedra([3, 3, 3], 1);
    let pattern = grid.pattern(1);
    let (mass, fixed) = (vec![1.0; pattern.dofs()], vec![false; pattern.dofs()]);
    for (shift, count) in [(0.5, 7), (-6.0, 2)] {
        let matrix = grid.laplacian(&pattern, shift);
        let found = check(&matrix, &mass, &fixed, count);
        let equal = |pair: &[f64]| (pair[1] - pair[0]).abs() < 1e-9 * pair[1].abs().max(1.0);
        assert!(found.values.windows(2).any(equal), "{:?}", found.values);
    }
}

#[test]
fn all_of_a_small_matrix_can_be_asked_for_and_not_more() {
    let grid = Grid::hexahedra([1, 1, 1], 1);
    let pattern = grid.pattern(2);
    let (matrix, _) = grid.random_matrix(&pattern, 2.0, &mut Random::new(5));
    let (mass, fixed) = (masses(16), vec![false; 16]);
    check(&matrix, &mass, &fixed, 16);
    for count in [0, 17] {
        let refused = find(&matrix, &mass, &fixed, count);
        assert_eq!(refused, Err(LinearError::EigenpairCount { count, unknowns: 16 }));
    }
}

/// What would not fit into memory is refused before anything is allocated.
#[test]
fn a_basis_beyond_all_memory_is_refused() {
    let grid = Grid::hexahedra([40, 40, 12], 1);
    let pattern = grid.pattern(3);
    let (matrix, n) = (grid.laplacian(&pattern, 1.0), pattern.dofs());
    let refused = find(&matrix, &vec![1.0; n], &vec![false; n], n / 2);
    assert!(matches!(refused, Err(LinearError::EigenpairsTooLarge { .. })), "{refused:?}");
}
