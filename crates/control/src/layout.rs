//! [`Layout`]: how the control fields of a problem stand one after the other in one vector.

use crate::error::ControlError;
use crate::map::{ControlMap, Space};
use crate::scaling::Scaling;
use crate::time::Knots;
use nastic_energy::SlotGroup;
use nastic_fem::{Controllable, Controls, Solid};
use nastic_numeric::vector::{axpy, norm};
use std::sync::Arc;

/// One control field: some slots of one actuation, with a space.
#[derive(Debug, Clone)]
pub struct ControlBlock {
    /// Name: the actuation's, or `ACTUATION.SLOTS` where it has several groups of slots.
    pub name: String,
    /// Index of the actuation in the body.
    pub actuation: usize,
    /// First slot.
    pub slot: usize,
    /// Number of components: of consecutive slots, or one amplitude along a direction.
    pub components: usize,
    /// The unit vector whose multiples the slots take; the control is then its amplitude.
    pub direction: Option<[f64; 3]>,
    /// The map to the points.
    pub map: Arc<ControlMap>,
    /// First entry of this field in the vector.
    pub first: usize,
    /// Unit kind of the values ("Pa", "T").
    pub unit: &'static str,
    /// Length that the vectors have at every point, where it is fixed; see [`Layout::fix_length`].
    pub length: Option<f64>,
    /// Factor of its part of the inner product: see [`Layout::weigh`].
    pub weight: f64,
    /// Of a control in time: its knots.
    pub knots: Option<Arc<Knots>>,
    /// Whether it moves a surface that it holds.
    pub holds: bool,
}

impl ControlBlock {
    /// Number of entries at one instant.
    pub fn size(&self) -> usize {
        self.map.len() * self.components
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
        self.map.is_empty()
    }

    /// The values in time that make up that at an instant, with their factors.
    fn weights(&self, t: f64) -> impl Iterator<Item = (usize, f64)> {
        let weights = self.knots.as_ref().map_or([(0, 1.0), (0, 0.0)], |knots| knots.weights(t));
        weights.into_iter().filter(|(_, factor)| *factor != 0.0)
    }

    /// Number of consecutive slots it sets.
    pub fn slots(&self) -> usize {
        self.direction.map_or(self.components, |direction| direction.len())
    }

    /// Values at the points, `stride` slots each; points the field does not reach keep theirs.
    fn to_points(&self, m: &[f64], stride: usize, out: &mut [f64]) {
        let Some(direction) = self.direction else {
            for c in 0..self.components {
                self.map.to_points(m, self.components, c, stride, self.slot + c, out);
            }
            return;
        };
        for (q, values) in out.chunks_exact_mut(stride).enumerate() {
            let mut terms = self.map.at_point(q).peekable();
            if terms.peek().is_some() {
                let amplitude: f64 = terms.map(|(i, shape)| shape * m[i]).sum();
                for (value, d) in values[self.slot..].iter_mut().zip(direction) {
                    *value = amplitude * d;
                }
            }
        }
    }

    /// The transpose: adds to the derivative by the field's unknowns.
    fn control_vjp(&self, by_point: &[f64], stride: usize, out: &mut [f64]) {
        let Some(direction) = self.direction else {
            for c in 0..self.components {
                self.map.from_points(by_point, stride, self.slot + c, self.components, c, out);
            }
            return;
        };
        let along = |values: &[f64]| values[self.slot..].iter().zip(direction).map(|(v, d)| v * d).sum();
        let amplitudes: Vec<f64> = by_point.chunks_exact(stride).map(along).collect();
        self.map.from_points(&amplitudes, 1, 0, 1, 0, out);
    }

