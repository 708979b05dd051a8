//! [`LogNormalField`]: a parameter that varies over the body at random.

use super::{Law, Normal, StochasticError};
use faer::diag::Diag;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::evd::{ComputeEigenvectors, self_adjoint_evd, self_adjoint_evd_scratch};
use faer::{Mat, Par};
use nastic_energy::Field;
use nastic_mesh::{GroupNames, Mesh};
use std::sync::Arc;

/// A log-normal random field, one value per cell, by a Karhunen-Loeve expansion on the mesh.
///
/// `a(X) = mean exp(g(X) - v(X)/2)`, `g = sum_k sqrt(l_k) phi_k(X) xi_k` with independent standard normal `xi_k`, where
/// `l_k`, `phi_k` are eigenpairs of the covariance `s^2 exp(-|X - Y|/length)`, `s^2 = log(1 + variation^2)`, and
/// `v = sum_k l_k phi_k^2` is the variance that the modes kept have at X: whatever is cut off, `E[a(X)] = mean`.
///
/// The eigenproblem is solved by Nystrom's method with the cell centres and volumes, as a dense symmetric one; the
/// share of the variance that the modes keep is [`captured`](Self::captured). The coefficients are random numbers like
/// others: rules over [`laws`](Self::laws) give nodes, [`realise`](Self::realise) turns a node into a parameter of a
/// material. Units: mean and values have the parameter's, length is a length, variation a pure number.
///
/// Source: Ghanem & Spanos, "Stochastic Finite Elements", section 2.3; Betz, Papaioannou & Straub, CMAME 271 (2014).
#[derive(Clone, Debug)]
pub struct LogNormalField {
    mean: f64,
    variance: f64,
    cells: Vec<u32>,
    all_cells: usize,
    values: Vec<f64>,
    /// `sqrt(l_k) phi_k` by mode, then by cell of the region.
    modes: Vec<Vec<f64>>,
    captured: f64,
}

/// How many modes to keep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Modes {
    /// So many, or one per cell if there are fewer cells.
    Count(usize),
    /// As many as it takes to keep this share of the variance, in (0, 1].
    Energy(f64),
}

/// A dense eigenproblem of this size is the most to wait for.
const MOST_CELLS: usize = 4000;

impl LogNormalField {
    /// The field of a mean, a coefficient of variation and a correlation length over a region, or over the union of several; outside the region the
    /// parameter is the mean.
    ///
    /// # Errors
    /// [`StochasticError::Parameter`] for numbers out of range, [`StochasticError::Rule`] for an unknown region, no
    /// mode, or more than 4000 cells.
    pub fn new(
        mesh: &Mesh,
        region: impl Into<GroupNames>,
        mean: f64,
        variation: f64,
        length: f64,
        modes: Modes,
    ) -> Result<Self, StochasticError> {
        for (name, value) in [("mean", mean), ("variation", variation), ("length", length)] {
            super::law::positive("log-normal", name, value)?;
        }
        let region = region.into();
        let refuse = |what: String| StochasticError::Rule { rule: "Karhunen-Loeve", what };
        let cells = mesh.cells_of(&region).map_err(|e| refuse(e.to_string()))?;
        if cells.len() > MOST_CELLS {
            let what = format!("region \"{region}\" has {} cells, the most is {MOST_CELLS}", cells.len());
            return Err(refuse(format!("{what}; make the field on a coarser region or leave the parameter uniform")));
        }
        if matches!(modes, Modes::Count(0)) || matches!(modes, Modes::Energy(share) if !(share > 0.0 && share <= 1.0)) {
            return Err(refuse(format!("{modes:?} keeps no mode; give a count from 1 or a share in (0, 1]")));
        }
        let variance = (variation * variation).ln_1p();
        let volumes = mesh.volumes(mesh.points());
        let volumes: Vec<f64> = cells.iter().map(|c| volumes[*c as usize]).collect();
        let centres: Vec<[f64; 3]> = cells.iter().map(|c| mesh.cell_centre(*c as usize)).collect();
        let pairs = eigenpairs(&centres, &volumes, variance, length)?;
        let total = variance * volumes.iter().sum::<f64>();
        let (kept, captured) = kept(&pairs, total, modes);
        let modes: Vec<Vec<f64>> = pairs.iter().take(kept).map(|(_, mode)| mode.clone()).collect();
        let values = pairs.iter().take(kept).map(|(value, _)| *value).collect();
        Ok(LogNormalField { mean, variance, cells, all_cells: mesh.cells(), values, modes, captured })
    }

