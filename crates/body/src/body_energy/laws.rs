//! The laws of a body and the cells that each acts on.

use crate::body_energy::BodyEnergy;
use crate::body_energy::cell_law::{CellLaw, LawSlots};
use crate::body_energy::driving::Driving;
use crate::body_energy::formulation::Formulation;
use crate::controls::Controls;
use crate::error::FemError;
use crate::kernels::cells::Cells;
use crate::kernels::patch::Patch;
use nastic_energy::{EnergyError, EnergyTerm, MaterialPoint, PointBatch, Slot, Slots};
use nastic_mesh::GroupNames;
use std::sync::Arc;

/// A law with slots by name and place: an actuation, a material with numbers of its own as slots, a viscous law.
#[derive(Debug, Clone)]
pub struct AttachedLaw {
    /// Name, unique in the body.
    pub name: String,
    /// The law.
    pub law: Arc<dyn EnergyTerm>,
    /// The regions it acts on.
    pub regions: GroupNames,
    /// Their cells.
    pub cells: Vec<u32>,
}

impl AttachedLaw {
    /// Whether its slots have one value for all points.
    pub fn is_global(&self) -> bool {
        self.law.slots().iter().any(Slot::is_global)
    }

    /// Its slots at a point, of the values of all points.
    pub(super) fn slots_at<'v>(&self, values: &'v [f64], at: MaterialPoint) -> &'v [f64] {
        let width = self.law.slots().len();
        if self.is_global() { values } else { &values[at.point * width..][..width] }
    }

    /// Its slots that are controls: none of a viscous law, whose slots are internal variables.
    pub fn controlled_slots(&self) -> &[Slot] {
        let slots = self.law.slots();
        if slots.iter().any(Slot::is_internal) { &[] } else { slots }
    }
}

/// A set of terms that acts on cells: indices into those of the body.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Composition {
    /// Laws without slots.
    pub terms: Vec<usize>,
    /// Laws with slots.
    pub actuations: Vec<usize>,
    /// Which of these the others grow by.
    pub growth: Option<usize>,
    /// Which of these is the change of the body's shape, behind which they grow.
    pub shape: Option<usize>,
    /// None chosen: the standard one.
    pub formulation: Option<Formulation>,
}

impl BodyEnergy {
    /// The materials of a cell.
    pub fn materials_of(&self, cell: usize) -> impl Iterator<Item = &Arc<dyn EnergyTerm>> {
        let Composition { terms, actuations, .. } = self.composition_of(cell);
        let own = actuations.iter().filter(|&&k| !self.is_growth(k)).map(|&k| &self.actuations[k].law);
        let with_slots = own.filter(|law| law.is_material());
        terms.iter().map(|&t| &self.terms[t]).chain(with_slots)
    }

