//! [`TangentSystems`]: the linear systems of one nonlinear solve.

use crate::linear_systems::nodal_rotations::nodal_rotations;
use crate::linear_systems::tangent::{Tangent, TangentRef};
use crate::model::Model;
use nastic_body::controls::Controls;
use nastic_body::state::SolveReport;
use nastic_linear::solver::{
    Accuracy, BlockElimination, Border, BorderedSolution, Configuration, Curvature, Definite, Inertia, Shift, Solution,
    Step, System, solve_bordered,
};
use nastic_linear::{
    Corners, LinearError, LinearSolver, LinearWork, Operator, Rotations, Space, SparseMatrix, VolumeModes,
};
use nastic_numeric::vector::axpy;
use std::borrow::Cow;
use std::sync::{Arc, OnceLock};

/// Of a solution that counts as exact: an adjoint, and the two systems of a second derivative, whose products shall be symmetric to 1e-10.
/// The error of a derivative, and of `a . H b`, is relative to the product of the energy norms of both solutions: hundreds of times the derivative where an actuator
/// strains the body and the cost depends on its bending, a million times for the compliance of a nearly incompressible body (an error of 4e-4 with 1e-9). Over
/// crates/control/tests/hessian.rs 1e-12 gives 2e-10, 1e-13 2e-12, and 1e-14 is where double precision ends: 9e-13.
pub(crate) const EXACT: Accuracy = Accuracy { error: 1e-13, residual: 1e-11 };

/// Relative residual of a system that nothing corrects afterwards.
const MAX_UNCORRECTED_RESIDUAL: f64 = 1e-12;

/// Least relative residual of a solution that is corrected by a separate product, about the rounding of moduli.
const MIN_CORRECTED_RESIDUAL: f64 = 1e-7;
/// Corrections of such a solution.
const MAX_CORRECTIONS: usize = 5;

/// Accuracy of full Newton steps with an indefinite or bordered tangent.
pub(crate) const FULL_STEP: Accuracy = Accuracy { error: 1e-9, residual: 1e-7 };

/// Largest relative residual at which the factor of the tangent before serves bordered systems.
const MAX_REUSE_RESIDUAL: f64 = 0.05;
/// Largest error of these systems.
const MAX_REUSE_ERROR: f64 = 1e-3;

/// Accuracy of a full step with a bordered tangent from a relative residual towards one of `accuracy`, and whether the factor before may be used: a tenth of the
/// residual keeps convergence quadratic, and a thousandth of the final one is always sufficient.
pub(crate) fn bordered_step(relative: f64, accuracy: f64) -> (Accuracy, bool) {
    if relative.is_nan() || relative > MAX_REUSE_RESIDUAL {
        return (FULL_STEP, false);
    }
    let error = (0.1 * relative).max(1e-3 * accuracy / relative).clamp(FULL_STEP.error, MAX_REUSE_ERROR);
    (Accuracy { error, residual: error.max(FULL_STEP.residual) }, true)
}

/// Which step to compute if the tangent is indefinite.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StepWanted {
    /// Newton's step, which may lead to a saddle, if the solver supports it.
    Newton,
    /// A descent direction.
    Downhill,
}

/// Whether a system is that of the transposed tangent.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Transposition {
    /// The tangent itself.
    No,
    /// Its transpose.
    Yes,
}

/// Solutions for several right-hand sides.
pub struct Counted<S> {
    /// One by right-hand side.
    pub solved: Vec<S>,
    /// Number of negative eigenvalues of the system, or why it is unknown: the sign of one is rounding, or the solver does not count.
    pub negative: Result<usize, LinearError>,
}

/// Systems with the tangent of a model, by the solver of a workspace.
pub struct TangentSystems<'a> {
    model: &'a Model,
    controls: &'a Controls,
    parallel: bool,
    solver: &'a mut dyn LinearSolver,
    shift: Shift,
    /// Expected changes of volume of the next steps, by quadrature point.
    expected: Option<Vec<f64>>,
    /// By volume mode, the difference between pressures and changes of volume of the last step.
    left: Option<Vec<f64>>,
}

impl<'a> TangentSystems<'a> {
    /// The systems of a model at controls, with a solver.
    pub fn new(model: &'a Model, controls: &'a Controls, parallel: bool, solver: &'a mut dyn LinearSolver) -> Self {
        solver.restart();
        TangentSystems { model, controls, parallel, solver, shift: Shift::default(), expected: None, left: None }
    }

