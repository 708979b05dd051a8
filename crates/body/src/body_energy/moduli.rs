//! The moduli of a body of 27-node hexahedra, from which [`HexahedraProducts`] makes its tangent.

use crate::body_energy::BodyEnergy;
use crate::body_energy::driving::Driving;
use crate::body_energy::hexahedra_products::{BATCH, HexahedraProducts};
use crate::discretization::hexahedra::Hexahedra;
use crate::error::Inadmissible;
use crate::kernels::cell_scratch::Scratch;
use crate::kernels::cells::Cells;
use crate::kernels::displaced::Displaced;
use crate::kernels::hexahedra::{CELLS, MODULI, NODES};
use crate::kernels::patch::Patch;
use nastic_energy::{EnergyTerm, Response, Want};
use nastic_tensor::Tangent;
use std::sync::Arc;

impl BodyEnergy {
    /// Whether all of its cells are 27-node hexahedra of the standard formulation.
    pub fn has_cell_products(&self) -> bool {
        let affine = |cells: Cells| cells.part.cells.iter().all(|&cell| self.arithmetic_of(cell as usize).is_affine());
        self.disc.hexahedra().is_some() && self.groups().all(|(cells, _)| affine(cells))
    }

    /// Its tangent by the products of its cells; `None` unless all of them are 27-node hexahedra of the standard formulation.
    ///
    /// # Errors
    /// [`Inadmissible`] where u is.
    pub fn cell_products(
        &self,
        to: Displaced,
        driving: Driving,
        fixed: &[bool],
        parallel: bool,
    ) -> Result<Option<Arc<HexahedraProducts>>, Inadmissible> {
        let Some(hexahedra) = self.disc.hexahedra().filter(|_| self.has_cell_products()) else { return Ok(None) };
        let mut moduli = vec![0.0; hexahedra.batches() * BATCH];
        let work = Moduli { body: self, to, driving, hexahedra };
        let (mut batch, mut of_cells) = (0, vec![0.0; CELLS * NODES * MODULI]);
        self.sweep(
            parallel,
            |_| NODES * MODULI,
            |cells, patch, scratch, own: &mut Vec<f32>| work.compute(cells, patch, scratch, own),
            |cells, patch, own| {
                let c = cells.number(patch);
                if c / CELLS != batch {
                    transpose(&of_cells, &mut moduli[batch * BATCH..][..BATCH]);
                    of_cells.fill(0.0);
                    batch = c / CELLS;
                }
                of_cells[c % CELLS * NODES * MODULI..][..NODES * MODULI].copy_from_slice(own);
            },
        )?;
        transpose(&of_cells, &mut moduli[batch * BATCH..][..BATCH]);
        Ok(Some(Arc::new(HexahedraProducts::new(hexahedra.clone(), moduli, fixed))))
    }
}

/// From cell by cell to modulus by modulus.
fn transpose(of_cells: &[f32], batch: &mut [f32]) {
    for (k, moduli) in batch.as_chunks_mut::<CELLS>().0.iter_mut().enumerate() {
        (0..CELLS).for_each(|cell| moduli[cell] = of_cells[cell * NODES * MODULI + k]);
    }
}

/// The moduli of every cell.
struct Moduli<'a> {
    body: &'a BodyEnergy,
    to: Displaced<'a>,
    driving: Driving<'a>,
    hexahedra: &'a Hexahedra,
}

impl Moduli<'_> {
    fn compute(
        &self,
        cells: Cells,
        patch: Patch,
        scratch: &mut Scratch,
        moduli: &mut Vec<f32>,
    ) -> Result<(), Inadmissible> {
        let c = cells.number(patch);
        self.body.kinematics(cells, patch, self.to, Some(self.driving), scratch)?;
        let want = Want { energy: false, stress: false, tangent: true };
        scratch.clear(want);
        for (range, at) in cells.batches(patch, &scratch.kinematics) {
            let mut out = Response { energy: &mut [], stress: &mut [], tangent: &mut scratch.tangent[range] };
            for (law, m) in self.body.laws(&at, self.driving) {
                law.respond(&at, m.get(), want, &mut out);
            }
        }
        moduli.resize(NODES * MODULI, 0.0);
        let inverse = &cells.part.inverse[c * NODES..][..NODES];
        for (q, (tangent, &weight)) in scratch.tangent.iter().zip(&scratch.weights).enumerate() {
            let at = self.hexahedra.point(q);
            put_moduli(tangent, &inverse[q], weight, &mut moduli[at * MODULI..][..MODULI]);
        }
        Ok(())
    }
}

/// `A_iKjM = w C_iJjL xi_KJ xi_ML` for `3 i + K <= 3 j + M`, row by row.
fn put_moduli(tangent: &Tangent, inverse: &[f64; 9], weight: f64, moduli: &mut [f32]) {
    // by the second pair first: half[iJ][jM]
    let mut half = [[0.0; 9]; 9];
    for (row, half) in tangent.0.as_chunks::<9>().0.iter().zip(&mut half) {
        for (at, half) in half.iter_mut().enumerate() {
            let (j, m) = (at / 3, at % 3);
            *half = (0..3).map(|l| row[3 * j + l] * inverse[3 * m + l]).sum();
        }
    }
    let mut put = moduli.iter_mut();
    for r in 0..9 {
        let (i, k) = (r / 3, r % 3);
        for c in r..9 {
            let sum: f64 = (0..3).map(|j| inverse[3 * k + j] * half[3 * i + j][c]).sum();
            if let Some(modulus) = put.next() {
                *modulus = (weight * sum) as f32;
            }
        }
    }
}
