//! [`Layout`]: how the control fields of a problem stand one after the other in one vector.

use crate::control_block::{ControlBlock, ControlTarget, Shown};
use crate::control_limit::{ControlAt, ControlLimit};
use crate::control_names::{groups, resolve};
use crate::error::ControlError;
use crate::knots::Knots;
use crate::map::{Basis, Chain, ControlMap, Direction, Expansion, Exponential, Length, Space};
use nastic_energy::SlotGroup;
use nastic_fem::{Controllable, Controls, Discretization, Solid};
use nastic_numeric::vector::{axpy, norm};
use std::collections::BTreeSet;
use std::ops::Range;
use std::sync::Arc;

/// The control fields of a problem, in the order of the case file, on top of fixed values of all slots.
#[derive(Debug, Clone)]
pub struct Layout {
    blocks: Vec<ControlBlock>,
    fixed: Arc<Controls>,
    len: usize,
}

impl Layout {
    /// No control field yet; every slot has its fixed value.
    pub fn new(fixed: Controls) -> Self {
        Layout { blocks: vec![], fixed: Arc::new(fixed), len: 0 }
    }

    /// Names of everything that can be controlled: `ACTUATION`, or `ACTUATION.SLOT` where it has several groups of slots.
    pub fn names(solid: &Solid) -> Vec<String> {
        let mut names: Vec<String> = groups(solid).into_iter().map(|(name, ..)| name).collect();
        let mut seen = BTreeSet::new();
        names.retain(|name| seen.insert(name.clone()));
        names
    }

    /// Adds a control field. `of` names an actuation with one group of slots, or `ACTUATION.SLOT` with the slot's name, where there
    /// is but one as well.
    ///
    /// # Errors
    /// Unknown names, a field controlled twice, or a space that does not fit the region.
    pub fn control(&mut self, solid: &Solid, of: &str, space: Space) -> Result<&ControlBlock, ControlError> {
        self.add(solid, of, space, None)
    }

