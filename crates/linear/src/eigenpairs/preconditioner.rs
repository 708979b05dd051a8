//! [`ShiftedLevels`]: an approximate inverse of `A + s M` by multigrid.

use crate::error::{FactorError, StructureError};
use crate::krylov::saddle_gmres::{Aim, Counts, SaddleGmres, Start};
use crate::krylov::volume_modes::VolumeModes;
use crate::multigrid::{Geometry, Multigrid};
use crate::pattern::matrix::SparseMatrix;
use crate::pattern::operator::Preconditioner;
use crate::solver::System;
use std::borrow::Cow;

/// Relative residual of a system with pressures as unknowns, for which one cycle is not enough.
const RESIDUAL_TOLERANCE: f64 = 0.1;
/// Cycles of such a system.
const MAX_CYCLES: usize = 30;

/// A V-cycle of a matrix with a multiple of masses added, or where it has volume modes GMRES with cycles of the rest.
pub(super) struct ShiftedLevels<'a> {
    system: System<'a>,
    /// With the multiple.
    matrix: Cow<'a, SparseMatrix>,
    modes: Option<&'a VolumeModes>,
    levels: Multigrid,
}

impl<'a> ShiftedLevels<'a> {
    /// With a multiple of these masses by unknown, or of their mean where the matrix is known by products.
    ///
    /// # Errors
    /// [`FactorError::NotPositive`] where the levels show that more has to be added.
    pub fn new(system: &System<'a>, shift: f64, masses: &[f64], mean: f64) -> Result<Self, FactorError> {
        let modes = if system.products.is_some() { None } else { system.configuration.volume_modes() };
        let mut matrix = Cow::Borrowed(system.matrix);
        if shift != 0.0 && system.products.is_none() {
            // rows of fixed unknowns have no mass
            let entry = |(mass, &fixed): (&f64, &bool)| shift * if fixed { mean } else { *mass };
            matrix.to_mut().add_diagonal(&masses.iter().zip(system.fixed).map(entry).collect::<Vec<_>>());
        }
        let shifted = system.products.filter(|_| shift != 0.0).map(|products| products.shifted(shift * mean));
        let products = shifted.as_ref().or(system.products);
        let (points, corners) = (system.configuration.positions(), system.configuration.corners());
        let geometry = Geometry { points, fixed: system.fixed, corners, products };
        let levels = match modes {
            None => Multigrid::new(&matrix, &geometry, system.parallel)?,
            Some(modes) => {
                let rest = modes.rest(&matrix).map_err(StructureError::from)?;
                Multigrid::new(&rest, &geometry, system.parallel)?
            }
        };
        Ok(ShiftedLevels { system: *system, matrix, modes, levels })
    }

    /// `x ~ (A + s M)^-1 b`.
    pub fn apply(&self, b: &[f64]) -> Vec<f64> {
        let Some(modes) = self.modes else {
            let mut x = b.to_vec();
            self.levels.apply(&mut x);
            return x;
        };
        let apply = |v: &[f64], out: &mut [f64]| self.matrix.multiply_on(v, out, self.system.parallel);
        let saddle = SaddleGmres { apply: &apply, modes, preconditioner: &self.levels, counts: Counts::Matrix };
        let (mut x, mut p) = (vec![0.0; b.len()], vec![0.0; modes.len()]);
        saddle.solve(b, Start { u: &mut x, p: &mut p }, Aim { tolerance: RESIDUAL_TOLERANCE, most: MAX_CYCLES });
        x
    }
}
