//! Internal variables of the viscous laws of a body: from those of the step that led to a state and from its displacement those of the
//! next step follow.

use crate::body_energy::cell_law::LawSlots;
use crate::body_energy::driving::Driving;
use crate::body_energy::{AttachedLaw, BodyEnergy};
use crate::error::Inadmissible;
use crate::history::{BeforeStep, History};
use crate::instant::Instant;
use crate::kernels::cell_scratch::Scratch;
use crate::kernels::displaced::Displaced;
use nastic_energy::{EnergyTerm, Evolution, MaterialPoint, PointBatch};
use nastic_tensor::{Kinematics, Mat3};
use rayon::prelude::*;

impl BodyEnergy {
    fn evolutions(&self) -> impl Iterator<Item = (usize, &dyn Evolution)> {
        self.actuations.iter().enumerate().filter_map(|(k, attached)| Some((k, attached.law.evolution()?)))
    }

    /// How the internal variables of the k-th law with slots follow at a point, where it sees the deformation through a growth, with its slots there.
    fn evolving<'b>(
        &'b self,
        k: usize,
        at: MaterialPoint,
        kinematics: &'b Kinematics,
        driving: Driving<'b>,
    ) -> Option<(&'b dyn Evolution, LawSlots<'b>)> {
        let law = self.law_of(at.cell, k)?;
        let points = PointBatch { kinematics: std::slice::from_ref(kinematics), cell: at.cell, first: at.point };
        Some((law.law.evolution()?, driving.of_law(law, &points)))
    }

    /// Whether it has internal variables.
    pub fn has_history(&self) -> bool {
        self.evolutions().next().is_some()
    }

    /// Whether the forces at an instant do not depend on the velocity through internal variables.
    pub fn is_known_at_instants(&self) -> bool {
        self.evolutions().all(|(_, evolution)| evolution.is_known_at_instants())
    }

    /// Of every actuation the internal variables per point, and how many there are.
    pub fn memory(&self) -> impl Iterator<Item = (usize, usize)> {
        let points = self.disc.points().len();
        let width = |attached: &AttachedLaw| attached.law.slots().len() - attached.controlled_slots().len();
        self.actuations.iter().map(width).map(move |width| (width, width * points))
    }

    /// The internal variables of the step behind an instant, without its length.
    pub fn advance(&self, at: &Instant, next: &mut History) -> Result<(), Inadmissible> {
        if !self.has_history() {
            return Ok(());
        }
        let kinematics = self.kinematics_of_laws(at.u)?;
        let driving = Driving::of(at);
        for (k, _) in self.evolutions() {
            let width = at.history().width(k);
            let advance = |place: &MaterialPoint| {
                let kinematics = &kinematics[place.point];
                let mut own = Vec::new();
                if let Some((evolution, slots)) = self.evolving(k, *place, kinematics, driving) {
                    own = slots.get().values.to_vec();
                    evolution.advance(*place, kinematics, slots.get().values, &mut own);
                }
                own
            };
            let places: Vec<MaterialPoint> = self.places(k).collect();
            let found: Vec<Vec<f64>> = match at.parallel && places.len() > 1024 {
                true => places.par_iter().with_min_len(64).map(advance).collect(),
                false => places.iter().map(advance).collect(),
            };
            for (place, own) in places.iter().zip(found) {
                let next = &mut next.values_mut(k)[width * place.point..][..width];
                next.iter_mut().zip(own).for_each(|(next, own)| *next = own);
            }
        }
        Ok(())
    }

    /// Sets what depends on the length of the step.
    pub fn set_step(&self, dt: f64, history: &mut History) {
        for (k, evolution) in self.evolutions() {
            let width = history.width(k);
            let own = history.values_mut(k);
            self.places(k).for_each(|at| evolution.set_step(at, dt, &mut own[width * at.point..][..width]));
        }
    }

    /// The transpose of [`advance`](Self::advance): adds the derivatives that follow from those by its internal variables, by the displacement and by those of
    /// the step before.
    pub fn advance_vjp(&self, at: &Instant, by_next: &History, into: &mut BeforeStep) -> Result<(), Inadmissible> {
        if !self.has_history() {
            return Ok(());
        }
        let kinematics = self.kinematics_of_laws(at.u)?;
        let mut by_f = vec![Mat3::zeros(); kinematics.len()];
        let driving = Driving::of(at);
        for (k, _) in self.evolutions() {
            let (width, by_next) = (by_next.width(k), by_next.values(k));
            for place in self.places(k) {
                let kinematics = &kinematics[place.point];
                let Some((evolution, slots)) = self.evolving(k, place, kinematics, driving) else { continue };
                let (slots, own) = (slots.get().values, width * place.point..width * (place.point + 1));
                let (by_next, by_f) = (&by_next[own.clone()], &mut by_f[place.point]);
                let before = &mut into.history.values_mut(k)[own];
                let growth = self.composition_of(place.cell).growth;
                let Some(growth) = growth else {
                    evolution.advance_vjp(place, kinematics, slots, by_next, by_f, before);
                    continue;
                };
                let mut by_slots = vec![0.0; slots.len()];
                evolution.advance_vjp(place, kinematics, slots, by_next, by_f, &mut by_slots);
                let (by_own, by_growth) = by_slots.split_at(width);
                before.iter_mut().zip(by_own).for_each(|(sum, own)| *sum += own);
                let sums = into.controls.values_mut(growth);
                let first = if sums.len() == by_growth.len() { 0 } else { by_growth.len() * place.point };
                sums[first..].iter_mut().zip(by_growth).for_each(|(sum, own)| *sum += own);
            }
        }
        self.add_forces(at.u, &by_f, &mut into.u)
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
                formulation.kinematics(&self.disc, cells, patch, Displaced::by(u), &mut scratch)?;
                cells.clear_rows(patch, &mut rows);
                formulation.add_force(cells, &scratch, &stress, &mut rows);
                cells.scatter(patch, &rows, nodal);
            }
        }
        Ok(())
    }
}
