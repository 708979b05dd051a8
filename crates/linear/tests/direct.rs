//! Factorisations against dense algebra.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use crate::support;

use nalgebra::DVector;
use nastic_linear::{FactorError, Graph, Ordering, Pattern, Pivots, Precision, SparseMatrix, Symbolic, refine};
use std::sync::Arc;
use support::{Grid, Random, negative_eigenvalues, relative_difference};

fn analysed(pattern: &Arc<Pattern>) -> Arc<Symbolic> {
    Arc::new(Symbolic::new(pattern))
}

#[test]
fn solutions_and_inertia_agree_with_dense_algebra() {
    let mut random = Random::new(3);
    let mut indefinite = 0;
    for grid in [Grid::hexahedra([4, 3, 2], 1), Grid::tetrahedra([2, 1, 1])] {
        for dim in 1..=4 {
            for ordering in grid.orderings() {
                let pattern = Arc::new(Pattern::new(&grid.graph(), dim, ordering).unwrap());
                let symbolic = analysed(&pattern);
                for shift in [0.0, 0.8, 1.5, 3.0, 50.0] {
                    let (matrix, dense) = grid.random_matrix(&pattern, shift, &mut random);
                    let x = random.vector(pattern.dofs());
                    let b = &dense * DVector::from_column_slice(&x);
                    let negative = negative_eigenvalues(&dense);
                    indefinite += usize::from(negative > 0 && negative < pattern.dofs());
                    let mut solution = b.as_slice().to_vec();
                    let factor = symbolic.factorize(&matrix, Pivots::AnySign, false).unwrap();
                    factor.solve(&mut solution, 1);
                    assert!(relative_difference(&solution, &x) < 1e-9);
                    assert_eq!(factor.negative_pivots(), negative);
                    match symbolic.factorize(&matrix, Pivots::Positive, false) {
                        Ok(factor) => {
                            assert_eq!(negative, 0);
                            let mut solution = b.as_slice().to_vec();
                            factor.solve(&mut solution, 1);
                            assert!(relative_difference(&solution, &x) < 1e-11);
                            assert_eq!((factor.negative_pivots(), factor.pivots()), (0, Pivots::Positive));
                        }
                        Err(FactorError::NotPositive { node, component }) => {
                            assert!(negative > 0 && node < grid.points.len() && component < dim);
                        }
                        Err(other) => panic!("{other}"),
                    }
                }
            }
        }
    }
    assert!(indefinite > 30, "the cases are not all definite: {indefinite}");
}

/// A symmetric matrix on two-dof nodes in a chain whose diagonal is zero: every pivot of one is zero, blocks of two
/// work.
#[test]
fn zero_diagonals_are_pivoted() {
    let elements: Vec<[u32; 2]> = (0..6).map(|k| [k, k + 1]).collect();
    let graph = Graph::from_cliques(7, elements.iter().map(|e| &e[..])).unwrap();
    let pattern = Arc::new(Pattern::new(&graph, 2, Ordering::multilevel(&graph)).unwrap());
    let mut matrix = SparseMatrix::zeros(pattern.clone());
    let mut dense = nalgebra::DMatrix::zeros(14, 14);
    let mut set = |i: usize, j: usize, value: f64| {
        for (i, j) in [(i, j), (j, i)] {
            matrix.values[pattern.value_index(i, j).unwrap()] = value;
            dense[(i, j)] = value;
        }
    };
    for node in 0..7 {
        set(2 * node, 2 * node + 1, 1.0 + 0.1 * node as f64);
        if node > 0 {
            set(2 * node, 2 * node - 1, 0.3);
            set(2 * node + 1, 2 * node - 2, -0.2);
        }
    }
    let symbolic = analysed(&pattern);
    let factor = symbolic.factorize(&matrix, Pivots::AnySign, false).unwrap();
    assert_eq!(factor.negative_pivots(), negative_eigenvalues(&dense));
    let x = Random::new(5).vector(14);
    let mut solution = (&dense * DVector::from_column_slice(&x)).as_slice().to_vec();
    factor.solve(&mut solution, 1);
    assert!(relative_difference(&solution, &x) < 1e-12);
    assert!(matches!(symbolic.factorize(&matrix, Pivots::Positive, false), Err(FactorError::NotPositive { .. })));
}

#[test]
fn the_node_that_loses_definiteness_is_named_in_mesh_numbering() {
    let grid = Grid::hexahedra([3, 3, 3], 1);
    let pattern = grid.pattern(3);
    let symbolic = analysed(&pattern);
    for node in [0, 21, 63] {
        let mut matrix = grid.laplacian(&pattern, 1.0);
        let at = pattern.value_index(3 * node + 1, 3 * node + 1).unwrap();
        matrix.values[at] = -1e6;
        let refused = symbolic.factorize(&matrix, Pivots::Positive, false).unwrap_err();
        assert_eq!(refused, FactorError::NotPositive { node, component: 1 });
        assert_eq!(symbolic.factorize(&matrix, Pivots::AnySign, false).unwrap().negative_pivots(), 1);
    }
}

