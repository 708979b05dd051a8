//! The solvers behind one trait, on matrices that are definite, indefinite and not symmetric; GMRES; bordered systems.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use crate::support;

use nalgebra::{DMatrix, DVector};
use nastic_linear::solver::{
    Accuracy, Border, BorderedSolution, Curvature, Definite, Shift, Step, System, solve_bordered,
};
use nastic_linear::{
    FactorError, LinearError, LinearSolver, LinearWork, Pivots, Rotations, Solver, SparseMatrix, Structure, Symmetry,
    gmres,
};
use nastic_tensor::Mat3;
use std::sync::Arc;
use support::case::{AtRest, Case, STRICT, solution};
use support::{Grid, Random, relative_difference};

#[test]
fn a_general_matrix_is_its_dense_twin() {
    let case = Case::new([3, 2, 2]);
    let (matrix, dense) = case.general(0.4);
    assert!(!matrix.is_symmetric());
    let x = Random::new(1).vector(case.pattern.dofs());
    let (mut y, mut z) = (vec![0.0; x.len()], vec![0.0; x.len()]);
    matrix.multiply(&x, &mut y);
    matrix.multiply_transposed(&x, &mut z, true);
    let v = DVector::from_column_slice(&x);
    assert!(relative_difference(&y, (&dense * &v).as_slice()) < 1e-14);
    assert!(relative_difference(&z, (dense.transpose() * &v).as_slice()) < 1e-14);
    for (i, j) in [(0, 5), (5, 0), (7, 7), (20, 22), (22, 20)] {
        assert!((matrix.get(i, j) - dense[(i, j)]).abs() < 1e-14, "entry {i}, {j}");
    }
    let mut eliminated = matrix.clone();
    let mut fixed = case.fixed.clone();
    fixed[4] = true;
    eliminated.eliminate(&fixed, 2.0);
    assert_eq!((eliminated.get(4, 4), eliminated.get(4, 5), eliminated.get(5, 4)), (2.0, 0.0, 0.0));
    assert_eq!(eliminated.get(20, 22), matrix.get(20, 22));
}

#[test]
fn general_systems_and_their_transposes_are_solved() {
    let case = Case::new([4, 3, 3]);
    let b = Random::new(8).vector(case.pattern.dofs());
    let (mut before, mut own) = (0, Solver::GENERAL.make(&case.structure));
    for skew in [0.0, 0.05, 0.4] {
        let (matrix, dense) = case.general(skew);
        let mut work = LinearWork::default();
        let x = own.solve(&case.system(&matrix), &b, STRICT, &mut work).unwrap().x;
        assert!(relative_difference(&x, &solution(&dense, &b)) < 1e-9, "skew {skew}");
        let x = own.solve(&case.system(&matrix).transpose(), &b, STRICT, &mut work).unwrap().x;
        assert!(relative_difference(&x, &solution(&dense.transpose(), &b)) < 1e-9, "skew {skew}, transposed");
        assert!(work.back_substitutions >= before, "a larger skew part takes no fewer iterations: {work:?}");
        assert!(work.factorisations <= 1 && own.state().name == "general", "{work:?}");
        before = work.back_substitutions;
        let step = own.step(&case.system(&matrix), &b, 1e-3, &mut work).unwrap();
        assert_eq!(step.curvature, Curvature::Positive);
        assert!(relative_difference(&step.x, &solution(&dense, &b)) < 1e-2);
    }
    assert!(before > 10, "the skew part is too small for the test to tell: {before}");
}

