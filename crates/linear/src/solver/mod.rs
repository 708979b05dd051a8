//! [`LinearSolver`]: tangent systems, whatever solves them.

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

/// How exact a solution has to be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Accuracy {
    /// `|x - A^-1 b|_A <= error |A^-1 b|_A`, `|v|_A^2 = v . A v`: where conjugate gradients with a factor estimate it.
    pub error: f64,
    /// `|b - A x| <= residual |b|`, Euclidean: everywhere else.
    pub residual: f64,
}

/// What the matrix turned out to be on the way to a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Curvature {
    /// Positive in every direction that was met: the step is Newton's, downhill.
    Positive,
    /// Negative in some direction; the step is the part of Newton's found before that, downhill. Dembo, Steihaug,
    /// "Truncated-Newton algorithms for large-scale unconstrained optimization", Math. Programming 26 (1983).
    CutShort,
    /// Negative in some direction; the step is Newton's and may lead to a saddle, uphill.
    Negative,
}

/// A Newton step.
#[derive(Clone, Debug, PartialEq)]
pub struct Step {
    /// The step.
    pub x: Vec<f64>,
    /// What the matrix turned out to be.
    pub curvature: Curvature,
    /// A quotient `p . A p / p . p` that is not positive, where one was met.
    pub quotient: Option<f64>,
    /// By [volume mode](crate::VolumeModes), `b . x - p / c` where the pressures p are unknowns that did not become those of its changes; the forces
    /// that it leaves are those without these differences. `None` where the pressures follow from x.
    pub changes_left: Option<Vec<f64>>,
}

impl Step {
    /// One of which nothing else is known.
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

/// Which matrices are to be shown to be positive definite.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Definite {
    /// One that does not come again: nothing is kept of it.
    Once,
    /// One of several that differ by multiples of the identity: coarsely, and with what serves of another one.
    Shifted,
}

/// What a solver is at the moment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SolverState {
    /// The name of what solves now: that of its [`SolverFactory`], or of what it fell back on.
    pub name: &'static str,
    /// Whether it takes systems with [products](System::products) in the place of entries; it may turn out to need entries on the way
    /// ([`LinearError::NoEntries`]).
    pub takes_products: bool,
    /// Memory of what is kept.
    pub bytes: usize,
}

/// Number of eigenvalues of either sign.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Inertia {
    /// Negative eigenvalues beyond one for each unknown by which the potential has a [maximum](Configuration::maxima): 0 of a positive definite matrix.
    pub negative: usize,
    /// Whether a factor shows it, by its pivots or by conjugate gradients with it; else these had none and met no negative curvature from scattered numbers, which is no proof.
    pub by_factor: bool,
}

/// What was done, in counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LinearWork {
    /// Numeric factorisations.
    pub factorisations: usize,
    /// Steps found with a factor or a multigrid hierarchy kept from earlier.
    pub reused: usize,
    /// Back substitutions, each iteration with a factor as preconditioner counting one.
    pub back_substitutions: usize,
    /// Multigrid hierarchies built.
    pub hierarchies: usize,
    /// Multigrid cycles.
    pub cycles: usize,
    /// Shifts of an indefinite matrix.
    pub shifted: usize,
}

/// Solves the systems of nonlinear solves that follow each other on one mesh, and keeps what serves the next one.
///
/// Matrices change from call to call, their pattern does not ([`Joining`] takes those with blocks beyond it). Results depend on what was kept within the accuracy asked;
/// the same calls in the same order give the same bits.
///
/// Rows of eliminated unknowns ([`System::fixed`]) have their diagonal alone, and are to be solved exactly, `x_i = b_i / A_ii`: what an iteration leaves there moves
/// supports, within its tolerance and unseen by the residual.
pub trait LinearSolver: CloneSolver + Debug + Send + Sync {
    /// What it is now.
    fn state(&self) -> SolverState;

    /// Begins another nonlinear solve: counts that decide about new factors start again, what is kept stays.
    fn restart(&mut self);

    /// Drops what is kept.
    fn clear(&mut self);

    /// Makes ready for several solutions with this matrix: factorises it.
    ///
    /// # Errors
    /// A matrix that cannot be factorised.
    fn prepare(&mut self, system: &System, work: &mut LinearWork) -> Result<(), LinearError>;

    /// A Newton step `A x = b` to a relative residual of about `tolerance`; it may end early where the curvature turns
    /// negative, which the answer shows.
    ///
    /// # Errors
    /// [`LinearError::Indefinite`] where the solver finds no step in a matrix that is not positive definite.
    fn step(&mut self, system: &System, b: &[f64], tolerance: f64, work: &mut LinearWork) -> Result<Step, LinearError>;

    /// `A x = b`, of a [transposed](System::transposed) system `A^T x = b`; A may be indefinite.
    ///
    /// # Errors
    /// A matrix that is singular to working precision, or that this solver does not take.
    fn solve(
        &mut self,
        system: &System,
        b: &[f64],
        accuracy: Accuracy,
        work: &mut LinearWork,
    ) -> Result<Solution, LinearError>;

    /// `A x = b` with A as a product alone, where what is kept is good enough for `most` iterations; `None` where it is not.
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

    /// One of its kind for matrices of another structure, with nothing kept; what it fell back on stays.
    fn anew(&self, structure: &Arc<Structure>) -> Box<dyn LinearSolver>;
}

/// A solver that can be copied with what it keeps: every [`LinearSolver`] that is `Clone`.
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
