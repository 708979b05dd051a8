//! [`SolverFactory`]: what solves tangent systems, behind a name, and how that is chosen.

use super::{Direct, General, LinearSolver, Lu, MultigridOrDirect};
use crate::factor::factor_size::fits;
use crate::factor::structure::Structure;
use crate::pattern::matrix::Symmetry;
use crate::pattern::multigrid_work::multigrid_flops;
use std::fmt;
use std::sync::Arc;

/// Makes the linear solvers of one kind. Those of this crate are in [`Solver::CATALOGUE`]; a crate of your own implements it for
/// its own solver and hands it to the solve.
pub trait SolverFactory: fmt::Debug + Send + Sync {
    /// What reports call it. Two factories of one name count as the same: what was kept of a solver of one serves the other.
    fn name(&self) -> &'static str;

    /// What it does, in one sentence.
    fn about(&self) -> &'static str;

    /// The most general matrices that its solvers take.
    fn takes(&self) -> Symmetry;

    /// Whether its solvers take systems of a body that several ranks have, whose matrix is the sum of theirs: right-hand sides and solutions are
    /// [whole](crate::Share), every rank has its own cells' share of the matrix.
    fn spans_ranks(&self) -> bool {
        false
    }

    /// A solver for matrices of a structure.
    fn make(&self, structure: &Arc<Structure>) -> Box<dyn LinearSolver>;
}

impl PartialEq for dyn SolverFactory + '_ {
    fn eq(&self, other: &Self) -> bool {
        self.name() == other.name()
    }
}

impl fmt::Display for dyn SolverFactory + '_ {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// A row of the catalogue of solvers.
#[derive(Debug)]
pub struct Solver {
    name: &'static str,
    about: &'static str,
    takes: Symmetry,
    make: fn(&Arc<Structure>) -> Box<dyn LinearSolver>,
}

impl Solver {
    /// A sparse factor of the tangent.
    pub const DIRECT: &'static dyn SolverFactory = &Solver {
        name: "direct",
        about: "a sparse factor of the tangent, kept as preconditioner of conjugate gradients while it serves",
        takes: Symmetry::Symmetric,
        make: |structure| Box::new(Direct::new(structure.clone())),
    };
    /// Conjugate gradients with [`Multigrid`](crate::Multigrid).
    pub const MULTIGRID: &'static dyn SolverFactory = &Solver {
        name: "multigrid",
        about: "conjugate gradients with multigrid, memory and time in proportion to the unknowns; a factor where that fails and a factor fits",
        takes: Symmetry::Symmetric,
        make: |structure| Box::new(MultigridOrDirect::new(structure.clone())),
    };
    /// GMRES, for matrices that are not symmetric.
    pub const GENERAL: &'static dyn SolverFactory = &Solver {
        name: "general",
        about: "GMRES with a factor of the symmetric part, or where that does not converge with an LU factorisation",
        takes: Symmetry::General,
        make: |structure| Box::new(General::new(structure.clone())),
    };
    /// A sparse LU factorisation.
    pub const LU: &'static dyn SolverFactory = &Solver {
        name: "lu",
        about: "a sparse LU factorisation with partial pivoting, kept as preconditioner of GMRES while it serves",
        takes: Symmetry::General,
        make: |structure| Box::new(Lu::new(structure.clone())),
    };

    /// All of them.
    pub const CATALOGUE: [&'static dyn SolverFactory; 4] =
        [Solver::DIRECT, Solver::MULTIGRID, Solver::GENERAL, Solver::LU];

    /// That of a name.
    pub fn named(name: &str) -> Option<&'static dyn SolverFactory> {
        Solver::CATALOGUE.into_iter().find(|factory| factory.name() == name)
    }

    /// The solver for a body that asks for none, from counts alone: the factor while it has at most 8 GiB, and at most
    /// three times the cost that multigrid is expected to have.
    ///
    /// The costs compared are the operations of one factorisation, and 400 passes over both triangles of the tangent at
    /// 19 operations per entry. docs/development/large-bodies.md has the measurements behind these numbers.
    pub fn cheaper(structure: &Structure) -> &'static dyn SolverFactory {
        let factor = structure.factor_size();
        let most = multigrid_flops(2.0 * structure.pattern().values() as f64);
        let direct = fits(factor.bytes()) && factor.flops <= most;
        if direct { Solver::DIRECT } else { Solver::MULTIGRID }
    }
}

impl SolverFactory for Solver {
    fn name(&self) -> &'static str {
        self.name
    }

    fn about(&self) -> &'static str {
        self.about
    }

    fn takes(&self) -> Symmetry {
        self.takes
    }

    fn make(&self, structure: &Arc<Structure>) -> Box<dyn LinearSolver> {
        (self.make)(structure)
    }
}
