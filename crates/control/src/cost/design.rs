//! Costs of a design field itself: [`DesignVolume`] and [`Greyness`].

use super::{Cost, CostContext, CostForm, CostPoint, Key, Partials, check_weight};
use crate::error::ControlError;
use crate::map::{Chain, ControlMap, Expansion};
use nastic_numeric::vector::axpy;
use std::ops::Range;
use std::sync::Arc;

/// `j = weight (1/V) int s dX`, the mean of a scalar control s over the region of the volume V that it is over: of a density the share of the region that is filled.
///
/// s is the field behind its own chain of maps (filter, projection), at the points. Derivative: `dj/dm [dm] = (weight/V) int s'(m) dm dX`. Unit: that of s.
#[derive(Debug, Clone)]
pub struct DesignVolume(OfDesign);

/// `j = weight (4/V) int s (1 - s) dX`: 0 of a field that is 0 or 1 everywhere, the weight of one that is 1/2; s and V as of [`DesignVolume`].
///
/// Derivative: `dj/dm [dm] = (4 weight/V) int (1 - 2 s) s'(m) dm dX`. Source: O. Sigmund, Struct. Multidisc. Optim. 33 (2007) 401-424, doi 10.1007/s00158-006-0087-x.
#[derive(Debug, Clone)]
pub struct Greyness(OfDesign);

#[derive(Debug, Clone)]
struct OfDesign {
    of: String,
    weight: f64,
    /// `f, f', f''` at s.
    density: fn(f64) -> [f64; 3],
}

impl DesignVolume {
    /// Of the named control.
    ///
    /// # Errors
    /// A weight that is not positive.
    pub fn of(control: &str, weight: f64) -> Result<Self, ControlError> {
        let weight = check_weight("design_volume", weight)?;
        Ok(DesignVolume(OfDesign { of: control.to_owned(), weight, density: |s| [s, 1.0, 0.0] }))
    }
}

impl Greyness {
    /// Of the named control.
    ///
    /// # Errors
    /// A weight that is not positive.
    pub fn of(control: &str, weight: f64) -> Result<Self, ControlError> {
        let weight = check_weight("greyness", weight)?;
        let density = |s: f64| [4.0 * s * (1.0 - s), 4.0 - 8.0 * s, -8.0];
        Ok(Greyness(OfDesign { of: control.to_owned(), weight, density }))
    }
}

/// How the volume stands in case files.
pub(super) const VOLUME: CostForm = CostForm::new(
    "design_volume",
    "weight times the mean of a design field: of a density the share of its region that is filled.",
    &[Key::CONTROL],
    |on| Ok(Box::new(DesignVolume::of(&on.get::<String>("of")?, on.weight)?)),
)
.words(|words| format!("mean of {}", words.text("of")));

/// How the greyness stands in case files.
pub(super) const GREYNESS: CostForm = CostForm::new(
    "greyness",
    "weight times the mean of 4 s (1 - s) of a design field s: 0 where it is 0 or 1 everywhere.",
    &[Key::CONTROL],
    |on| Ok(Box::new(Greyness::of(&on.get::<String>("of")?, on.weight)?)),
)
.words(|words| format!("mean of 4 {0} (1 - {0})", words.text("of")));

impl Cost for DesignVolume {
    fn name(&self) -> &str {
        "design_volume"
    }

    fn spans_ranks(&self) -> bool {
        true
    }

    fn at(&self, at: &CostContext) -> Result<Arc<dyn CostPoint>, ControlError> {
        Ok(Arc::new(self.0.at(at)?))
    }
}

impl Cost for Greyness {
    fn name(&self) -> &str {
        "greyness"
    }

    fn spans_ranks(&self) -> bool {
        true
    }

    fn at(&self, at: &CostContext) -> Result<Arc<dyn CostPoint>, ControlError> {
        Ok(Arc::new(self.0.at(at)?))
    }
}

/// `weight/V sum_q w_q f(s_q)` evaluated.
#[derive(Debug)]
struct AtPoints {
    value: f64,
    /// From the unknowns to the points.
    map: Chain,
    unknowns: Vec<f64>,
    /// The place of the unknowns in the control vector.
    place: Range<usize>,
    /// By s at the points, first and second.
    by_point: [Vec<f64>; 2],
}

impl OfDesign {
    fn at(&self, at: &CostContext) -> Result<AtPoints, ControlError> {
        let block = at.layout.block(&self.of)?;
        if block.components > 1 || block.log || block.basis.is_of_contribution() {
            let what = format!("\"{}\" has no volume: it is no scalar field over the body as it stands", self.of);
            return Err(ControlError::Cost { what });
        }
        let map = block.field.clone().then(Expansion { basis: block.basis.clone(), components: 1 });
        let (unknowns, model) = (block.of(at.m).to_vec(), at.solid.model());
        let (s, weights) = (map.values(&unknowns), block.basis.weights(at.solid.discretization()));
        let acting = || weights.iter().enumerate().filter(|(q, _)| block.basis.acts_at(*q));
        let factor = self.weight / model.unknowns().total(acting().map(|(_, w)| w).sum());
        let mut by_point = [vec![0.0; s.len()], vec![0.0; s.len()]];
        let mut sum = 0.0;
        for (q, w) in acting() {
            let [f, slope, curvature] = (self.density)(s[q]);
            sum += w * f;
            by_point[0][q] = factor * w * slope;
            by_point[1][q] = factor * w * curvature;
        }
        let place = block.first..block.first + unknowns.len();
        Ok(AtPoints { value: factor * model.unknowns().total(sum), map, unknowns, place, by_point })
    }
}

impl CostPoint for AtPoints {
    fn value(&self) -> f64 {
        self.value
    }

    fn add_partials(&self, out: &mut Partials) -> Result<(), ControlError> {
        axpy(1.0, &self.map.vjp(&self.unknowns, &self.by_point[0]), &mut out.m[self.place.clone()]);
        Ok(())
    }

    fn add_second_partials(&self, along: &Partials, out: &mut Partials) -> Result<(), ControlError> {
        let (x, v, out) = (&self.unknowns, &along.m[self.place.clone()], &mut out.m[self.place.clone()]);
        let moved = self.map.change(x, v);
        let change: Vec<f64> = self.by_point[1].iter().zip(moved).map(|(second, moved)| second * moved).collect();
        axpy(1.0, &self.map.vjp(x, &change), out);
        if let Some(bent) = self.map.second_vjp(x, v, &self.by_point[0]) {
            axpy(1.0, &bent, out);
        }
        Ok(())
    }
}
