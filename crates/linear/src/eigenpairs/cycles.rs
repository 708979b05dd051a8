//! [`Cycles`]: a matrix that is known by its products and inverted by cycles of multigrid.

use super::Eigenproblem;
use super::inner_product::{ENTRY_ROUNDING, rounding};
use super::shifted_matrix::{Inverse, SearchLimits, ShiftedMatrix};
use crate::error::{FactorError, StructureError};
use crate::krylov::saddle_gmres::{Aim, Counts, SaddleGmres, Start};
use crate::krylov::volume_modes::VolumeModes;
use crate::multigrid::{Geometry, Multigrid};
use crate::pattern::matrix::SparseMatrix;
use crate::pattern::operator::{Operator, Preconditioner};
use crate::solver::{LinearError, System};
use std::borrow::Cow;

/// Relative residual of a system with pressures as unknowns, for which one cycle is not enough.
const RESIDUAL_TOLERANCE: f64 = 0.1;
/// Cycles of such a system.
const MAX_CYCLES: usize = 30;

/// Error of the vector of a pair in the energy norm.
const TOLERANCE: f64 = 1e-7;
/// Iterations.
const MAX_ITERATIONS: usize = 60;
/// Approximate sum of the magnitudes of a row of A over its diagonal entry.
const ROW_SUM_RATIO: f64 = 8.0;

/// A by its products, with a matrix for the levels.
pub(super) struct Cycles<'a> {
    product: &'a dyn Operator,
    system: System<'a>,
    /// `M_ii`, and their mean over free unknowns.
    masses: Vec<f64>,
    mean: f64,
}

impl<'a> Cycles<'a> {
    pub fn new(problem: &Eigenproblem<'a>, product: &'a dyn Operator, system: System<'a>) -> Self {
        let masses = problem.mass.diagonal();
        let mean = mean_magnitude(&masses, problem.fixed);
        Cycles { product, system, masses, mean }
    }
}

/// The mean magnitude over free unknowns.
pub(super) fn mean_magnitude(diagonal: &[f64], fixed: &[bool]) -> f64 {
    let free = diagonal.iter().zip(fixed).filter(|(_, fixed)| !**fixed);
    let (sum, count) = free.fold((0.0, 0), |(sum, count), (d, _)| (sum + d.abs(), count + 1));
    sum / f64::from(count.max(1))
}

impl ShiftedMatrix for Cycles<'_> {
    fn multiply(&self, x: &[f64], out: &mut [f64]) {
        self.product.apply(x, out);
    }

    /// Also by products.
    fn diagonal(&self) -> Vec<f64> {
        let System { matrix, products, parallel, .. } = self.system;
        match products {
            Some(products) => products
                .diagonal_blocks(parallel)
                .as_flattened()
                .iter()
                .enumerate()
                .map(|(at, row)| row[at % 3])
                .collect(),
            None => matrix.diagonal(),
        }
    }

    /// For products |A| is a multiple of the diagonal of A.
    fn rounding(&self, vectors: &[Vec<f64>]) -> Vec<f64> {
        let System { matrix, products, parallel, .. } = self.system;
        if products.is_none() {
            return rounding(&matrix.magnitudes(), vectors, parallel);
        }
        let diagonal = self.diagonal();
        let of = |x: &Vec<f64>| x.iter().zip(&diagonal).map(|(x, d)| x * x * d.abs()).sum::<f64>();
        vectors.iter().map(|x| ENTRY_ROUNDING * ROW_SUM_RATIO * of(x)).collect()
    }

    /// With a multiple of the diagonal of M, or of its mean where the matrix is known by products; the levels show whether more has to be added.
    fn inverse(&self, shift: f64) -> Result<Box<dyn Inverse + '_>, LinearError> {
        Ok(Box::new(ShiftedLevels::new(&self.system, shift, &self.masses, self.mean)?))
    }

    fn search_limits(&self) -> SearchLimits {
        SearchLimits { tolerance: TOLERANCE, rounding: 0.0, iterations: MAX_ITERATIONS }
    }
}

/// A V-cycle of a matrix with a multiple of masses added, or where it has volume modes GMRES with cycles of the rest.
struct ShiftedLevels<'a> {
    system: System<'a>,
    /// With the multiple.
    matrix: Cow<'a, SparseMatrix>,
    modes: Option<&'a VolumeModes>,
    levels: Multigrid,
}

impl<'a> ShiftedLevels<'a> {
    fn new(system: &System<'a>, shift: f64, masses: &[f64], mean: f64) -> Result<Self, FactorError> {
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

    /// `x ~ (A + s M)^-1 x`.
    fn solve(&self, x: &mut [f64]) {
        let Some(modes) = self.modes else {
            self.levels.apply(x);
            return;
        };
        let apply = |v: &[f64], out: &mut [f64]| self.matrix.multiply_on(v, out, self.system.parallel);
        let saddle = SaddleGmres { apply: &apply, modes, preconditioner: &self.levels, counts: Counts::Matrix };
        let (b, mut p) = (x.to_vec(), vec![0.0; modes.len()]);
        x.fill(0.0);
        saddle.solve(&b, Start { u: x, p: &mut p }, Aim { tolerance: RESIDUAL_TOLERANCE, most: MAX_CYCLES });
    }
}

impl Inverse for ShiftedLevels<'_> {
    fn apply(&self, columns: &mut [f64], count: usize) {
        let length = columns.len() / count.max(1);
        columns.chunks_mut(length.max(1)).for_each(|x| self.solve(x));
    }
}