/// What sliding samples add, `v n^T`: the symmetric part is indefinite, without it it is that of the Laplacian.
#[test]
fn what_is_set_aside_preconditions_and_belongs_to_no_product() {
    let case = Case::new([4, 3, 3]);
    let b = Random::new(8).vector(case.pattern.dofs());
    let (plain, mut dense) = case.general(0.0);
    let (mut with, mut without) = (plain.clone(), plain);
    for node in 0..25 {
        let [v, n] = [[1.0, 0.6, 0.0], [0.0, 0.3, 1.0]];
        let element: Vec<f64> = (0..9).map(|at| 400.0 * v[at / 3] * n[at % 3]).collect();
        [&mut with, &mut without].into_iter().for_each(|to| to.add_pairs(&[node], &element).unwrap());
        let aside = element.iter().map(|e| -e).collect();
        with.add_aside(&[node], aside);
        (0..9).for_each(|at| dense[(3 * node as usize + at / 3, 3 * node as usize + at % 3)] += element[at]);
    }
    let twin = |of: &SparseMatrix| DMatrix::from_fn(b.len(), b.len(), |i, j| of.get(i, j));
    assert!((twin(&with) - &dense).amax() < 1e-12 && (twin(&without) - &dense).amax() < 1e-12);
    assert_eq!(support::negative_eigenvalues(&twin(&with.stand_in())), 0);
    assert!(support::negative_eigenvalues(&twin(&with.symmetric_part())) >= 20);
    let work = |matrix: &SparseMatrix| {
        let (mut own, mut work) = (Solver::GENERAL.make(&case.structure), LinearWork::default());
        let x = own.solve(&case.system(matrix), &b, STRICT, &mut work).unwrap().x;
        assert!(relative_difference(&x, &solution(&dense, &b)) < 1e-8);
        let x = own.solve(&case.system(matrix).transpose(), &b, STRICT, &mut work).unwrap().x;
        assert!(relative_difference(&x, &solution(&dense.transpose(), &b)) < 1e-8);
        assert_eq!(own.state().name, "general");
        work.back_substitutions
    };
    let (found, other) = (work(&with), work(&without));
    assert!(found < other, "{found} iterations, without what is set aside {other}");
    let mut eliminated = with.clone();
    let mut fixed = case.fixed.clone();
    fixed[3] = true;
    eliminated.eliminate(&fixed, 2.0);
    assert_eq!((eliminated.stand_in().get(3, 3), eliminated.stand_in().get(3, 5)), (2.0, 0.0));
}

/// `Q^T (S + E) Q` for the stand-in `S + E` of a matrix before its unknowns were mixed.
#[test]
fn what_is_set_aside_is_mixed_with_the_matrix() {
    let case = Case::new([2, 2, 2]);
    let (mut matrix, _) = case.general(0.1);
    let (nodes, n) = ([3, 4], case.pattern.dofs());
    let entries: Vec<f64> = (0..81).map(|at| f64::from(at % 7) - 3.0).collect();
    matrix.add_aside(&[3, 4, 12], entries);
    let dense = |of: &SparseMatrix| DMatrix::from_fn(n, n, |i, j| of.get(i, j));
    let before = dense(&matrix.stand_in());
    let q = DMatrix::from_fn(6, 6, |i, j| ((i * 5 + j * 3) % 7) as f64 - 2.5).qr().q();
    let mut all = DMatrix::identity(n, n);
    all.view_mut((9, 9), (6, 6)).copy_from(&q);
    matrix.mix(&nodes, &q);
    let error = (dense(&matrix.stand_in()) - all.transpose() * before * &all).amax();
    assert!(error < 1e-12, "{error}");
}

/// The symmetric part may be indefinite.
#[test]
fn an_indefinite_general_system_is_solved() {
    let case = Case::new([3, 2, 2]);
    let (mut matrix, mut dense) = case.general(0.05);
    matrix.add_to_diagonal(-2.0);
    dense -= 2.0 * DMatrix::identity(dense.nrows(), dense.nrows());
    let b = Random::new(9).vector(case.pattern.dofs());
    let mut work = LinearWork::default();
    let mut own = Solver::GENERAL.make(&case.structure);
    let x = own.solve(&case.system(&matrix), &b, STRICT, &mut work).unwrap().x;
    assert!(relative_difference(&x, &solution(&dense, &b)) < 1e-8);
    assert_eq!(own.step(&case.system(&matrix), &b, 1e-3, &mut work).unwrap().curvature, Curvature::Negative);
}