    /// The Newton step of a tangent at u whose supports are eliminated, to a relative residual of `tolerance`, and the curvature of the tangent.
    pub fn step<'m>(
        &mut self,
        tangent: impl Into<TangentRef<'m>>,
        u: &[f64],
        rhs: &[f64],
        tolerance: f64,
        wanted: StepWanted,
        report: &mut SolveReport,
    ) -> Result<(Vec<f64>, Curvature), LinearError> {
        let configuration = Deformed {
            expected: self.expected.as_deref(),
            ..Deformed::new(self.model, u, self.controls, self.parallel)
        };
        let system = configuration.system(tangent.into());
        let mut work = LinearWork::default();
        let found = self.solver.step(&system, rhs, tolerance, &mut work);
        if let Ok(Step { quotient, .. }) | Err(LinearError::Indefinite { quotient }) = &found {
            self.shift.note(*quotient);
        }
        let step = match found {
            Ok(step) if wanted == StepWanted::Newton || step.curvature != Curvature::Negative => Ok(step),
            Ok(_) | Err(LinearError::Indefinite { .. }) => {
                let shifted = self.shift.step(self.solver, &system, rhs, &mut work);
                shifted.map(|x| Step::new(x, Curvature::Negative))
            }
            Err(other) => Err(other),
        };
        self.left = step.as_ref().ok().and_then(|step| step.changes_left.clone());
        report.add_linear(self.solver, &work);
        report.unassembled += usize::from(step.is_ok() && system.products.is_some());
        step.map(|step| (self.extended(step.x), step.curvature))
    }

    /// Sets the expected changes of volume of the next [steps](Self::step), by quadrature point.
    pub fn expect_changes(&mut self, changes: Option<Vec<f64>>) {
        self.expected = changes;
    }

    /// By volume mode, the difference between pressures and changes of volume of the last step ([`Step::changes_left`]).
    pub fn changes_left(&self) -> Option<&[f64]> {
        self.left.as_deref()
    }

    /// Drops the preconditioners of earlier tangents.
    pub fn forget(&mut self) {
        self.solver.clear();
    }

    /// Sets nodes that depend on others to their dependent values.
    fn extended(&self, mut x: Vec<f64>) -> Vec<f64> {
        self.model.supports.extend(&mut x);
        x
    }

    /// A descent direction where the tangent is not positive definite.
    pub fn shifted_step<'m>(
        &mut self,
        tangent: impl Into<TangentRef<'m>>,
        u: &[f64],
        rhs: &[f64],
        report: &mut SolveReport,
    ) -> Result<Vec<f64>, LinearError> {
        self.left = None;
        let configuration = Deformed::new(self.model, u, self.controls, self.parallel);
        let mut work = LinearWork::default();
        let step = self.shift.step(self.solver, &configuration.system(tangent.into()), rhs, &mut work);
        report.add_linear(self.solver, &work);
        step.map(|x| self.extended(x))
    }

    /// `K x = b` with a tangent at u whose supports are eliminated; it may be indefinite.
    pub fn solve(
        &mut self,
        matrix: &SparseMatrix,
        u: &[f64],
        b: &[f64],
        report: &mut SolveReport,
    ) -> Result<Vec<f64>, LinearError> {
        self.solve_to(FULL_STEP, matrix, u, b, Transposition::No, report)
    }

    /// `K^T x = b` for several right-hand sides, with the present tangent at u; it may be indefinite.
    pub fn solve_transposed(
        &mut self,
        mut matrix: SparseMatrix,
        u: &[f64],
        rhs: &[&[f64]],
        report: &mut SolveReport,
    ) -> Result<Vec<Vec<f64>>, LinearError> {
        eliminate(self.model, &mut matrix);
        rhs.iter().map(|b| self.solve_to(EXACT, &matrix, u, b, Transposition::Yes, report)).collect()
    }

    /// `K x = b` or `K^T x = b` with a tangent at u whose supports are eliminated, to an accuracy; it may be indefinite.
    pub fn solve_to<'m>(
        &mut self,
        accuracy: Accuracy,
        tangent: impl Into<TangentRef<'m>>,
        u: &[f64],
        b: &[f64],
        transposition: Transposition,
        report: &mut SolveReport,
    ) -> Result<Vec<f64>, LinearError> {
        Ok(self.solution(accuracy, tangent.into(), u, b, transposition, report)?.x)
    }

    fn solution(
        &mut self,
        accuracy: Accuracy,
        tangent: TangentRef,
        u: &[f64],
        b: &[f64],
        transposition: Transposition,
        report: &mut SolveReport,
    ) -> Result<Solution, LinearError> {
        let configuration = Deformed::new(self.model, u, self.controls, self.parallel);
        let system = System { transposed: transposition == Transposition::Yes, ..configuration.system(tangent) };
        let mut work = LinearWork::default();
        let solution = self.solver.solve(&system, b, accuracy, &mut work);
        report.add_linear(self.solver, &work);
        solution.map(|Solution { x, negative }| Solution { x: self.extended(x), negative })
    }

    /// `K x = b` with a symmetric tangent by products of cells, whose moduli are rounded: corrected by the residual of K as the product `exact`, zero on the supports,
    /// until the last correction shows that the error is below `accuracy.error` in the energy norm.
    ///
    /// # Errors
    /// [`LinearError::Singular`] where corrections do not shrink; [`LinearError::NoEntries`].
    pub fn solve_corrected(
        &mut self,
        accuracy: Accuracy,
        tangent: &Tangent,
        exact: &dyn Operator,
        u: &[f64],
        b: &[f64],
        report: &mut SolveReport,
    ) -> Result<Vec<f64>, LinearError> {
        let space = self.model.unknowns();
        let (mut x, mut rest, mut before) = (vec![0.0; b.len()], b.to_vec(), f64::INFINITY);
        // two solutions that leave the root of the error each
        let rounded = Accuracy { residual: MIN_CORRECTED_RESIDUAL.max(0.3 * accuracy.error.sqrt()), ..accuracy };
        for _ in 0..=MAX_CORRECTIONS {
            let dx = self.solve_to(rounded, tangent, u, &rest, Transposition::No, report)?;
            // |dx|_K, and the next one by the ratio to the one before
            let size = space.dot(&dx, &rest).max(0.0).sqrt();
            axpy(1.0, &dx, &mut x);
            exact.apply(&x, &mut rest);
            rest.iter_mut().zip(b).for_each(|(r, b)| *r = b - *r);
            let left = if before.is_finite() { size * size / before } else { size };
            let is_exact = left <= accuracy.error * space.dot(&x, b).max(0.0).sqrt();
            if is_exact || space.norm(&rest) <= accuracy.residual * space.norm(b) {
                report.unassembled += 1;
                return Ok(x);
            }
            // also where a contribution has no product
            if !space.norm(&rest).is_finite() || size.is_nan() || size >= before {
                break;
            }
            before = size;
        }
        Err(LinearError::Singular { residual: space.norm(&rest) / space.norm(b), wanted: accuracy.residual })
    }

    /// `K x = b` with a tangent at u whose supports are eliminated, which is to be positive definite, to a relative residual of 1e-12;
    /// preconditioners of earlier systems are not used.
    ///
    /// # Errors
    /// [`LinearError::Indefinite`].
    pub fn solve_definite(
        &mut self,
        matrix: &SparseMatrix,
        u: &[f64],
        b: &[f64],
        report: &mut SolveReport,
    ) -> Result<Vec<f64>, LinearError> {
        let configuration = Deformed::new(self.model, u, self.controls, self.parallel);
        let mut work = LinearWork::default();
        let solved = self.solver.solve_definite(&configuration.system(matrix.into()), b, Definite::Once, &mut work);
        report.add_linear(self.solver, &work);
        let mut x = solved?;
        let mut rest = vec![0.0; b.len()];
        configuration.system(matrix.into()).multiply(&x, &mut rest);
        rest.iter_mut().zip(b).for_each(|(r, b)| *r = b - *r);
        // for multigrid, which shows at a coarser residual that a matrix is definite
        if self.model.unknowns().norm(&rest) > MAX_UNCORRECTED_RESIDUAL * self.model.unknowns().norm(b) {
            let correction = self.solution(EXACT, matrix.into(), u, &rest, Transposition::No, report)?;
            if correction.negative.is_some_and(|negative| negative > 0) {
                return Err(LinearError::Indefinite { quotient: None });
            }
            x.iter_mut().zip(&correction.x).for_each(|(x, c)| *x += c);
        }
        Ok(self.extended(x))
    }

    /// Factorises a tangent at u whose supports are eliminated, for several solutions with it.
    pub fn prepare<'m>(
        &mut self,
        tangent: impl Into<TangentRef<'m>>,
        u: &[f64],
        report: &mut SolveReport,
    ) -> Result<(), LinearError> {
        let configuration = Deformed::new(self.model, u, self.controls, self.parallel);
        let mut work = LinearWork::default();
        let prepared = self.solver.prepare(&configuration.system(tangent.into()), &mut work);
        report.add_linear(self.solver, &work);
        prepared
    }

    /// `[K B; C^T D] [x; y] = [f; g]`, K a tangent at u whose supports are eliminated; it may be indefinite and nearly
    /// singular.
    pub fn solve_bordered(
        &mut self,
        matrix: &SparseMatrix,
        u: &[f64],
        border: &Border,
        rhs: (&[f64], &[f64]),
        report: &mut SolveReport,
    ) -> Result<(Vec<f64>, Vec<f64>), LinearError> {
        let configuration = Deformed::new(self.model, u, self.controls, self.parallel);
        let system = configuration.system(matrix.into());
        let mut work = LinearWork::default();
        let found = solve_bordered(self.solver, &system, border, rhs, FULL_STEP, &mut work);
        report.add_linear(self.solver, &work);
        found.map(|found| (self.extended(found.x), found.y))
    }

    /// The same, or with `K^T`, for several right-hand sides and a K that is [prepared](Self::prepare), and the number of negative eigenvalues of the whole. K is counted
    /// by the factor that solves; multigrid solves positive definite matrices alone.
    pub fn eliminate_border(
        &mut self,
        (matrix, transposed): (&SparseMatrix, bool),
        u: &[f64],
        border: &Border,
        rhs: &[(Vec<f64>, Vec<f64>)],
        accuracy: Accuracy,
        report: &mut SolveReport,
    ) -> Result<Counted<BorderedSolution>, LinearError> {
        let configuration = Deformed::new(self.model, u, self.controls, self.parallel);
        let system = System { transposed, ..configuration.system(matrix.into()) };
        let scalars = border.columns.len();
        let mut work = LinearWork::default();
        let mut solve = || {
            let elimination = BlockElimination::new(self.solver, &system, border, accuracy, &mut work)?;
            let of_border = elimination.negative();
            let mut solve = |(f, g): &(Vec<f64>, Vec<f64>)| elimination.solve(self.solver, &system, f, g, &mut work);
            let solved = rhs.iter().map(&mut solve).collect::<Result<Vec<BorderedSolution>, _>>();
            let solved = solved.map_err(|error| match (error.is_singular(), of_border) {
                (true, None) => LinearError::Border { scalars },
                _ => error,
            })?;
            let uncounted = LinearError::NotCounted { solver: self.solver.state().name };
            let of_matrix = solved.last().and_then(|solution| solution.negative).ok_or(uncounted);
            let extended = |own: BorderedSolution| BorderedSolution { x: self.extended(own.x), ..own };
            let solved = solved.into_iter().map(extended).collect();
            let negative =
                of_matrix.and_then(|of_matrix| Ok(of_matrix + of_border.ok_or(LinearError::Border { scalars })?));
            Ok(Counted { solved, negative })
        };
        let solved = solve();
        report.add_linear(self.solver, &work);
        solved
    }

    /// Negative eigenvalues of `[K B; B^T D]`, K a tangent at u whose supports are eliminated.
    pub fn bordered_inertia(
        &mut self,
        matrix: &SparseMatrix,
        u: &[f64],
        border: &Border,
        report: &mut SolveReport,
    ) -> Result<Inertia, LinearError> {
        let configuration = Deformed::new(self.model, u, self.controls, self.parallel);
        let system = configuration.system(matrix.into());
        let Inertia { negative: of_matrix, by_factor } = inertia(self.solver, &system)?;
        let mut work = LinearWork::default();
        let elimination = BlockElimination::new(self.solver, &system, border, FULL_STEP, &mut work);
        report.add_linear(self.solver, &work);
        let scalars = border.columns.len();
        let of_border = elimination?.negative().ok_or(LinearError::Border { scalars })?;
        Ok(Inertia { negative: of_matrix + of_border, by_factor })
    }

    /// `K x = b` with the symmetric tangent at u as a product, zero on the supports, and the preconditioner held, if it
    /// converges within a number of iterations; `None` otherwise.
    pub fn solve_by_products(
        &mut self,
        product: &dyn Operator,
        u: &[f64],
        b: &[f64],
        accuracy: Accuracy,
        most: usize,
        report: &mut SolveReport,
    ) -> Option<Vec<f64>> {
        let configuration = Deformed::new(self.model, u, self.controls, self.parallel);
        let empty = self.model.matrix_without_values();
        let mut work = LinearWork::default();
        let x = self.solver.solve_by_products(
            product,
            &configuration.system((&empty).into()),
            b,
            accuracy,
            most,
            &mut work,
        );
        report.add_linear(self.solver, &work);
        x
    }

    /// Whether products of cells may replace the entries of a tangent.
    pub fn takes_products(&self) -> bool {
        self.solver.state().takes_products
    }

    /// Negative eigenvalues of a tangent whose supports are eliminated, and whether a factor shows them.
    pub fn inertia(&mut self, tangent: &Tangent, u: &[f64]) -> Result<Inertia, LinearError> {
        let configuration = Deformed::new(self.model, u, self.controls, self.parallel);
        inertia(self.solver, &configuration.system(tangent.into()))
    }
}

