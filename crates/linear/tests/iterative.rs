//! Conjugate gradients and iterative refinement with the factor of a nearby matrix.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use crate::support;

use nastic_linear::{CgEnd, Factor, Pattern, Pivots, SparseMatrix, StoppingTest, Symbolic, conjugate_gradient, refine};
use std::sync::Arc;
use support::{Grid, Random, relative_difference};

struct Case {
    grid: Grid,
    pattern: Arc<Pattern>,
    symbolic: Arc<Symbolic>,
}

impl Case {
    fn new() -> Self {
        let grid = Grid::hexahedra([5, 4, 4], 1);
        let pattern = grid.pattern(3);
        let symbolic = Arc::new(Symbolic::new(&pattern));
        Self { grid, pattern, symbolic }
    }

    fn matrix(&self, shift: f64) -> SparseMatrix {
        self.grid.laplacian(&self.pattern, shift)
    }

    fn factor(&self, shift: f64, pivots: Pivots) -> Factor {
        self.symbolic.factorize(&self.matrix(shift), pivots, false).unwrap()
    }

    /// A right-hand side and the solution it belongs to.
    fn system(&self, matrix: &SparseMatrix) -> (Vec<f64>, Vec<f64>) {
        let x = Random::new(23).vector(self.pattern.dofs());
        let mut b = vec![0.0; x.len()];
        matrix.multiply(&x, &mut b);
        (b, x)
    }
}

fn apply(matrix: &SparseMatrix) -> impl Fn(&[f64], &mut [f64]) {
    |v, out| matrix.multiply(v, out)
}

#[test]
fn conjugate_gradients_with_the_exact_factor_need_one_iteration() {
    let case = Case::new();
    let matrix = case.matrix(0.5);
    let (b, exact) = case.system(&matrix);
    let mut x = vec![0.0; b.len()];
    let report = conjugate_gradient(&apply(&matrix), &case.factor(0.5, Pivots::Positive), &b, &mut x, 1e-10, 5);
    assert_eq!((report.end, report.iterations), (CgEnd::Converged, 1));
    assert!(relative_difference(&x, &exact) < 1e-10);
}

#[test]
fn conjugate_gradients_reach_the_tolerance_with_a_nearby_factor() {
    let case = Case::new();
    let matrix = case.matrix(0.5);
    let (b, exact) = case.system(&matrix);
    let factor = case.factor(8.0, Pivots::Positive);
    let mut before = 0;
    for tolerance in [1e-3, 1e-6, 1e-12] {
        let mut x = vec![0.0; b.len()];
        let report = conjugate_gradient(&apply(&matrix), &factor, &b, &mut x, tolerance, 200);
        assert!(report.converged() && report.residual <= tolerance && report.iterations > before, "{report:?}");
        let mut residual = vec![0.0; b.len()];
        matrix.multiply(&x, &mut residual);
        assert!((relative_difference(&residual, &b) - report.residual).abs() <= 1e-15);
        assert!(relative_difference(&x, &exact) < 100.0 * tolerance);
        before = report.iterations;
    }
    // From a good start there is less to do; from the solution, nothing.
    let mut x: Vec<f64> = exact.iter().map(|x| x * (1.0 + 1e-5)).collect();
    assert!(conjugate_gradient(&apply(&matrix), &factor, &b, &mut x, 1e-12, 200).iterations < before);
    let mut x = exact.clone();
    assert_eq!(conjugate_gradient(&apply(&matrix), &factor, &b, &mut x, 1e-12, 200).iterations, 0);
    assert_eq!(x, exact);
    let mut x = vec![0.0; b.len()];
    let report = conjugate_gradient(&apply(&matrix), &factor, &b, &mut x, 1e-12, 3);
    assert_eq!((report.end, report.iterations), (CgEnd::Exhausted, 3));
    assert!(report.residual > 1e-12 && report.residual < 1.0);
}

/// `|x - A^-1 b|_A` relative to the solution: what is asked for, and not far less.
#[test]
fn an_error_aimed_at_is_that_of_the_energy_norm() {
    let case = Case::new();
    let matrix = case.matrix(0.5);
    let (b, exact) = case.system(&matrix);
    let energy = |v: &[f64]| {
        let mut product = vec![0.0; v.len()];
        matrix.multiply(v, &mut product);
        v.iter().zip(&product).map(|(v, p)| v * p).sum::<f64>().sqrt()
    };
    for shift in [0.6, 2.0, 8.0, 30.0] {
        let factor = case.factor(shift, Pivots::Positive);
        for tolerance in [1e-3, 1e-6, 1e-9] {
            let mut x = vec![0.0; b.len()];
            let report = conjugate_gradient(&apply(&matrix), &factor, &b, &mut x, StoppingTest::Error(tolerance), 200);
            let difference: Vec<f64> = x.iter().zip(&exact).map(|(x, e)| x - e).collect();
            let error = energy(&difference) / energy(&exact);
            assert!(
                report.converged() && error <= tolerance && error >= 1e-3 * tolerance,
                "{shift}: {error:e} for {tolerance:e}, {report:?}"
            );
        }
    }
    // An error below what double precision resolves: the corrections end it, not the limit of iterations.
    let factor = case.factor(2.0, Pivots::Positive);
    let mut x = vec![0.0; b.len()];
    let report = conjugate_gradient(&apply(&matrix), &factor, &b, &mut x, StoppingTest::Error(1e-17), 200);
    assert!(report.end != CgEnd::Exhausted && relative_difference(&x, &exact) < 1e-13, "{report:?}");
    let mut x = vec![0.0; b.len()];
    let none = conjugate_gradient(&apply(&matrix), &factor, &vec![0.0; b.len()], &mut x, StoppingTest::Error(1e-9), 5);
    assert!(none.converged() && none.iterations == 0, "{none:?}");
}

