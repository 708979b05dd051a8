//! [`Scratch`]: working memory of a loop over cells.

use crate::discretization::quadrature_points::gather_rows;
use crate::error::Inadmissible;
use crate::kernels::cells::Cells;
use crate::kernels::dilatation::Dilatation;
use crate::kernels::displaced::Displaced;
use crate::kernels::patch::Patch;
use nastic_energy::Want;
use nastic_tensor::{Kinematics, Mat3, Tangent};

/// Working memory of one task, of the cells and points of a [`Patch`].
pub struct Scratch {
    /// Reference gradients of the shape functions, in physical coordinates.
    pub g: Vec<f64>,
    rows: Vec<f64>,
    /// Quadrature weights.
    pub weights: Vec<f64>,
    /// `1 + grad u` at the points.
    pub gradients: Vec<Mat3>,
    /// F, H and J of them.
    pub kinematics: Vec<Kinematics>,
    /// Gradient of another field, see [`Scratch::change_by`].
    pub change: Vec<Mat3>,
    /// Gradient of a direction by controls.
    pub by_control: Vec<Mat3>,
    /// Energy densities.
    pub energy: Vec<f64>,
    /// First Piola-Kirchhoff stresses.
    pub stress: Vec<Mat3>,
    /// Stress of the actuations alone.
    pub driving: Vec<Mat3>,
    /// Tangents `dP/dF`.
    pub tangent: Vec<Tangent>,
    /// Memory of the arithmetic of a kind of cell.
    pub work: Vec<f64>,
    /// Of formulations that change the dilatation.
    pub dilatation: Dilatation,
}

impl Scratch {
    /// For the cells of one kind.
    pub fn new(cells: Cells) -> Self {
        let points = cells.part.table.points;
        Scratch {
            g: vec![0.0; cells.part.table.gradients.len()],
            rows: vec![0.0; cells.row_length()],
            weights: Vec::with_capacity(points),
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

    /// Shape gradients, weights and kinematics of a displaced patch.
    pub fn move_to(&mut self, cells: Cells, patch: Patch, to: Displaced) -> Result<(), Inadmissible> {
        let (part, points) = (cells.part, cells.part.table.points);
        self.g.resize(patch.cells.len() * part.table.gradients.len(), 0.0);
        self.weights.clear();
        for (&c, g) in patch.cells.iter().zip(self.g.chunks_exact_mut(part.table.gradients.len())) {
            let inverse = &part.inverse[c as usize * points..][..points];
            cells.kernel.gradients(&part.table.gradients, inverse, g);
            self.weights.extend_from_slice(cells.weights_of(c));
        }
        self.gradients.clear();
        if let Some(known) = to.known {
            let of_cell = |&c: &u32| &known[part.first_point(c as usize)..][..points];
            patch.cells.iter().for_each(|c| self.gradients.extend_from_slice(of_cell(c)));
        } else {
            self.gradients.resize(patch.cells.len() * points, Mat3::identity());
            add_gradients(cells, patch, &self.g, &mut self.rows, to.u, &mut self.gradients);
        }
        self.kinematics.clear();
        for (q, f) in self.gradients.iter().enumerate() {
            let refused = |jacobian| cells.inverted_at(patch, q, jacobian);
            let kinematics = Kinematics::new(*f).map_err(|inverted| refused(inverted.jacobian))?;
            self.kinematics.push(kinematics);
        }
        Ok(())
    }

    /// The gradient of another nodal field at the points of the patch that was moved to.
    pub fn change_by(&mut self, cells: Cells, patch: Patch, v: &[f64]) {
        self.change.clear();
        self.change.resize(patch.cells.len() * cells.part.table.points, Mat3::zeros());
        add_gradients(cells, patch, &self.g, &mut self.rows, v, &mut self.change);
    }
}

/// Adds the gradient of a nodal field at the points of a patch, for which there are rows of one cell.
fn add_gradients(cells: Cells, patch: Patch, g: &[f64], rows: &mut [f64], nodal: &[f64], out: &mut [Mat3]) {
    let table = &cells.part.table;
    let each = g.chunks_exact(table.gradients.len()).zip(out.chunks_exact_mut(table.points));
    for (&c, (g, out)) in patch.cells.iter().zip(each) {
        gather_rows(nodal, cells.part.nodes_of(c as usize), cells.dim, table.width, rows);
        cells.kernel.displacement_gradients(g, rows, out);
    }
}
