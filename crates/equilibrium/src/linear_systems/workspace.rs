//! [`Workspace`]: what makes the next solve faster, and decides no result beyond the accuracy asked for.

use crate::linear_systems::tangent::Tangent;
use crate::model::Model;
use nastic_body::controls::Controls;
use nastic_body::state::State;
use nastic_linear::solver::{Direct, Joining};
use nastic_linear::{Factor, LinearSolver, Pattern, Solver, SolverFactory, Structure};
use std::fmt;
use std::sync::Arc;

/// What one solve leaves behind for the next on the same body: a linear solver with what it keeps (a factor of a recent
/// tangent, a multigrid hierarchy), used as preconditioner while that is cheaper than a new one. Owned by the run that makes the
/// solves, one after the other; results depend on it only within the accuracy asked of them, and the same history gives the
/// same bits.
#[derive(Default)]
pub struct Workspace {
    solver: Option<KeptSolver>,
    tangent: Option<KeptTangent>,
    /// Attempts with predicted pressures that have failed since the last that did not.
    pub(crate) unpredicted: usize,
}

/// The tangent at the state whose second derivatives were last asked for, its supports eliminated.
#[derive(Clone)]
struct KeptTangent {
    /// Of which state: these are shared with it, so that no other state of the body can have them.
    of: (Arc<Vec<f64>>, Arc<Controls>, f64),
    /// On which mesh.
    pattern: Arc<Pattern>,
    tangent: Option<Tangent>,
    /// Whether what the solver keeps is of this tangent.
    factorised: bool,
}

struct KeptSolver {
    /// Name of what made it.
    name: &'static str,
    pattern: Arc<Pattern>,
    solver: Box<dyn LinearSolver>,
}

impl Workspace {
    /// One that holds a factor of a tangent near the expected ones.
    pub fn with_factor(factor: Factor) -> Self {
        let (name, pattern) = (Solver::DIRECT.name(), factor.symbolic().pattern().clone());
        let structure = Structure::analysed(factor.symbolic().clone());
        let solver = Box::new(Joining::new(&structure, Box::new(Direct::with_factor(factor))));
        Workspace { solver: Some(KeptSolver { name, pattern, solver }), ..Workspace::default() }
    }

    /// The linear solver of a factory for a model: the one that is here, if it is such.
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

    /// Notes that second derivatives at a state are asked for; whether that is not the first time in a row.
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

    /// Takes out the tangent of the state that was noted last, if it was put there, and whether it was factorised.
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

    /// Memory of what is kept, in bytes.
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
