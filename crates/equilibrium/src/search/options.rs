//! [`SolveOptions`]: options of a solve.

use nastic_body::state::{SolveReport, State};
use nastic_body::strategy::{Strategies, Strategy};
use nastic_linear::SolverFactory;
use std::fmt;
use std::sync::atomic::{AtomicBool, Ordering};

/// How to solve, with an explicit warm start. The default needs no tuning.
#[derive(Clone)]
pub struct SolveOptions<'a> {
    /// Start from this state (its controls and load are where the path begins); one of another body is an error. Default: from
    /// rest.
    pub near: Option<&'a State>,
    /// A guess of the equilibrium, flat displacements, from which the first attempt begins; if that fails, the solve is the
    /// same as without it. Another length than that of the body's displacements is an error.
    pub guess: Option<&'a [f64]>,
    /// The solver of tangent systems: a row of [`Solver::CATALOGUE`](nastic_linear::Solver::CATALOGUE), or a user's factory. Default:
    /// that of the body (`Solid::solver`), or the choice of [`Solver::cheaper`](nastic_linear::Solver::cheaper).
    pub solver: Option<&'a dyn SolverFactory>,
    /// Residual, relative to the norm of the summed absolute element forces of laws, actuations and loads. Where obstacles move, intermediate equilibria
    /// meet 1e-7, also the last one in an error.
    pub accuracy: f64,
    /// Newton iterations of a descent per load step. If they do not converge, up to 40 with independent strains at the quadrature
    /// points follow, and a further descent from their result. Nearly incompressible bodies use these strains after twelve iterations, or
    /// at once where prescribed components move, as do constrained bodies.
    pub max_newton: usize,
    /// Newton iterations of the whole solve, those of abandoned load steps and of the way from rest included. A solve that reaches this limit fails with
    /// [`StateError::NoConvergence`](nastic_body::error::StateError) and this `budget`, without further attempts; a path stops. Default: no limit.
    pub budget: Option<usize>,
    /// Compute cells and factors on all threads; `false` inside parallelism over scenarios.
    pub parallel: bool,
    /// Strategies beside Newton's method on the displacement; they can be switched off to measure the effect of each.
    pub strategies: Strategies,
    /// Checked between iterations; if it is true the solve stops with [`StateError::Cancelled`](nastic_body::error::StateError).
    pub cancel: Option<&'a AtomicBool>,
    /// Called after every Newton iteration.
    pub watch: Option<&'a (dyn Fn(&Progress) + Sync)>,
}

/// Progress of a solve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// Fraction of the way from the starting state that is being tried.
    pub load: f64,
    /// Newton iterations so far.
    pub newton: usize,
    /// Relative residual.
    pub residual: f64,
    /// Step length of the last iteration.
    pub step: f64,
    /// Total potential.
    pub energy: f64,
}

impl Default for SolveOptions<'_> {
    fn default() -> Self {
        SolveOptions {
            near: None,
            guess: None,
            solver: None,
            accuracy: 1e-11,
            max_newton: 60,
            budget: None,
            parallel: true,
            strategies: Strategies::ALL,
            cancel: None,
            watch: None,
        }
    }
}

impl<'a> SolveOptions<'a> {
    /// A request that starts from a state.
    pub fn near(state: &'a State) -> Self {
        SolveOptions { near: Some(state), ..SolveOptions::default() }
    }

    /// Whether this number of Newton iterations reaches the budget.
    pub(crate) fn is_spent(&self, newton: usize) -> bool {
        self.budget.is_some_and(|budget| newton >= budget)
    }

    /// Whether a strategy may be tried; the attempt is counted.
    pub(crate) fn tries(&self, strategy: Strategy, report: &mut SolveReport) -> bool {
        let may = self.strategies.has(strategy);
        if may {
            report.strategies.count(strategy);
        }
        may
    }

    pub(crate) fn cancelled(&self) -> bool {
        self.cancel.is_some_and(|flag| flag.load(Ordering::Relaxed))
    }
}

impl fmt::Debug for SolveOptions<'_> {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.debug_struct("SolveOptions")
            .field("near", &self.near.is_some())
            .field("guess", &self.guess.is_some())
            .field("solver", &self.solver)
            .field("accuracy", &self.accuracy)
            .field("max_newton", &self.max_newton)
            .field("budget", &self.budget)
            .field("parallel", &self.parallel)
            .field("strategies", &self.strategies)
            .finish()
    }
}
