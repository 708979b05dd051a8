//! [`Fill`]: by what the density of a body is multiplied, by its design and its shape.

use nastic_body::body_energy::BodyEnergy;
use nastic_energy::{EnergyTerm, MaterialPoint, Slot};
use nastic_tensor::HyperDual;
use std::sync::Arc;

/// The control: the share of the full density at a quadrature point of the body.
const FILL: Slot = Slot::design("fill", "1", 1.0);

/// `f det G(a)` at the quadrature points of a body: f the fill, a design that is 1 at rest, and G(a) the change of the shape of the drawn body, whose mass is that of the volume
/// `det G dX`. Slots: a, under the name of the change of shape, and f behind them.
#[derive(Debug, Clone)]
pub struct Fill {
    slots: Vec<Slot>,
    shape: Option<Shape>,
}

#[derive(Debug, Clone)]
struct Shape {
    name: String,
    law: Arc<dyn EnergyTerm>,
    /// By quadrature point: where G is looked up, none where the shape stays.
    places: Vec<Option<MaterialPoint>>,
}

/// Numbers of all slots at a point.
type OfSlots<'a> = &'a dyn Fn(usize) -> f64;

impl Fill {
    /// Of a body, whose shape is known already.
    pub fn of(body: &BodyEnergy) -> Self {
        let shape = body.shape().map(|(_, attached)| {
            let place = |(point, cell): (usize, u32)| {
                let inside = attached.cells.binary_search(&cell).is_ok();
                inside.then_some(MaterialPoint { cell: cell as usize, point })
            };
            let places = body.discretization().points().cells().into_iter().enumerate().map(place).collect();
            Shape { name: attached.name.clone(), law: attached.law.clone(), places }
        });
        let amplitudes =
            shape.iter().flat_map(|shape| shape.law.slots()).map(|slot| Slot::design(slot.group, slot.unit, 0.0));
        Fill { slots: amplitudes.chain([FILL]).collect(), shape }
    }

    /// Whether the shape is among what it follows.
    pub fn follows_shape(&self) -> bool {
        self.shape.is_some()
    }

    /// Amplitudes of the shape, then the fill.
    pub fn slots(&self) -> &[Slot] {
        &self.slots
    }

    /// The name of the change of shape, and the number of its slots.
    pub fn shared_slots(&self) -> Option<(&str, usize)> {
        self.shape.as_ref().map(|shape| (shape.name.as_str(), self.slots.len() - 1))
    }

    /// det G at a point with its derivatives along the slot `along` and along the changes v.
    fn volume(&self, point: usize, m: OfSlots, along: Option<usize>, v: Option<OfSlots>) -> HyperDual {
        let one = HyperDual::constant(1.0);
        let Some(shape) = &self.shape else { return one };
        let (Some(map), Some(at)) = (shape.law.strain_map(), shape.places[point]) else { return one };
        let number = |k: usize| HyperDual([m(k), f64::from(u8::from(along == Some(k))), v.map_or(0.0, |v| v(k)), 0.0]);
        let numbers: Vec<HyperDual> = (0..self.slots.len() - 1).map(number).collect();
        map.volume(at, &numbers)
    }

    fn fill(&self) -> usize {
        self.slots.len() - 1
    }

    /// `f det G`.
    pub fn value(&self, point: usize, m: OfSlots) -> f64 {
        match &self.shape {
            None => m(0),
            Some(_) => m(self.fill()) * self.volume(point, m, None, None).real(),
        }
    }

    /// Its change along v.
    pub fn change(&self, point: usize, m: OfSlots, v: OfSlots) -> f64 {
        match &self.shape {
            None => v(0),
            Some(_) => {
                let volume = self.volume(point, m, None, Some(v));
                v(self.fill()) * volume.0[0] + m(self.fill()) * volume.0[2]
            }
        }
    }

    /// Its derivatives by the slots.
    pub fn each_derivative(&self, point: usize, m: OfSlots, mut call: impl FnMut(usize, f64)) {
        for k in 0..self.fill() {
            call(k, m(self.fill()) * self.volume(point, m, Some(k), None).0[1]);
        }
        call(self.fill(), if self.shape.is_none() { 1.0 } else { self.volume(point, m, None, None).real() });
    }

    /// The changes of these along v; none where there is no change of shape, as the fill itself is linear.
    pub fn each_second(&self, point: usize, m: OfSlots, v: OfSlots, mut call: impl FnMut(usize, f64)) {
        if self.shape.is_none() {
            return;
        }
        for k in 0..self.fill() {
            let volume = self.volume(point, m, Some(k), Some(v));
            call(k, v(self.fill()) * volume.0[1] + m(self.fill()) * volume.0[3]);
        }
        call(self.fill(), self.volume(point, m, None, Some(v)).0[2]);
    }
}