#[test]
fn symmetric_solvers_refuse_what_is_not_symmetric() {
    let case = Case::new([2, 2, 2]);
    let (matrix, _) = case.general(0.1);
    let b = vec![1.0; case.pattern.dofs()];
    for kind in [Solver::DIRECT, Solver::MULTIGRID] {
        let mut own = kind.make(&case.structure);
        let error = own.solve(&case.system(&matrix), &b, STRICT, &mut LinearWork::default());
        assert_eq!(error.unwrap_err(), LinearError::NotSymmetric, "{kind}");
    }
}

/// Direct and multigrid agree with a dense factor on the same calls, and keep what served.
#[test]
fn every_symmetric_solver_gives_the_same_answers() {
    let case = Case::new([5, 4, 4]);
    let matrix = case.grid.laplacian(&case.pattern, 0.4);
    let b = Random::new(2).vector(case.pattern.dofs());
    let mut exact = b.clone();
    case.symbolic.factorize(&matrix, Pivots::Positive, false).unwrap().solve(&mut exact, 1);
    for kind in [Solver::DIRECT, Solver::MULTIGRID] {
        let mut own = kind.make(&case.structure);
        let mut work = LinearWork::default();
        own.restart();
        let step = own.step(&case.system(&matrix), &b, 1e-6, &mut work).unwrap();
        assert_eq!(step.curvature, Curvature::Positive, "{kind}");
        assert!(relative_difference(&step.x, &exact) < 1e-3, "{kind}");
        let x = own.solve(&case.system(&matrix), &b, STRICT, &mut work).unwrap().x;
        assert!(relative_difference(&x, &exact) < 1e-9, "{kind}");
        assert_eq!(own.inertia(&case.system(&matrix)).unwrap().map(|found| found.negative), Some(0), "{kind}");
        assert!(own.state().name == kind.name() && work.factorisations + work.hierarchies <= 2, "{kind}: {work:?}");
        own.prepare(&case.system(&matrix), &mut work).unwrap();
        let made = (work.factorisations, work.hierarchies);
        let x = own.solve(&case.system(&matrix), &b, STRICT, &mut work).unwrap().x;
        assert!(relative_difference(&x, &exact) < 1e-9, "{kind}");
        assert_eq!(made, (work.factorisations, work.hierarchies), "{kind}: what was prepared is not used");
        own.clear();
        assert_eq!(own.state().bytes, 0);
    }
}

/// Once a factor in single precision turned out too coarse, or not to exist, systems with this matrix take one in double precision, and
/// that alone; so do those with the next one of its kind.
#[test]
fn a_prepared_matrix_is_not_factorised_again() {
    let case = Case::new([5, 4, 4]);
    let mut random = Random::new(2);
    for (diagonal, first, next) in [(0.4, 1, 1), (1e-8, 2, 1), (-3.0, 2, 2)] {
        let mut matrix = case.grid.laplacian(&case.pattern, 0.0);
        matrix.add_to_diagonal(diagonal);
        let mut own = Solver::DIRECT.make(&case.structure);
        for most in [first, next] {
            matrix.add_to_diagonal(1e-3 * diagonal);
            let (system, mut work) = (case.system(&matrix), LinearWork::default());
            own.prepare(&system, &mut work).unwrap();
            for _ in 0..3 {
                let b = random.vector(case.pattern.dofs());
                let x = own.solve(&system, &b, Accuracy { error: 1e-9, residual: 1e-7 }, &mut work).unwrap().x;
                let mut image = vec![0.0; b.len()];
                matrix.multiply(&x, &mut image);
                assert!(relative_difference(&image, &b) < 1e-6, "{diagonal}");
            }
            assert!(work.factorisations <= most, "{diagonal}: {work:?}");
        }
    }
}

#[test]
fn a_shift_makes_steps_go_downhill() {
    let case = Case::new([4, 3, 3]);
    let mut matrix = case.grid.laplacian(&case.pattern, 0.4);
    matrix.add_to_diagonal(-3.0);
    let b = Random::new(2).vector(case.pattern.dofs());
    for kind in [Solver::DIRECT, Solver::MULTIGRID] {
        let (mut own, mut work) = (kind.make(&case.structure), LinearWork::default());
        let x = Shift::default().step(own.as_mut(), &case.system(&matrix), &b, &mut work).unwrap();
        assert!(x.iter().zip(&b).map(|(x, b)| x * b).sum::<f64>() > 0.0, "{kind}: the step goes uphill");
        assert_eq!(work.shifted, 1);
    }
    let negative = Solver::DIRECT.make(&case.structure).inertia(&case.system(&matrix)).unwrap();
    assert!(negative.is_some_and(|found| found.negative > 0));
}