/// Number of negative eigenvalues of a matrix; refused by a solver that does not count them.
fn inertia(solver: &mut dyn LinearSolver, system: &System) -> Result<Inertia, LinearError> {
    solver.inertia(system)?.ok_or(LinearError::NotCounted { solver: solver.state().name })
}

/// Rows and columns of supported unknowns and of nodes that depend on others become those of a multiple of the identity.
pub(crate) fn eliminate(model: &Model, matrix: &mut SparseMatrix) {
    let diagonal = matrix.diagonal().iter().fold(0.0, |m: f64, d| m.max(d.abs()));
    let diagonal = if diagonal > 0.0 && diagonal.is_finite() { diagonal } else { 1.0 };
    matrix.tie(model.supports.ties(), diagonal);
    matrix.eliminate(model.supports.fixed(), diagonal);
}

/// The displaced body, as linear solvers see it; what they may not need is made when they ask.
pub(crate) struct Deformed<'a> {
    model: &'a Model,
    /// The displacement.
    u: Cow<'a, [f64]>,
    controls: &'a Controls,
    parallel: bool,
    rotations: OnceLock<Arc<Rotations>>,
    positions: OnceLock<Vec<[f64; 3]>>,
    volume_modes: OnceLock<Option<VolumeModes>>,
    maxima: OnceLock<Vec<bool>>,
    /// Changes of volume that a solution is expected to have, by quadrature point.
    expected: Option<&'a [f64]>,
}

