//! [`RandomField`]: a parameter that varies over the body at random.

use super::{Law, Normal, StochasticError};
use faer::diag::Diag;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::evd::{ComputeEigenvectors, self_adjoint_evd, self_adjoint_evd_scratch};
use faer::{Mat, Par};
use nastic_energy::Field;
use nastic_mesh::{GroupNames, Mesh};
use std::sync::Arc;

/// A random field, one value per cell, log-normal or Gaussian, by modes of a Gaussian field g.
///
/// `a(X) = mean exp(g(X) - v(X)/2)` or `mean + g(X)`, `g = sum_k sqrt(l_k) phi_k(X) xi_k` with independent standard normal `xi_k`; `v = sum_k l_k phi_k^2`
/// is the variance that the modes kept have at X: whatever is cut off, `E[a(X)] = mean`. The logarithm of a log-normal field has the variance
/// `s^2 = log(1 + variation^2)`, a Gaussian one `s^2 = deviation^2`.
///
/// By a Karhunen-Loeve expansion on the mesh `l_k`, `phi_k` are eigenpairs of the covariance `s^2 exp(-|X - Y|/length)`: Nystrom's method with the cell
/// centres and volumes, a dense symmetric eigenproblem of at most 4000 cells. Of a field of Whittle and Matern others find them ([`of_modes`](Self::of_modes)).
/// The share of the variance that the modes keep is [`captured`](Self::captured). The coefficients are random numbers like
/// others: rules over [`laws`](Self::laws) give nodes, [`realise`](Self::realise) turns a node into a parameter of a
/// material. Units: mean, deviation and values have the parameter's, length is a length, variation a pure number.
///
/// Source: Ghanem & Spanos, "Stochastic Finite Elements", section 2.3; Betz, Papaioannou & Straub, CMAME 271 (2014).
#[derive(Clone, Debug)]
pub struct RandomField {
    mean: f64,
    law: FieldLaw,
    variance: f64,
    cells: Vec<u32>,
    all_cells: usize,
    values: Vec<f64>,
    /// `sqrt(l_k) phi_k` by mode, then by cell of the region.
    modes: Vec<Vec<f64>>,
    captured: f64,
}

/// How a parameter follows from a Gaussian field g of the variance v.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FieldLaw {
    /// `mean exp(g - v/2)`.
    LogNormal,
    /// `mean + g`.
    Gaussian,
}

/// Modes of a Gaussian field of unit variance, found elsewhere.
#[derive(Clone, Debug)]
pub struct UnitModes {
    /// The cells that they are on, ascending.
    pub cells: Vec<u32>,
    /// Number of cells of the mesh.
    pub all_cells: usize,
    /// By mode, then by cell.
    pub modes: Vec<Vec<f64>>,
    /// Share of the variance that they had before they were scaled to one.
    pub captured: f64,
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

impl RandomField {
    /// The log-normal field of a mean, a coefficient of variation and a correlation length over a region, or over the union of several; outside the region the
    /// parameter is the mean.
    ///
    /// # Errors
    /// [`StochasticError::Parameter`] for numbers out of range, [`StochasticError::Rule`] for an unknown region, no
    /// mode, or more than 4000 cells.
    pub fn log_normal(
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
        let law = FieldLaw::LogNormal;
        Self { mean, law, variance: (variation * variation).ln_1p(), ..Self::NONE }.expanded(
            mesh,
            region.into(),
            length,
            modes,
        )
    }

    /// The Gaussian field of a mean and a standard deviation, otherwise as [`log_normal`](Self::log_normal).
    ///
    /// # Errors
    /// As there.
    pub fn gaussian(
        mesh: &Mesh,
        region: impl Into<GroupNames>,
        mean: f64,
        deviation: f64,
        length: f64,
        modes: Modes,
    ) -> Result<Self, StochasticError> {
        for (name, value) in [("deviation", deviation), ("length", length)] {
            super::law::positive(Normal::NAME, name, value)?;
        }
        Normal::from_mean_variance(mean, deviation * deviation)?;
        let law = FieldLaw::Gaussian;
        Self { mean, law, variance: deviation * deviation, ..Self::NONE }.expanded(mesh, region.into(), length, modes)
    }