#[test]
fn useless_numbers_are_refused() {
    let grid = Grid::hexahedra([2, 2, 2], 1);
    let pattern = grid.pattern(3);
    let symbolic = analysed(&pattern);
    for pivots in [Pivots::Positive, Pivots::AnySign] {
        let mut matrix = grid.laplacian(&pattern, 1.0);
        matrix.values[pattern.value_index(3 * 4 + 2, 3 * 7).unwrap()] = f64::NAN;
        let refused = symbolic.factorize(&matrix, pivots, false).unwrap_err();
        assert!(matches!(refused, FactorError::NotFinite { .. }), "{refused}");

        // A node that nothing holds: an empty row.
        let mut matrix = grid.laplacian(&pattern, 1.0);
        let held: Vec<bool> = (0..pattern.dofs()).map(|dof| dof == 3 * 13 + 2).collect();
        matrix.eliminate(&held, 0.0);
        let refused = symbolic.factorize(&matrix, pivots, false).unwrap_err();
        let expected = match pivots {
            Pivots::Positive => FactorError::NotPositive { node: 13, component: 2 },
            Pivots::AnySign => FactorError::Singular { node: 13, component: 2 },
        };
        assert_eq!(refused, expected);
    }
    let other = grid.pattern(3);
    let foreign = symbolic.factorize(&grid.laplacian(&other, 1.0), Pivots::Positive, false).unwrap_err();
    assert_eq!(foreign, FactorError::ForeignPattern);
}

/// A body that floats is singular, but round-off hides it from the pivots: the residual shows.
#[test]
fn a_singular_matrix_shows_in_the_pivots_or_in_the_residual() {
    let mut random = Random::new(11);
    for cells in [[2, 2, 2], [3, 2, 2], [4, 3, 2], [5, 5, 1]] {
        let grid = Grid::hexahedra(cells, 1);
        let pattern = grid.pattern(3);
        let matrix = grid.laplacian(&pattern, 0.0);
        for pivots in [Pivots::Positive, Pivots::AnySign] {
            let Ok(factor) = analysed(&pattern).factorize(&matrix, pivots, false) else { continue };
            let b = random.vector(pattern.dofs());
            let mut x = b.clone();
            factor.solve(&mut x, 1);
            let report = refine(&|v, out| matrix.multiply(v, out), &factor, &b, &mut x, 1e-8, 10);
            assert!(!report.converged() && report.residual > 1e-6, "{report:?}");
        }
    }
}

#[test]
fn many_right_hand_sides_are_solved_like_one() {
    let mut random = Random::new(13);
    let grid = Grid::hexahedra([5, 4, 3], 1);
    let pattern = grid.pattern(3);
    let (matrix, _) = grid.random_matrix(&pattern, 1.0, &mut random);
    let n = pattern.dofs();
    for pivots in [Pivots::Positive, Pivots::AnySign] {
        let matrix = if pivots == Pivots::Positive { &grid.laplacian(&pattern, 0.1) } else { &matrix };
        let factor = analysed(&pattern).factorize(matrix, pivots, false).unwrap();
        let b = random.vector(17 * n);
        let mut together = b.clone();
        factor.solve(&mut together, 17);
        for (column, together) in b.chunks(n).zip(together.chunks(n)) {
            let mut alone = column.to_vec();
            factor.solve(&mut alone, 1);
            assert!(relative_difference(together, &alone) < 1e-11);
        }
        factor.solve(&mut [], 0);
    }
}

/// Large enough that fronts are cut into tiles and the tree into tasks.
#[test]
fn one_thread_and_many_give_the_same_bits() {
    let grid = Grid::hexahedra([13, 12, 11], 1);
    let pattern = grid.pattern(3);
    let symbolic = analysed(&pattern);
    let pools = [2, 3].map(|threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap());
    let b = Random::new(17).vector(2 * pattern.dofs());
    for (pivots, shift) in [(Pivots::Positive, 0.01), (Pivots::AnySign, -2.0)] {
        let matrix = grid.laplacian(&pattern, shift);
        let alone = symbolic.factorize(&matrix, pivots, false).unwrap();
        let mut expected = b.clone();
        alone.solve(&mut expected, 2);
        let mut product = vec![0.0; pattern.dofs()];
        matrix.multiply(&expected[..pattern.dofs()], &mut product);
        assert!(relative_difference(&product, &b[..pattern.dofs()]) < 1e-9);
        assert_eq!(alone.negative_pivots() > 0, pivots == Pivots::AnySign);
        for pool in &pools {
            for _ in 0..2 {
                let together = pool.install(|| symbolic.factorize(&matrix, pivots, true).unwrap());
                let mut solution = b.clone();
                pool.install(|| together.solve(&mut solution, 2));
                assert!(solution.iter().zip(&expected).all(|(a, b)| a.to_bits() == b.to_bits()));
                assert_eq!(together.negative_pivots(), alone.negative_pivots());
            }
        }
    }
}