    /// Its part of the vector.
    pub fn of<'m>(&self, m: &'m [f64]) -> &'m [f64] {
        &m[self.first..self.first + self.len()]
    }

    /// Gives a vector at a point the length it must have, if there is one.
    pub(crate) fn scale(&self, v: &mut [f64]) {
        let size = norm(v);
        if let Some(length) = self.length.filter(|_| size > 0.0) {
            v.iter_mut().for_each(|v| *v *= length / size);
        }
    }

    /// Takes derivatives by the vectors at the points, `[points][stride]`, to those by the vectors before scaling.
    fn unscale(&self, m: &[f64], stride: usize, by_point: &mut [f64]) {
        let Some(length) = self.length else { return };
        let before = self.before_scaling(m);
        for (v, d) in before.chunks_exact(self.components).zip(self.vectors_mut(stride, by_point)) {
            let scaling = Scaling::new(length, v);
            d.copy_from_slice(&scaling.derivative(d));
        }
    }

    /// Changes of the values at the points, `[points][stride]`, along a change v of the control vector at m.
    fn change(&self, m: &[f64], v: &[f64], stride: usize, out: &mut [f64]) {
        self.to_points(self.of(v), stride, out);
        self.unscale(m, stride, out); // symmetric at every point
    }

    /// Takes derivatives g by the vectors at the points, `[points][stride]`, to the change of `unscale(g)` along a change v of the
    /// control vector at m; false where that is zero.
    fn unscale_change(&self, m: &[f64], v: &[f64], stride: usize, by_point: &mut [f64]) -> bool {
        let Some(length) = self.length else { return false };
        let (before, change) = (self.before_scaling(m), self.before_scaling(v));
        let vectors = before.chunks_exact(self.components).zip(change.chunks_exact(self.components));
        for ((at, change), g) in vectors.zip(self.vectors_mut(stride, by_point)) {
            let scaling = Scaling::new(length, at);
            g.copy_from_slice(&scaling.second_derivative(change, g));
        }
        true
    }

    /// The vectors at the points without their scaling, `[points][components]`.
    fn before_scaling(&self, m: &[f64]) -> Vec<f64> {
        let n = self.components;
        let mut before = vec![0.0; n * self.map.points()];
        for c in 0..n {
            self.map.to_points(self.of(m), n, c, n, c, &mut before);
        }
        before
    }

    /// Its slots at every point.
    fn vectors_mut<'v>(&self, stride: usize, by_point: &'v mut [f64]) -> impl Iterator<Item = &'v mut [f64]> {
        let own = self.slot..self.slot + self.components;
        by_point.chunks_exact_mut(stride).map(move |at| &mut at[own.clone()])
    }
}

/// The control fields of a problem, in the order of the case file, on top of fixed values of all slots.
#[derive(Debug, Clone)]
pub struct Layout {
    blocks: Vec<ControlBlock>,
    fixed: Controls,
    len: usize,
}

impl Layout {
    /// No control field yet; every slot has its fixed value.
    pub fn new(fixed: Controls) -> Self {
        Layout { blocks: vec![], fixed, len: 0 }
    }

    /// Names of everything that can be controlled: `ACTUATION`, or `ACTUATION.SLOT` where it has several groups of slots.
    pub fn names(solid: &Solid) -> Vec<String> {
        groups(solid).into_iter().map(|(name, ..)| name).collect()
    }

    /// Adds a control field. `of` names an actuation with one group of slots, or `ACTUATION.SLOT` with the slot's name, where there
    /// is but one as well.
    ///
    /// # Errors
    /// Unknown names, a field controlled twice, or a space that does not fit the region.
    pub fn control(&mut self, solid: &Solid, of: &str, space: Space) -> Result<&ControlBlock, ControlError> {
        self.add(solid, of, space, None)
    }

    /// Adds the amplitude a of a vector `a direction`: a scalar field for three slots. The direction is normalised.
    ///
    /// # Errors
    /// As [`control`](Self::control); a slot that is no vector, a direction without a length.
    pub fn control_along(
        &mut self,
        solid: &Solid,
        of: &str,
        space: Space,
        direction: [f64; 3],
    ) -> Result<&ControlBlock, ControlError> {
        let length = norm(&direction);
        if !(length.is_finite() && length > 0.0) {
            return Err(ControlError::Direction { name: of.to_owned(), why: "its length is not a positive number" });
        }
        self.add(solid, of, space, Some(direction.map(|d| d / length)))
    }

    fn add(
        &mut self,
        solid: &Solid,
        of: &str,
        space: Space,
        direction: Option<[f64; 3]>,
    ) -> Result<&ControlBlock, ControlError> {
        let (actuation, group) = resolve(solid, of)?;
        let (slot, slots, unit) = (group.first, group.len, group.unit);
        if direction.is_some() && !group.is_vector() {
            return Err(ControlError::Direction { name: of.to_owned(), why: "the control is no vector of space" });
        }
        let overlaps =
            |b: &ControlBlock| b.actuation == actuation && b.slot < slot + slots && slot < b.slot + b.slots();
        if let Some(other) = self.blocks.iter().find(|b| overlaps(b)) {
            return Err(ControlError::ControlledTwice { name: of.to_owned(), other: other.name.clone() });
        }
        let controllable = solid.model().controllable()[actuation];
        let map = match controllable {
            Controllable { regions: Some(regions), .. } => ControlMap::new(solid.discretization(), regions, space)?,
            Controllable { measure, .. } if space == Space::Uniform => ControlMap::whole(measure),
            _ => return Err(ControlError::OneNumber { name: of.to_owned(), space: space.name() }),
        };
        let (map, components) = (Arc::new(map), if direction.is_some() { 1 } else { slots });
        let (name, first, length, weight, knots) = (of.to_owned(), self.len, None, 1.0, None);
        let holds = controllable.holds;
        let block = ControlBlock {
            name,
            actuation,
            slot,
            components,
            direction,
            map,
            first,
            unit,
            length,
            weight,
            knots,
            holds,
        };
        self.len += block.len();
        self.blocks.push(block);
        Ok(&self.blocks[self.blocks.len() - 1])
    }

