//! [`Tracking`]: the mean squared distance of a surface, region or node set from target positions.

use super::body_points::{BodyPart, BodyPoints};
use super::target_positions::Target;
use super::{
    Aim, Cost, CostContext, CostForm, CostPoint, CostTarget, Figure, FigureKind, IntoCost, Key, KeyKind, Partials,
    check_weight,
};
use nastic_fem::Solid;
use nastic_fields::ControlError;
use nastic_mesh::{GroupNames, Mesh};
use std::sync::Arc;

/// `j = (weight/2) int_{Gamma_0} |x - x_target|^2 dA` over a named surface of the reference body (`dX` over a region, a
/// plain sum over a node set), with `x = X + u(X)`.
///
/// Derivatives: `dj/du [v] = weight int (x - x_target) . v dA`, `d2j/du2 [v, w] = weight int v . w dA`. Over ranks the integral is the sum of those over the facets and cells
/// of each, node sets count nodes where they belong; a target by node is one of the part.
/// Units: length^4 times the weight's on a surface, length^5 over a region, length^2 over nodes.
/// Source: survey, section 4.2.3; docs/model/costs.md.
#[derive(Clone, Debug)]
pub struct Tracking {
    place: BodyPart,
    target: Target,
    weight: f64,
}

impl Tracking {
    /// Tracks a named surface, or the union of several.
    pub fn surface(names: impl Into<GroupNames>, target: Target) -> Self {
        Tracking { place: BodyPart::Surface(names.into()), target, weight: 1.0 }
    }

    /// Tracks a named region, or the union of several.
    pub fn region(names: impl Into<GroupNames>, target: Target) -> Self {
        Tracking { place: BodyPart::Region(names.into()), target, weight: 1.0 }
    }

    /// Tracks the nodes of named node sets (or of surfaces), each with weight one.
    pub fn nodes(names: impl Into<GroupNames>, target: Target) -> Self {
        Tracking { place: BodyPart::Nodes(names.into()), target, weight: 1.0 }
    }

    /// Multiplies the cost.
    pub fn weight(mut self, weight: f64) -> Self {
        self.weight = weight;
        self
    }
}

/// How it stands in case files.
pub(super) const FORM: CostForm = CostForm::new(
    "tracking",
    "weight/2 int |x - x_target|^2 over a surface or region, the sum over a node set.",
    &[
        Key::SURFACE.one_of(),
        Key::REGION.one_of(),
        Key::NODES.one_of(),
        Key::new("target", "Target positions.", KeyKind::Target),
    ],
    |on| Tracking { place: on.place()?, target: on.get("target")?, weight: on.weight }.bind(on.solid),
)
.square()
.reported_at("target")
.words(|words| format!("weight/2 int |x - x_target|^2 on {}", words.place()));

impl IntoCost for Tracking {
    fn not_over_ranks(&self) -> Option<String> {
        None
    }

    fn bind(self, solid: &Solid) -> Result<Box<dyn Cost>, ControlError> {
        Ok(Box::new(self.bind_to(solid)?))
    }
}

impl Tracking {
    /// The cost on a body.
    ///
    /// # Errors
    /// Unknown names, a target of the wrong size or not finite, a weight that is not positive.
    pub fn bind_to(self, solid: &Solid) -> Result<BoundTracking, ControlError> {
        let weight = check_weight("tracking", self.weight)?;
        let (points, nodes) = self.place.points(solid)?;
        let target = self.target.at(&points, solid, "tracking")?;
        let mesh = solid.mesh().clone();
        Ok(BoundTracking { mesh, points: Arc::new(points), target, weight, nodes, wanted: self.target })
    }
}

/// [`Tracking`] bound to a body.
#[derive(Debug)]
pub struct BoundTracking {
    mesh: Arc<Mesh>,
    points: Arc<BodyPoints>,
    target: Vec<[f64; 3]>,
    weight: f64,
    /// The nodes of what is tracked, and where they should be.
    nodes: Vec<u32>,
    wanted: Target,
}

impl Cost for BoundTracking {
    fn name(&self) -> &str {
        "tracking"
    }

    fn spans_ranks(&self) -> bool {
        true
    }

    fn is_of(&self, solid: &Solid) -> bool {
        Arc::ptr_eq(&self.mesh, solid.mesh())
    }

