//! [`DesignMean`]: costs of a design field itself.

use super::{Cost, CostContext, CostForm, CostPoint, Key, Partials, check_weight};
use nastic_fields::{Chain, ControlError, ControlMap, Expansion};
use nastic_numeric::vector::axpy;
use std::ops::Range;
use std::sync::Arc;

/// `j = (weight/V) int f(s) dX`, the mean of a function of a scalar control s over the region of the volume V that it is over.
///
/// | | name | f |
/// |---|---|---|
/// | [`volume`](Self::volume) | `design_volume` | s: of a density the share of the region that is filled |
/// | [`greyness`](Self::greyness) | `greyness` | 4 s (1 - s): 0 of a field that is 0 or 1 everywhere, 1 of one that is 1/2 |
///
/// s is the field behind its own chain of maps (filter, projection), at the points. Derivative: `dj/dm [dm] = (weight/V) int f'(s) s'(m) dm dX`. Unit: that of f.
/// Source of the greyness: O. Sigmund, Struct. Multidisc. Optim. 33 (2007) 401-424, doi 10.1007/s00158-006-0087-x.
#[derive(Debug, Clone)]
pub struct DesignMean {
    of: String,
    weight: f64,
    name: &'static str,
    /// `f, f', f''` at s.
    density: fn(f64) -> [f64; 3],
}

impl DesignMean {
    /// That of the named control.
    ///
    /// # Errors
    /// A weight that is not positive.
    pub fn volume(control: &str, weight: f64) -> Result<Self, ControlError> {
        Self::new(control, weight, "design_volume", |s| [s, 1.0, 0.0])
    }

    /// That of the named control.
    ///
    /// # Errors
    /// A weight that is not positive.
    pub fn greyness(control: &str, weight: f64) -> Result<Self, ControlError> {
        Self::new(control, weight, "greyness", |s| [4.0 * s * (1.0 - s), 4.0 - 8.0 * s, -8.0])
    }

    fn new(of: &str, weight: f64, name: &'static str, density: fn(f64) -> [f64; 3]) -> Result<Self, ControlError> {
        Ok(DesignMean { of: of.to_owned(), weight: check_weight(name, weight)?, name, density })
    }
}

/// How the volume stands in case files.
pub(super) const VOLUME: CostForm = CostForm::new(
    "design_volume",
    "weight times the mean of a design field: of a density the share of its region that is filled.",
    &[Key::CONTROL],
    |on| Ok(Box::new(DesignMean::volume(&on.get::<String>("of")?, on.weight)?)),
)
.words(|words| format!("mean of {}", words.text("of")));

/// How the greyness stands in case files.
pub(super) const GREYNESS: CostForm = CostForm::new(
    "greyness",
    "weight times the mean of 4 s (1 - s) of a design field s: 0 where it is 0 or 1 everywhere.",
    &[Key::CONTROL],
    |on| Ok(Box::new(DesignMean::greyness(&on.get::<String>("of")?, on.weight)?)),
)
.words(|words| format!("mean of 4 {0} (1 - {0})", words.text("of")));

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

impl Cost for DesignMean {
    fn name(&self) -> &str {
        self.name
    }

    fn spans_ranks(&self) -> bool {
        true
    }

    fn at(&self, at: &CostContext) -> Result<Arc<dyn CostPoint>, ControlError> {
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
        let value = factor * model.unknowns().total(sum);
        Ok(Arc::new(AtPoints { value, map, unknowns, place, by_point }))
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
