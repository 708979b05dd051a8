//! Blocks beyond the pattern of a matrix: in all that it says of itself, and joined to it by every solver.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use crate::support;

use nalgebra::{DMatrix, DVector};
use nastic_linear::solver::Joining;
use nastic_linear::{FactorError, LinearSolver, LinearWork, Pivots, Solver, SparseMatrix, Structure, Symmetry};
use std::sync::Arc;
use support::case::{Case, STRICT, solution};
use support::{Random, relative_difference};

/// A spring between two nodes, in every component.
fn spring(stiffness: f64) -> Vec<f64> {
    let entry = |i: usize, j: usize| if i == j { stiffness } else { -stiffness };
    (0..36).map(|at| if at / 6 % 3 == at % 3 { entry(at / 18, at % 6 / 3) } else { 0.0 }).collect()
}

fn dense_of(matrix: &SparseMatrix) -> DMatrix<f64> {
    let n = matrix.pattern().dofs();
    DMatrix::from_fn(n, n, |i, j| matrix.get(i, j))
}

/// Every solver joins blocks beyond the pattern to it: solutions, transposed ones, inertia and steps are those of the whole matrix,
/// also where other pairs come with the next matrix, and where none are left.
#[test]
fn blocks_beyond_the_pattern_are_solved_with() {
    let mut case = Case::new([5, 4, 4]);
    let (n, last) = (case.pattern.dofs(), case.grid.points.len() as u32 - 1);
    case.fixed[..3].fill(true);
    let mut b = Random::new(2).vector(n);
    b[..3].fill(0.0);
    assert!(case.pattern.scatter_map(&[7, last]).is_err(), "the pattern has the pair");
    // a spring at a fixed node among them
    let sets: [&[[u32; 2]]; 4] = [&[[7, last], [0, last]], &[[7, last]], &[[last, 11], [20, last - 3]], &[]];
    for factory in Solver::CATALOGUE {
        let structure = Structure::new(case.pattern.clone());
        let (mut own, mut work) = (Joining::new(&structure, factory.make(&structure)), LinearWork::default());
        for (stiffness, pairs) in [5.0, -8.0].into_iter().flat_map(|s| sets.map(|pairs| (s, pairs))) {
            let what = format!("{factory}, {stiffness}, {pairs:?}");
            let mut matrix = case.grid.laplacian(&case.pattern, 0.4);
            pairs.iter().for_each(|pair| matrix.add_beyond(pair, spring(stiffness)));
            matrix.eliminate(&case.fixed, 2.0);
            let dense = dense_of(&matrix);
            let negative = support::negative_eigenvalues(&dense);
            assert_eq!(negative > 0, stiffness < 0.0 && !pairs.is_empty(), "{what}");
            let system = case.system(&matrix);
            let x = own.solve(&system, &b, STRICT, &mut work).unwrap_or_else(|e| panic!("{what}: {e}")).x;
            assert!(relative_difference(&x, &solution(&dense, &b)) < 1e-8, "{what}");
            let x = own.solve(&system.transpose(), &b, STRICT, &mut work).unwrap_or_else(|e| panic!("{what}: {e}")).x;
            assert!(relative_difference(&x, &solution(&dense.transpose(), &b)) < 1e-8, "{what}, transposed");
            if let Some(found) = own.inertia(&system).unwrap_or_else(|e| panic!("{what}: {e}")) {
                assert_eq!(found.negative, negative, "{what}");
            } else {
                assert_eq!(factory.name(), "lu", "{what}: not counted");
            }
            if negative == 0 {
                let step = own.step(&system, &b, 1e-6, &mut work).unwrap();
                assert!(relative_difference(&step.x, &solution(&dense, &b)) < 1e-3, "{what}");
            }
        }
        // one for each set of pairs, and the first one: what was known serves again
        assert!(structure.analyses() <= 3, "{factory}: {}", structure.analyses());
        let lone = case.grid.laplacian(&case.pattern, 0.4);
        let mut far = lone.clone();
        far.add_beyond(&[7, last], spring(1.0));
        let refused = case.symbolic.factorize(&far, Pivots::Positive, false);
        assert!(matches!(refused, Err(FactorError::Beyond { blocks: 1 })), "{refused:?}");
    }
}

/// A node that is named twice has both parts, in products and in the matrix that is factorised.
#[test]
fn a_node_may_be_named_twice() {
    let mut case = Case::new([5, 4, 4]);
    let (n, last) = (case.pattern.dofs(), case.grid.points.len() as u32 - 1);
    case.fixed[..3].fill(true);
    let mut random = Random::new(3);
    let mut b = random.vector(n);
    b[..3].fill(0.0);
    let nodes = [7, last, 7, 3];
    let noise = DMatrix::from_fn(12, 12, |_, _| 0.2 * random.next());
    for factory in Solver::CATALOGUE {
        let element = if factory.takes() == Symmetry::Symmetric { &noise + noise.transpose() } else { noise.clone() };
        let mut matrix = case.grid.laplacian(&case.pattern, 0.4);
        if factory.takes() == Symmetry::General {
            let mut general = SparseMatrix::with_symmetry(case.pattern.clone(), Symmetry::General);
            general.add_scaled(1.0, &matrix).unwrap();
            matrix = general;
        }
        let mut expected = dense_of(&matrix);
        matrix.add_beyond(&nodes, element.transpose().as_slice().to_vec());
        let dof = |i: usize| 3 * nodes[i / 3] as usize + i % 3;
        (0..144).for_each(|at| expected[(dof(at / 12), dof(at % 12))] += element[(at / 12, at % 12)]);
        assert!((dense_of(&matrix) - &expected).amax() < 1e-13);
        matrix.eliminate(&case.fixed, 2.0);
        let (dense, structure) = (dense_of(&matrix), Structure::new(case.pattern.clone()));
        let mut own = Joining::new(&structure, factory.make(&structure));
        let x = own.solve(&case.system(&matrix), &b, STRICT, &mut LinearWork::default());
        let x = x.unwrap_or_else(|error| panic!("{factory}: {error}")).x;
        assert!(relative_difference(&x, &solution(&dense, &b)) < 1e-8, "{factory}");
    }
}