/// Levels are made once for all the shifts that are tried, and no shift is tried that a quotient seen before shows to be too small.
#[test]
fn levels_serve_for_all_shifts() {
    let case = Case::new([6, 6, 6]);
    let (definite, mut matrix) = (case.grid.laplacian(&case.pattern, 0.4), case.grid.laplacian(&case.pattern, 0.4));
    matrix.add_to_diagonal(-1.0);
    let b = Random::new(2).vector(case.pattern.dofs());
    let (mut own, mut work) = (Solver::MULTIGRID.make(&case.structure), LinearWork::default());
    let system = case.system(&matrix);
    own.step(&case.system(&definite), &b, 1e-2, &mut work).unwrap();
    let quotient = match own.step(&system, &b, 1e-2, &mut work) {
        Ok(Step { curvature: Curvature::Negative, quotient, .. }) | Err(LinearError::Indefinite { quotient }) => {
            quotient
        }
        other => panic!("the matrix is indefinite: {other:?}"),
    };
    let quotient = quotient.unwrap();
    let dense = DMatrix::from_fn(b.len(), b.len(), |i, j| matrix.get(i, j));
    let least = dense.symmetric_eigenvalues().min();
    assert!(quotient <= 0.0 && quotient >= least, "{quotient} of {least}");
    let mut shift = Shift::default();
    shift.note(Some(quotient));
    let x = shift.step(own.as_mut(), &system, &b, &mut work).unwrap();
    assert!(x.iter().zip(&b).map(|(x, b)| x * b).sum::<f64>() > 0.0);
    assert!(work.hierarchies <= 1, "{work:?}");
}

#[test]
fn gmres_says_when_it_does_not_converge() {
    let case = Case::new([3, 3, 3]);
    let (matrix, dense) = case.general(3.0);
    let symmetric = matrix.symmetric_part();
    let factor = case.symbolic.factorize(&symmetric, Pivots::Positive, false).unwrap();
    let b = Random::new(4).vector(case.pattern.dofs());
    let apply = |v: &[f64], out: &mut [f64]| matrix.multiply(v, out);
    let (_, report) = gmres(&apply, &factor, &b, 1e-10, 5);
    assert!(!report.converged() && report.iterations == 5 && report.residual > 1e-10, "{report:?}");
    let (x, report) = gmres(&apply, &factor, &b, 1e-10, 1000);
    assert!(report.converged(), "{report:?}");
    assert!(relative_difference(&x, &solution(&dense, &b)) < 1e-7);
    let (x, report) = gmres(&apply, &factor, &vec![0.0; b.len()], 1e-10, 10);
    assert!(report.converged() && x.iter().all(|&x| x == 0.0));
}

