//! [`ControlBlock`]: one control field, and the slots that it drives.

use crate::control_limit::ControlAt;
use crate::knots::Knots;
use crate::map::{Basis, Chain, ControlMap, Exponential, Length, Space};
use nastic_fem::Controls;
use nastic_numeric::vector::{axpy, norm};
use std::ops::Range;
use std::sync::Arc;

/// One control field: unknowns, and slots of an actuation or contribution that follow from them.
#[derive(Debug, Clone)]
pub struct ControlBlock {
    /// Name: the actuation's, or `ACTUATION.SLOTS` where it has several groups of slots.
    pub name: String,
    /// Number of components of the unknowns.
    pub components: usize,
    /// The basis functions of the unknowns.
    pub basis: Arc<Basis>,
    /// What stands between the unknowns at one instant and their expansion, once for all slots that follow: a filter, a projection. Bounds, norms, rates and
    /// smoothness of a control are those of the unknowns, [`values_of`](Self::values_of) what stands behind.
    pub field: Chain,
    /// The slots that follow from the unknowns.
    pub targets: Vec<ControlTarget>,
    /// First entry of this field in the vector.
    pub first: usize,
    /// Unit kind of the values ("Pa", "T").
    pub unit: &'static str,
    /// How messages call it.
    pub shown: Shown,
    /// Factor of its part of the inner product: see [`Layout::weigh`](crate::Layout::weigh).
    pub weight: f64,
    /// Of a control in time: its knots.
    pub knots: Option<Arc<Knots>>,
    /// Whether it moves a surface that it holds.
    pub holds: bool,
    /// Whether its unknowns are the logarithms of its values: see [`Layout::by_logarithm`](crate::Layout::by_logarithm).
    pub log: bool,
}

/// How messages call a control field: by its [`name`](ControlBlock::name) and [`unit`](ControlBlock::unit), unless [named otherwise](crate::Layout::show).
#[derive(Debug, Clone, PartialEq)]
pub struct Shown {
    /// Its name.
    pub name: String,
    /// The unit of its values.
    pub unit: String,
}

/// Consecutive slots of an actuation or contribution that a control field drives.
#[derive(Debug, Clone)]
pub struct ControlTarget {
    /// Index of the actuation or contribution among all that can be controlled.
    pub actuation: usize,
    /// First slot.
    pub slot: usize,
    /// Number of slots.
    pub slots: usize,
    /// The basis functions at its points.
    pub basis: Arc<Basis>,
    /// From the unknowns at one instant, behind [`ControlBlock::field`], to the slots at its points, `slots * point + component`.
    pub map: Chain,
    /// Whether its values come on top of fixed ones, as amplitudes along a direction do; others take their place.
    pub adds: bool,
}

impl ControlTarget {
    /// Whether it drives one of these slots at a point where a field of another basis does.
    pub(crate) fn overlaps(&self, actuation: usize, slots: &Range<usize>, basis: &Basis) -> bool {
        let points = self.basis.points().min(basis.points());
        self.actuation == actuation
            && self.slot < slots.end
            && slots.start < self.slot + self.slots
            && (points == 0 || (0..points).any(|q| self.basis.acts_at(q) && basis.acts_at(q)))
    }

    /// Writes values or changes by point into the slots (or adds them), where the field acts; other points keep theirs.
    fn write(&self, values: &[f64], controls: &mut Controls) {
        let stride = controls.slots(self.actuation);
        let points = controls.values_mut(self.actuation).chunks_exact_mut(stride).zip(values.chunks_exact(self.slots));
        for (_, (out, values)) in points.enumerate().filter(|(q, _)| self.basis.acts_at(*q)) {
            let out = &mut out[self.slot..self.slot + self.slots];
            match self.adds {
                true => out.iter_mut().zip(values).for_each(|(out, value)| *out += value),
                false => out.copy_from_slice(values),
            }
        }
    }

    /// Its slots at all points.
    fn read(&self, controls: &Controls) -> Vec<f64> {
        let points = controls.values(self.actuation).chunks_exact(controls.slots(self.actuation));
        points.flat_map(|at| &at[self.slot..self.slot + self.slots]).copied().collect()
    }
}

impl ControlBlock {
    /// Whether its values go straight where its unknowns do, but for a logarithm of the field itself: nothing between them but affine maps.
    pub fn goes_straight(&self) -> bool {
        self.field.is_empty() || (!self.log && self.field.is_affine())
    }

    /// Whether a share of its unknowns gives that share of its values.
    pub fn is_proportional(&self) -> bool {
        let at_zero = || self.field.values(&vec![0.0; self.size()]).iter().all(|value| *value == 0.0);
        self.field.is_empty() || (self.goes_straight() && at_zero())
    }

    /// Whether each value of its field can be 0 or 1 and nothing between: a scalar by cell or region, or a uniform one, not by its logarithm.
    #[must_use]
    pub fn can_be_cut(&self) -> bool {
        let by_part = matches!(self.basis.space(), Space::Uniform | Space::Region | Space::Cell);
        self.components == 1 && !self.log && by_part
    }

    /// Number of entries at one instant.
    pub fn size(&self) -> usize {
        self.basis.len() * self.components
    }

    /// Number of values in time: 1 of a control that is constant in time.
    pub fn values_in_time(&self) -> usize {
        self.knots.as_ref().map_or(1, |knots| knots.len())
    }

