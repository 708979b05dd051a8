//! [`LinearSolver`]: the interface of all solvers of tangent systems.

mod bordered;
mod direct;
mod error;
mod factor_reuse;
mod factory;
mod fallback;
mod general;
mod joining;
mod lu;
mod multigrid;
mod settled;
mod shift;
mod system;

pub use bordered::{BlockElimination, Border, BorderedSolution, solve_bordered};
pub use direct::Direct;
pub use error::LinearError;
pub use factory::{Solver, SolverFactory};
pub use fallback::MultigridOrDirect;
pub use general::General;
pub use joining::Joining;
pub use lu::Lu;
pub use multigrid::MultigridSolver;
pub use shift::Shift;
pub use system::{Configuration, System};

use crate::factor::structure::Structure;
use crate::pattern::operator::Operator;
use std::fmt::Debug;
use std::sync::Arc;

/// The accuracy of a solution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Accuracy {
    /// `|x - A^-1 b|_A <= error |A^-1 b|_A`, `|v|_A^2 = v . A v`, where conjugate gradients with a factor estimate the error.
    pub error: f64,
    /// `|b - A x| <= residual |b|`, Euclidean, for all other methods.
    pub residual: f64,
}

/// The curvature of the matrix as seen by the computation of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Curvature {
    /// Positive in every direction: the step is Newton's step, a descent direction.
    Positive,
    /// Negative in some direction; the step is the last iterate before this direction, a descent direction. Dembo, Steihaug,
    /// "Truncated-Newton algorithms for large-scale unconstrained optimization", Math. Programming 26 (1983).
    CutShort,
    /// Negative in some direction; the step is Newton's step, which may be an ascent direction and lead to a saddle.
    Negative,
}

/// A Newton step.
#[derive(Clone, Debug, PartialEq)]
pub struct Step {
    /// The step.
    pub x: Vec<f64>,
    /// The curvature of the matrix.
    pub curvature: Curvature,
    /// A Rayleigh quotient `p . A p / p . p` that is not positive, if one was found.
    pub quotient: Option<f64>,
    /// By [volume mode](crate::VolumeModes), the difference `b . x - p / c` where the pressures p are unknowns; the residual of the step is
    /// without these differences. `None` where the pressures follow from x.
    pub changes_left: Option<Vec<f64>>,
}

impl Step {
    /// A step without a quotient and without pressures.
    pub fn new(x: Vec<f64>, curvature: Curvature) -> Self {
        Step { x, curvature, quotient: None, changes_left: None }
    }
}

/// The solution of a system.
#[derive(Clone, Debug, PartialEq)]
pub struct Solution {
    /// The unknowns.
    pub x: Vec<f64>,
    /// Negative eigenvalues of the matrix beyond one for each unknown by which the potential has a [maximum](Configuration::maxima), where what solved it
    /// shows them.
    pub negative: Option<usize>,
}

/// Which matrices a test for positive definiteness is applied to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Definite {
    /// A single matrix: nothing of it is held for later.
    Once,
    /// One of several matrices that differ by multiples of the identity: with lower accuracy, and reuse between them.
    Shifted,
}

/// The state of a solver.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SolverState {
    /// The name of the present method: that of its [`SolverFactory`], or of the method that it fell back on.
    pub name: &'static str,
    /// Whether it accepts systems with [products](System::products) instead of entries; it may still need entries later
    /// ([`LinearError::NoEntries`]).
    pub takes_products: bool,
    /// Memory that it holds, in bytes.
    pub bytes: usize,
}

/// Number of eigenvalues of either sign.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Inertia {
    /// Negative eigenvalues beyond one for each unknown by which the potential has a [maximum](Configuration::maxima): 0 of a positive definite matrix.
    pub negative: usize,
    /// Whether a factor proves it, by its pivots or as preconditioner of conjugate gradients; otherwise conjugate gradients from a random vector met no negative curvature.
    pub by_factor: bool,
}

