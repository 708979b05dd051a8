//! Factors in single precision: what they are good for, and what happens where they are not.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use crate::support;

use nastic_linear::{FactorError, Pivots, Precision, SparseMatrix, Symbolic, conjugate_gradient};
use std::sync::Arc;
use support::{Grid, Random, relative_difference};

struct Case {
    matrix: SparseMatrix,
    symbolic: Arc<Symbolic>,
}

impl Case {
    fn new(shift: f64) -> Self {
        let grid = Grid::hexahedra([9, 6, 5], 1);
        let pattern = grid.pattern(3);
        let matrix = grid.laplacian(&pattern, shift);
        Case { matrix, symbolic: Arc::new(Symbolic::new(&pattern)) }
    }

    fn scaled(&self, by: f64) -> SparseMatrix {
        let mut matrix = self.matrix.clone();
        matrix.values.iter_mut().for_each(|v| *v *= by);
        matrix
    }

    /// A solution and its right-hand sides, one after the other.
    fn system(&self, matrix: &SparseMatrix, columns: usize) -> (Vec<f64>, Vec<f64>) {
        let n = matrix.pattern().dofs();
        let x = Random::new(5).vector(n * columns);
        let mut b = vec![0.0; n * columns];
        b.chunks_mut(n).zip(x.chunks(n)).for_each(|(b, x)| matrix.multiply(x, b));
        (x, b)
    }
}

#[test]
fn a_factor_in_single_precision_solves_to_single_precision_whatever_the_units() {
    let case = Case::new(0.5);
    for scale in [1.0, 1e-200, 3e150] {
        let matrix = case.scaled(scale);
        let factor = case.symbolic.approximate(&matrix, false).unwrap();
        assert_eq!(
            (factor.precision(), factor.pivots(), factor.is_usable()),
            (Precision::Single, Pivots::Positive, true)
        );
        assert_eq!(2 * factor.bytes(), case.symbolic.factor_bytes(), "half of a whole factor");
        let (x, mut b) = case.system(&matrix, 3);
        // Columns of very different sizes do not disturb each other.
        let n = matrix.pattern().dofs();
        b[n..2 * n].iter_mut().for_each(|b| *b *= 1e-90);
        b[2 * n..].fill(0.0);
        factor.solve(&mut b, 3);
        b[n..2 * n].iter_mut().for_each(|b| *b *= 1e90);
        for k in 0..2 {
            let error = relative_difference(&b[k * n..(k + 1) * n], &x[k * n..(k + 1) * n]);
            assert!(error < 3e-5 && error > 1e-9, "scale {scale:e}, column {k}: {error:e}");
        }
        assert!(b[2 * n..].iter().all(|&x| x == 0.0));
    }
}

#[test]
fn conjugate_gradients_make_it_exact_in_a_few_iterations() {
    let case = Case::new(0.01);
    let factor = case.symbolic.approximate(&case.matrix, false).unwrap();
    let (exact, b) = case.system(&case.matrix, 1);
    let mut x = vec![0.0; b.len()];
    let apply = |v: &[f64], out: &mut [f64]| case.matrix.multiply(v, out);
    let report = conjugate_gradient(&apply, &factor, &b, &mut x, 1e-13, 10);
    assert!(report.converged() && report.iterations <= 4, "{report:?}");
    assert!(relative_difference(&x, &exact) < 1e-10);
}

/// The bits do not depend on the number of threads, nor on what the memory was used for before.
#[test]
fn precisions_may_take_turns_in_one_factor() {
    let case = Case::new(0.5);
    let solved = |factor: &nastic_linear::Factor| {
        let mut x = vec![1.0; case.matrix.pattern().dofs()];
        factor.solve(&mut x, 1);
        x
    };
    let single = solved(&case.symbolic.approximate(&case.matrix, false).unwrap());
    let double = solved(&case.symbolic.factorize(&case.matrix, Pivots::Positive, false).unwrap());
    assert!(single != double);
    let mut factor = case.symbolic.factorize(&case.scaled(7.0), Pivots::AnySign, false).unwrap();
    for parallel in [false, true, true] {
        factor.approximate(&case.matrix, parallel).unwrap();
        assert!(solved(&factor) == single);
        assert_eq!(factor.negative_pivots(), 0);
        factor.refactorize(&case.matrix, Pivots::Positive, parallel).unwrap();
        assert!(solved(&factor) == double && factor.precision() == Precision::Double);
    }
}

#[test]
fn what_cannot_be_factorised_is_refused() {
    let case = Case::new(0.5);
    let indefinite = Case::new(-2.0);
    let mut factor = indefinite.symbolic.factorize(&indefinite.matrix, Pivots::AnySign, false).unwrap();
    assert!(matches!(factor.approximate(&indefinite.matrix, false), Err(FactorError::NotPositive { .. })));
    assert!(!factor.is_usable());
    let mut poisoned = case.matrix.clone();
    poisoned.values[17] = f64::NAN;
    assert!(matches!(case.symbolic.approximate(&poisoned, false), Err(FactorError::NotFinite { .. })));
    assert_eq!(case.symbolic.approximate(&indefinite.matrix, false).unwrap_err(), FactorError::ForeignPattern);
}