    /// The eigenvalues `l_k` that were kept, falling (length^3).
    pub fn eigenvalues(&self) -> &[f64] {
        &self.values
    }

    /// `sqrt(l_k) phi_k` of every mode kept, by cell of the region.
    pub fn modes(&self) -> &[Vec<f64>] {
        &self.modes
    }

    /// Share of the Gaussian field's variance, integrated over the region, that the modes keep.
    pub fn captured(&self) -> f64 {
        self.captured
    }

    /// Variance `s^2 = log(1 + variation^2)` of the Gaussian field.
    pub fn variance(&self) -> f64 {
        self.variance
    }

    /// The cells of the region.
    pub fn cells(&self) -> &[u32] {
        &self.cells
    }

    /// The laws of the coefficients: as many standard normal ones as there are modes.
    pub fn laws(&self) -> Vec<&dyn Law> {
        self.modes.iter().map(|_| &Normal::STANDARD as &dyn Law).collect()
    }

    /// The parameter at given coefficients, one value per cell of the mesh.
    ///
    /// # Errors
    /// [`StochasticError::Rule`] unless there is one coefficient per mode.
    pub fn realise(&self, coefficients: &[f64]) -> Result<Field<f64>, StochasticError> {
        if coefficients.len() != self.modes.len() {
            let what = format!("{} coefficients for {} modes", coefficients.len(), self.modes.len());
            return Err(StochasticError::Rule { rule: "Karhunen-Loeve", what });
        }
        let mut values = vec![self.mean; self.all_cells];
        for (i, cell) in self.cells.iter().enumerate() {
            let (mut g, mut v) = (0.0, 0.0);
            for (mode, xi) in self.modes.iter().zip(coefficients) {
                g += mode[i] * xi;
                v += mode[i] * mode[i];
            }
            values[*cell as usize] = self.mean * (g - 0.5 * v).exp();
        }
        Ok(Field::Cell(Arc::from(values)))
    }
}

/// All eigenvalues, falling, with `sqrt(l) phi` at the cells.
fn eigenpairs(
    centres: &[[f64; 3]],
    volumes: &[f64],
    variance: f64,
    length: f64,
) -> Result<Vec<(f64, Vec<f64>)>, StochasticError> {
    let n = centres.len();
    let matrix = Mat::from_fn(n, n, |i, j| {
        let distance = (0..3).map(|k| (centres[i][k] - centres[j][k]).powi(2)).sum::<f64>().sqrt();
        (volumes[i] * volumes[j]).sqrt() * variance * (-distance / length).exp()
    });
    let (mut rising, mut vectors) = (Diag::zeros(n), Mat::zeros(n, n));
    // One thread: with several the bits would depend on their number.
    let scratch = self_adjoint_evd_scratch::<f64>(n, ComputeEigenvectors::Yes, Par::Seq, Default::default());
    let mut memory = MemBuffer::new(scratch);
    let (s, u, stack) = (rising.as_mut(), Some(vectors.as_mut()), MemStack::new(&mut memory));
    self_adjoint_evd(matrix.as_ref(), s, u, Par::Seq, stack, Default::default()).map_err(|_| {
        StochasticError::Rule {
            rule: "Karhunen-Loeve",
            what: format!(
                "no eigenpairs of the covariance of {n} cells were found; check their volumes and the length"
            ),
        }
    })?;
    let pair = |k: usize| {
        let value = rising[k].max(0.0);
        let vector = vectors.col(k);
        // One of the two signs, so that fields of one seed look alike on refined meshes: the first large entry is
        // positive.
        let largest = vector.norm_max();
        let first = vector.iter().find(|v| v.abs() > 0.5 * largest).copied().unwrap_or(1.0);
        let scale = value.sqrt() * first.signum();
        (value, vector.iter().zip(volumes).map(|(v, volume)| scale * v / volume.sqrt()).collect())
    };
    Ok((0..n).rev().map(pair).collect())
}

/// How many modes are kept, and what share of the total they hold.
fn kept(pairs: &[(f64, Vec<f64>)], total: f64, modes: Modes) -> (usize, f64) {
    let mut sum = 0.0;
    for (k, (value, _)) in pairs.iter().enumerate() {
        sum += value;
        let enough = match modes {
            Modes::Count(count) => k + 1 >= count,
            Modes::Energy(share) => sum >= share * total,
        };
        if enough {
            return (k + 1, (sum / total).min(1.0));
        }
    }
    (pairs.len(), (sum / total).min(1.0))
}
