//! [`ObstaclePenetration`]: the cost of being inside of an obstacle.

use super::body_points::{BodyPart, BodyPoints};
use super::{
    Cost, CostContext, CostForm, CostPoint, Figure, FigureKind, IntoCost, Key, KeyKind, Partials, check_weight,
};
use nastic_fem::Solid;
use nastic_fields::ControlError;
use nastic_mesh::GroupNames;
use nastic_mesh::spatial::{Obstacle, SignedDistance};
use nastic_numeric::vector::dot;
use std::sync::Arc;

/// Checks an obstacle, and the distance to keep from it.
pub(crate) fn check(obstacle: &Obstacle, clearance: f64, dim: usize) -> Result<(), ControlError> {
    if !clearance.is_finite() {
        let what = format!("an obstacle has the clearance {clearance}; clearances are finite lengths");
        return Err(ControlError::Cost { what });
    }
    if let Obstacle::Grid(grid) = obstacle
        && grid.margin() < clearance
    {
        let what = format!(
            "the clearance {clearance} from an obstacle is more than the margin of its grid, {:.3e}, beyond which the distance jumps: give the grid a wider \
             margin",
            grid.margin()
        );
        return Err(ControlError::Cost { what });
    }
    obstacle.check(dim).map_err(|error| ControlError::Cost { what: error.to_string() })
}

/// `j = (weight/2) int_{Gamma_0} max(0, clearance - d(x))^2 dA` over a named surface of the reference body (`dX` over a region, a plain
/// sum over a node set), with `x = X + u(X)` and d the signed distance from an [`Obstacle`].
///
/// With `p = clearance - d > 0`: `dj/du [v] = -weight int p grad d . v dA`,
/// `d2j/du2 [v, w] = weight int (grad d . v)(grad d . w) - p v . (d2d/dx2 w) dA`; points with p <= 0 add nothing. A penalty: the
/// body enters the obstacle a little. [`ObstacleDistance`](crate::ObstacleDistance) keeps it out.
/// Units: length^4 times the weight's on a surface, length^5 over a region, length^2 over nodes. Source: docs/model/costs.md.
#[derive(Clone, Debug)]
pub struct ObstaclePenetration {
    place: BodyPart,
    obstacle: Obstacle,
    clearance: f64,
    weight: f64,
}

impl ObstaclePenetration {
    fn of(place: BodyPart, obstacle: Obstacle) -> Self {
        ObstaclePenetration { place, obstacle, clearance: 0.0, weight: 1.0 }
    }

    /// Of a named surface, or of the union of several.
    pub fn surface(names: impl Into<GroupNames>, obstacle: Obstacle) -> Self {
        Self::of(BodyPart::Surface(names.into()), obstacle)
    }

    /// Of a named region, or of the union of several.
    pub fn region(names: impl Into<GroupNames>, obstacle: Obstacle) -> Self {
        Self::of(BodyPart::Region(names.into()), obstacle)
    }

    /// Of the nodes of named node sets (or of surfaces), each with weight one.
    pub fn nodes(names: impl Into<GroupNames>, obstacle: Obstacle) -> Self {
        Self::of(BodyPart::Nodes(names.into()), obstacle)
    }

    /// The distance to keep; zero if not given.
    pub fn clearance(mut self, clearance: f64) -> Self {
        self.clearance = clearance;
        self
    }

    /// Multiplies the cost.
    pub fn weight(mut self, weight: f64) -> Self {
        self.weight = weight;
        self
    }
}

/// How it stands in case files.
pub(super) const FORM: CostForm = CostForm::new(
    "obstacle",
    "weight/2 int max(0, clearance - d(x))^2 over a surface or region, the sum over a node set; d is the distance from an obstacle.",
    &[
        Key::SURFACE.one_of(),
        Key::REGION.one_of(),
        Key::NODES.one_of(),
        Key::new(
            "shape",
            "The obstacle: a shape, or the name of one of `obstacles`, where it is not moved.",
            KeyKind::Obstacle,
        ),
        Key::new("clearance", "The distance to keep.", KeyKind::Number { unit: "m", default: Some(0.0) })
            .optional(),
    ],
    |on| {
        let (place, obstacle, clearance) = (on.place()?, on.get("shape")?, on.get("clearance")?);
        ObstaclePenetration { place, obstacle, clearance, weight: on.weight }.bind(on.solid)
    },
)
.square()
.words(|words| {
    let (clearance, shape) = (words.text("clearance"), words.text("shape"));
    format!("weight/2 int max(0, {clearance} - d)^2 on {}, d from {shape}", words.place())
});

