//! [`MeanRadius`]: the mean distance of a surface from an axis or from a point.

use super::{
    Cost, CostContext, CostForm, CostPoint, Figure, FigureKind, IntoCost, Key, KeyKind, Output, Partials, check_weight,
};
use crate::cost::body_points::{BodyPart, BodyPoints};
use nastic_fem::Solid;
use nastic_fields::ControlError;
use nastic_mesh::GroupNames;
use nastic_tensor::{Mat3, Vec3};
use std::sync::Arc;

/// `j = (weight/2) (R - radius)^2` with the mean distance of a named surface of the reference body from an axis through c along the unit
/// vector n, or from c alone,
///
/// ```text
/// R = int_{Gamma_0} r dA / int_{Gamma_0} dA,    r = |T (X + u - c)|,    T = 1 - n (x) n, or 1
/// ```
///
/// of a lumen its radius. c and n stay where they are. With `e = T (x - c)/r`,
///
/// ```text
/// dR/du [v] = int e . v dA / int dA,    d2R/du2 [v, w] = int (T v . T w - (e . v)(e . w))/r dA / int dA
/// ```
///
/// In plane strain the axis is z. Units: length^2 times the weight's. Source: docs/model/costs.md.
#[derive(Clone, Debug)]
pub struct MeanRadius {
    surface: GroupNames,
    axis: Option<[f64; 3]>,
    centre: [Option<f64>; 3],
    radius: f64,
    weight: f64,
}

impl MeanRadius {
    /// Of a named surface, or of the union of several, from the mean of the surface at rest.
    pub fn of_surface(names: impl Into<GroupNames>, radius: f64) -> Self {
        MeanRadius { surface: names.into(), axis: None, centre: [None; 3], radius, weight: 1.0 }
    }

    /// From an axis along a direction, of any length but zero.
    #[must_use]
    pub fn about(mut self, axis: [f64; 3]) -> Self {
        self.axis = Some(axis);
        self
    }

    /// Where the axis passes, or the point itself; components left out are those of the mean of the surface at rest.
    #[must_use]
    pub fn centre(mut self, centre: [Option<f64>; 3]) -> Self {
        self.centre = centre;
        self
    }

    /// Multiplies the cost.
    #[must_use]
    pub fn weight(mut self, weight: f64) -> Self {
        self.weight = weight;
        self
    }
}

/// How it stands in case files.
pub(super) const FORM: CostForm = CostForm::new(
    "mean_radius",
    "weight/2 (R - radius)^2, R the mean distance of a surface from an axis, or from a point.",
    &[
        Key::SURFACE,
        Key::new("radius", "The mean radius that is wanted.", KeyKind::Number { unit: "m", default: None }),
        Key::new(
            "axis",
            "Direction of the axis; in plane strain z. Without it the distance from the centre counts.",
            KeyKind::Direction,
        )
        .optional(),
        Key::new(
            "centre",
            "Where the axis passes; components left out are those of the surface's mean at rest.",
            KeyKind::Position,
        )
        .optional(),
    ],
    |on| {
        let (surface, radius) = (on.get("surface")?, on.get("radius")?);
        let centre = on.given("centre").unwrap_or_default();
        MeanRadius { surface, axis: on.given("axis"), centre, radius, weight: on.weight }.bind(on.solid)
    },
)
.square()
.reported_at("surface")
.words(|words| format!("weight/2 (mean radius of {} - {})^2", words.place(), words.text("radius")));

impl IntoCost for MeanRadius {
    fn bind(self, solid: &Solid) -> Result<Box<dyn Cost>, ControlError> {
        let weight = check_weight("mean_radius", self.weight)?;
        let refuse = |what: String| Err(ControlError::Cost { what });
        if !(self.radius >= 0.0 && self.radius.is_finite()) {
            return refuse(format!("the radius {} of a mean_radius must be finite and not negative", self.radius));
        }
        let plane = solid.mesh().dim() == 2;
        let axis = if plane { Some([0.0, 0.0, 1.0]) } else { self.axis };
        let length = axis.map_or(1.0, |axis| Vec3::from(axis).norm());
        if !(length > 0.0 && length.is_finite()) {
            return refuse(
                "the axis of a mean_radius has no direction: give one of a finite length but zero".to_owned(),
            );
        }
        let across = axis.map_or_else(Mat3::identity, |axis| {
            let n = Vec3::from(axis) / length;
            Mat3::identity() - n * n.transpose()
        });
        let (points, _) = BodyPart::Surface(self.surface).points(solid)?;
        let rest = points.positions(solid, None);
        let weights: Vec<f64> = (0..rest.len()).map(|q| points.weight(q)).collect();
        let area: f64 = weights.iter().sum();
        let shares: Vec<f64> = weights.iter().map(|w| w / area).collect();
        let mean = |i: usize| rest.iter().zip(&shares).map(|(x, share)| share * x[i]).sum();
        let centre = Vec3::from_fn(|i, _| self.centre[i].unwrap_or_else(|| mean(i)));
        Ok(Box::new(OnBody {
            points: Arc::new(points),
            shares: shares.into(),
            across,
            centre,
            radius: self.radius,
            weight,
        }))
    }
}