/// Whichever is had first, the error only where the residual is within a thousand of what is asked.
#[test]
fn the_error_or_the_residual_may_be_aimed_at() {
    let case = Case::new();
    let matrix = case.matrix(0.5);
    let (b, _) = case.system(&matrix);
    let factor = case.factor(8.0, Pivots::Positive);
    let run = |aim: StoppingTest| {
        let mut x = vec![0.0; b.len()];
        let report = conjugate_gradient(&apply(&matrix), &factor, &b, &mut x, aim, 200);
        assert!(report.converged(), "{report:?}");
        report
    };
    let (error, residual) = (run(StoppingTest::Error(1e-6)), run(StoppingTest::Residual(1e-12)));
    assert!(error.iterations + 3 < residual.iterations, "{error:?} {residual:?}");
    let either = run(StoppingTest::Either { error: 1e-6, residual: 1e-12 });
    assert!(either.residual <= 1e-9 && either.iterations < residual.iterations, "{either:?} {residual:?}");
    assert_eq!(run(StoppingTest::Either { error: 1e-6, residual: 1e-9 }), error);
    assert_eq!(run(StoppingTest::Either { error: 1e-300, residual: 1e-12 }), residual);
}

#[test]
fn conjugate_gradients_notice_what_they_cannot_solve() {
    let case = Case::new();
    let (definite, indefinite) = (case.matrix(0.5), case.matrix(-3.0));
    let (b, _) = case.system(&indefinite);
    let factor = case.factor(0.5, Pivots::Positive);
    let mut x = vec![0.0; b.len()];
    let report = conjugate_gradient(&apply(&indefinite), &factor, &b, &mut x, 1e-12, 500);
    let CgEnd::NegativeCurvature { curvature } = report.end else { panic!("{report:?}") };
    assert!((-3.0..=0.0).contains(&curvature), "{curvature} is a Rayleigh quotient");
    assert!(x.iter().all(|x| x.is_finite()) && report.residual.is_finite());

    let any_sign = case.factor(-3.0, Pivots::AnySign);
    let report = conjugate_gradient(&apply(&definite), &any_sign, &b, &mut vec![0.0; b.len()], 1e-12, 500);
    assert_eq!(report.end, CgEnd::IndefinitePreconditioner);

    let poisoned = |v: &[f64], out: &mut [f64]| {
        definite.multiply(v, out);
        out[3] = f64::NAN;
    };
    let report = conjugate_gradient(&poisoned, &factor, &b, &mut vec![0.0; b.len()], 1e-12, 500);
    assert_eq!((report.end, report.iterations), (CgEnd::NotFinite, 1));

    // Nothing to do for a zero right-hand side.
    let zero = vec![0.0; b.len()];
    let mut x = zero.clone();
    let report = conjugate_gradient(&apply(&definite), &factor, &zero, &mut x, 1e-12, 500);
    assert_eq!((report.end, report.iterations, report.residual), (CgEnd::Converged, 0, 0.0));
    assert_eq!(x, zero);
}

#[test]
fn refinement_improves_and_never_spoils() {
    let case = Case::new();
    let indefinite = case.matrix(-3.0);
    let (b, exact) = case.system(&indefinite);
    let close = case.factor(-3.01, Pivots::AnySign);
    let mut x = b.clone();
    close.solve(&mut x, 1);
    let at_first = relative_difference(&x, &exact);
    let report = refine(&apply(&indefinite), &close, &b, &mut x, 1e-12, 50);
    assert!(report.converged() && report.residual <= 1e-12 && report.iterations > 1, "{report:?}");
    assert!(relative_difference(&x, &exact) < 1e-3 * at_first);

    // A factor that is too far away makes it worse: the best iterate stays.
    let far = case.factor(0.3, Pivots::Positive);
    let mut kept = x.clone();
    let report = refine(&apply(&indefinite), &far, &b, &mut kept, 0.0, 50);
    assert_eq!(report.end, CgEnd::Exhausted);
    assert!(report.residual <= 1e-12 && relative_difference(&kept, &exact) < 1e-3 * at_first);
}