    /// Gives the vectors `v` of a field the same length at every point: `length v/|v|`, with the derivative
    /// `length/|v| (I - v (x) v/|v|^2)`. Linear interpolation between nodes on a sphere falls short of it, so a nodal
    /// field of unit vectors needs this; elsewhere it changes rounding alone. Where `v = 0` it stays zero.
    ///
    /// # Errors
    /// An unknown name, a scalar field, a length that is not positive.
    pub fn fix_length(&mut self, of: &str, length: f64) -> Result<(), ControlError> {
        let known = self.block(of)?;
        let (first, components) = (known.first, known.components);
        if components == 1 || !(length.is_finite() && length > 0.0) {
            let what = format!("\"{of}\" cannot have the length {length}: vectors and a positive length are needed");
            return Err(ControlError::Cost { what });
        }
        for block in self.blocks.iter_mut().filter(|block| block.first == first) {
            block.length = Some(length);
        }
        Ok(())
    }

    /// Multiplies a field's part of the inner product by a factor (1 unless told): `(a, b) = sum_k weight_k (a_k, b_k)`. Fields of
    /// different units or ranges are balanced by `(range_0 / range_k)^2`: a change through the whole range counts the same in each.
    ///
    /// # Errors
    /// An unknown name, a factor that is not positive.
    pub fn weigh(&mut self, of: &str, weight: f64) -> Result<(), ControlError> {
        let first = self.block(of)?.first;
        if !(weight.is_finite() && weight > 0.0) {
            let what = format!("the weight of \"{of}\" in the inner product is {weight}; it is a positive number");
            return Err(ControlError::Cost { what });
        }
        self.blocks.iter_mut().filter(|block| block.first == first).for_each(|block| block.weight = weight);
        Ok(())
    }

    /// Gives the last control field that was added values at knots in time.
    pub(crate) fn in_time(&mut self, knots: Knots) {
        if let Some(block) = self.blocks.last_mut() {
            self.len -= block.len();
            block.knots = Some(Arc::new(knots));
            self.len += block.len();
        }
    }

    /// The same fields at one instant: its vectors are those of [`at`](Self::at).
    pub fn of_instant(&self) -> Layout {
        let mut layout = Layout { len: 0, ..self.clone() };
        for block in &mut layout.blocks {
            block.knots = None;
            block.first = layout.len;
            layout.len += block.size();
        }
        layout
    }

    /// The vector of the fields at an instant, from one with the values of all knots.
    ///
    /// # Errors
    /// [`ControlError::Length`].
    pub fn at(&self, m: &[f64], t: f64) -> Result<Vec<f64>, ControlError> {
        self.check(m)?;
        let mut out = Vec::new();
        for block in &self.blocks {
            let (own, size, first) = (block.of(m), block.size(), out.len());
            out.resize(first + size, 0.0);
            for (k, factor) in block.weights(t) {
                axpy(factor, &own[k * size..(k + 1) * size], &mut out[first..]);
            }
        }
        Ok(out)
    }

    /// The transpose of [`at`](Self::at): adds a derivative by the fields at an instant to that by the values of all knots.
    pub(crate) fn add_at(&self, t: f64, by_instant: &[f64], out: &mut [f64]) {
        let mut rest = by_instant;
        for block in &self.blocks {
            let (own, behind) = rest.split_at(block.size());
            for (k, factor) in block.weights(t) {
                axpy(factor, own, &mut out[block.first + k * own.len()..][..own.len()]);
            }
            rest = behind;
        }
    }

    /// The control fields.
    pub fn blocks(&self) -> &[ControlBlock] {
        &self.blocks
    }

    /// The field of a name.
    ///
    /// # Errors
    /// [`ControlError::UnknownControl`] with the names there are.
    pub fn block(&self, name: &str) -> Result<&ControlBlock, ControlError> {
        self.blocks.iter().find(|b| b.name == name).ok_or_else(|| ControlError::UnknownControl {
            name: name.to_owned(),
            known: self.blocks.iter().map(|b| b.name.clone()).collect::<Vec<_>>().join(", "),
        })
    }