/// Counts of the work done.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LinearWork {
    /// Numeric factorisations.
    pub factorisations: usize,
    /// Steps found with a factor or a multigrid hierarchy kept from earlier.
    pub reused: usize,
    /// Back substitutions, one for each iteration with a factor as preconditioner.
    pub back_substitutions: usize,
    /// Multigrid hierarchies built.
    pub hierarchies: usize,
    /// Multigrid cycles.
    pub cycles: usize,
    /// Shifts of an indefinite matrix.
    pub shifted: usize,
}

/// Solves the systems of successive nonlinear solves on one mesh, and holds preconditioners for the next system.
///
/// Matrices change from call to call, their pattern does not ([`Joining`] accepts blocks outside of it). Results depend on earlier calls only within the accuracy asked for;
/// the same calls in the same order give the same bits.
///
/// Rows of eliminated unknowns ([`System::fixed`]) have their diagonal alone, and must be solved exactly, `x_i = b_i / A_ii`: an error there would move
/// supports without an effect on the residual.
pub trait LinearSolver: CloneSolver + Debug + Send + Sync {
    /// Its state.
    fn state(&self) -> SolverState;

    /// Begins another nonlinear solve: counts that decide about new factors are reset, preconditioners are held.
    fn restart(&mut self);

    /// Drops all preconditioners.
    fn clear(&mut self);

    /// Prepares several solutions with this matrix: factorises it.
    ///
    /// # Errors
    /// A matrix that cannot be factorised.
    fn prepare(&mut self, system: &System, work: &mut LinearWork) -> Result<(), LinearError>;

    /// A Newton step `A x = b` to a relative residual of about `tolerance`; it may stop early at negative curvature, which
    /// [`Step::curvature`] reports.
    ///
    /// # Errors
    /// [`LinearError::Indefinite`] where the solver finds no step in a matrix that is not positive definite.
    fn step(&mut self, system: &System, b: &[f64], tolerance: f64, work: &mut LinearWork) -> Result<Step, LinearError>;

    /// `A x = b`, of a [transposed](System::transposed) system `A^T x = b`; A may be indefinite.
    ///
    /// # Errors
    /// A matrix that is singular to working precision, or that this solver does not support.
    fn solve(
        &mut self,
        system: &System,
        b: &[f64],
        accuracy: Accuracy,
        work: &mut LinearWork,
    ) -> Result<Solution, LinearError>;

    /// `A x = b` with A as a product alone and the preconditioner held, if `most` iterations suffice; `None` otherwise.
    fn solve_by_products(
        &mut self,
        _product: &dyn Operator,
        _at: &System,
        _b: &[f64],
        _accuracy: Accuracy,
        _most: usize,
        _work: &mut LinearWork,
    ) -> Option<Vec<f64>> {
        None
    }

    /// `A x = b` if A is positive definite, by the unknowns that are left once those by which the potential has a [maximum](Configuration::maxima) are
    /// eliminated.
    ///
    /// # Errors
    /// [`LinearError::Indefinite`] where it is not; as [`solve`](Self::solve).
    fn solve_definite(
        &mut self,
        system: &System,
        b: &[f64],
        which: Definite,
        work: &mut LinearWork,
    ) -> Result<Vec<f64>, LinearError>;

    /// Counts negative eigenvalues; `None` where this solver cannot.
    ///
    /// # Errors
    /// A matrix that is singular to working precision, or not symmetric.
    fn inertia(&mut self, _system: &System) -> Result<Option<Inertia>, LinearError> {
        Ok(None)
    }

    /// A solver of the same kind for matrices of another structure, without preconditioners; the method that it fell back on stays.
    fn anew(&self, structure: &Arc<Structure>) -> Box<dyn LinearSolver>;
}

/// A solver that can be copied with its preconditioners: every [`LinearSolver`] that is `Clone`.
pub trait CloneSolver {
    /// The copy.
    fn boxed_clone(&self) -> Box<dyn LinearSolver>;
}

impl<S: LinearSolver + Clone + 'static> CloneSolver for S {
    fn boxed_clone(&self) -> Box<dyn LinearSolver> {
        Box::new(self.clone())
    }
}

impl Clone for Box<dyn LinearSolver> {
    fn clone(&self) -> Self {
        (**self).boxed_clone()
    }
}
