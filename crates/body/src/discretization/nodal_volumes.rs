//! The volume of a body divided among its nodes.

use crate::discretization::Discretization;

impl Discretization {
    /// Reference volume (area in two dimensions) of every node, positive for all kinds of cells, the sum that of the
    /// body: of each cell `V_a = V int N_a^2 dX / sum_b int N_b^2 dX`, the diagonal of the consistent mass matrix
    /// scaled to the volume V.
    ///
    /// Row sums `int N_a dX` are negative at corners of serendipity cells and zero at those of quadratic triangles.
    /// Hinton, Rock, Zienkiewicz, "A note on mass lumping and related processes in the finite element method",
    /// Earthquake Eng. Struct. Dyn. 4 (1976).
    pub fn nodal_volumes(&self) -> Vec<f64> {
        self.nodal_integrals(|_| 1.0)
    }

    /// [`nodal_volumes`](Self::nodal_volumes) with a density that is constant in every cell.
    pub(crate) fn nodal_integrals(&self, density: impl Fn(usize) -> f64) -> Vec<f64> {
        let mut volumes = vec![0.0; self.mesh().points().len()];
        for part in &self.points().parts {
            for c in 0..part.cells.len() {
                let first = part.first_point(c);
                let weights = &self.points().weights()[first..first + part.table.points];
                let mut squares = vec![0.0; part.table.nodes];
                for (q, w) in weights.iter().enumerate() {
                    squares.iter_mut().zip(part.table.shapes_at(q)).for_each(|(sum, n)| *sum += w * n * n);
                }
                let volume = density(part.cells[c] as usize) * weights.iter().sum::<f64>();
                let share = volume / squares.iter().sum::<f64>();
                for (&node, square) in part.nodes_of(c).iter().zip(&squares) {
                    volumes[node as usize] += share * square;
                }
            }
        }
        volumes
    }

    /// [`nodal_volumes`](Self::nodal_volumes) by unknown.
    pub fn volumes_by_unknown(&self) -> Vec<f64> {
        self.nodal_volumes().into_iter().flat_map(|volume| std::iter::repeat_n(volume, self.dim())).collect()
    }

    /// The lumped mass of every unknown: [`nodal_volumes`](Self::nodal_volumes) with densities by cell, by diagonal
    /// scaling (HRZ), which is positive on all kinds of cells. On linear simplices and parallelepipeds it is the row
    /// sum of the consistent mass.
    pub fn lumped_mass(&self, density: &[f64]) -> Vec<f64> {
        let nodal = self.nodal_integrals(|cell| density[cell]);
        nodal.into_iter().flat_map(|mass| std::iter::repeat_n(mass, self.dim())).collect()
    }
}