/// Against the dense system; also where the matrix is close to singular and the border is what makes it regular.
#[test]
fn bordered_systems_are_solved_by_block_elimination() {
    let case = Case::new([3, 3, 2]);
    let n = case.pattern.dofs();
    let mut random = Random::new(5);
    let (general, dense_general) = case.general(0.2);
    let symmetric = case.grid.laplacian(&case.pattern, 0.4);
    let nearly_singular = case.grid.laplacian(&case.pattern, 3e-7);
    let dense_of = |matrix: &SparseMatrix| DMatrix::from_fn(n, n, |i, j| matrix.get(i, j));
    for (name, matrix, dense, kind, tolerance) in [
        ("symmetric", &symmetric, dense_of(&symmetric), Solver::DIRECT, 1e-9),
        ("general", &general, dense_general, Solver::GENERAL, 1e-9),
        // constant vectors are eigenvectors of the eigenvalue 3e-7; below it rounding limits what a solution can be, see the test of that
        ("nearly singular", &nearly_singular, dense_of(&nearly_singular), Solver::DIRECT, 1e-5),
    ] {
        let columns: Vec<Vec<f64>> =
            (0..3).map(|k| (0..n).map(|i| f64::from(u8::from(i % 3 == k)) + 0.1 * random.next()).collect()).collect();
        let rows: Vec<Vec<f64>> = match name {
            "general" => (0..3).map(|_| random.vector(n)).collect(),
            _ => columns.clone(),
        };
        let corner = DMatrix::from_fn(3, 3, |i, j| if i == j { -0.5 } else { 0.1 });
        let mut whole = DMatrix::zeros(n + 3, n + 3);
        whole.view_mut((0, 0), (n, n)).copy_from(&dense);
        for k in 0..3 {
            for i in 0..n {
                (whole[(i, n + k)], whole[(n + k, i)]) = (columns[k][i], rows[k][i]);
            }
            (0..3).for_each(|j| whole[(n + k, n + j)] = corner[(k, j)]);
        }
        let border = Border { columns, rows, corner };
        let (f, g) = (random.vector(n), random.vector(3));
        for transposed in [false, true] {
            let mut own: Box<dyn LinearSolver> = kind.make(&case.structure);
            let system = case.system(matrix);
            let system = System { transposed, ..system };
            let solved = solve_bordered(own.as_mut(), &system, &border, (&f, &g), STRICT, &mut LinearWork::default());
            let BorderedSolution { x, y, negative } = solved.unwrap_or_else(|e| panic!("{name}: {e}"));
            assert_eq!(negative, (name != "general").then_some(0));
            let whole = if transposed { whole.transpose() } else { whole.clone() };
            let exact = solution(&whole, &[f.clone(), g.clone()].concat());
            let error = relative_difference(&[x, y].concat(), &exact);
            assert!(error < tolerance, "{name}, transposed {transposed}: {error:e}");
        }
    }
    let border = Border { columns: vec![vec![0.0; n]], rows: vec![vec![0.0; n]], corner: DMatrix::zeros(1, 1) };
    let mut own = Solver::DIRECT.make(&case.structure);
    let system = case.system(&symmetric);
    let short = Border { columns: vec![vec![1.0; n - 1]], ..border.clone() };
    let (f, work) = (random.vector(n), &mut LinearWork::default());
    let refused = solve_bordered(own.as_mut(), &system, &short, (&f, &[1.0]), STRICT, work);
    assert!(matches!(refused, Err(LinearError::ForeignBorder { scalars: 1, .. })), "{refused:?}");
    let halved = case.symbolic.factorize(&general, Pivots::AnySign, false).err();
    assert_eq!(halved, Some(FactorError::NotSymmetric), "its symmetric part would be factorised instead");
    let failed =
        solve_bordered(own.as_mut(), &system, &border, (&vec![1.0; n], &[1.0]), STRICT, &mut LinearWork::default());
    assert_eq!(failed.unwrap_err(), LinearError::Border { scalars: 1 });
}

/// A beam of a thousand nodes under bending alone (squares of second differences), stiffer by a factor beside its first two nodes.
fn beam(stiffer: f64, clamped: bool) -> (Case, SparseMatrix) {
    const NODES: u32 = 1000;
    let points = (0..NODES).map(|i| [f64::from(i), 0.0, 0.0]).collect();
    let grid = Grid { points, elements: (0..NODES - 2).map(|i| vec![i, i + 1, i + 2]).collect() };
    let pattern = grid.pattern(1);
    let mut matrix = SparseMatrix::zeros(pattern.clone());
    for (i, nodes) in grid.elements.iter().enumerate() {
        let stiffness = if i < 10 { stiffer } else { 1.0 };
        let bending = DVector::from_column_slice(&[1.0, -2.0, 1.0]);
        let element = stiffness * &bending * bending.transpose();
        pattern.scatter(&pattern.scatter_map(nodes).unwrap(), element.as_slice(), &mut matrix.values);
    }
    let fixed: Vec<bool> = (0..NODES).map(|i| clamped && i < 2).collect();
    matrix.eliminate(&fixed, 1.0);
    let structure = Structure::new(pattern.clone());
    let symbolic = structure.symbolic().clone();
    let rotations = Arc::new(Rotations(vec![Mat3::identity(); NODES as usize]));
    let at = AtRest { points: grid.points.clone(), rotations };
    (Case { grid, pattern, symbolic, structure, fixed, at }, matrix)
}

