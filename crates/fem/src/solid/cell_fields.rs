//! [`CellFields`]: J, stresses and energies of a state, averaged over cells.

use super::Solid;
use nastic_body::body_energy::driving::Driving;
use nastic_body::error::Inadmissible;
use nastic_body::state::State;
use nastic_energy::{EnergyTerm, PointBatch, Response, Want};
use nastic_tensor::{Kinematics, Mat3, Vec3};

/// Averages over the reference volume of each cell, in mesh order, of what its laws see and answer: F is that of the cell's
/// [`Formulation`](nastic_body::body_energy::formulation::kind::Formulation).
#[derive(Debug, Clone, PartialEq)]
pub struct CellFields {
    /// det F.
    pub j: Vec<f64>,
    /// First Piola-Kirchhoff stress, actuations included, row by row (9 per cell).
    pub piola: Vec<f64>,
    /// Cauchy stress `P F^T / J`, row by row (9 per cell).
    pub cauchy: Vec<f64>,
    /// Stored energy density of the passive materials.
    pub energy: Vec<f64>,
    /// Direction of each actuation that has one (3 per cell), by actuation name; zero where it does not act.
    pub directions: Vec<(String, Vec<f64>)>,
    /// Direction of the passive material (its fibre), where one has it.
    pub fiber: Option<Vec<f64>>,
}

/// At every quadrature point: kinematics, P with actuations, energy density of the passive materials.
struct PointStresses {
    kinematics: Vec<Kinematics>,
    piola: Vec<Mat3>,
    energy: Vec<f64>,
}

impl Solid {
    /// The cell averages of a state, for output.
    ///
    /// # Errors
    /// [`Inadmissible`] where J <= 0, or beyond the domain of a law.
    pub fn cell_fields(&self, state: &State) -> Result<CellFields, Inadmissible> {
        let disc = self.discretization();
        let PointStresses { kinematics, piola, energy } = self.point_stresses(state)?;
        let cauchy = by_row(cauchy(&kinematics, &piola));
        let j: Vec<f64> = kinematics.iter().map(|k| k.j()).collect();
        Ok(CellFields {
            j: disc.cell_average(&j, 1),
            piola: disc.cell_average(&by_row(piola.iter().copied()), 9),
            cauchy: disc.cell_average(&cauchy, 9),
            energy: disc.cell_average(&energy, 1),
            directions: self.directions(),
            fiber: self.fibers(),
        })
    }

    /// Green-Lagrange strain `(F^T F - 1) / 2`, averaged over the reference volume of each cell, row by row (9 per cell).
    ///
    /// # Errors
    /// [`Inadmissible`] where u is.
    pub fn cell_strains(&self, state: &State) -> Result<Vec<f64>, Inadmissible> {
        let disc = self.discretization();
        let kinematics = disc.points().kinematics(&self.model().displacement(&state.u))?;
        let strains = kinematics.iter().map(|k| 0.5 * (k.f().transpose() * k.f() - Mat3::identity()));
        Ok(disc.cell_average(&by_row(strains), 9))
    }

    /// Cauchy stress by node, actuations included, smoothed by [`Discretization::nodal_average`](nastic_body::discretization::Discretization::nodal_average), row
    /// by row (9 per node).
    ///
    /// # Errors
    /// [`Inadmissible`] where J <= 0, or beyond the domain of a law.
    pub fn nodal_stresses(&self, state: &State) -> Result<Vec<f64>, Inadmissible> {
        let PointStresses { kinematics, piola, .. } = self.point_stresses(state)?;
        Ok(self.discretization().nodal_average(&by_row(cauchy(&kinematics, &piola)), 9))
    }

    /// What the laws answer at the quadrature points, where all are within the domains of their laws.
    fn point_stresses(&self, state: &State) -> Result<PointStresses, Inadmissible> {
        let disc = self.discretization();
        let kinematics = self.body().kinematics_of_laws(&self.model().displacement(&state.u))?;
        let n = kinematics.len();
        let (mut piola, mut energy) = (vec![Mat3::zeros(); n], vec![0.0; n]);
        let driving = Driving { controls: &state.controls, history: &state.history };
        for (cell, (first, count)) in disc.points_of_cells().into_iter().enumerate() {
            let range = first..first + count;
            let at = PointBatch { kinematics: &kinematics[range.clone()], cell, first };
            self.body().check_domain(&at, Some(driving))?;
            let mut out =
                Response { energy: &mut energy[range.clone()], stress: &mut piola[range.clone()], tangent: &mut [] };
            let want = Want { energy: true, stress: true, tangent: false };
            for (law, m) in self.body().laws(&at, driving) {
                law.respond(&at, m.get(), Want { energy: law.is_material(), ..want }, &mut out);
            }
        }
        Ok(PointStresses { kinematics, piola, energy })
    }

    /// The smallest J at a quadrature point of each cell.
    ///
    /// # Errors
    /// [`Inadmissible`] where u is.
    pub fn min_j_of_cells(&self, state: &State) -> Result<Vec<f64>, Inadmissible> {
        let disc = self.discretization();
        let kinematics = disc.points().kinematics(&self.model().displacement(&state.u))?;
        let lowest = |(first, count): (usize, usize)| {
            kinematics[first..first + count].iter().map(|k| k.j()).fold(f64::INFINITY, f64::min)
        };
        Ok(disc.points_of_cells().into_iter().map(lowest).collect())
    }

    fn directions(&self) -> Vec<(String, Vec<f64>)> {
        let disc = self.discretization();
        let points = disc.points_of_cells();
        let mut out = Vec::new();
        for attached in self.body().actuations() {
            let mut array = vec![0.0; 3 * disc.mesh().cells()];
            let mut any = false;
            for &cell in &attached.cells {
                let place = nastic_energy::MaterialPoint { cell: cell as usize, point: points[cell as usize].0 };
                // that of a growth is no fibre: no bound of a tension depends on it
                let of_growth = || attached.law.strain_map()?.direction(place);
                if let Some(a) = attached.law.direction(place).or_else(of_growth) {
                    any = true;
                    array[3 * cell as usize..3 * cell as usize + 3].copy_from_slice(a.as_slice());
                }
            }
            if any {
                out.push((attached.name.clone(), array));
            }
        }
        out
    }

    fn fibers(&self) -> Option<Vec<f64>> {
        let disc = self.discretization();
        let points = disc.points_of_cells();
        let fiber = |cell: usize| {
            let place = nastic_energy::MaterialPoint { cell, point: points[cell].0 };
            self.body().materials_of(cell).find_map(|m| m.direction(place))
        };
        let fibers: Vec<Option<Vec3>> = (0..disc.mesh().cells()).map(fiber).collect();
        let flat = || fibers.iter().flat_map(|f| f.unwrap_or_default().as_slice().to_vec()).collect();
        fibers.iter().any(Option::is_some).then(flat)
    }
}

/// `P F^T / J`
fn cauchy<'a>(kinematics: &'a [Kinematics], piola: &'a [Mat3]) -> impl Iterator<Item = Mat3> + 'a {
    kinematics.iter().zip(piola).map(|(k, p)| p * k.f().transpose() / k.j())
}

fn by_row(tensors: impl Iterator<Item = Mat3>) -> Vec<f64> {
    tensors.flat_map(|t| t.transpose().as_slice().to_vec()).collect()
}