/// [`MeanRadius`] bound to a body.
#[derive(Debug)]
struct OnBody {
    points: Arc<BodyPoints>,
    shares: Arc<[f64]>,
    across: Mat3,
    centre: Vec3,
    radius: f64,
    weight: f64,
}

impl Cost for OnBody {
    fn name(&self) -> &str {
        "mean_radius"
    }

    fn numbers(&self) -> Option<usize> {
        Some(1)
    }

    fn at(&self, at: &CostContext) -> Result<Arc<dyn CostPoint>, ControlError> {
        let places = self.points.positions(at.solid, Some(at.u));
        let arms: Vec<Vec3> = places.iter().map(|x| self.across * (Vec3::from(*x) - self.centre)).collect();
        if arms.iter().any(|arm| arm.norm() == 0.0) {
            let what = "a point of the surface of a mean_radius lies on its axis, where its distance has no derivative: move the centre".to_owned();
            return Err(ControlError::Cost { what });
        }
        let radius = arms.iter().zip(self.shares.iter()).map(|(arm, share)| share * arm.norm()).sum();
        let dim = at.solid.discretization().dim();
        let (points, shares, across) = (self.points.clone(), self.shares.clone(), self.across);
        Ok(Arc::new(EvaluatedCost {
            points,
            shares,
            across,
            arms,
            dim,
            radius,
            wanted: self.radius,
            weight: self.weight,
        }))
    }
}

/// The cost evaluated.
#[derive(Debug)]
struct EvaluatedCost {
    points: Arc<BodyPoints>,
    shares: Arc<[f64]>,
    across: Mat3,
    /// `T (x - c)`
    arms: Vec<Vec3>,
    dim: usize,
    radius: f64,
    wanted: f64,
    weight: f64,
}

impl EvaluatedCost {
    /// Adds `sum_q share_q f(q) . v(q)` as a nodal vector.
    fn spread(&self, f: impl Fn(usize) -> Vec3, out: &mut [f64]) {
        let value = |q: usize| {
            let f = f(q) * self.shares[q];
            (0..self.dim).map(move |i| f[i])
        };
        let values: Vec<f64> = (0..self.arms.len()).flat_map(value).collect();
        self.points.spread(&values, self.dim, out);
    }
}

impl CostPoint for EvaluatedCost {
    fn value(&self) -> f64 {
        0.5 * self.weight * (self.radius - self.wanted).powi(2)
    }

    fn add_partials(&self, out: &mut Partials) -> Result<(), ControlError> {
        let slope = self.weight * (self.radius - self.wanted);
        self.spread(|q| self.arms[q].normalize() * slope, &mut out.u);
        Ok(())
    }

    fn add_second_partials(&self, along: &Partials, out: &mut Partials) -> Result<(), ControlError> {
        let moved = self.points.weighted(&along.u, self.dim, 1.0);
        let at = |q: usize| {
            Vec3::from_fn(|i, _| if i < self.dim { moved[q * self.dim + i] } else { 0.0 } / self.points.weight(q))
        };
        let change: f64 = (0..self.arms.len()).map(|q| self.shares[q] * self.arms[q].normalize().dot(&at(q))).sum();
        let gap = self.radius - self.wanted;
        let turned = |q: usize| {
            let (e, v) = (self.arms[q].normalize(), at(q));
            (self.across * v - e * e.dot(&v)) * (gap / self.arms[q].norm()) + e * change
        };
        self.spread(|q| turned(q) * self.weight, &mut out.u);
        Ok(())
    }

    fn outputs(&self, zero: &Partials) -> Result<Vec<Output>, ControlError> {
        let mut partials = zero.clone();
        self.spread(|q| self.arms[q].normalize(), &mut partials.u);
        Ok(vec![Output::watched("", self.radius, "m", partials).aiming(self.wanted, self.weight)])
    }

    fn figures(&self) -> Result<Vec<Figure>, ControlError> {
        Ok(vec![Figure::length(FigureKind::Other("mean_radius"), self.radius)])
    }
}