/// The smallest eigenvalue of the clamped beam is 12.4/1000^4. A stiff part where it does not move is no reason to doubt its sign.
#[test]
fn only_the_rounding_of_the_eigenvalue_itself_makes_a_matrix_singular() {
    let inertia = |(case, matrix): (Case, SparseMatrix)| {
        Solver::DIRECT
            .make(&case.structure)
            .inertia(&case.system(&matrix))
            .map(|found| found.map(|found| found.negative))
    };
    for stiffer in [1.0, 1e5] {
        assert_eq!(inertia(beam(stiffer, true)), Ok(Some(0)), "{stiffer}");
        let message = inertia(beam(stiffer, false)).unwrap_err();
        assert!(message.is_singular(), "two free motions: {message}");
    }
    let case = Case::new([3, 3, 2]);
    let free = case.grid.laplacian(&case.pattern, 0.0);
    let message = inertia((case, free)).unwrap_err();
    assert!(message.is_singular() && !message.is_lack_of_memory(), "three free motions: {message}");
}

/// The three free motions of a body on springs have the eigenvalue of the springs, whose sign is counted right above and far below what single
/// precision resolves.
#[test]
fn eigenvalues_below_single_precision_are_counted() {
    for (cells, size) in (1..=3).flat_map(|n| (3..12).map(move |k| ([n + 1, n + 1, n], 10.0_f64.powi(-k)))) {
        let case = Case::new(cells);
        for (spring, negative) in [(size, 0), (-size, 3)] {
            let mut matrix = case.grid.laplacian(&case.pattern, 0.0);
            matrix.add_to_diagonal(spring);
            let counted = Solver::DIRECT.make(&case.structure).inertia(&case.system(&matrix)).unwrap();
            assert_eq!(counted.map(|found| found.negative), Some(negative), "{cells:?}, {spring}");
        }
    }
}

#[test]
fn every_solver_has_a_name_of_its_own() {
    let case = Case::new([2, 2, 2]);
    let (general, _) = case.general(0.1);
    let b = vec![1.0; case.pattern.dofs()];
    for factory in Solver::CATALOGUE {
        assert_eq!(Solver::named(factory.name()), Some(factory));
        assert!(!factory.about().is_empty());
        let mut own = factory.make(&case.structure);
        assert_eq!((own.state().name, own.state().bytes), (factory.name(), 0));
        let solved = own.solve(&case.system(&general), &b, STRICT, &mut LinearWork::default());
        assert_eq!(solved.is_ok(), factory.takes() == Symmetry::General, "{factory}: {solved:?}");
    }
    assert_eq!(Solver::named("none"), None);
}