impl IntoCost for ObstaclePenetration {
    fn bind(self, solid: &Solid) -> Result<Box<dyn Cost>, ControlError> {
        check(&self.obstacle, self.clearance, solid.discretization().dim())?;
        let weight = check_weight("obstacle", self.weight)?;
        let (points, _) = self.place.points(solid)?;
        Ok(Box::new(OnBody { points: Arc::new(points), obstacle: self.obstacle, clearance: self.clearance, weight }))
    }
}

/// [`ObstaclePenetration`] bound to a body.
#[derive(Debug)]
struct OnBody {
    points: Arc<BodyPoints>,
    obstacle: Obstacle,
    clearance: f64,
    weight: f64,
}

impl Cost for OnBody {
    fn name(&self) -> &str {
        "obstacle"
    }

    fn at(&self, at: &CostContext) -> Result<Arc<dyn CostPoint>, ControlError> {
        let dim = at.solid.discretization().dim();
        let distances: Vec<SignedDistance> =
            self.points.positions(at.solid, Some(at.u)).iter().map(|x| self.obstacle.at(x)).collect();
        let square =
            |(q, d): (usize, &SignedDistance)| self.points.weight(q) * (self.clearance - d.value).max(0.0).powi(2);
        let value = 0.5 * self.weight * distances.iter().enumerate().map(square).sum::<f64>();
        let (points, clearance, weight) = (self.points.clone(), self.clearance, self.weight);
        Ok(Arc::new(EvaluatedCost { points, clearance, weight, dim, value, distances }))
    }
}

/// The cost evaluated.
#[derive(Debug)]
struct EvaluatedCost {
    points: Arc<BodyPoints>,
    clearance: f64,
    weight: f64,
    dim: usize,
    value: f64,
    distances: Vec<SignedDistance>,
}

impl CostPoint for EvaluatedCost {
    fn value(&self) -> f64 {
        self.value
    }

    fn add_partials(&self, out: &mut Partials) -> Result<(), ControlError> {
        let mut forces = vec![0.0; self.dim * self.distances.len()];
        for (q, (force, d)) in forces.chunks_exact_mut(self.dim).zip(&self.distances).enumerate() {
            let depth = (self.clearance - d.value).max(0.0);
            let factor = -self.weight * self.points.weight(q) * depth;
            force.iter_mut().zip(&d.gradient).for_each(|(f, n)| *f = factor * n);
        }
        self.points.spread(&forces, self.dim, &mut out.u);
        Ok(())
    }

    fn add_second_partials(&self, along: &Partials, out: &mut Partials) -> Result<(), ControlError> {
        let mut forces = self.points.weighted(&along.u, self.dim, self.weight);
        for (v, d) in forces.chunks_exact_mut(self.dim).zip(&self.distances) {
            let depth = self.clearance - d.value;
            if depth <= 0.0 {
                v.fill(0.0);
                continue;
            }
            let (slope, bent) = (dot(&d.gradient[..v.len()], v), d.second(v));
            v.iter_mut().zip(d.gradient).zip(bent).for_each(|((v, n), bent)| *v = slope * n - depth * bent);
        }
        self.points.spread(&forces, self.dim, &mut out.u);
        Ok(())
    }

    /// The smallest distance of a quadrature point or node from the obstacle, negative inside.
    fn figures(&self) -> Result<Vec<Figure>, ControlError> {
        let smallest = self.distances.iter().map(|d| d.value).fold(f64::INFINITY, f64::min);
        Ok(vec![Figure::length(FigureKind::ObstacleDistance, smallest)])
    }
}
