//! [`MultigridOrDirect`]: multigrid while it converges, then a factor if that fits.

use super::{
    Accuracy, Curvature, Definite, Direct, Inertia, LinearError, LinearSolver, LinearWork, MultigridSolver, Solution,
    SolverState, Step, System,
};
use crate::factor::structure::Structure;
use crate::factor::symmetric::Precision;
use crate::memory;
use std::sync::Arc;

/// Steps of one nonlinear solve that may meet negative curvature: bodies that bend meet it once or twice. An iteration that continues among
/// indefinite matrices is at a saddle or far from any equilibrium, and every step there takes several sets of levels.
const MAX_INDEFINITE_STEPS: usize = 8;

/// Multigrid, until it fails or meets an indefinite matrix of which an exact solution is asked; from then on [`Direct`],
/// since whatever made multigrid fail stays true nearby. [`Direct`] too for the rest of a nonlinear solve that has met several indefinite matrices, if a factor
/// fits. [`state`](LinearSolver::state) says which of the two serves.
#[derive(Clone, Debug)]
pub struct MultigridOrDirect {
    structure: Arc<Structure>,
    multigrid: Option<MultigridSolver>,
    direct: Direct,
    /// Steps of this nonlinear solve by multigrid that met negative curvature, and whether it was given up for that.
    indefinite: usize,
    given_up: bool,
}

impl MultigridOrDirect {
    /// For matrices of a structure, which is analysed only if a factor is needed.
    pub fn new(structure: Arc<Structure>) -> Self {
        let direct = Direct::new(structure.clone());
        MultigridOrDirect {
            structure,
            multigrid: Some(MultigridSolver::default()),
            direct,
            indefinite: 0,
            given_up: false,
        }
    }

    fn too_large(&self, why: LinearError) -> LinearError {
        let gib = self.structure.factor_size().bytes() as f64 / f64::from(1 << 30);
        LinearError::TooLarge { source: Box::new(why), gib }
    }

    /// Multigrid where it serves.
    fn serving(&self) -> Option<&MultigridSolver> {
        self.multigrid.as_ref().filter(|_| !self.given_up)
    }

    fn serving_mut(&mut self) -> Option<&mut MultigridSolver> {
        self.multigrid.as_mut().filter(|_| !self.given_up)
    }

    /// Whether a factor may be made unasked, within the limit of the user. What memory happens to be there decides nothing: results would depend on it.
    fn factor_is_allowed(&self) -> bool {
        let needed = || self.structure.symbolic().factorisation_bytes(Precision::Double);
        let within = |limit: Option<usize>| limit.is_none_or(|limit| needed() <= limit);
        self.structure.factor_fits() && memory::limit().is_ok_and(within)
    }

    /// From multigrid to a factor, unless that is too large.
    fn fall_back(&mut self, why: LinearError) -> Result<(), LinearError> {
        if !self.structure.factor_fits() {
            return Err(self.too_large(why));
        }
        self.multigrid = None;
        Ok(())
    }

    /// By multigrid, or by a factor where that fails for good.
    fn by_either<T>(
        &mut self,
        system: &System,
        fails: fn(&LinearError) -> bool,
        mut solve: impl FnMut(&mut dyn LinearSolver) -> Result<T, LinearError>,
    ) -> Result<T, LinearError> {
        if let Some(multigrid) = self.serving_mut() {
            match solve(multigrid) {
                Err(why) if fails(&why) => self.fall_back(why)?,
                done => return done,
            }
        }
        entries(system)?;
        solve(&mut self.direct)
    }
}

impl LinearSolver for MultigridOrDirect {
    fn state(&self) -> SolverState {
        let (multigrid, direct) = (self.multigrid.as_ref().map(|multigrid| multigrid.state()), self.direct.state());
        let bytes = direct.bytes + multigrid.map_or(0, |multigrid| multigrid.bytes);
        SolverState { bytes, ..multigrid.filter(|_| !self.given_up).unwrap_or(direct) }
    }

    fn restart(&mut self) {
        (self.indefinite, self.given_up) = (0, false);
        self.direct.restart();
    }

    /// What it fell back on stays.
    fn clear(&mut self) {
        if let Some(multigrid) = &mut self.multigrid {
            multigrid.clear();
        }
        self.direct.clear();
    }

    fn prepare(&mut self, system: &System, work: &mut LinearWork) -> Result<(), LinearError> {
        self.by_either(system, |_| true, |solver| solver.prepare(system, work))
    }

    fn step(&mut self, system: &System, b: &[f64], tolerance: f64, work: &mut LinearWork) -> Result<Step, LinearError> {
        if self.serving().is_some() && self.indefinite >= MAX_INDEFINITE_STEPS && self.factor_is_allowed() {
            self.given_up = true;
            self.multigrid.iter_mut().for_each(LinearSolver::clear);
        }
        let by_multigrid = self.serving().is_some();
        let step = self.by_either(system, does_not_converge, |solver| solver.step(system, b, tolerance, work));
        let indefinite = match &step {
            Ok(step) => step.curvature == Curvature::Negative,
            Err(why) => matches!(why, LinearError::Indefinite { .. }),
        };
        self.indefinite += usize::from(by_multigrid && indefinite);
        step
    }

    fn solve(
        &mut self,
        system: &System,
        b: &[f64],
        accuracy: Accuracy,
        work: &mut LinearWork,
    ) -> Result<Solution, LinearError> {
        let fails = |why: &LinearError| does_not_converge(why) || matches!(why, LinearError::Indefinite { .. });
        self.by_either(system, fails, |solver| solver.solve(system, b, accuracy, work))
    }

    fn solve_definite(
        &mut self,
        system: &System,
        b: &[f64],
        which: Definite,
        work: &mut LinearWork,
    ) -> Result<Vec<f64>, LinearError> {
        self.by_either(system, does_not_converge, |solver| solver.solve_definite(system, b, which, work))
    }

    fn inertia(&mut self, system: &System) -> Result<Option<Inertia>, LinearError> {
        match self.serving_mut().map(|multigrid| multigrid.inertia(system)) {
            Some(Ok(inertia)) => Ok(inertia),
            Some(Err(why)) if !self.structure.factor_fits() => Err(self.too_large(why)),
            _ => entries(system).and_then(|()| self.direct.inertia(system)),
        }
    }

    fn anew(&self, structure: &Arc<Structure>) -> Box<dyn LinearSolver> {
        let multigrid = self.multigrid.as_ref().map(|_| MultigridSolver::default());
        let (indefinite, given_up) = (self.indefinite, self.given_up);
        Box::new(MultigridOrDirect { multigrid, indefinite, given_up, ..MultigridOrDirect::new(structure.clone()) })
    }
}

fn does_not_converge(why: &LinearError) -> bool {
    matches!(why, LinearError::Multigrid { .. })
}

/// Refuses a system without entries, of which there is no factor: it has to come again with some.
fn entries(system: &System) -> Result<(), LinearError> {
    if system.products.is_none() { Ok(()) } else { Err(LinearError::NoEntries) }
}