    /// Adds the amplitude a of a vector `a direction`: a scalar field for three slots, on top of fixed values that they may have. The direction is normalised.
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
        if direction.is_none() && solid.model().free_shape().is_some_and(|(shape, _)| shape.name == of) {
            return self.add_free_shape(solid, of, space);
        }
        let found = resolve(solid, of)?;
        let (lead, group) = found[0];
        if direction.is_some() && !group.is_vector() {
            return Err(ControlError::Direction { name: of.to_owned(), why: "the control is no vector of space" });
        }
        let all = solid.model().controllable();
        let basis = basis_of(solid, &all[lead], of, space)?;
        let components = if direction.is_some() { 1 } else { group.len };
        let target = |(actuation, group): (usize, SlotGroup)| {
            // of one number that others have at the points of their cells
            let basis = match all[actuation].regions == all[lead].regions {
                true => basis.clone(),
                false => basis_of(solid, &all[actuation], of, space)?,
            };
            self.check_free(of, actuation, group.first..group.first + group.len, &basis)?;
            let mut map = Chain::default().then(Expansion { basis: basis.clone(), components });
            if let Some(direction) = direction {
                map = map.then(Direction(direction));
            }
            let adds = direction.is_some();
            Ok(ControlTarget { actuation, slot: group.first, slots: group.len, basis, map, adds })
        };
        let targets = found.into_iter().map(target).collect::<Result<Vec<_>, ControlError>>()?;
        let (name, unit, holds) = (of.to_owned(), group.unit, all[lead].holds);
        let (first, weight, knots) = (self.len, 1.0, None);
        let shown = Shown { name: name.clone(), unit: unit.to_owned() };
        Ok(self.push(ControlBlock {
            name,
            components,
            basis,
            field: Chain::default(),
            targets,
            first,
            unit,
            shown,
            weight,
            knots,
            holds,
            log: false,
        }))
    }

    pub(crate) fn push(&mut self, block: ControlBlock) -> &ControlBlock {
        self.len += block.len();
        self.blocks.push(block);
        &self.blocks[self.blocks.len() - 1]
    }

    /// Refuses slots that another field drives at the same points.
    pub fn check_free(
        &self,
        of: &str,
        actuation: usize,
        slots: Range<usize>,
        basis: &Basis,
    ) -> Result<(), ControlError> {
        let overlaps =
            |block: &&ControlBlock| block.targets.iter().any(|target| target.overlaps(actuation, &slots, basis));
        match self.blocks.iter().find(overlaps) {
            Some(other) => Err(ControlError::ControlledTwice { name: of.to_owned(), other: other.name.clone() }),
            None => Ok(()),
        }
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
            block.targets.iter_mut().for_each(|target| target.map.push(Arc::new(Length { length, components })));
        }
        Ok(())
    }

    /// Makes the logarithm x of a positive field the unknown, `m = exp x` at every point; between nodes x is what is interpolated.
    ///
    /// # Errors
    /// An unknown name, a field of vectors or of amplitudes along a direction.
    pub fn by_logarithm(&mut self, of: &str) -> Result<(), ControlError> {
        let known = self.block(of)?;
        if known.log {
            return Ok(());
        }
        if known.components > 1 || known.targets.iter().any(|target| target.map.len() > 1) {
            let what = format!(
                "\"{of}\" is a vector, or has a map of its own: the logarithm is that of a positive number as it is"
            );
            return Err(ControlError::Cost { what });
        }
        let first = known.first;
        for block in self.blocks.iter_mut().filter(|block| block.first == first) {
            block.log = true;
            block.targets.iter_mut().for_each(|target| target.map.push(Arc::new(Exponential)));
        }
        Ok(())
    }

    /// Puts a map between the unknowns of a field and their expansion over the body, once for all that follows from it: behind those put there before.
    /// The vector stays that of the unknowns.
    ///
    /// # Errors
    /// An unknown name; [`ControlError::FieldMap`] of a map that leads to another number of unknowns; one that leads to no number.
    pub fn through(&mut self, of: &str, map: impl ControlMap + 'static) -> Result<(), ControlError> {
        let known = self.block(of)?;
        let (first, size) = (known.first, known.size());
        let image = map.values(&vec![0.5; size]);
        if image.len() != size {
            let (found, expected) = (image.len(), size);
            return Err(ControlError::FieldMap { name: of.to_owned(), map: map.describe(), found, expected });
        }
        if image.iter().any(|value| !value.is_finite()) {
            let what = format!("the map \"{}\" of \"{of}\" leads from 1/2 to what is no number", map.describe());
            return Err(ControlError::Cost { what });
        }
        let map = Arc::new(map);
        for block in self.blocks.iter_mut().filter(|block| block.first == first) {
            block.field.push(map.clone());
        }
        Ok(())
    }

    /// Multiplies a field's part of the inner product by a factor (1 unless set): `(a, b) = sum_k weight_k (a_k, b_k)`. Fields of
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

    /// How messages are to call a field, where its values are not in SI units or it has another name for people.
    ///
    /// # Errors
    /// An unknown name.
    pub fn show(&mut self, of: &str, shown: Shown) -> Result<(), ControlError> {
        let first = self.block(of)?.first;
        self.blocks.iter_mut().filter(|block| block.first == first).for_each(|block| block.shown = shown.clone());
        Ok(())
    }

    /// The values of all fields as messages show them.
    ///
    /// # Errors
    /// [`ControlError::Length`].
    pub fn described(&self, m: &[f64]) -> Result<Vec<ControlAt>, ControlError> {
        self.check(m)?;
        Ok(self.blocks.iter().map(|block| block.described(m)).collect())
    }

    /// A limit point at a share of the way between two control vectors: the fields that change on it are named.
    pub fn limit_point(&self, [from, to]: [&[f64]; 2], share: f64) -> ControlLimit {
        let m: Vec<f64> = from.iter().zip(to).map(|(from, to)| from + share * (to - from)).collect();
        let changing = self.blocks.iter().filter(|block| block.of(from) != block.of(to));
        ControlLimit { share, at: changing.map(|block| block.described(&m)).collect() }
    }

    /// Gives the last control field that was added values at knots in time.
    pub fn in_time(&mut self, knots: Knots) {
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
    pub fn add_at(&self, t: f64, by_instant: &[f64], out: &mut [f64]) {
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

    /// The same, to be changed; their places in the vector stay.
    pub fn blocks_mut(&mut self) -> &mut [ControlBlock] {
        &mut self.blocks
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
    pub fn fixed(&self) -> &Controls {
        &self.fixed
    }

    /// The same, to be changed.
    pub fn fixed_mut(&mut self) -> &mut Controls {
        Arc::make_mut(&mut self.fixed)
    }

    /// Shares the fixed values with other problems on the discretisation that have the same ones.
    pub fn share_equal_parts(&mut self, disc: &Discretization) {
        self.fixed = disc.share(self.fixed.clone());
    }

    /// Values of all actuations at the points; of fields in time at t = 0.
    ///
    /// # Errors
    /// [`ControlError::Length`].
    pub fn to_points(&self, m: &[f64]) -> Result<Controls, ControlError> {
        match self.blocks.iter().any(|block| block.knots.is_some()) {
            true => self.of_instant().to_points_over(self.fixed.as_ref().clone(), &self.at(m, 0.0)?),
            false => self.to_points_over(self.fixed.as_ref().clone(), m),
        }
    }

    /// The same of fields at one instant, on top of other values of slots that are not controlled.
    pub fn to_points_over(&self, mut controls: Controls, m: &[f64]) -> Result<Controls, ControlError> {
        self.check(m)?;
        for block in &self.blocks {
            block.write_values(m, &mut controls);
        }
        Ok(controls)
    }

    /// The transpose of the derivative at m: derivative by control vector from the derivative by values at the points.
    pub fn control_vjp(&self, m: &[f64], by_point: &Controls) -> Vec<f64> {
        let mut out = vec![0.0; self.len];
        for block in &self.blocks {
            block.add_vjp(m, by_point, &mut out);
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
        let mut controls = self.fixed.as_ref().clone();
        (0..controls.len()).for_each(|k| controls.values_mut(k).fill(0.0));
        for block in &self.blocks {
            block.write_change(m, v, &mut controls);
        }
        Ok(controls)
    }

    /// The change of [`control_vjp`](Self::control_vjp) along a change v of the control vector, for the same derivative by values at
    /// the points: zero of maps that are linear.
    pub fn second_vjp(&self, m: &[f64], v: &[f64], by_point: &Controls) -> Vec<f64> {
        let mut out = vec![0.0; self.len];
        for block in &self.blocks {
            block.add_second_vjp(m, v, by_point, &mut out);
        }
        out
    }

    /// Refuses a vector of another length.
    ///
    /// # Errors
    /// [`ControlError::Length`].
    pub fn check(&self, m: &[f64]) -> Result<(), ControlError> {
        match m.len() == self.len {
            true => Ok(()),
            false => Err(ControlError::Length { found: m.len(), expected: self.len }),
        }
    }
}

/// The basis functions of a field of one actuation or contribution.
pub(crate) fn basis_of(solid: &Solid, of: &Controllable, name: &str, space: Space) -> Result<Arc<Basis>, ControlError> {
    let basis = match of.regions {
        Some(regions) => Some(Basis::new(solid.discretization(), regions, space)?),
        None => Basis::of_contribution(of.measure, of.points, space)?,
    };
    let fits = |basis: &Basis| space == Space::Uniform || !of.points.is_empty() || !basis.is_of_contribution();
    match basis.filter(fits) {
        Some(basis) => Ok(solid.discretization().share(Arc::new(basis))),
        None if of.points.is_empty() => Err(ControlError::OneNumber { name: name.to_owned(), space: space.name() }),
        None => Err(ControlError::OwnPoints { name: name.to_owned(), space: space.name() }),
    }
}
