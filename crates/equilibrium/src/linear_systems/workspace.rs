//! [`Workspace`]: data that accelerates the next solve, and affects results within the accuracy asked for only.

use crate::linear_systems::tangent::Tangent;
use crate::model::Model;
use nastic_body::controls::Controls;
use nastic_body::state::State;
use nastic_linear::solver::{Direct, Joining};
use nastic_linear::{Factor, LinearSolver, Pattern, Solver, SolverFactory, Structure};
use std::fmt;
use std::sync::Arc;

/// Data of one solve for the next on the same body: a linear solver with a factor of a recent tangent or a multigrid hierarchy,
/// used as preconditioner while that is less expensive than a new one. Owned by the run that makes the solves, one after the
/// other; results depend on it only within the accuracy asked for, and the same history gives the same bits.
#[derive(Default)]
pub struct Workspace {
    solver: Option<KeptSolver>,
    tangent: Option<KeptTangent>,
    /// Consecutive failed attempts with predicted pressures.
    pub(crate) unpredicted: usize,
}

/// The tangent at the state of the last second derivatives, its supports eliminated.
#[derive(Clone)]
struct KeptTangent {
    /// The displacement of the state, shared with it, so that no other state of the body can have it.
    of: (Arc<Vec<f64>>, Arc<Controls>, f64),
    /// Its mesh.
    pattern: Arc<Pattern>,
    tangent: Option<Tangent>,
    /// Whether the preconditioner held is of this tangent.
    factorised: bool,
}

struct KeptSolver {
    /// Name of its factory.
    name: &'static str,
    pattern: Arc<Pattern>,
    solver: Box<dyn LinearSolver>,
}

impl Workspace {
    /// A workspace with a factor of a tangent near the expected ones.
    pub fn with_factor(factor: Factor) -> Self {
        let (name, pattern) = (Solver::DIRECT.name(), factor.symbolic().pattern().clone());
        let structure = Structure::analysed(factor.symbolic().clone());
        let solver = Box::new(Joining::new(&structure, Box::new(Direct::with_factor(factor))));
        Workspace { solver: Some(KeptSolver { name, pattern, solver }), ..Workspace::default() }
    }

    /// The linear solver of a factory for a model: the one held, if it is from this factory.
    pub(crate) fn solver(&mut self, factory: &dyn SolverFactory, model: &Model) -> &mut dyn LinearSolver {
        let (name, structure) = (factory.name(), model.structure());
        let fits = |kept: &KeptSolver| kept.name == name && Arc::ptr_eq(&kept.pattern, structure.pattern());
        let kept = self.solver.take().filter(fits);
        let new = || {
            let solver = Box::new(Joining::new(&structure, factory.make(&structure)));
            KeptSolver { name, pattern: structure.pattern().clone(), solver }
        };
        self.solver.insert(kept.unwrap_or_else(new)).solver.as_mut()
    }

    /// Records that second derivatives are computed at a state; whether the last ones were at the same state.
    pub(crate) fn comes_again(&mut self, state: &State, model: &Model) -> bool {
        let structure = model.structure();
        let pattern = structure.pattern();
        let again = self.tangent.as_ref().is_some_and(|kept| {
            let (u, controls, load) = &kept.of;
            let same_state = Arc::ptr_eq(u, &state.u) && Arc::ptr_eq(controls, &state.controls) && *load == state.load;
            same_state && Arc::ptr_eq(pattern, &kept.pattern)
        });
        if !again {
            let of = (state.u.clone(), state.controls.clone(), state.load);
            self.tangent = Some(KeptTangent { of, pattern: pattern.clone(), tangent: None, factorised: false });
        }
        again
    }

    /// Takes the tangent of the state that was recorded last, if it is held, and whether it was factorised.
    pub(crate) fn take_tangent(&mut self) -> Option<(Tangent, bool)> {
        let kept = self.tangent.as_mut()?;
        Some((kept.tangent.take()?, kept.factorised))
    }

    /// Puts it there.
    pub(crate) fn put_tangent(&mut self, tangent: Tangent, factorised: bool) {
        if let Some(kept) = &mut self.tangent {
            (kept.tangent, kept.factorised) = (Some(tangent), factorised);
        }
    }

    /// Drops factors and hierarchies; a solver that fell back on another stays with that.
    pub(crate) fn forget(&mut self) {
        self.tangent = None;
        if let Some(kept) = &mut self.solver {
            kept.solver.clear();
        }
    }

    /// Memory held, in bytes.
    pub fn factor_bytes(&self) -> usize {
        self.solver.as_ref().map_or(0, |kept| kept.solver.state().bytes)
    }

    /// Drops everything: the next solve starts as if it were the first.
    pub fn clear(&mut self) {
        *self = Workspace::default();
    }
}

impl Clone for Workspace {
    fn clone(&self) -> Self {
        let copy = |kept: &KeptSolver| KeptSolver {
            name: kept.name,
            pattern: kept.pattern.clone(),
            solver: kept.solver.clone(),
        };
        let Workspace { tangent, unpredicted, .. } = self;
        Workspace { solver: self.solver.as_ref().map(copy), tangent: tangent.clone(), unpredicted: *unpredicted }
    }
}

impl fmt::Debug for Workspace {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "Workspace({} bytes)", self.factor_bytes())
    }
}
