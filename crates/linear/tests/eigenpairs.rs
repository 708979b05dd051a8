//! Smallest eigenpairs against a dense solver: definite, indefinite, singular, multiple eigenvalues, fixed unknowns, any mass.

#![allow(clippy::unwrap_used)]

use crate::support;

use nalgebra::{DMatrix, DVector, SymmetricEigen};
use nastic_linear::{
    DefiniteProblem, Eigenpairs, Eigenproblem, FactorError, Graph, Inversion, LinearError, MassMatrix, Ordering,
    Pattern, Pivots, SparseMatrix, Symbolic, leading_eigenpairs, smallest_eigenpairs,
};
use nastic_numeric::vector::dot;
use std::sync::Arc;
use support::case::Case;
use support::{Grid, Random};

fn mass_entry(mass: MassMatrix, row: usize, column: usize) -> f64 {
    match mass {
        MassMatrix::Diagonal(diagonal) if row == column => diagonal[row],
        MassMatrix::Diagonal(_) => 0.0,
        MassMatrix::Sparse(matrix) => matrix.get(row, column),
    }
}

/// All eigenvalues of the free part of `A x = lambda M x`, ascending: those of `L^-1 A L^-T` with `M = L L^T`.
fn dense_eigenvalues(matrix: &SparseMatrix, mass: MassMatrix, fixed: &[bool]) -> Vec<f64> {
    let free: Vec<usize> = (0..fixed.len()).filter(|&i| !fixed[i]).collect();
    let a = DMatrix::from_fn(free.len(), free.len(), |i, k| matrix.get(free[i], free[k]));
    let m = DMatrix::from_fn(free.len(), free.len(), |i, k| mass_entry(mass, free[i], free[k]));
    let inverse = m.cholesky().unwrap().l().try_inverse().unwrap();
    let dense = &inverse * a * inverse.transpose();
    let mut values: Vec<f64> = SymmetricEigen::new(dense).eigenvalues.iter().copied().collect();
    values.sort_by(f64::total_cmp);
    values
}

fn find(matrix: &SparseMatrix, mass: MassMatrix, fixed: &[bool], count: usize) -> Result<Eigenpairs, LinearError> {
    let symbolic = Arc::new(Symbolic::new(matrix.pattern()));
    let inversion = Inversion::Factors { matrix, constraints: &[], symbolic: &symbolic };
    let problem = Eigenproblem { mass, fixed, inversion, zeros: 0, cancel: None, parallel: false };
    smallest_eigenpairs(&problem, count)
}

/// Values against the dense ones, residuals, orthogonality.
fn check(matrix: &SparseMatrix, mass: MassMatrix, fixed: &[bool], count: usize) -> Eigenpairs {
    let found = find(matrix, mass, fixed, count).unwrap();
    let expected = dense_eigenvalues(matrix, mass, fixed);
    let size = expected.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
    let negative = expected.iter().filter(|&&value| value < 0.0).count();
    assert_eq!(found.negative, negative);
    assert_eq!(found.values.len(), count.max(negative));
    check_pairs(matrix, mass, fixed, (&found, &expected, size));
    found
}

fn check_pairs(
    matrix: &SparseMatrix,
    mass: MassMatrix,
    fixed: &[bool],
    (found, expected, size): (&Eigenpairs, &[f64], f64),
) {
    for (value, expected) in found.values.iter().zip(expected) {
        assert!((value - expected).abs() <= 1e-12 * size, "{value:e} instead of {expected:e}");
    }
    let n = fixed.len();
    for (i, (value, x)) in found.values.iter().zip(&found.vectors).enumerate() {
        let mut residual = DVector::zeros(n);
        matrix.multiply(x, residual.as_mut_slice());
        let mut mx = vec![0.0; n];
        match mass {
            MassMatrix::Diagonal(mass) => mx.iter_mut().zip(x).zip(mass).for_each(|((out, x), m)| *out = x * m),
            MassMatrix::Sparse(mass) => mass.multiply(x, &mut mx),
        }
        residual -= DVector::from_column_slice(&mx) * *value;
        assert!(residual.norm() <= 1e-8 * size, "pair {i}: residual {:e}", residual.norm());
        for (k, y) in found.vectors.iter().enumerate() {
            let expected = f64::from(u8::from(i == k));
            assert!((dot(y, &mx) - expected).abs() < 1e-8, "{i}, {k}");
        }
        assert!(x.iter().zip(fixed).all(|(x, fixed)| !fixed || *x == 0.0));
    }
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
        let found = check(&matrix, MassMatrix::Diagonal(&masses(n)), &fixed, 5);
        assert_eq!(found.negative > 0, shift > 0.0, "{shift}: {}", found.negative);
    }
}

