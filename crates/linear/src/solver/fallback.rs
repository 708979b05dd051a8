//! [`MultigridOrDirect`]: multigrid while it converges, then a factor if that fits.

use super::{
    Accuracy, Curvature, Direct, Inertia, LinearError, LinearSolver, LinearWork, MultigridSolver, Step, System,
};
use crate::memory;
use crate::structure::Structure;
use std::sync::Arc;

/// Steps of one nonlinear solve that may end where the curvature turns negative: bodies that bend meet it once or twice on their way. An iteration that
/// goes on among indefinite matrices is at a saddle or far from any equilibrium, and every step there takes several sets of levels.
const INDEFINITE: usize = 8;

/// Multigrid, until it fails, meets an indefinite matrix of which an exact solution is asked or several in one nonlinear solve; from then on
/// [`Direct`], since whatever made multigrid fail stays true nearby. [`name`](LinearSolver::name) says which of the two served.
#[derive(Clone, Debug)]
pub struct MultigridOrDirect {
    structure: Arc<Structure>,
    multigrid: Option<MultigridSolver>,
    direct: Direct,
    /// Steps of this nonlinear solve that met negative curvature.
    indefinite: usize,
}

impl MultigridOrDirect {
    /// For matrices of a structure, which is analysed only if a factor is needed.
    pub fn new(structure: Arc<Structure>) -> Self {
        let direct = Direct::new(structure.clone());
        MultigridOrDirect { structure, multigrid: Some(MultigridSolver::default()), direct, indefinite: 0 }
    }

    fn too_large(&self, why: LinearError) -> LinearError {
        let gib = self.structure.factor_size().bytes() as f64 / f64::from(1 << 30);
        LinearError::TooLarge { source: Box::new(why), gib }
    }

    /// Whether a factor fits, with what it takes while it is made, into the memory that there is.
    fn factor_has_room(&self) -> bool {
        let bytes = 3 * (self.structure.factor_size().bytes() / 2);
        let available = memory::available().map_or(Some(0), |available| available);
        self.structure.factor_fits() && available.is_none_or(|available| bytes <= available)
    }

    /// From multigrid to a factor, unless that is too large.
    fn fall_back(&mut self, why: LinearError) -> Result<(), LinearError> {
        if !self.structure.factor_fits() {
            return Err(self.too_large(why));
        }
        self.multigrid = None;
        Ok(())
    }

    /// By multigrid, or by a factor where that does not converge.
    fn by_either<T>(
        &mut self,
        system: &System,
        mut solve: impl FnMut(&mut dyn LinearSolver) -> Result<T, LinearError>,
    ) -> Result<T, LinearError> {
        if let Some(multigrid) = &mut self.multigrid {
            match solve(multigrid) {
                Err(why @ LinearError::Multigrid { .. }) => self.fall_back(why)?,
                done => return done,
            }
        }
        entries(system)?;
        solve(&mut self.direct)
    }
}

impl LinearSolver for MultigridOrDirect {
    fn name(&self) -> &'static str {
        self.multigrid.as_ref().map_or(self.direct.name(), |multigrid| multigrid.name())
    }

    fn takes_products(&self) -> bool {
        self.multigrid.is_some()
    }

    fn restart(&mut self) {
        self.indefinite = 0;
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
        if let Some(multigrid) = &mut self.multigrid {
            match multigrid.prepare(system, work) {
                Ok(()) => return Ok(()),
                Err(why) => self.fall_back(why)?,
            }
        }
        entries(system)?;
        self.direct.prepare(system, work)
    }

    fn step(&mut self, system: &System, b: &[f64], tolerance: f64, work: &mut LinearWork) -> Result<Step, LinearError> {
        if self.indefinite >= INDEFINITE && self.factor_has_room() {
            self.multigrid = None;
        }
        let step = self.by_either(system, |solver| solver.step(system, b, tolerance, work));
        let definite = step.as_ref().is_ok_and(|step| step.curvature != Curvature::Negative);
        self.indefinite += usize::from(self.multigrid.is_some() && !definite);
        step
    }

    fn solve(
        &mut self,
        system: &System,
        b: &[f64],
        accuracy: Accuracy,
        work: &mut LinearWork,
    ) -> Result<Vec<f64>, LinearError> {
        if let Some(multigrid) = &mut self.multigrid {
            match multigrid.solve(system, b, accuracy, work) {
                Err(why @ (LinearError::Multigrid { .. } | LinearError::Indefinite)) => self.fall_back(why)?,
                done => return done,
            }
        }
        entries(system)?;
        self.direct.solve(system, b, accuracy, work)
    }

    fn solve_definite(
        &mut self,
        system: &System,
        b: &[f64],
        work: &mut LinearWork,
    ) -> Result<Option<Vec<f64>>, LinearError> {
        self.by_either(system, |solver| solver.solve_definite(system, b, work))
    }

    fn negative_quotient(&self) -> Option<f64> {
        self.multigrid.as_ref().and_then(MultigridSolver::negative_quotient)
    }

    fn changes_left(&self) -> Option<&[f64]> {
        self.multigrid.as_ref().and_then(MultigridSolver::changes_left)
    }

    fn solve_shifted(
        &mut self,
        system: &System,
        b: &[f64],
        work: &mut LinearWork,
    ) -> Result<Option<Vec<f64>>, LinearError> {
        self.by_either(system, |solver| solver.solve_shifted(system, b, work))
    }

    fn inertia(&mut self, system: &System) -> Result<Option<Inertia>, LinearError> {
        match self.multigrid.as_mut().map(|multigrid| multigrid.inertia(system)) {
            Some(Ok(inertia)) => Ok(inertia),
            Some(Err(why)) if !self.structure.factor_fits() => Err(self.too_large(why)),
            _ => entries(system).and_then(|()| self.direct.inertia(system)),
        }
    }

    fn negative(&self) -> Option<usize> {
        self.multigrid.as_ref().map_or(self.direct.negative(), |multigrid| multigrid.negative())
    }

    fn bytes(&self) -> usize {
        self.direct.bytes() + self.multigrid.as_ref().map_or(0, |multigrid| multigrid.bytes())
    }

    fn anew(&self, structure: &Arc<Structure>) -> Box<dyn LinearSolver> {
        let multigrid = self.multigrid.as_ref().map(|_| MultigridSolver::default());
        Box::new(MultigridOrDirect { multigrid, ..MultigridOrDirect::new(structure.clone()) })
    }

    fn boxed_clone(&self) -> Box<dyn LinearSolver> {
        Box::new(self.clone())
    }
}

/// Refuses a system without entries, of which there is no factor: it has to come again with some.
fn entries(system: &System) -> Result<(), LinearError> {
    if system.products.is_none() { Ok(()) } else { Err(LinearError::NoEntries) }
}
