//! Internal variables of the viscous laws of a body, which are slots of its [`Controls`]: a state has those of the step that led to
//! it, from which and from its displacement those of the next step follow.

use crate::contributions::body_energy::BodyEnergy;
use crate::contributions::controls::Controls;
use crate::error::Inadmissible;
use crate::kernels::cell_scratch::Scratch;
use nastic_energy::{Evolution, Place};
use nastic_tensor::Mat3;
use rayon::prelude::*;

/// Blocks of controls with internal variables: index and values.
pub(crate) type History = Vec<(usize, Vec<f64>)>;

impl BodyEnergy {
    fn evolutions(&self) -> impl Iterator<Item = (usize, &dyn Evolution)> {
        self.actuations.iter().enumerate().filter_map(|(k, attached)| Some((k, attached.law.evolution()?)))
    }

    /// Whether it has internal variables.
    pub(crate) fn has_history(&self) -> bool {
        self.evolutions().next().is_some()
    }

    /// Whether the forces at an instant do not depend on the velocity through internal variables.
    pub(crate) fn is_known_at_instants(&self) -> bool {
        self.evolutions().all(|(_, evolution)| evolution.is_known_at_instants())
    }

    /// The points of the cells that the k-th actuation acts on, with the place of each.
    fn points_of(&self, k: usize) -> Vec<Place> {
        let ranges = self.disc.points_of_cells();
        let cells = self.actuations[k].cells.iter().map(|&cell| cell as usize);
        cells
            .flat_map(|cell| (ranges[cell].0..ranges[cell].0 + ranges[cell].1).map(move |point| Place { cell, point }))
            .collect()
    }

    /// The internal variables of the step behind a state of this displacement and these controls, without its length.
    pub(crate) fn next_history(&self, u: &[f64], controls: &Controls, parallel: bool) -> Result<History, Inadmissible> {
        if !self.has_history() {
            return Ok(Vec::new());
        }
        let kinematics = self.kinematics_of_laws(u)?;
        let next = |(k, evolution): (usize, &dyn Evolution)| {
            let (now, width) = (controls.values(k), controls.slots(k));
            let advance = |place: &Place| {
                let slots = &now[width * place.point..][..width];
                let mut own = slots.to_vec();
                evolution.advance(*place, &kinematics[place.point], slots, &mut own);
                own
            };
            let places = self.points_of(k);
            let found: Vec<Vec<f64>> = match parallel {
                true => places.par_iter().with_min_len(64).map(advance).collect(),
                false => places.iter().map(advance).collect(),
            };
            let mut next = vec![0.0; now.len()];
            for (place, own) in places.iter().zip(found) {
                next[width * place.point..][..width].copy_from_slice(&own);
            }
            (k, next)
        };
        Ok(self.evolutions().map(next).collect())
    }

    /// Puts internal variables into the controls of a step of this length.
    pub(crate) fn put_history(&self, history: &History, dt: f64, controls: &mut Controls) {
        for (k, values) in history {
            let Some(evolution) = self.actuations[*k].law.evolution() else { continue };
            let width = controls.slots(*k);
            let into = controls.values_mut(*k);
            into.copy_from_slice(values);
            for place in self.points_of(*k) {
                evolution.set_step(place, dt, &mut into[width * place.point..][..width]);
            }
        }
    }

    /// The transpose of [`next_history`](Self::next_history): adds what derivatives by its internal variables owe to the displacement
    /// of the state, and returns what they owe to those of the step before.
    pub(crate) fn history_vjp(
        &self,
        u: &[f64],
        controls: &Controls,
        by_next: &History,
        by_u: &mut [f64],
    ) -> Result<History, Inadmissible> {
        let kinematics = self.kinematics_of_laws(u)?;
        let mut by_f = vec![Mat3::zeros(); kinematics.len()];
        let mut out = Vec::new();
        for (k, by_next) in by_next {
            let Some(evolution) = self.actuations[*k].law.evolution() else { continue };
            let (now, width) = (controls.values(*k), controls.slots(*k));
            let mut before = vec![0.0; now.len()];
            for place in self.points_of(*k) {
                let own = width * place.point..width * (place.point + 1);
                let (slots, by_next) = (&now[own.clone()], &by_next[own.clone()]);
                let by_f = &mut by_f[place.point];
                evolution.advance_vjp(place, &kinematics[place.point], slots, by_next, by_f, &mut before[own]);
            }
            out.push((*k, before));
        }
        self.add_forces(u, &by_f, by_u)?;
        Ok(out)
    }

    /// Adds `sum_q by_F : dF/du` at the points: nodal forces of stresses that carry their weights.
    fn add_forces(&self, u: &[f64], by_f: &[Mat3], nodal: &mut [f64]) -> Result<(), Inadmissible> {
        for (cells, patches) in self.groups() {
            let (mut scratch, mut rows) = (Scratch::new(cells), Vec::new());
            for patch in patches.iter() {
                let of_cell = |&c: &u32| &by_f[cells.part.first_point(c as usize)..][..cells.part.table.points];
                let stress = patch.cells.iter().flat_map(of_cell).copied().collect::<Vec<Mat3>>();
                if stress.iter().all(|stress| *stress == Mat3::zeros()) {
                    continue;
                }
                let formulation = self.arithmetic_of(cells.first(patch));
                formulation.kinematics(&self.disc, cells, patch, u, &mut scratch)?;
                cells.clear_rows(patch, &mut rows);
                formulation.add_force(cells, &scratch, &stress, &mut rows);
                cells.scatter(patch, &rows, nodal);
            }
        }
        Ok(())
    }
}