/// Symmetric and not, definite and not, the transpose too; the factorisation of one matrix serves one nearby.
#[test]
fn lu_solves_any_regular_matrix() {
    let case = Case::new([4, 3, 3]);
    let n = case.pattern.dofs();
    let b = Random::new(8).vector(n);
    let symmetric = case.grid.laplacian(&case.pattern, 0.4);
    let dense_symmetric = DMatrix::from_fn(n, n, |i, j| symmetric.get(i, j));
    for (name, (mut matrix, mut dense), shift) in [
        ("symmetric", (symmetric, dense_symmetric), 0.0),
        ("general", case.general(0.4), 0.0),
        ("mostly skew", case.general(20.0), 0.0),
        ("indefinite", case.general(0.4), -2.0),
    ] {
        matrix.add_to_diagonal(shift);
        dense += shift * DMatrix::identity(n, n);
        let (mut own, mut work) = (Solver::LU.make(&case.structure), LinearWork::default());
        let x = own.solve(&case.system(&matrix), &b, STRICT, &mut work).unwrap().x;
        assert!(relative_difference(&x, &solution(&dense, &b)) < 1e-9, "{name}");
        let x = own.solve(&case.system(&matrix).transpose(), &b, STRICT, &mut work).unwrap().x;
        assert!(relative_difference(&x, &solution(&dense.transpose(), &b)) < 1e-9, "{name}, transposed");
        matrix.add_to_diagonal(1e-3);
        dense += 1e-3 * DMatrix::identity(n, n);
        let x = own.solve(&case.system(&matrix), &b, STRICT, &mut work).unwrap().x;
        assert!(relative_difference(&x, &solution(&dense, &b)) < 1e-9, "{name}, nearby");
        assert_eq!((work.factorisations, work.reused), (1, 2), "{name}");
        assert!(work.back_substitutions <= 15 && own.state().bytes > 0, "{name}: {work:?}");
        assert_eq!(own.inertia(&case.system(&matrix)), Ok(None), "{name}: it cannot count");
        own.clear();
        assert_eq!(own.state().bytes, 0);
    }
    let singular = case.grid.laplacian(&case.pattern, 0.0);
    let mut own = Solver::LU.make(&case.structure);
    let message = own.solve(&case.system(&singular), &b, STRICT, &mut LinearWork::default()).unwrap_err();
    assert!(message.is_singular(), "three free motions: {message}");
    let refused = own.solve_definite(&case.system(&singular), &b, Definite::Once, &mut LinearWork::default());
    assert_eq!(refused, Err(LinearError::NotCounted { solver: "lu" }));
}

/// What is hardly held moves so far that no solution in double precision has the residual that is wanted: one that has what rounding leaves
/// counts as solved.
#[test]
fn what_rounding_leaves_is_solved() {
    let case = Case::new([4, 3, 3]);
    let b = Random::new(8).vector(case.pattern.dofs());
    let matrix = case.grid.laplacian(&case.pattern, 3e-7);
    for kind in [Solver::LU, Solver::GENERAL] {
        let mut own = kind.make(&case.structure);
        let x = own.solve(&case.system(&matrix), &b, STRICT, &mut LinearWork::default());
        let x = x.unwrap_or_else(|error| panic!("{}: {error}", own.state().name)).x;
        let mut rest = vec![0.0; b.len()];
        matrix.multiply(&x, &mut rest);
        let residual = relative_difference(&rest, &b);
        assert!(residual > STRICT.residual && residual < 1e3 * STRICT.residual, "{}: {residual:e}", own.state().name);
    }
}

/// Where the skew part decides, a factor of the symmetric one is of no use, or there is none: LU takes its place and stays.
#[test]
fn general_falls_back_on_lu() {
    let case = Case::new([5, 4, 4]);
    let b = Random::new(9).vector(case.pattern.dofs());
    let mut no_symmetric_part = case.general(1.0);
    let symmetric = no_symmetric_part.0.symmetric_part();
    no_symmetric_part.0.add_scaled(-1.0, &symmetric).unwrap();
    let n = case.pattern.dofs();
    no_symmetric_part.1 -= DMatrix::from_fn(n, n, |i, j| symmetric.get(i, j));
    for (name, (matrix, dense)) in [("skew part decides", case.general(300.0)), ("skew alone", no_symmetric_part)] {
        let (mut own, mut work) = (Solver::GENERAL.make(&case.structure), LinearWork::default());
        let accuracy = Accuracy { error: 1e-12, residual: 1e-10 };
        let x = own.solve(&case.system(&matrix), &b, accuracy, &mut work).unwrap_or_else(|e| panic!("{name}: {e}")).x;
        assert!(relative_difference(&x, &solution(&dense, &b)) < 1e-7, "{name}");
        let (made, iterations) = (work.factorisations, work.back_substitutions);
        let x = own.solve(&case.system(&matrix).transpose(), &b, accuracy, &mut work).unwrap().x;
        assert!(relative_difference(&x, &solution(&dense.transpose(), &b)) < 1e-7, "{name}, transposed");
        assert_eq!((own.state().name, work.factorisations), ("lu", made), "{name}");
        assert!(work.back_substitutions <= iterations + 10, "{name}: {work:?}");
    }
}
