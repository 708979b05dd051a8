//! [`HexahedraProducts`]: the tangent of a body of 27-node hexahedra by its moduli.

use crate::contributions::body_energy::BodyEnergy;
use crate::contributions::body_energy::driving::Driving;
use crate::discretization::hexahedra::Hexahedra;
use crate::error::Inadmissible;
use crate::kernels::cell_scratch::Scratch;
use crate::kernels::cell_sweep::{CellWork, sweep};
use crate::kernels::cells::Cells;
use crate::kernels::displaced::Displaced;
use crate::kernels::hexahedra::{Batch, CELLS, MODULI, NODES, ROWS};
use crate::kernels::patch::Patch;
use nastic_energy::{EnergyTerm, Response, Slots, Want};
use nastic_linear::CellProducts;
use nastic_tensor::Tangent;
use rayon::prelude::*;
use std::fmt;
use std::sync::Arc;

/// Moduli of a batch.
const BATCH: usize = NODES * MODULI * CELLS;
/// Batches handled by one task, and nodes copied by one.
const TASK: usize = 8;
const COPIED: usize = 4096;

/// `K v` of a body whose cells are all 27-node hexahedra of the standard formulation, supports left out.
pub(crate) struct HexahedraProducts {
    hexahedra: Arc<Hexahedra>,
    /// By batch, `[point][45][cell]`: moduli by coordinates of the reference cell, with quadrature weights.
    moduli: Vec<f32>,
    fixed: Vec<bool>,
}

impl BodyEnergy {
    /// Its tangent by the products of its cells; `None` unless all of them are 27-node hexahedra of the standard formulation.
    ///
    /// # Errors
    /// [`Inadmissible`] where u is.
    pub(crate) fn cell_products(
        &self,
        (to, driving): (Displaced, Driving),
        fixed: &[bool],
        parallel: bool,
    ) -> Result<Option<Arc<dyn CellProducts>>, Inadmissible> {
        let Some(hexahedra) = self.disc.hexahedra() else { return Ok(None) };
        let affine = |cells: Cells| cells.part.cells.iter().all(|&cell| self.arithmetic_of(cell as usize).is_affine());
        if !self.groups().all(|(cells, _)| affine(cells)) {
            return Ok(None);
        }
        let mut moduli = vec![0.0; hexahedra.batches() * BATCH];
        for (cells, patches) in self.groups() {
            let work = Moduli { body: self, cells, to, driving, hexahedra };
            let (mut batch, mut of_cells) = (0, vec![0.0; CELLS * NODES * MODULI]);
            sweep(&work, patches, parallel, |patch, own| {
                let c = cells.number(patch);
                if c / CELLS != batch {
                    transpose(&of_cells, &mut moduli[batch * BATCH..][..BATCH]);
                    of_cells.fill(0.0);
                    batch = c / CELLS;
                }
                of_cells[c % CELLS * NODES * MODULI..][..NODES * MODULI].copy_from_slice(own);
            })?;
            transpose(&of_cells, &mut moduli[batch * BATCH..][..BATCH]);
        }
        Ok(Some(Arc::new(HexahedraProducts { hexahedra: hexahedra.clone(), moduli, fixed: fixed.to_vec() })))
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
    cells: Cells<'a>,
    to: Displaced<'a>,
    driving: Driving<'a>,
    hexahedra: &'a Hexahedra,
}

impl CellWork for Moduli<'_> {
    type Answer = Vec<f32>;
    type Error = Inadmissible;

    fn cells(&self) -> Cells<'_> {
        self.cells
    }

    fn room(&self) -> (Vec<f32>, usize) {
        (vec![0.0; NODES * MODULI], NODES * MODULI)
    }

    fn compute(&self, patch: Patch, scratch: &mut Scratch, moduli: &mut Vec<f32>) -> Result<(), Inadmissible> {
        let c = self.cells.number(patch);
        self.body.kinematics(self.cells, patch, self.to, scratch)?;
        let want = Want { energy: false, stress: false, tangent: true };
        scratch.clear(want);
        for (range, at) in self.cells.batches(patch, &scratch.kinematics) {
            let mut out = Response { energy: &mut [], stress: &mut [], tangent: &mut scratch.tangent[range] };
            let composition = self.body.composition_of(at.cell);
            for &t in &composition.terms {
                self.body.terms[t].respond(&at, Slots::none(), want, &mut out);
            }
            for &k in &composition.actuations {
                self.body.actuations[k].law.respond(&at, self.driving.slots(k, &at), want, &mut out);
            }
        }
        let inverse = &self.cells.part.inverse[c * NODES..][..NODES];
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

impl CellProducts for HexahedraProducts {
    fn of_cells(&self, v: &[f64], room: &mut Vec<f32>, parallel: bool) {
        let hexahedra = &*self.hexahedra;
        let nodes = v.len() / 3;
        room.resize(4 * nodes + hexahedra.batches() * ROWS, 0.0);
        let (own, rows) = room.split_at_mut(4 * nodes);
        let own = own.as_chunks_mut::<4>().0;
        let copy = |own: &mut [[f32; 4]], v: &[f64], fixed: &[bool]| {
            let of_nodes = v.as_chunks::<3>().0.iter().zip(fixed.as_chunks::<3>().0);
            for (own, (v, fixed)) in own.iter_mut().zip(of_nodes) {
                (0..3).for_each(|i| own[i] = if fixed[i] { 0.0 } else { v[i] as f32 });
            }
        };
        let multiply = |own: &[[f32; 4]], first: usize, rows: &mut [f32]| {
            for (at, rows) in rows.chunks_exact_mut(ROWS).enumerate() {
                let batch = first + at;
                let moduli = &self.moduli[batch * BATCH..][..BATCH];
                let (line, nodes) = (hexahedra.line(), hexahedra.nodes_of(batch));
                Batch { line, moduli, nodes, v: own, rows }.multiply();
            }
        };
        if !parallel {
            copy(own, v, &self.fixed);
            multiply(own, 0, rows);
            return;
        }
        let vectors = v.par_chunks(3 * COPIED).zip(self.fixed.par_chunks(3 * COPIED));
        own.par_chunks_mut(COPIED).zip(vectors).for_each(|(own, (v, fixed))| copy(own, v, fixed));
        let own = &*own;
        rows.par_chunks_mut(TASK * ROWS).enumerate().for_each(|(task, rows)| multiply(own, TASK * task, rows));
    }

    #[inline]
    fn at_node(&self, node: usize, of_cells: &[f32]) -> [f64; 3] {
        let nodes = self.fixed.len() / 3;
        let (rows, fixed) = (&of_cells[4 * nodes..], &self.fixed[3 * node..3 * node + 3]);
        let mut sum = [0.0; 3];
        for &at in self.hexahedra.places(node) {
            for (i, sum) in sum.iter_mut().enumerate() {
                *sum += f64::from(rows[at as usize + CELLS * i]);
            }
        }
        std::array::from_fn(|i| if fixed[i] { 0.0 } else { sum[i] })
    }

    fn bytes(&self) -> usize {
        size_of_val(&self.moduli[..]) + self.fixed.len()
    }
}

impl fmt::Debug for HexahedraProducts {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "HexahedraProducts({} batches of {CELLS} cells)", self.hexahedra.batches())
    }
}
