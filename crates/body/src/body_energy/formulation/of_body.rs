//! The formulations of a body's cells.

use super::{CellFormulation, Formulation};
use crate::body_energy::BodyEnergy;
use crate::discretization::parted::not_over_ranks;
use crate::error::{FemError, Inadmissible};
use crate::kernels::cell_scratch::Scratch;
use crate::kernels::cells::Cells;
use crate::kernels::displaced::Displaced;
use crate::kernels::patch::{Patch, Patches};
use nastic_tensor::Kinematics;
use std::collections::BTreeMap;

impl BodyEnergy {
    /// Chooses the formulation of cells.
    pub fn set_formulation(&mut self, cells: &[u32], formulation: Formulation) -> Result<(), FemError> {
        let mesh = self.disc.mesh();
        for &cell in cells {
            let kind = mesh.cell(cell as usize).kind;
            if !formulation.kinds().contains(&kind) {
                return Err(FemError::Formulation { cell: cell as usize, kind, formulation });
            }
            if formulation.takes_patches(kind) {
                self.check_whole_patch(cell, formulation)?;
            }
            let earlier = self.compositions[self.of_cell[cell as usize] as usize].formulation;
            if let Some(earlier) = earlier.filter(|earlier| *earlier != formulation) {
                return Err(FemError::FormulationConflict { cell: cell as usize, earlier, later: formulation });
            }
        }
        self.extend(cells, |composition| composition.formulation = Some(formulation))?;
        let structure = self.structure.with_couplings(&self.patches_of(cells))?;
        self.set_structure(structure)
    }

    /// Refuses a patch of which other ranks have cells.
    fn check_whole_patch(&self, cell: u32, formulation: Formulation) -> Result<(), FemError> {
        let Some((part, share)) = self.disc.over_ranks() else { return Ok(()) };
        let Some(other) = part.cuts_patch_of(cell) else { return Ok(()) };
        let (kind, own) = (self.disc.mesh().cell(cell as usize).kind.name(), share.team().rank());
        let whole = part.cells()[cell as usize];
        let why = format!(
            "the patch of cell {whole} of the whole mesh has cells on ranks {own} and {other}: divide the cells by Mesh::with_whole_patches"
        );
        Err(not_over_ranks(&format!("the formulation {formulation} of {kind} cells"), &why))
    }

    /// The nodes of the patches that these cells are in by their formulation.
    fn patches_of(&self, cells: &[u32]) -> Vec<Vec<u32>> {
        let mut patches: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
        for &cell in cells.iter().filter(|&&cell| self.is_in_patch(cell)) {
            patches.entry(self.disc.patches()[cell as usize]).or_default().push(cell);
        }
        patches.into_values().map(|cells| self.disc.mesh().nodes_of_cells(&cells)).collect()
    }

    /// The formulation of a cell.
    pub fn formulation_of(&self, cell: usize) -> Formulation {
        self.compositions[self.of_cell[cell] as usize].formulation.unwrap_or_default()
    }

    /// Whether its formulation takes a cell together with others.
    pub(crate) fn is_in_patch(&self, cell: u32) -> bool {
        self.formulation_of(cell as usize).takes_patches(self.disc.mesh().cell(cell as usize).kind)
    }

    pub(crate) fn arithmetic_of(&self, cell: usize) -> &'static dyn CellFormulation {
        self.formulation_of(cell).of_cells()
    }

    /// The cells of the mesh that share a mean dilatation: one by itself, or a patch of several. Every cell is in one of them.
    pub fn patches(&self) -> impl Iterator<Item = Vec<u32>> {
        let of_group = |(cells, patches): (Cells<'_>, &Patches)| {
            let patch = |patch: Patch| patch.cells.iter().map(|&c| cells.part.cells[c as usize]).collect();
            patches.iter().map(patch).collect::<Vec<_>>()
        };
        self.groups().flat_map(of_group).collect::<Vec<_>>().into_iter()
    }

    /// What laws see at every quadrature point of a displaced body, in the order of its points.
    ///
    /// # Errors
    /// [`Inadmissible`] where u is.
    pub fn kinematics_of_laws(&self, u: &[f64]) -> Result<Vec<Kinematics>, Inadmissible> {
        let mut all = vec![Kinematics::rest(); self.disc.points().len()];
        for (cells, patches) in self.groups() {
            let mut scratch = Scratch::new(cells);
            for patch in patches.iter() {
                self.arithmetic_of(cells.first(patch)).kinematics(
                    &self.disc,
                    cells,
                    patch,
                    Displaced::by(u),
                    &mut scratch,
                )?;
                for (_, at) in cells.batches(patch, &scratch.kinematics) {
                    all[at.first..][..at.len()].copy_from_slice(at.kinematics);
                }
            }
        }
        Ok(all)
    }
}
