//! [`CellLaw`]: a law as cells evaluate it, with the numbers that its slots hold there.

use crate::body_energy::driving::{Driving, slots};
use crate::controls::Controls;
use nastic_energy::{EnergyError, EnergyTerm, Grown, PointBatch, Slots};
use std::sync::Arc;

/// A law of some cells, behind their growth where they grow.
#[derive(Debug, Clone)]
pub struct CellLaw {
    /// The law.
    pub law: Arc<dyn EnergyTerm>,
    /// Whose slots are its own, one after the other: indices among the laws with slots, of a law that grows its own and the growth.
    pub blocks: Vec<usize>,
}

impl CellLaw {
    /// Of an index among the laws with slots, if it has slots of its own.
    pub(super) fn new(law: &Arc<dyn EnergyTerm>, own: Option<usize>) -> Self {
        CellLaw { law: law.clone(), blocks: own.into_iter().collect() }
    }

    /// The same behind the growth of an index.
    pub(super) fn behind(mut self, k: usize, growth: &Arc<dyn EnergyTerm>) -> Result<Self, EnergyError> {
        self.blocks.push(k);
        Ok(CellLaw { law: Arc::new(Grown::new(self.law, growth.clone())?), blocks: self.blocks })
    }
}

/// What the slots of a law hold at the points of one cell.
pub enum LawSlots<'a> {
    /// As they stand in one block.
    OfBlock(Slots<'a>),
    /// Put together from several.
    Joined {
        /// Point by point.
        values: Vec<f64>,
        /// Number of slots.
        width: usize,
    },
}

impl LawSlots<'_> {
    /// For a law.
    pub fn get(&self) -> Slots<'_> {
        match self {
            Self::OfBlock(slots) => *slots,
            Self::Joined { values, width } => Slots::by_point(values, *width),
        }
    }
}

impl<'a> Driving<'a> {
    /// What the slots of a law hold at the points of a cell.
    pub fn of_law(&self, law: &CellLaw, at: &PointBatch) -> LawSlots<'a> {
        match law.blocks[..] {
            [] => LawSlots::OfBlock(Slots::none()),
            [own] => LawSlots::OfBlock(self.slots(own, at)),
            _ => self.joined(law, at, |k| self.slots(k, at)),
        }
    }

    /// Changes v of the controls among the slots of a law; none of internal variables, which are zero beside others.
    pub(super) fn changes(&self, law: &CellLaw, v: &'a Controls, at: &PointBatch) -> LawSlots<'a> {
        match law.blocks[..] {
            [] => LawSlots::OfBlock(Slots::none()),
            [own] => LawSlots::OfBlock(slots(v, own, at)),
            _ => self.joined(law, at, |k| slots(v, k, at)),
        }
    }

    fn joined(&self, law: &CellLaw, at: &PointBatch, of: impl Fn(usize) -> Slots<'a>) -> LawSlots<'a> {
        let blocks: Vec<(usize, Slots)> = law.blocks.iter().map(|&k| (self.width(k), of(k))).collect();
        let width = blocks.iter().map(|(width, _)| width).sum();
        let mut values = Vec::with_capacity(width * at.len());
        for q in 0..at.len() {
            for (width, slots) in &blocks {
                values.extend((0..*width).map(|k| slots.get(q, k)));
            }
        }
        LawSlots::Joined { values, width }
    }
}
