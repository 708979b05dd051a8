//! The formulations of a body's cells.

use super::{CellFormulation, Formulation};
use crate::contributions::body_energy::BodyEnergy;
use crate::error::{FemError, InvertedAt};
use crate::kernels::cell_scratch::Scratch;
use crate::kernels::cell_sweep::Cells;
use crate::kernels::kernel;
use nastic_tensor::Kinematics;

impl BodyEnergy {
    /// Chooses the formulation of cells.
    pub(crate) fn set_formulation(&mut self, cells: &[u32], formulation: Formulation) -> Result<(), FemError> {
        let mesh = self.disc.mesh();
        for &cell in cells {
            let kind = mesh.cell(cell as usize).kind;
            if !formulation.kinds().contains(&kind) {
                return Err(FemError::Formulation { cell: cell as usize, kind, formulation });
            }
            let earlier = self.compositions[self.of_cell[cell as usize] as usize].formulation;
            if let Some(earlier) = earlier.filter(|earlier| *earlier != formulation) {
                return Err(FemError::FormulationConflict { cell: cell as usize, earlier, later: formulation });
            }
        }
        self.extend(cells, |composition| composition.formulation = Some(formulation));
        Ok(())
    }

    /// The formulation of a cell.
    pub fn formulation_of(&self, cell: usize) -> Formulation {
        self.compositions[self.of_cell[cell] as usize].formulation.unwrap_or_default()
    }

    pub(crate) fn arithmetic_of(&self, cell: usize) -> &'static dyn CellFormulation {
        self.formulation_of(cell).of_cells()
    }

    /// What laws see at every quadrature point of a displaced body, in the order of its points.
    ///
    /// # Errors
    /// [`InvertedAt`] where J <= 0.
    pub fn kinematics_of_laws(&self, u: &[f64]) -> Result<Vec<Kinematics>, InvertedAt> {
        let disc = self.discretization();
        let mut all = vec![Kinematics::rest(); disc.points().len()];
        for part in &disc.points().parts {
            let Some(kernel) = kernel(part.kind) else { continue };
            let cells = Cells { part, kernel, dim: disc.dim() };
            let mut scratch = Scratch::new(part, disc.dim());
            for (c, &cell) in part.cells.iter().enumerate() {
                self.arithmetic_of(cell as usize).kinematics(disc, cells, c, u, &mut scratch)?;
                all[part.first_point(c)..][..part.table.points].copy_from_slice(&scratch.kinematics);
            }
        }
        Ok(all)
    }
}
