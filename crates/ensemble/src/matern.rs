//! [`Matern`]: Gaussian fields by a sparse operator on the nodes; [`MaternModes`]: what is kept of them.

mod modes;
mod reference_basis;

pub use modes::{Kept, MaternModes};

use nastic_control::{Basis, ControlError, FieldOperator, Space};
use nastic_fem::Discretization;
use nastic_mesh::GroupNames;
use std::f64::consts::PI;

/// A Gaussian field g of Whittle and Matern over regions: `(1 - L^2 laplace) g = c w`, natural boundary, w white noise. In the nodal space
/// `g = c A^-1 M^(1/2) w`, `A = M + L^2 K`, M lumped, K the stiffness of (multi)linear basis functions: covariance `c^2 A^-1 M A^-1`.
///
/// With `c^2 = 8 pi L^3` in space and `4 pi L^2` in the plane it has in the whole space unit variance and the covariance (`r = |X - Y|`)
///
/// | | covariance | falls to 0.14 at |
/// |---|---|---|
/// | space | `exp(-r/L)` | 2 L |
/// | plane | `r/L K_1(r/L)` | 2.8 L |
///
/// The natural boundary reflects the field: its variance is 2, 4, 8 on a face, an edge, a corner of a box much larger than L, and larger in a body
/// that is thinner than L. [`modes`](Self::modes) scale that away.
///
/// Source: P. Whittle, Biometrika 41 (1954) 434-449; F. Lindgren, H. Rue & J. Lindstrom, J. R. Stat. Soc. B 73 (2011) 423-498, doi 10.1111/j.1467-9868.2011.00777.x.
#[derive(Debug)]
pub struct Matern {
    length: f64,
    scale: f64,
    cells: Vec<u32>,
    /// The unknowns at the corners of each of the cells, one after the other, and where those of each begin.
    corners: Vec<u32>,
    starts: Vec<usize>,
    entities: Vec<u32>,
    positions: Vec<[f64; 3]>,
    masses: Vec<f64>,
    spacing: f64,
    /// A and its factor.
    operator: FieldOperator,
}

impl Matern {
    /// Over the cells of regions, with the length L.
    ///
    /// # Errors
    /// A length that is not positive, unknown regions, ranks that share the body, a factor that does not fit.
    pub fn new(disc: &Discretization, regions: &GroupNames, length: f64) -> Result<Self, ControlError> {
        let fail = |what: String| ControlError::Cost { what };
        if !(length.is_finite() && length > 0.0) {
            return Err(fail(format!("the correlation length of a random field is {length}; it is a positive length")));
        }
        if disc.over_ranks().is_some() {
            let what = "a random field by the operator of Whittle and Matern needs the whole body; ranks that share one have parts of it: take one process";
            return Err(fail(what.to_owned()));
        }
        let basis = Basis::new(disc, regions, Space::Node)?;
        let (masses, operator) = FieldOperator::of_nodes(disc, &basis, length)?;
        let scale = if disc.mesh().dim() == 3 { 8.0 * PI * length.powi(3) } else { 4.0 * PI * length * length };
        let (entities, positions) = (basis.entities().to_vec(), basis.positions().to_vec());
        let mut field = Matern {
            length,
            scale: scale.sqrt(),
            cells: disc.mesh().cells_of(regions)?,
            corners: vec![],
            starts: vec![0],
            entities,
            positions,
            masses,
            spacing: 0.0,
            operator,
        };
        field.add_corners(disc);
        Ok(field)
    }

    /// Corners of the cells, and the mean of their edges, as that of the root of the mean square distance of corners from the centre: of a cube 2/sqrt 3 of it.
    fn add_corners(&mut self, disc: &Discretization) {
        let mesh = disc.mesh();
        let mut sum = 0.0;
        for cell in &self.cells {
            let cell = mesh.cell(*cell as usize);
            let own = &cell.nodes[..cell.kind.corners()];
            let at = own.iter().filter_map(|node| self.entities.binary_search(node).ok());
            self.corners.extend(at.map(|unknown| unknown as u32));
            self.starts.push(self.corners.len());
            let count = own.len() as f64;
            let points = || own.iter().map(|node| mesh.points()[*node as usize]);
            let mean = points().fold([0.0; 3], |sum, x| [0, 1, 2].map(|k| sum[k] + x[k] / count));
            let square = |x: [f64; 3]| (0..3).map(|k| (x[k] - mean[k]).powi(2)).sum::<f64>();
            sum += (points().map(square).sum::<f64>() / count).sqrt();
        }
        let of_cube = 2.0 / (mesh.dim() as f64).sqrt();
        self.spacing = of_cube * sum / self.cells.len().max(1) as f64;
    }

    /// The mean size of the cells: the edge of a cube or square whose corners are as far from its centre.
    pub fn spacing(&self) -> f64 {
        self.spacing
    }

    /// The nodes of its unknowns, ascending.
    pub fn nodes(&self) -> &[u32] {
        &self.entities
    }

    /// Where these are.
    pub fn positions(&self) -> &[[f64; 3]] {
        &self.positions
    }

    /// The covariance of the field at an unknown with that at all of them, as a share of the variance in the whole space, before any scaling: a column of `c^2 A^-1 M A^-1`.
    pub fn covariance(&self, unknown: usize) -> Vec<f64> {
        let mut column = vec![0.0; self.masses.len()];
        column[unknown] = self.scale * self.scale;
        self.operator.factor.solve(&mut column, 1);
        column.iter_mut().zip(&self.masses).for_each(|(x, mass)| *x *= mass);
        self.operator.factor.solve(&mut column, 1);
        column
    }

    /// The mean of the corners of each cell: the value at its centre of a (multi)linear field.
    fn at_cells(&self, nodal: &[f64]) -> Vec<f64> {
        let mean = |of: &[usize]| {
            let own = &self.corners[of[0]..of[1]];
            own.iter().map(|i| nodal[*i as usize]).sum::<f64>() / own.len() as f64
        };
        self.starts.windows(2).map(mean).collect()
    }
}
