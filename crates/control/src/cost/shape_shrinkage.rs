//! [`ShapeShrinkage`]: a smoothed maximum of how much a change of shape shrinks the body somewhere.

use super::{
    Cost, CostContext, CostForm, CostPoint, Figure, FigureKind, IntoCost, Key, KeyKind, Partials, check_weight,
};
use nastic_fem::{Controls, FemError, Solid};
use nastic_fields::{ControlError, Layout};
use nastic_numeric::vector::axpy;
use std::sync::Arc;

/// `j = weight M`, a power mean of 1/det G over what a change of shape, G = 1 + grad s, moves:
///
/// ```text
/// M = ( 1/|Omega_0| int (det G)^-p dX )^(1/p)
/// ```
///
/// 1 of the drawn body, never above the largest 1/det G, and close to it for large p: where det G is J in a share f of the volume, M > f^(1/p)/J. As a constraint, `M <= 1/J`, it keeps optimisers off the
/// bound of det G, beyond which no state is. It hangs on controls alone. `dM/d(det G) = -M^(1-p) (det G)^-(p+1) / |Omega_0|` at a point. A plain number.
/// Source: power means, as of [`LargestStretch`](super::LargestStretch).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShapeShrinkage {
    exponent: u32,
    weight: f64,
}

/// p where none is given: det G = 1/2 in a twentieth of the volume gives 1.77.
const DEFAULT_EXPONENT: u32 = 24;
/// Largest p: above it powers of a det G of 1e-4 overflow.
const MAX_EXPONENT: u32 = 64;

impl Default for ShapeShrinkage {
    fn default() -> Self {
        ShapeShrinkage { exponent: DEFAULT_EXPONENT, weight: 1.0 }
    }
}

impl ShapeShrinkage {
    /// p, 24 if not given.
    #[must_use]
    pub fn exponent(self, p: u32) -> Self {
        ShapeShrinkage { exponent: p, ..self }
    }

    /// Multiplies the cost.
    #[must_use]
    pub fn weight(self, weight: f64) -> Self {
        ShapeShrinkage { weight, ..self }
    }
}

/// How it stands in case files.
pub(super) const FORM: CostForm = CostForm::new(
    "shape_shrinkage",
    "weight times a smoothed maximum of 1/det G of the change of shape, the power mean of exponent p: as a constraint, at most 1/J keeps det G above about J.",
    &[Key::new("exponent", "p, from 1 to 64.", KeyKind::Count { default: Some(DEFAULT_EXPONENT) }).optional()],
    |on| ShapeShrinkage { exponent: on.get("exponent")?, weight: on.weight }.bind(on.solid),
)
.reported_at("exponent")
.words(|words| {
    format!("smoothed maximum of 1/det G of the change of shape, power mean of exponent {}", words.count("exponent"))
});

impl IntoCost for ShapeShrinkage {
    fn bind(self, solid: &Solid) -> Result<Box<dyn Cost>, ControlError> {
        check_weight("shape_shrinkage", self.weight)?;
        let fail = |what: String| Err(ControlError::Cost { what });
        if !(1..=MAX_EXPONENT).contains(&self.exponent) {
            return fail(format!(
                "the exponent of a shrinkage of shape is {}; take 1 to {MAX_EXPONENT}",
                self.exponent
            ));
        }
        match solid.body().shape() {
            Some(_) => Ok(Box::new(OnBody(self))),
            None => fail("the shape of the body does not change: it has no shrinkage".to_owned()),
        }
    }
}

/// [`ShapeShrinkage`] bound to a body.
#[derive(Debug)]
struct OnBody(ShapeShrinkage);

impl Cost for OnBody {
    fn name(&self) -> &str {
        "shape_shrinkage"
    }