#[test]
fn a_mass_may_couple_unknowns() {
    let grid = Grid::hexahedra([3, 3, 2], 1);
    let pattern = grid.pattern(3);
    let fixed: Vec<bool> = (0..pattern.dofs()).map(|i| i % 17 == 0).collect();
    let (mut mass, _) = grid.random_matrix(&pattern, -0.5, &mut Random::new(4));
    mass.eliminate(&fixed, 0.0);
    for shift in [0.0, 3.0] {
        let (mut matrix, _) = grid.random_matrix(&pattern, shift, &mut Random::new(11));
        matrix.eliminate(&fixed, 1.0);
        let found = check(&matrix, MassMatrix::Sparse(&mass), &fixed, 5);
        assert_eq!(found.negative > 0, shift > 0.0, "{shift}: {}", found.negative);
    }
}

/// A diagonal mass is the same in either form.
#[test]
fn a_diagonal_mass_may_be_a_matrix() {
    let grid = Grid::hexahedra([3, 2, 2], 1);
    let pattern = grid.pattern(2);
    let (matrix, _) = grid.random_matrix(&pattern, 1.0, &mut Random::new(2));
    let (diagonal, fixed) = (masses(pattern.dofs()), vec![false; pattern.dofs()]);
    let mut mass = SparseMatrix::zeros(pattern);
    mass.add_diagonal(&diagonal);
    let one = find(&matrix, MassMatrix::Diagonal(&diagonal), &fixed, 4).unwrap();
    assert_eq!(one, find(&matrix, MassMatrix::Sparse(&mass), &fixed, 4).unwrap());
}

/// Chains without supports, of increasing length: whether 0 is above or below 0 is a matter of rounding, which is
/// reported; a triple one, and the next ones are as exact as ever.
#[test]
fn zero_eigenvalues_are_zero_to_their_rounding() {
    for cells in [[1, 1, 1], [4, 1, 1], [20, 1, 1], [60, 1, 1]] {
        let grid = Grid::hexahedra(cells, 1);
        let pattern = grid.pattern(3);
        let matrix = grid.laplacian(&pattern, 0.0);
        let (mass, fixed) = (masses(pattern.dofs()), vec![false; pattern.dofs()]);
        let mass = MassMatrix::Diagonal(&mass);
        let expected = dense_eigenvalues(&matrix, mass, &fixed);
        let size = expected[expected.len() - 1];
        for count in [1, 3, 6] {
            let found = find(&matrix, mass, &fixed, count).unwrap();
            check_pairs(&matrix, mass, &fixed, (&found, &expected, size));
            for (k, (value, rounding)) in found.values.iter().zip(&found.rounding).enumerate() {
                assert_eq!(value.abs() <= *rounding, k < 3, "{cells:?}, {k}: {value:e}, rounding {rounding:e}");
                assert!(*rounding < 1e-13 * size, "{rounding:e}");
                if k >= 3 {
                    assert!((value / expected[k] - 1.0).abs() < 1e-9, "{value:e} instead of {:e}", expected[k]);
                }
            }
        }
    }
}