    /// Length of the control vector.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether nothing is controlled.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// The fixed values of slots that are not controlled.
    pub(crate) fn fixed(&self) -> &Controls {
        &self.fixed
    }

    /// The same, to be changed.
    pub fn fixed_mut(&mut self) -> &mut Controls {
        &mut self.fixed
    }

    /// Values of all actuations at the points; of fields in time at t = 0.
    ///
    /// # Errors
    /// [`ControlError::Length`].
    pub fn to_points(&self, m: &[f64]) -> Result<Controls, ControlError> {
        match self.blocks.iter().any(|block| block.knots.is_some()) {
            true => self.of_instant().to_points_over(self.fixed.clone(), &self.at(m, 0.0)?),
            false => self.to_points_over(self.fixed.clone(), m),
        }
    }

    /// The same of fields at one instant, on top of other values of slots that are not controlled.
    pub(crate) fn to_points_over(&self, mut controls: Controls, m: &[f64]) -> Result<Controls, ControlError> {
        self.check(m)?;
        for block in &self.blocks {
            let stride = controls.slots(block.actuation);
            let out = controls.values_mut(block.actuation);
            block.to_points(block.of(m), stride, out);
            for at in out.chunks_exact_mut(stride) {
                block.scale(&mut at[block.slot..block.slot + block.components]);
            }
        }
        Ok(controls)
    }

    /// The transpose of the derivative at m: derivative by control vector from the derivative by values at the points.
    pub fn control_vjp(&self, m: &[f64], by_point: &Controls) -> Vec<f64> {
        let mut out = vec![0.0; self.len];
        for block in &self.blocks {
            let stride = by_point.slots(block.actuation);
            let mut values = by_point.values(block.actuation).to_vec();
            block.unscale(m, stride, &mut values);
            block.control_vjp(&values, stride, &mut out[block.first..block.first + block.len()]);
        }
        out
    }

    /// The change of the values at the points along a change v of the control vector at m.
    ///
    /// # Errors
    /// [`ControlError::Length`].
    pub fn change(&self, m: &[f64], v: &[f64]) -> Result<Controls, ControlError> {
        self.check(m)?;
        self.check(v)?;
        let mut controls = self.fixed.clone();
        (0..controls.len()).for_each(|k| controls.values_mut(k).fill(0.0));
        for block in &self.blocks {
            let stride = controls.slots(block.actuation);
            block.change(m, v, stride, controls.values_mut(block.actuation));
        }
        Ok(controls)
    }

    /// The change of [`control_vjp`](Self::control_vjp) along a change v of the control vector, for the same derivative by values at
    /// the points: zero but for fields of vectors of one length.
    pub fn second_vjp(&self, m: &[f64], v: &[f64], by_point: &Controls) -> Vec<f64> {
        let mut out = vec![0.0; self.len];
        for block in &self.blocks {
            let stride = by_point.slots(block.actuation);
            let mut values = by_point.values(block.actuation).to_vec();
            if block.unscale_change(m, v, stride, &mut values) {
                block.control_vjp(&values, stride, &mut out[block.first..block.first + block.len()]);
            }
        }
        out
    }

    pub(crate) fn check(&self, m: &[f64]) -> Result<(), ControlError> {
        match m.len() == self.len {
            true => Ok(()),
            false => Err(ControlError::Length { found: m.len(), expected: self.len }),
        }
    }
}

/// Actuation and slots of a control's name.
fn resolve(solid: &Solid, of: &str) -> Result<(usize, SlotGroup), ControlError> {
    let all = groups(solid);
    // The only slot of an actuation may be named as well.
    let is = |name: &str, group: &SlotGroup| {
        name == of || of.strip_prefix(name).and_then(|rest| rest.strip_prefix('.')) == Some(group.name)
    };
    let found = all.iter().find(|(name, _, group)| is(name, group));
    found.map(|&(_, actuation, group)| (actuation, group)).ok_or_else(|| {
        let known = all.iter().map(|(name, ..)| name.as_str()).collect::<Vec<_>>().join(", ");
        ControlError::UnknownControl { name: of.to_owned(), known }
    })
}

/// Name, actuation and slots of all that can be controlled.
fn groups(solid: &Solid) -> Vec<(String, usize, SlotGroup)> {
    let mut all = Vec::new();
    for (k, what) in solid.model().controllable().into_iter().enumerate() {
        let groups = SlotGroup::of(what.slots);
        for group in &groups {
            let several = groups.len() > 1;
            let name = if several { format!("{}.{}", what.name, group.name) } else { what.name.to_owned() };
            all.push((name, k, *group));
        }
    }
    all
}