impl<'a> Deformed<'a> {
    pub fn new(model: &'a Model, u: &'a [f64], controls: &'a Controls, parallel: bool) -> Self {
        Deformed {
            model,
            u: model.displacement(u),
            controls,
            parallel,
            rotations: OnceLock::new(),
            positions: OnceLock::new(),
            volume_modes: OnceLock::new(),
            maxima: OnceLock::new(),
            expected: None,
        }
    }

    pub fn system<'s>(&'s self, tangent: TangentRef<'s>) -> System<'s> {
        let (TangentRef { matrix, products }, fixed) = (tangent, self.model.supports.fixed());
        System { matrix, products, fixed, configuration: self, transposed: false, parallel: self.parallel }
    }
}

impl Configuration for Deformed<'_> {
    fn positions(&self) -> &[[f64; 3]] {
        self.positions.get_or_init(|| {
            let disc = self.model.discretization();
            let mut points = disc.mesh().points().to_vec();
            for (x, u) in points.iter_mut().zip(self.u.chunks_exact(disc.dim())) {
                x.iter_mut().zip(u).for_each(|(x, u)| *x += u);
            }
            points
        })
    }

    fn rotations(&self) -> &Arc<Rotations> {
        let make = || Arc::new(nodal_rotations(self.model.discretization(), &self.u, self.parallel));
        self.rotations.get_or_init(make)
    }

    fn corners(&self) -> Option<&Corners> {
        self.model.discretization().corners()
    }

    fn space(&self) -> &Space {
        self.model.unknowns()
    }

    fn maxima(&self) -> &[bool] {
        self.maxima.get_or_init(|| self.model.maxima())
    }

    fn volume_modes(&self) -> Option<&VolumeModes> {
        let make = || self.model.volume_modes(&self.u, self.controls, self.expected, self.parallel);
        self.volume_modes.get_or_init(make).as_ref()
    }
}
