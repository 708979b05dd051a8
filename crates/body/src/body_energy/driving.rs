//! [`Driving`]: what the slots of actuations hold, controls or internal variables.

use crate::controls::Controls;
use crate::history::History;
use crate::instant::Instant;
use nastic_energy::{PointBatch, Slots};

/// The controls, and the internal variables of the viscous laws: of an actuation either the one or the other.
#[derive(Clone, Copy)]
pub struct Driving<'a> {
    /// The controls of all blocks.
    pub controls: &'a Controls,
    /// The internal variables of all blocks.
    pub history: &'a History,
}

impl<'a> Driving<'a> {
    /// Those of an instant.
    pub fn of(at: &Instant<'a>) -> Self {
        Driving { controls: at.controls, history: at.history() }
    }

    /// Of a body whose viscous laws are relaxed.
    pub fn relaxed(controls: &'a Controls) -> Self {
        Driving { controls, history: History::relaxed() }
    }

    /// Number of slots of the k-th actuation; 0 of a viscous law that is relaxed.
    pub fn width(&self, k: usize) -> usize {
        self.controls.slots(k).max(self.history.width(k))
    }

    /// The slots of the k-th actuation at the points of one cell.
    pub fn slots(&self, k: usize, at: &PointBatch) -> Slots<'a> {
        match self.history.width(k) {
            0 => slots(self.controls, k, at),
            width => of_batch(self.history.values(k), width, at),
        }
    }
}

/// The controls of the k-th actuation at the points of one cell.
pub(crate) fn slots<'a>(controls: &'a Controls, k: usize, at: &PointBatch) -> Slots<'a> {
    let (values, width) = (controls.values(k), controls.slots(k));
    if values.len() == width { Slots::shared(values) } else { of_batch(values, width, at) }
}

fn of_batch<'a>(values: &'a [f64], width: usize, at: &PointBatch) -> Slots<'a> {
    Slots::by_point(&values[at.first * width..(at.first + at.len()) * width], width)
}