/// Three unit masses on two unit springs: 0, 1 and 3. All pivots are whole numbers, the last is exactly zero.
#[test]
fn a_matrix_without_a_factor_has_its_zero() {
    let elements: [&[u32]; 2] = [&[0, 1], &[1, 2]];
    let graph = Graph::from_cliques(3, elements).unwrap();
    let ordering = Ordering::given(&graph, &[0, 1, 2]).unwrap();
    let pattern = Arc::new(Pattern::new(&graph, 1, ordering).unwrap());
    let mut matrix = SparseMatrix::zeros(pattern.clone());
    for nodes in elements {
        pattern.scatter(&pattern.scatter_map(nodes).unwrap(), &[1.0, -1.0, -1.0, 1.0], &mut matrix.values);
    }
    let symbolic = Symbolic::new(&pattern);
    let singular = Arc::new(symbolic).factorize(&matrix, Pivots::AnySign, false);
    assert!(matches!(singular, Err(FactorError::Singular { .. })), "{singular:?}");
    let found = find(&matrix, MassMatrix::Diagonal(&[1.0; 3]), &[false; 3], 3).unwrap();
    assert_eq!(found.negative, 0);
    for (value, expected) in found.values.iter().zip([0.0, 1.0, 3.0]) {
        assert!((value - expected).abs() < 1e-14, "{:?}", found.values);
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
        let found = check(&matrix, MassMatrix::Diagonal(&mass), &fixed, count);
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
    check(&matrix, MassMatrix::Diagonal(&mass), &fixed, 16);
    for count in [0, 17] {
        let refused = find(&matrix, MassMatrix::Diagonal(&mass), &fixed, count);
        assert_eq!(refused, Err(LinearError::EigenpairCount { count, unknowns: 16 }));
    }
}

fn find_leading(matrix: &SparseMatrix, masses: &[f64], count: usize) -> Result<Eigenpairs, LinearError> {
    let symbolic = Arc::new(Symbolic::new(matrix.pattern()));
    let factor = symbolic.factorize(matrix, Pivots::Positive, false).unwrap();
    leading_eigenpairs(&DefiniteProblem { matrix, factor: &factor, masses, parallel: false }, count)
}

/// Blocks of a Krylov space give the pairs of a dense solver: of a random matrix, of a cube with its pairs and triples, all of a small one.
#[test]
fn leading_pairs_are_those_of_a_dense_solver() {
    let cube = Grid::hexahedra([5, 5, 5], 1);
    let pattern = cube.pattern(1);
    let cube = (cube.laplacian(&pattern, 1e-3), vec![1.0; pattern.dofs()]);
    let bar = Grid::hexahedra([9, 4, 3], 1);
    let pattern = bar.pattern(3);
    let bar = (bar.random_matrix(&pattern, -3.0, &mut Random::new(7)).0, masses(pattern.dofs()));
    let whole = Grid::hexahedra([7, 7, 7], 1);
    let pattern = whole.pattern(1);
    let whole = (whole.laplacian(&pattern, 1.0), vec![1.0; pattern.dofs()]);
    let small = Grid::hexahedra([1, 1, 1], 1);
    let pattern = small.pattern(1);
    let small = (small.laplacian(&pattern, 1.0), masses(pattern.dofs()));
    for ((matrix, masses), counts) in
        [(cube, [1, 7, 40]), (bar, [3, 17, 60]), (whole, [250, 400, 511]), (small, [1, 3, 8])]
    {
        let fixed = vec![false; masses.len()];
        let mass = MassMatrix::Diagonal(&masses);
        let expected = dense_eigenvalues(&matrix, mass, &fixed);
        for count in counts {
            let found = find_leading(&matrix, &masses, count).unwrap();
            assert!(found.counted && found.values.len() == count && found.vectors.len() == count);
            check_pairs(&matrix, mass, &fixed, (&found, &expected, expected[expected.len() - 1]));
        }
        let n = masses.len();
        let refused = find_leading(&matrix, &masses, n + 1);
        assert_eq!(refused, Err(LinearError::EigenpairCount { count: n + 1, unknowns: n }));
    }
}

/// Three eigenvalues, each there more than twenty times, more often than a block has vectors: pivots show what is missing.
#[test]
fn eigenvalues_of_more_vectors_than_a_block_are_all_found() {
    let grid = Grid::hexahedra([3, 3, 3], 1);
    let pattern = grid.pattern(1);
    let mut matrix = SparseMatrix::zeros(pattern.clone());
    let values: Vec<f64> = (0..pattern.dofs()).map(|i| 1.0 + (i % 3) as f64).collect();
    matrix.add_diagonal(&values);
    let found = find_leading(&matrix, &vec![1.0; pattern.dofs()], 30).unwrap();
    let low = values.iter().filter(|value| **value == 1.0).count();
    assert!(low > 16 && low < 30);
    let expected = (0..30).map(|k| if k < low { 1.0 } else { 2.0 });
    assert!(
        found.values.iter().zip(expected).all(|(value, expected)| (value - expected).abs() < 1e-12),
        "{:?}",
        found.values
    );
}

/// What would not fit into memory is refused before anything is allocated.
#[test]
fn a_basis_beyond_all_memory_is_refused() {
    let grid = Grid::hexahedra([40, 40, 12], 1);
    let pattern = grid.pattern(3);
    let (matrix, n) = (grid.laplacian(&pattern, 1.0), pattern.dofs());
    let refused = find(&matrix, MassMatrix::Diagonal(&vec![1.0; n]), &vec![false; n], n / 2);
    assert!(matches!(refused, Err(LinearError::EigenpairsTooLarge { .. })), "{refused:?}");
}

fn find_by_products(
    case: &Case,
    matrix: &SparseMatrix,
    mass: MassMatrix,
    count: usize,
) -> Result<Eigenpairs, LinearError> {
    let system = case.system(matrix);
    let inversion = Inversion::Cycles { product: &system, system };
    let problem =
        Eigenproblem { mass, fixed: system.fixed, inversion, zeros: 0, cancel: None, parallel: system.parallel };
    smallest_eigenpairs(&problem, count)
}

/// Semi-definite, definite and indefinite ones, by masses that differ by a factor of five or couple unknowns.
#[test]
fn pairs_by_products_are_those_of_a_dense_solver() {
    let mut case = Case::new([9, 2, 2]);
    let n = case.pattern.dofs();
    case.fixed = (0..n).map(|i| i % 19 == 0).collect();
    let diagonal = masses(n);
    let mut coupled = case.grid.laplacian(&case.pattern, 30.0);
    coupled.eliminate(&case.fixed, 0.0);
    for shift in [0.0, 0.5, -0.7, -4.0] {
        let mut matrix = case.grid.laplacian(&case.pattern, shift);
        matrix.eliminate(&case.fixed, 1.0);
        for mass in [MassMatrix::Diagonal(&diagonal), MassMatrix::Sparse(&coupled)] {
            let found = find_by_products(&case, &matrix, mass, 4).unwrap();
            let expected = dense_eigenvalues(&matrix, mass, &case.fixed);
            let negative = expected.iter().filter(|&&value| value < 0.0).count();
            assert_eq!((found.negative, found.values.len()), (negative, negative.max(4)), "{shift}");
            let how = found.by_products.as_ref().unwrap();
            assert!(!found.counted && how.iterations > 0 && how.errors.len() == found.values.len());
            assert!(how.errors.iter().all(|error| *error <= 1e-7), "{shift}: {:?}", how.errors);
            let size = expected.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
            for (value, expected) in found.values.iter().zip(&expected) {
                assert!((value - expected).abs() <= 1e-11 * size, "{shift}: {value:e} instead of {expected:e}");
            }
            let norms = found.vectors.iter().zip(&found.rounding);
            assert!(norms.clone().all(|(x, rounding)| x.iter().all(|x| x.is_finite()) && *rounding < 1e-11 * size));
        }
    }
}

#[test]
fn what_products_do_not_find_is_a_typed_error() {
    let case = Case::new([2, 2, 2]);
    let mut matrix = case.grid.laplacian(&case.pattern, 1.0);
    let n = case.pattern.dofs();
    let mass = masses(n);
    let found = |matrix: &SparseMatrix, count| find_by_products(&case, matrix, MassMatrix::Diagonal(&mass), count);
    assert!(matches!(found(&matrix, 0), Err(LinearError::EigenpairCount { count: 0, .. })));
    assert!(matches!(found(&matrix, n + 1), Err(LinearError::EigenpairCount { .. })));
    assert_eq!(found(&matrix, n).unwrap().values.len(), n);
    matrix.values[0] = f64::NAN;
    assert!(found(&matrix, 2).is_err());
}