    /// The materials of a cell without its growth, with what the designs among the controls are there; viscous ones are relaxed.
    pub(super) fn ungrown_materials<'b>(
        &'b self,
        at: &'b PointBatch,
        controls: &'b Controls,
    ) -> impl Iterator<Item = (&'b Arc<dyn EnergyTerm>, Slots<'b>)> {
        let Composition { terms, actuations, .. } = self.composition_of(at.cell);
        let own = actuations.iter().filter(|&&k| !self.is_growth(k) && self.actuations[k].law.is_material());
        let slots = move |k: usize| Driving::relaxed(controls).slots(k, at);
        let with_slots = own.map(move |&k| (&self.actuations[k].law, slots(k)));
        terms.iter().map(|&t| (&self.terms[t], Slots::none())).chain(with_slots)
    }

    /// The laws of a cell as they are evaluated there.
    pub(crate) fn laws_of(&self, cell: usize) -> &[CellLaw] {
        &self.laws[self.of_cell[cell] as usize]
    }

    /// The law of a cell whose own slots are those of an index among the laws with slots.
    pub(crate) fn law_of(&self, cell: usize, own: usize) -> Option<&CellLaw> {
        self.laws_of(cell).iter().find(|law| law.blocks.first() == Some(&own) && !self.is_growth(own))
    }

    /// Whether the k-th law with slots, of all that can be controlled, is a growth.
    pub fn grows_by(&self, k: usize) -> bool {
        k < self.actuations.len() && self.is_growth(k)
    }

    /// Whether some of its cells grow.
    pub fn grows(&self) -> bool {
        (0..self.actuations.len()).any(|k| self.is_growth(k))
    }

    /// Why the k-th law with slots, a growth, refuses values that they have at a point, given the slot and its value at rest; `None` where it does not, and
    /// of another law.
    pub fn refused_growth(&self, k: usize, value: impl Fn(MaterialPoint, usize, f64) -> f64) -> Option<&'static str> {
        let law = &self.actuations.get(k)?.law;
        let map = law.strain_map()?;
        let slots = law.slots().len();
        let refuses = |at: MaterialPoint| {
            let values: Vec<f64> = (0..slots).map(|slot| value(at, slot, law.rest(at, slot))).collect();
            !map.admits(at, &values)
        };
        self.places(k).any(refuses).then(|| map.limit())
    }

    pub(super) fn is_growth(&self, actuation: usize) -> bool {
        self.actuations[actuation].law.strain_map().is_some()
    }

    /// The materials of a cell with what their slots hold there.
    pub(crate) fn materials<'b>(
        &'b self,
        at: &'b PointBatch,
        driving: Driving<'b>,
    ) -> impl Iterator<Item = (&'b Arc<dyn EnergyTerm>, LawSlots<'b>)> {
        self.laws(at, driving).filter(|(law, _)| law.is_material())
    }

    /// All laws of a cell with what their slots hold there, those without slots of their own first.
    pub fn laws<'b>(
        &'b self,
        at: &'b PointBatch,
        driving: Driving<'b>,
    ) -> impl Iterator<Item = (&'b Arc<dyn EnergyTerm>, LawSlots<'b>)> {
        self.laws_of(at.cell).iter().map(move |own| (&own.law, driving.of_law(own, at)))
    }

    pub(super) fn composition_of(&self, cell: usize) -> &Composition {
        &self.compositions[self.of_cell[cell] as usize]
    }

    /// Whether an actuation acts on a cell of a patch.
    pub(super) fn is_actuated(&self, cells: Cells, patch: Patch) -> bool {
        patch.cells.iter().any(|&c| {
            let cell = cells.part.cells[c as usize] as usize;
            !self.composition_of(cell).actuations.is_empty()
        })
    }

    /// Adds a passive law on cells.
    ///
    /// # Errors
    /// A field of the law that does not fit the mesh.
    pub fn add_term(&mut self, cells: &[u32], term: Arc<dyn EnergyTerm>) -> Result<(), FemError> {
        term.check(self.disc.mesh().cells(), self.disc.points().len())?;
        self.terms.push(term);
        let new = self.terms.len() - 1;
        self.extend(cells, |composition| composition.terms.push(new))
    }

    /// Attaches an actuation.
    ///
    /// # Errors
    /// A field of the law that does not fit the mesh.
    pub fn add_actuation(&mut self, attached: AttachedLaw) -> Result<(), FemError> {
        attached.law.check(self.disc.mesh().cells(), self.disc.points().len())?;
        if attached.is_global() && !attached.law.slots().iter().all(Slot::is_global) {
            let what =
                format!("slots of \"{}\" have one value for each point and one for all: take two laws", attached.name);
            return Err(FemError::Meaningless { what });
        }
        let new = self.actuations.len();
        let (cells, shapes) = (attached.cells.clone(), attached.is_shape());
        let grows = attached.law.strain_map().is_some() && !shapes;
        if shapes {
            self.check_new_shape(&attached)?;
        }
        let earlier = cells.iter().find_map(|&cell| Some((cell, self.composition_of(cell as usize).growth?)));
        if let Some((cell, earlier)) = earlier.filter(|_| grows) {
            let what = format!(
                "cell {cell} grows by \"{}\" and by \"{}\"; attach them to different regions",
                self.actuations[earlier].name, attached.name
            );
            return Err(FemError::Meaningless { what });
        }
        self.actuations.push(attached);
        self.extend(&cells, |composition| {
            composition.actuations.push(new);
            composition.growth = composition.growth.or(grows.then_some(new));
            composition.shape = composition.shape.or(shapes.then_some(new));
        })
    }

    /// The same without energies in some cells.
    ///
    /// # Errors
    /// As [`add_actuation`](Self::add_actuation).
    pub fn without(&self, cells: &[u32]) -> Result<Self, FemError> {
        let mut left = self.clone();
        if !cells.is_empty() {
            left.extend(cells, |composition| {
                *composition = Composition { formulation: composition.formulation, ..Composition::default() };
            })?;
        }
        Ok(left)
    }

    pub(super) fn extend(&mut self, cells: &[u32], change: impl Fn(&mut Composition)) -> Result<(), FemError> {
        let (mut all, mut own) = (vec![0; self.compositions.len()], vec![0; self.compositions.len()]);
        self.of_cell.iter().for_each(|&old| all[old as usize] += 1);
        cells.iter().for_each(|&cell| own[self.of_cell[cell as usize] as usize] += 1);
        // one that no cell keeps is changed where it is, so that there are never more than kinds of cells
        let mut left: Vec<bool> = (0..all.len()).map(|old| own[old] > 0 && own[old] == all[old]).collect();
        let mut becomes: Vec<u32> = (0..all.len() as u32).collect();
        for old in (0..all.len()).filter(|old| own[*old] > 0) {
            let mut wanted = self.compositions[old].clone();
            change(&mut wanted);
            let is_there = |k: &usize| !left.get(*k).is_some_and(|left| *left) && self.compositions[*k] == wanted;
            let known = (0..self.compositions.len()).rev().find(is_there);
            becomes[old] = match known {
                Some(known) => known,
                None if left[old] => {
                    (self.compositions[old], left[old]) = (wanted, false);
                    old
                }
                None => {
                    self.compositions.push(wanted);
                    self.compositions.len() - 1
                }
            } as u32;
        }
        for &cell in cells {
            let of_cell = &mut self.of_cell[cell as usize];
            *of_cell = becomes[*of_cell as usize];
        }
        self.laws = self.compositions.iter().map(|own| self.cell_laws(own)).collect::<Result<_, _>>()?;
        Ok(())
    }

    /// The laws of a composition as its cells evaluate them.
    fn cell_laws(&self, of: &Composition) -> Result<Vec<CellLaw>, EnergyError> {
        let without_slots = of.terms.iter().map(|&t| (&self.terms[t], None));
        let others = of.actuations.iter().filter(|&&k| !self.is_growth(k));
        let with_slots = others.map(|&k| (&self.actuations[k].law, Some(k)));
        // the body grows in its new shape: F G_shape^-1 G_growth^-1
        let grown = |own: CellLaw| {
            let mut maps = [of.growth, of.shape].into_iter().flatten();
            maps.try_fold(own, |own, k| own.behind(k, &self.actuations[k].law))
        };
        without_slots.chain(with_slots).map(|(law, own)| grown(CellLaw::new(law, own))).collect()
    }
}
