//! [`SolveOptions`]: how an equilibrium is to be found.

use nastic_body::state::{SolveReport, State};
use nastic_body::strategy::{Strategies, Strategy};
use nastic_linear::SolverFactory;
use std::fmt;
use std::sync::atomic::{AtomicBool, Ordering};

/// How to solve: warm starts are handed in here, explicitly. The default needs no tuning.
#[derive(Clone)]
pub struct SolveOptions<'a> {
    /// Start from this state (its controls and load are where the path begins); one of another body is an error. Default: from
    /// rest.
    pub near: Option<&'a State>,
    /// A guess of the equilibrium, flat displacements, from which the first attempt begins; where that leads nowhere, it
    /// is as if none had been given. Another length than that of the body's displacements is an error.
    pub guess: Option<&'a [f64]>,
    /// By what tangent systems are solved: a row of [`Solver::CATALOGUE`](nastic_linear::Solver::CATALOGUE), or a factory of your own. Default:
    /// that of the body (`Solid::solver`), or what [`Solver::cheaper`](nastic_linear::Solver::cheaper) expects to be cheaper.
    pub solver: Option<&'a dyn SolverFactory>,
    /// Residual wanted, relative to the norm of the summed absolute element forces of laws, actuations and loads. Equilibria on the way there meet 1e-7
    /// where obstacles move, also those that an error gives as the last ones found.
    pub accuracy: f64,
    /// Newton iterations allowed downhill per load step; where that many lead nowhere, up to 40 with strains of their own at the
    /// quadrature points follow, and as many as downhill from where these arrive. Nearly incompressible bodies turn to these after twelve,
    /// where prescribed components move them at once, as under constraints.
    pub max_newton: usize,
    /// Newton iterations allowed in all, those of abandoned load steps and of the way from rest included; a solve that has used them up ends with
    /// [`StateError::NoConvergence`](nastic_body::error::StateError), whose `budget` they are, and no other way is tried; a path ends where it stands. Default: no limit.
    pub budget: Option<usize>,
    /// Compute cells and factors on all threads; `false` inside parallelism over scenarios.
    pub parallel: bool,
    /// What may be tried beside Newton's method on the displacement; fewer for those who measure what each is worth.
    pub strategies: Strategies,
    /// Checked between iterations; when it turns true the solve ends with [`StateError::Cancelled`](nastic_body::error::StateError).
    pub cancel: Option<&'a AtomicBool>,
    /// Called after every Newton iteration.
    pub watch: Option<&'a (dyn Fn(&Progress) + Sync)>,
}

/// Where a solve stands.
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

    /// Whether so many Newton iterations are all that were allowed.
    pub(crate) fn is_spent(&self, newton: usize) -> bool {
        self.budget.is_some_and(|budget| newton >= budget)
    }

    /// Whether a strategy may be tried, which is counted then.
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