/// With several bad pivots in different branches, which one is named must not depend on who finds it first.
#[test]
fn the_same_pivot_is_blamed_for_any_number_of_threads() {
    let grid = Grid::hexahedra([10, 10, 10], 1);
    let pattern = grid.pattern(3);
    let symbolic = analysed(&pattern);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().unwrap();
    let mut matrix = grid.laplacian(&pattern, 0.1);
    for node in (0..grid.points.len()).step_by(50) {
        matrix.values[pattern.value_index(3 * node, 3 * node).unwrap()] = -1e3;
    }
    let alone = symbolic.factorize(&matrix, Pivots::Positive, false).unwrap_err();
    for _ in 0..5 {
        assert_eq!(pool.install(|| symbolic.factorize(&matrix, Pivots::Positive, true)).unwrap_err(), alone);
    }
}

#[test]
fn memory_is_reused_and_failures_leave_no_factor() {
    let grid = Grid::hexahedra([6, 5, 4], 1);
    let pattern = grid.pattern(3);
    let symbolic = analysed(&pattern);
    let [good, better, bad] = [0.5, 2.0, -2.0].map(|shift| grid.laplacian(&pattern, shift));
    let solved = |factor: &nastic_linear::Factor| {
        let mut x = vec![1.0; pattern.dofs()];
        factor.solve(&mut x, 1);
        x
    };
    let mut factor = symbolic.factorize(&good, Pivots::Positive, false).unwrap();
    let workspace = symbolic.workspace_bytes();
    assert!(workspace > 0);
    let predicted = symbolic.factorisation_bytes(Precision::Double) - symbolic.factor_bytes();
    assert!((0.5..2.0).contains(&(workspace as f64 / predicted as f64)), "{workspace} bytes, {predicted} predicted");
    assert_eq!(2 * symbolic.factorisation_bytes(Precision::Single), symbolic.factorisation_bytes(Precision::Double));
    assert!(factor.refactorize(&bad, Pivots::Positive, false).is_err());
    assert!(!factor.is_usable() && solved(&factor).iter().all(|x| x.is_nan()));
    factor.refactorize(&bad, Pivots::AnySign, false).unwrap();
    assert!(factor.negative_pivots() > 0);
    factor.refactorize(&better, Pivots::Positive, false).unwrap();
    assert!(factor.is_usable());
    let fresh = symbolic.factorize(&better, Pivots::Positive, false).unwrap();
    assert_eq!(solved(&factor), solved(&fresh));
    let mut kept = Vec::new();
    for _ in 0..20 {
        factor.refactorize(&better, Pivots::Positive, false).unwrap();
        kept.push(symbolic.workspace_bytes());
    }
    assert!(kept[19] == kept[9] && kept[19] < 3 * workspace / 2, "the workspace does not grow for ever: {kept:?}");
    symbolic.release_workspace();
    assert_eq!(symbolic.workspace_bytes(), 0);
    factor.refactorize(&good, Pivots::Positive, false).unwrap();
    assert_eq!(solved(&factor), solved(&symbolic.factorize(&good, Pivots::Positive, false).unwrap()));
}

#[test]
fn odd_graphs_are_solved_too() {
    let none: [&[u32]; 0] = [];
    let clique: Vec<u32> = (0..300).collect();
    let chain: Vec<[u32; 2]> = (0..2000).map(|k| [k, k + 1]).collect();
    let star: Vec<[u32; 2]> = (1..500).map(|k| [0, k]).collect();
    let cases: Vec<(usize, Vec<&[u32]>)> = vec![
        (0, none.to_vec()),
        (1, none.to_vec()),
        (7, none.to_vec()),
        (300, vec![&clique]),
        (2001, chain.iter().map(|e| &e[..]).collect()),
        (500, star.iter().map(|e| &e[..]).collect()),
        (40, vec![&[0, 1, 2], &[30, 31, 2], &[8, 9]]),
    ];
    for (nodes, elements) in cases {
        // All nodes in one place: geometry is of no help.
        let points = vec![[1.0; 3]; nodes];
        let grid = Grid { points, elements: elements.iter().map(|e| e.to_vec()).collect() };
        for dim in [1, 2, 3] {
            let pattern = grid.pattern(dim);
            let matrix = grid.laplacian(&pattern, 1.0);
            let symbolic = analysed(&pattern);
            for pivots in [Pivots::Positive, Pivots::AnySign] {
                let factor = symbolic.factorize(&matrix, pivots, false).unwrap();
                let x = Random::new(19).vector(pattern.dofs());
                let mut y = vec![0.0; pattern.dofs()];
                matrix.multiply(&x, &mut y);
                factor.solve(&mut y, 1);
                assert!(nodes == 0 || relative_difference(&y, &x) < 1e-10);
                assert_eq!(factor.negative_pivots(), 0);
            }
        }
    }
}
