//! The consistent mass matrix of a body whose density is constant in every cell.

use super::TangentStructure;
use crate::discretization::quadrature_points::QuadraturePoints;
use crate::error::FemError;
use nastic_linear::SparseMatrix;

impl TangentStructure {
    /// The consistent mass matrix `M_ab = int rho N_a N_b dX`, the same for every displacement component, in kg where
    /// densities (by cell) are in kg/m^3; in plane strain per unit of thickness.
    ///
    /// # Errors
    /// As [`mass_rule`](Self::mass_rule).
    pub fn consistent_mass(&self, density: &[f64]) -> Result<SparseMatrix, FemError> {
        Ok(self.mass_by(&self.mass_rule()?, density))
    }

    /// The rule that is exact for `N_a N_b` on an affine cell; the default rule of linear simplices has one point, with which M would be singular.
    ///
    /// # Errors
    /// [`FemError::InvertedReference`] at a point of that rule.
    pub fn mass_rule(&self) -> Result<QuadraturePoints, FemError> {
        let cells = 0..self.mesh().cells() as u32;
        QuadraturePoints::of_cells(self.mesh(), cells, |kind| kind.rule_of_degree(2 * kind.order()))
    }

    /// The same by a rule over all cells.
    pub fn mass_by(&self, sampling: &QuadraturePoints, density: &[f64]) -> SparseMatrix {
        let (dim, mut mass) = (self.mesh().dim(), self.matrix());
        for (p, part) in sampling.parts.iter().enumerate() {
            let nodes = part.table.nodes;
            let n = dim * nodes;
            let pairs = nodes * (nodes + 1) / 2;
            let mut element = vec![0.0; n * n];
            for (c, map) in self.scatter(p).chunks_exact(pairs).enumerate() {
                element.fill(0.0);
                let first = part.first_point(c);
                for (q, weight) in sampling.weights()[first..first + part.table.points].iter().enumerate() {
                    let shapes = part.table.shapes_at(q);
                    let weight = weight * density[part.cells[c] as usize];
                    for (a, n_a) in shapes.iter().enumerate() {
                        for (b, n_b) in shapes.iter().enumerate().take(a + 1) {
                            let value = weight * n_a * n_b;
                            (0..dim).for_each(|i| element[n * (dim * a + i) + dim * b + i] += value);
                        }
                    }
                }
                self.pattern().scatter(map, &element, &mut mass.values);
            }
        }
        mass
    }
}