    fn at(&self, at: &CostContext) -> Result<Arc<dyn CostPoint>, ControlError> {
        let controls = at.layout.to_points(at.m)?;
        let volumes = at.solid.body().shape_volumes(&controls);
        if let Some([_, lost]) = volumes.iter().find(|[_, det]| det.is_nan() || *det <= 0.0) {
            let what = format!("the change of shape turns the body over, det G = {lost:.3e}: it has no shrinkage");
            return Err(FemError::Meaningless { what }.into());
        }
        let p = self.0.exponent as i32;
        let whole: f64 = volumes.iter().map(|[weight, _]| weight).sum();
        let mean = volumes.iter().map(|[weight, det]| weight / whole * det.powi(-p)).sum::<f64>();
        let (norm, solid, layout) = (mean.powf(1.0 / f64::from(p)), at.solid.clone(), at.layout.clone());
        Ok(Arc::new(EvaluatedCost { cost: self.0, solid, layout, m: at.m.to_vec(), controls, volumes, whole, norm }))
    }
}

/// The cost evaluated.
#[derive(Debug)]
struct EvaluatedCost {
    cost: ShapeShrinkage,
    solid: Solid,
    layout: Layout,
    m: Vec<f64>,
    controls: Controls,
    /// Reference volume and det G by point.
    volumes: Vec<[f64; 2]>,
    whole: f64,
    /// M
    norm: f64,
}

impl EvaluatedCost {
    /// `f_q`, the derivative of j by det G at the points.
    fn slopes(&self) -> Vec<f64> {
        let p = self.cost.exponent as i32;
        let factor = -self.cost.weight * self.norm.powi(1 - p) / self.whole;
        self.volumes.iter().map(|[weight, det]| factor * weight * det.powi(-p - 1)).collect()
    }

    /// Adds what has this derivative by det G, along a change of the controls that of the derivative of det G.
    fn add(&self, by_volume: &[f64], v: Option<&Controls>, out: &mut Controls) {
        self.solid.body().add_shape_volume_vjp(&self.controls, v, by_volume, out);
    }
}

impl CostPoint for EvaluatedCost {
    fn value(&self) -> f64 {
        self.cost.weight * self.norm
    }

    fn add_partials(&self, out: &mut Partials) -> Result<(), ControlError> {
        let mut by_point = self.controls.clone().zeroed();
        self.add(&self.slopes(), None, &mut by_point);
        axpy(1.0, &self.layout.control_vjp(&self.m, &by_point), &mut out.m);
        Ok(())
    }

    /// `f_q' = (1-p)/j (sum_r f_r J_r') f_q - (p+1)/J_q J_q' f_q`, with the changes J' of det G.
    fn add_second_partials(&self, along: &Partials, out: &mut Partials) -> Result<(), ControlError> {
        let v = self.layout.change(&self.m, &along.m)?;
        let (slopes, p) = (self.slopes(), f64::from(self.cost.exponent));
        let changes = self.solid.body().shape_volume_changes(&self.controls, &v);
        let moved: f64 = slopes.iter().zip(&changes).map(|(slope, change)| slope * change).sum();
        let common = (1.0 - p) / self.value() * moved;
        let rows = slopes.iter().zip(&changes).zip(&self.volumes);
        let bent: Vec<f64> =
            rows.map(|((slope, change), [_, det])| slope * (common - (p + 1.0) / det * change)).collect();
        let (mut first, mut second) = (self.controls.clone().zeroed(), self.controls.clone().zeroed());
        self.add(&slopes, None, &mut first);
        self.add(&bent, None, &mut second);
        self.add(&slopes, Some(&v), &mut second);
        axpy(1.0, &self.layout.control_vjp(&self.m, &second), &mut out.m);
        axpy(1.0, &self.layout.second_vjp(&self.m, &along.m, &first), &mut out.m);
        Ok(())
    }

    /// M, and the least det G.
    fn figures(&self) -> Result<Vec<Figure>, ControlError> {
        let least = self.volumes.iter().map(|[_, det]| *det).fold(f64::INFINITY, f64::min);
        let figure = |name, value| Figure { kind: FigureKind::Other(name), value, unit: "" };
        Ok(vec![figure("smoothed_shrinkage", self.norm), figure("least_det_G", least)])
    }
}