    /// Number of entries in the vector: entry `first + size * knot + components * unknown + component`.
    pub fn len(&self) -> usize {
        self.size() * self.values_in_time()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.basis.is_empty()
    }

    /// Its part of the vector.
    pub fn of<'m>(&self, m: &'m [f64]) -> &'m [f64] {
        &m[self.first..self.first + self.len()]
    }

    /// Its values at its unknowns: these themselves behind its [`field`](Self::field), of the [`length`](Self::length) that is fixed, or what they are the logarithms of.
    pub fn values_of(&self, unknowns: &[f64]) -> Vec<f64> {
        let values = self.of_field(match self.field.is_empty() {
            true => unknowns.to_vec(),
            false => unknowns.chunks(self.size().max(1)).flat_map(|at_knot| self.field.values(at_knot)).collect(),
        });
        match self.length() {
            None => values,
            Some(length) => Length { length, components: self.components }.values(&values),
        }
    }

    /// What its bounds are of: its unknowns, or what they are the logarithms of, in front of its [`field`](Self::field).
    pub fn free_values_of(&self, unknowns: &[f64]) -> Vec<f64> {
        self.of_field(unknowns.to_vec())
    }

    /// Its values at the quadrature points of the body, of unknowns at one instant.
    pub fn values_at_points(&self, unknowns: &[f64]) -> Vec<f64> {
        self.of_field(self.basis.values(&self.field.values(unknowns), self.components))
    }

    fn of_field(&self, field: Vec<f64>) -> Vec<f64> {
        if self.log { Exponential.values(&field) } else { field }
    }

    /// The length that its vectors have at every point, where it is fixed; see [`Layout::fix_length`](crate::Layout::fix_length).
    pub fn length(&self) -> Option<f64> {
        self.targets.iter().find_map(|target| target.map.length())
    }

    /// Its values as messages show them.
    pub(crate) fn described(&self, m: &[f64]) -> ControlAt {
        let size = |value: &[f64]| if let [one] = value { *one } else { norm(value) };
        let values = self.values_of(self.of(m));
        let sizes = values.chunks_exact(self.components).map(size);
        let range = sizes.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)]);
        ControlAt { name: self.shown.name.clone(), range, unit: self.shown.unit.clone() }
    }

    /// Whether all its slots are affine in its unknowns.
    pub fn is_affine(&self) -> bool {
        self.field.is_affine() && self.targets.iter().all(|target| target.map.is_affine())
    }

    /// The values in time that make up that at an instant, with their factors.
    pub fn weights(&self, t: f64) -> impl Iterator<Item = (usize, f64)> {
        let weights = self.knots.as_ref().map_or([(0, 1.0), (0, 0.0)], |knots| knots.weights(t));
        weights.into_iter().filter(|(_, factor)| *factor != 0.0)
    }

    /// Sets the values of its slots at the points; points the field does not reach keep theirs.
    pub fn write_values(&self, m: &[f64], controls: &mut Controls) {
        let x = self.field.values(self.of(m));
        self.targets.iter().for_each(|target| target.write(&target.map.values(&x), controls));
    }

    /// Sets their changes along a change v of the control vector at m.
    pub(crate) fn write_change(&self, m: &[f64], v: &[f64], controls: &mut Controls) {
        let (x, v) = (self.field.values(self.of(m)), self.field.change(self.of(m), self.of(v)));
        self.targets.iter().for_each(|target| target.write(&target.map.change(&x, &v), controls));
    }

    /// Adds the derivative by its unknowns, of what has this one by the values at the points.
    pub(crate) fn add_vjp(&self, m: &[f64], by_point: &Controls, out: &mut [f64]) {
        let own = self.field.vjp(self.of(m), &self.by_field(&self.field.values(self.of(m)), by_point));
        axpy(1.0, &own, &mut out[self.first..][..own.len()]);
    }

    /// The derivative by the field behind its own chain, the sum over what follows from it.
    fn by_field(&self, x: &[f64], by_point: &Controls) -> Vec<f64> {
        let mut sum = vec![0.0; x.len()];
        for target in &self.targets {
            axpy(1.0, &target.map.vjp(x, &target.read(by_point)), &mut sum);
        }
        sum
    }

    /// Adds the change of [`add_vjp`](Self::add_vjp) along a change v of the control vector, `by_point` kept.
    pub(crate) fn add_second_vjp(&self, m: &[f64], v: &[f64], by_point: &Controls, out: &mut [f64]) {
        let (m, v) = (self.of(m), self.of(v));
        let (x, moved) = (self.field.values(m), self.field.change(m, v));
        let mut change = vec![0.0; x.len()];
        for target in self.targets.iter().filter(|target| !target.map.is_affine()) {
            let own = target.map.second_vjp(&x, &moved, &target.read(by_point)).unwrap_or_default();
            axpy(1.0, &own, &mut change[..own.len()]);
        }
        let out = &mut out[self.first..][..x.len()];
        axpy(1.0, &self.field.vjp(m, &change), out);
        let curved = (!self.field.is_affine()).then(|| self.field.second_vjp(m, v, &self.by_field(&x, by_point)));
        if let Some(own) = curved.flatten() {
            axpy(1.0, &own, out);
        }
    }
}