    fn at(&self, at: &CostContext) -> Result<Arc<dyn CostPoint>, ControlError> {
        let dim = at.solid.discretization().dim();
        let x = self.points.positions(at.solid, Some(at.u));
        let (mut squares, mut forces) = (0.0, Vec::with_capacity(dim * x.len()));
        let (mut measure, mut largest) = (0.0, 0.0f64);
        for (q, (x, target)) in x.iter().zip(&self.target).enumerate() {
            let gap: [f64; 3] = std::array::from_fn(|i| x[i] - target[i]);
            let weight = self.points.weight(q);
            let square = gap.iter().map(|g| g * g).sum::<f64>();
            squares += weight * square;
            (measure, largest) = (measure + weight, largest.max(square));
            forces.extend(gap[..dim].iter().map(|g| self.weight * weight * g));
        }
        if let Some(share) = at.solid.model().unknowns().share() {
            let (mut sums, mut most) = ([squares, measure], [-largest]);
            share.sum(&mut sums);
            share.least(&mut most);
            ([squares, measure], [largest]) = (sums, most.map(|most| -most));
        }
        let value = 0.5 * self.weight * squares;
        let distances = [(squares / measure).sqrt(), largest.sqrt()];
        Ok(Arc::new(TrackingPoint { points: self.points.clone(), weight: self.weight, dim, value, forces, distances }))
    }

    /// The body displaced to where its tracked nodes should be; a node that has no finite place does not matter.
    fn target(&self, solid: &Solid) -> Option<CostTarget> {
        let (mesh, dim) = (solid.mesh(), solid.discretization().dim());
        let mut displacement = vec![([0.0; 3], false); mesh.points().len()];
        for &node in &self.nodes {
            let x = mesh.points()[node as usize];
            let u: [f64; 3] = match &self.wanted {
                Target::Position(at) => {
                    let y = at(x);
                    std::array::from_fn(|k| y[k] - x[k])
                }
                Target::Displacement(u) => {
                    std::array::from_fn(|k| if k < dim { u[node as usize * dim + k] } else { 0.0 })
                }
            };
            if u.iter().all(|u| u.is_finite()) {
                displacement[node as usize] = (u, true);
            }
        }
        Some(CostTarget { mesh: mesh.clone(), regions: None, displacement })
    }

    /// The means over what is tracked; none of a body over ranks, of which each knows its own points.
    fn aim(&self, solid: &Solid, u: &[f64]) -> Option<Aim> {
        if solid.model().ranks().is_over_ranks() {
            return None;
        }
        let mean = |at: &[[f64; 3]]| -> [f64; 3] {
            let measure: f64 = (0..at.len()).map(|q| self.points.weight(q)).sum();
            let sum = |i: usize| at.iter().enumerate().map(|(q, x)| self.points.weight(q) * x[i]).sum::<f64>();
            std::array::from_fn(|i| sum(i) / measure)
        };
        let x = self.points.positions(solid, Some(u));
        Some(Aim { position: mean(&x), target: mean(&self.target).map(Some) })
    }
}

/// [`Tracking`] evaluated.
#[derive(Debug)]
struct TrackingPoint {
    points: Arc<BodyPoints>,
    weight: f64,
    dim: usize,
    value: f64,
    /// `weight w_q (x - x_target)` at every point, `dim` numbers each.
    forces: Vec<f64>,
    /// `(int |x - x_target|^2 dA / int dA)^(1/2)`, and the largest distance of a quadrature point or node.
    distances: [f64; 2],
}

impl CostPoint for TrackingPoint {
    fn value(&self) -> f64 {
        self.value
    }

    fn add_partials(&self, out: &mut Partials) -> Result<(), ControlError> {
        self.points.spread(&self.forces, self.dim, &mut out.u);
        Ok(())
    }

    /// `weight int du . v dA`.
    fn add_second_partials(&self, along: &Partials, out: &mut Partials) -> Result<(), ControlError> {
        let forces = self.points.weighted(&along.u, self.dim, self.weight);
        self.points.spread(&forces, self.dim, &mut out.u);
        Ok(())
    }

    fn figures(&self) -> Result<Vec<Figure>, ControlError> {
        let [mean, largest] = self.distances;
        Ok(vec![
            Figure::length(FigureKind::RootMeanSquareDistance, mean),
            Figure::length(FigureKind::LargestDistance, largest),
        ])
    }
}
