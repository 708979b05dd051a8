//! [`Scratch`]: working memory of a loop over cells.

use crate::discretization::quadrature_points::{CellGroup, gather_rows};
use crate::error::InvertedAt;
use crate::kernels::cell_sweep::Cells;
use crate::kernels::dilatation::Dilatation;
use nastic_energy::Want;
use nastic_tensor::{Kinematics, Mat3, Tangent};

/// Working memory of one task.
pub(crate) struct Scratch {
    pub g: Vec<f64>,
    pub rows: Vec<f64>,
    gradients: Vec<Mat3>,
    pub kinematics: Vec<Kinematics>,
    /// Gradient of another field, see [`Scratch::change_by`].
    pub change: Vec<Mat3>,
    pub by_control: Vec<Mat3>,
    pub energy: Vec<f64>,
    pub stress: Vec<Mat3>,
    /// Stress of the actuations alone.
    pub driving: Vec<Mat3>,
    pub tangent: Vec<Tangent>,
    pub work: Vec<f64>,
    /// Of formulations that change the dilatation.
    pub dilatation: Dilatation,
}

impl Scratch {
    pub fn new(part: &CellGroup, dim: usize) -> Self {
        let points = part.table.points;
        Scratch {
            g: vec![0.0; part.table.gradients.len()],
            rows: vec![0.0; dim * part.table.width],
            gradients: vec![Mat3::zeros(); points],
            kinematics: Vec::with_capacity(points),
            change: vec![Mat3::zeros(); points],
            by_control: Vec::new(),
            energy: Vec::new(),
            stress: Vec::new(),
            driving: Vec::new(),
            tangent: Vec::new(),
            work: Vec::new(),
            dilatation: Dilatation::default(),
        }
    }

    /// Zeroes what terms are going to add to.
    pub fn clear(&mut self, want: Want) {
        let points = self.gradients.len();
        self.energy.clear();
        self.energy.resize(points, 0.0);
        if want.stress {
            self.clear_stress();
        }
        if want.tangent {
            self.tangent.clear();
            self.tangent.resize(points, Tangent::zero());
        }
    }

    /// Zeroes the stresses.
    pub fn clear_stress(&mut self) {
        let points = self.gradients.len();
        for stress in [&mut self.stress, &mut self.driving] {
            stress.clear();
            stress.resize(points, Mat3::zeros());
        }
    }

    /// Shape gradients and kinematics of the c-th cell displaced by u.
    pub fn move_to(&mut self, cells: Cells, c: usize, u: &[f64]) -> Result<(), InvertedAt> {
        let Cells { part, kernel, dim } = cells;
        let points = part.table.points;
        kernel.gradients(&part.table.gradients, &part.inverse[c * points..(c + 1) * points], &mut self.g);
        gather_rows(u, part.nodes_of(c), dim, part.table.width, &mut self.rows);
        self.gradients.fill(Mat3::identity());
        kernel.displacement_gradients(&self.g, &self.rows, &mut self.gradients);
        self.kinematics.clear();
        for (q, f) in self.gradients.iter().enumerate() {
            let kinematics = Kinematics::new(*f).map_err(|inverted| InvertedAt {
                cell: part.cells[c] as usize,
                point: q,
                jacobian: inverted.jacobian,
                outside: None,
            })?;
            self.kinematics.push(kinematics);
        }
        Ok(())
    }
    /// The gradient of another nodal field at the points of the cell that was moved to.
    pub fn change_by(&mut self, cells: Cells, c: usize, v: &[f64]) {
        gather_rows(v, cells.part.nodes_of(c), cells.dim, cells.part.table.width, &mut self.rows);
        self.change.fill(Mat3::zeros());
        cells.kernel.displacement_gradients(&self.g, &self.rows, &mut self.change);
    }
}