/// Blocks beyond the pattern are in all that a matrix says of itself.
#[test]
fn blocks_beyond_the_pattern_belong_to_the_matrix() {
    let case = Case::new([2, 1, 1]);
    let (n, last) = (case.pattern.dofs(), case.grid.points.len() as u32 - 1);
    let mut random = Random::new(5);
    for skew in [0.0, 1.0] {
        let (mut matrix, mut expected) = case.general(skew);
        if skew == 0.0 {
            matrix = case.grid.laplacian(&case.pattern, 0.3);
            expected = dense_of(&matrix);
        }
        let nodes = [last, 0, 3];
        let noise = DMatrix::from_fn(9, 9, |_, _| random.next());
        let element = if skew == 0.0 { &noise + noise.transpose() } else { noise };
        matrix.add_beyond(&nodes, element.transpose().as_slice().to_vec());
        let dof = |i: usize| 3 * nodes[i / 3] as usize + i % 3;
        (0..81).for_each(|at| expected[(dof(at / 9), dof(at % 9))] += element[(at / 9, at % 9)]);
        let apart = |found: &DMatrix<f64>, expected: &DMatrix<f64>| (found - expected).norm() / expected.norm();
        assert!(apart(&dense_of(&matrix), &expected) < 1e-14);
        let x = random.vector(n);
        let (mut y, mut transposed) = (vec![0.0; n], vec![0.0; n]);
        matrix.multiply(&x, &mut y);
        matrix.multiply_transposed(&x, &mut transposed, true);
        let x = DVector::from_vec(x);
        assert!(relative_difference(&y, (&expected * &x).as_slice()) < 1e-13);
        assert!(relative_difference(&transposed, (expected.transpose() * &x).as_slice()) < 1e-13);
        assert!(relative_difference(&matrix.diagonal(), expected.diagonal().as_slice()) < 1e-14);
        let symmetric = 0.5 * (&expected + expected.transpose());
        assert!(apart(&dense_of(&matrix.symmetric_part()), &symmetric) < 1e-14);
        let rows = symmetric.row_iter().map(|row| row.iter().map(|v| v.abs()).sum::<f64>()).fold(0.0, f64::max);
        assert!(matrix.norm() >= rows && matrix.norm() < 1.5 * rows);
        let mut sum = matrix.symmetric_part();
        sum.add_scaled(-0.5, &matrix.symmetric_part()).unwrap();
        assert!(apart(&dense_of(&sum), &(0.5 * &symmetric)) < 1e-13);
        // the same added among four components per node
        let symmetry = if matrix.is_symmetric() { Symmetry::Symmetric } else { Symmetry::General };
        let [mut narrow, mut wide] =
            [3, 4].map(|dim| SparseMatrix::with_symmetry(Arc::new(case.pattern.with_dim(dim)), symmetry));
        let pair: Vec<f64> = (0..36).map(|at| element[(at / 6, at % 6)]).collect();
        let add = |into: &mut SparseMatrix| {
            into.add_pairs(&[0, 1], &pair).unwrap();
            into.add_beyond(&nodes, element.as_slice().to_vec());
            into.add_diagonal(&x.as_slice()[..n]);
            into.add_scaled(0.3, &case.grid.laplacian(&case.pattern, 0.3)).unwrap();
        };
        add(&mut narrow);
        wide.among(&[0, 1, 3], add);
        let place = |i: usize| 4 * (i / 3) + [0, 1, 3][i % 3];
        assert!((0..n * n).all(|at| wide.get(place(at / n), place(at % n)) == narrow.get(at / n, at % n)));
        assert!((0..wide.pattern().dofs()).all(|i| wide.get(i, 2) == 0.0 && wide.get(2, i) == 0.0));
        let fixed: Vec<bool> = (0..n).map(|dof| dof % 5 == 0).collect();
        matrix.eliminate(&fixed, 3.0);
        for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))).filter(|(i, j)| fixed[*i] || fixed[*j]) {
            assert_eq!(matrix.get(i, j), if i == j { 3.0 } else { 0.0 }, "{i}, {j}");
        }
        matrix.add_beyond(&[1], vec![f64::NAN; 9]);
        assert!(matrix.check_finite().is_err());
        matrix.clear();
        assert!(matrix.beyond().is_empty() && dense_of(&matrix).amax() == 0.0);
    }
}