    /// The field of a mean and a standard deviation with these modes of its Gaussian field.
    ///
    /// # Errors
    /// [`StochasticError::Parameter`] for numbers out of range.
    pub fn of_modes(law: FieldLaw, mean: f64, deviation: f64, of: UnitModes) -> Result<Self, StochasticError> {
        super::law::positive("random field", "deviation", deviation)?;
        let variance = match law {
            FieldLaw::LogNormal => {
                super::law::positive("log-normal", "mean", mean)?;
                (deviation / mean).powi(2).ln_1p()
            }
            FieldLaw::Gaussian => {
                Normal::from_mean_variance(mean, deviation * deviation)?;
                deviation * deviation
            }
        };
        let UnitModes { cells, all_cells, mut modes, captured } = of;
        modes.iter_mut().flatten().for_each(|a| *a *= variance.sqrt());
        Ok(RandomField { mean, law, variance, cells, all_cells, values: vec![], modes, captured })
    }

    const NONE: Self = RandomField {
        mean: 0.0,
        law: FieldLaw::Gaussian,
        variance: 0.0,
        cells: Vec::new(),
        all_cells: 0,
        values: Vec::new(),
        modes: Vec::new(),
        captured: 0.0,
    };

    /// With the modes of the exponential covariance.
    fn expanded(self, mesh: &Mesh, region: GroupNames, length: f64, modes: Modes) -> Result<Self, StochasticError> {
        let refuse = |what: String| StochasticError::Rule { rule: "Karhunen-Loeve", what };
        let cells = mesh.cells_of(&region).map_err(|e| refuse(e.to_string()))?;
        if cells.len() > MOST_CELLS {
            let what = format!("region \"{region}\" has {} cells, the most is {MOST_CELLS}", cells.len());
            return Err(refuse(format!(
                "{what}; take \"kernel\": \"matern\", a sparse operator, make the field on a coarser region or leave the parameter uniform"
            )));
        }
        if matches!(modes, Modes::Count(0)) || matches!(modes, Modes::Energy(share) if !(share > 0.0 && share <= 1.0)) {
            return Err(refuse(format!("{modes:?} keeps no mode; give a count from 1 or a share in (0, 1]")));
        }
        let variance = self.variance;
        let volumes = mesh.volumes(mesh.points());
        let volumes: Vec<f64> = cells.iter().map(|c| volumes[*c as usize]).collect();
        let centres: Vec<[f64; 3]> = cells.iter().map(|c| mesh.cell_centre(*c as usize)).collect();
        let pairs = eigenpairs(&centres, &volumes, variance, length)?;
        let total = variance * volumes.iter().sum::<f64>();
        let (kept, captured) = kept(&pairs, total, modes);
        let modes: Vec<Vec<f64>> = pairs.iter().take(kept).map(|(_, mode)| mode.clone()).collect();
        let values = pairs.iter().take(kept).map(|(value, _)| *value).collect();
        Ok(RandomField { cells, all_cells: mesh.cells(), values, modes, captured, ..self })
    }

    /// The eigenvalues `l_k` that were kept, falling (length^3); none of modes found elsewhere.
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

    /// Variance `s^2` of the Gaussian field.
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
            values[*cell as usize] = match self.law {
                FieldLaw::LogNormal => self.mean * (g - 0.5 * v).exp(),
                FieldLaw::Gaussian => self.mean + g,
            };
        }
        Ok(Field::Cell(Arc::from(values)))
    }

    /// The median of a field with all of its variance: `mean exp(-s^2/2)` of a log-normal one.
    pub fn median(&self) -> f64 {
        match self.law {
            FieldLaw::LogNormal => self.mean * (-0.5 * self.variance).exp(),
            FieldLaw::Gaussian => self.mean,
        }
    }

    /// The parameter at the median, all coefficients zero, by cell of the region, and its derivative by each coefficient there.
    pub fn linearised(&self) -> (Vec<f64>, Vec<Vec<f64>>) {
        let mut v = vec![0.0; self.cells.len()];
        self.modes.iter().for_each(|mode| v.iter_mut().zip(mode).for_each(|(v, a)| *v += a * a));
        match self.law {
            FieldLaw::Gaussian => (vec![self.mean; v.len()], self.modes.clone()),
            FieldLaw::LogNormal => {
                let median: Vec<f64> = v.iter().map(|v| self.mean * (-0.5 * v).exp()).collect();
                let slope = |mode: &Vec<f64>| mode.iter().zip(&median).map(|(a, median)| a * median).collect();
                let slopes = self.modes.iter().map(slope).collect();
                (median, slopes)
            }
        }
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
