//! [`MeanPosition`]: the squared distance of one point, or of the mean of a surface, region or node set, from a position.

use super::body_points::BodyPart;
use super::{
    AXES, Aim, Cost, CostContext, CostForm, CostPoint, Figure, FigureKind, IntoCost, Key, KeyKind, Output, Partials,
    check_weight,
};
use nastic_fem::Solid;
use nastic_fields::ControlError;
use nastic_mesh::GroupNames;
use std::sync::Arc;

/// `j = (weight/2) sum_i (x_i - y_i)^2` over the components i that have a target y_i, with the mean `x = int_{Gamma_0} (X + u) dA / int dA`
/// of a named surface of the reference body (`dX` over a region, the mean of the nodes of a node set), or with the position of one point.
///
/// Derivatives: `dj/du [v] = weight (x - y) . v_mean`, `d2j/du2 [v, w] = weight v_mean . w_mean`, over those components.
/// Units: length^2 times the weight's. Source: docs/model/costs.md.
#[derive(Clone, Debug)]
pub struct MeanPosition {
    of: Of,
    target: [Option<f64>; 3],
    weight: f64,
}

/// Whose position.
#[derive(Clone, Debug)]
pub(super) enum Of {
    Part(BodyPart),
    Point([f64; 3]),
}

impl Of {
    /// That of a surface.
    pub fn surface(names: GroupNames) -> Self {
        Of::Part(BodyPart::Surface(names))
    }
}

impl MeanPosition {
    fn of(of: Of, target: [Option<f64>; 3]) -> Self {
        MeanPosition { of, target, weight: 1.0 }
    }

    /// The mean of a named surface, or of the union of several; components without a target are free.
    pub fn surface(names: impl Into<GroupNames>, target: [Option<f64>; 3]) -> Self {
        Self::of(Of::Part(BodyPart::Surface(names.into())), target)
    }

    /// The mean of a named region, or of the union of several.
    pub fn region(names: impl Into<GroupNames>, target: [Option<f64>; 3]) -> Self {
        Self::of(Of::Part(BodyPart::Region(names.into())), target)
    }

    /// The mean of the nodes of named node sets (or of surfaces).
    pub fn nodes(names: impl Into<GroupNames>, target: [Option<f64>; 3]) -> Self {
        Self::of(Of::Part(BodyPart::Nodes(names.into())), target)
    }

    /// The point that is at `point` in the reference body.
    pub fn point(point: [f64; 3], target: [Option<f64>; 3]) -> Self {
        Self::of(Of::Point(point), target)
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
    "position",
    "weight/2 |x - target|^2 of the mean x of a surface, region or node set, or of one point.",
    &[
        Key::SURFACE.one_of(),
        Key::REGION.one_of(),
        Key::NODES.one_of(),
        Key::POINT.one_of(),
        Key::new("target", "Where it shall be; components left out are free.", KeyKind::Position),
    ],
    |on| {
        let of = on.given("point").map_or_else(|| on.place().map(Of::Part), |point| Ok(Of::Point(point)))?;
        MeanPosition { of, target: on.get("target")?, weight: on.weight }.bind(on.solid)
    },
)
.square()
.reported_at("target")
.words(|words| {
    let mean = || format!("the mean of {}", words.place());
    let place = words.given("point").map_or_else(mean, |point| format!("the point ({point})"));
    format!("weight/2 |x - target|^2 of {place}, target {}", words.text("target"))
});

impl IntoCost for MeanPosition {
    fn not_over_ranks(&self) -> Option<String> {
        None
    }

    fn bind(self, solid: &Solid) -> Result<Box<dyn Cost>, ControlError> {
        // before messages that would wait for a rank that refuses
        let weight = solid.model().ranks().all_accept(self.checked(solid))?;
        let (shares, reference) = shares(&self.of, solid)?;
        Ok(Box::new(OnBody { shares: shares.into(), reference, target: self.target, weight }))
    }
}

impl MeanPosition {
    /// The weight, if all is right that is given.
    fn checked(&self, solid: &Solid) -> Result<f64, ControlError> {
        let weight = check_weight("position", self.weight)?;
        let dim = solid.discretization().dim();
        let refuse = |what: &str| Err(ControlError::Cost { what: what.to_owned() });
        if self.target.iter().all(Option::is_none) {
            return refuse("a position has no target: give at least one component");
        }
        if self.target.iter().flatten().any(|y| !y.is_finite()) {
            return refuse("the target of a position is not finite");
        }
        if dim == 2 && self.target[2].is_some() {
            return refuse("a plane body has no component z: leave it out of the target of a position");
        }
        Ok(weight)
    }
}

/// Nodes with their shares of a mean.
pub(super) type Shares = Vec<(u32, f64)>;

/// Shares `c_a` of the nodes, `x = sum_a c_a x_a`, and the mean at rest.
pub(super) fn shares(of: &Of, solid: &Solid) -> Result<(Shares, [f64; 3]), ControlError> {
    let mesh = solid.mesh();
    let mut by_node = vec![0.0; mesh.points().len()];
    match of {
        Of::Part(place) => {
            let (points, _) = solid.model().ranks().all_accept(place.points(solid))?;
            let count = points.positions(solid, None).len();
            let weights: Vec<f64> = (0..count).map(|q| points.weight(q)).collect();
            let measure = solid.model().unknowns().total(weights.iter().sum());
            let means: Vec<f64> = weights.iter().map(|w| w / measure).collect();
            points.spread(&means, 1, &mut by_node);
        }
        Of::Point(point) => {
            let located = mesh.locate_inside(*point);
            if counts(solid, located.is_ok()) {
                located?.weights.iter().for_each(|&(node, shape)| by_node[node as usize] += shape);
            }
        }
    }
    let nodes = (0..).zip(by_node).filter(|(_, share)| *share != 0.0);
    let shares: Shares = nodes.collect();
    let mean = |i: usize| shares.iter().map(|&(node, share)| share * mesh.points()[node as usize][i]).sum();
    let mut reference: [f64; 3] = std::array::from_fn(mean);
    over_ranks(solid, &mut reference);
    Ok((shares, reference))
}

/// Whether this rank counts a point of the body: the lowest rank that has found it does, or all if none has.
fn counts(solid: &Solid, found: bool) -> bool {
    let Some(share) = solid.model().unknowns().share() else { return true };
    let own = share.team().rank() as f64;
    let lowest = solid.model().unknowns().least(if found { own } else { f64::INFINITY });
    lowest == own || lowest == f64::INFINITY
}

/// The sums of the shares of a mean that the ranks have.
pub(super) fn over_ranks(solid: &Solid, mean: &mut [f64; 3]) {
    if let Some(share) = solid.model().unknowns().share() {
        share.sum(mean);
    }
}

/// [`MeanPosition`] bound to a body.
#[derive(Debug)]
struct OnBody {
    shares: Arc<[(u32, f64)]>,
    reference: [f64; 3],
    target: [Option<f64>; 3],
    weight: f64,
}

impl Cost for OnBody {
    fn name(&self) -> &str {
        "position"
    }

    fn spans_ranks(&self) -> bool {
        true
    }

    fn numbers(&self) -> Option<usize> {
        Some(self.target.iter().flatten().count())
    }

    fn has_position(&self) -> bool {
        true
    }

    fn at(&self, at: &CostContext) -> Result<Arc<dyn CostPoint>, ControlError> {
        let dim = at.solid.discretization().dim();
        let mut moved = mean(&self.shares, at.u, dim);
        over_ranks(at.solid, &mut moved);
        let gap = |i: usize| self.target[i].map_or(0.0, |y| self.reference[i] + moved[i] - y);
        let (shares, target, weight) = (self.shares.clone(), self.target, self.weight);
        Ok(Arc::new(EvaluatedCost { shares, target, weight, dim, gap: std::array::from_fn(gap) }))
    }

    fn aim(&self, solid: &Solid, u: &[f64]) -> Option<Aim> {
        if solid.model().ranks().is_over_ranks() {
            return None;
        }
        let moved = mean(&self.shares, u, solid.discretization().dim());
        Some(Aim { position: std::array::from_fn(|i| self.reference[i] + moved[i]), target: self.target })
    }
}

/// `sum_a c_a v_a` of a nodal vector.
pub(super) fn mean(shares: &[(u32, f64)], nodal: &[f64], dim: usize) -> [f64; 3] {
    let component = |i: usize| shares.iter().map(|&(node, share)| share * nodal[node as usize * dim + i]).sum();
    std::array::from_fn(|i| if i < dim { component(i) } else { 0.0 })
}

/// The cost evaluated.
#[derive(Debug)]
struct EvaluatedCost {
    shares: Arc<[(u32, f64)]>,
    target: [Option<f64>; 3],
    weight: f64,
    dim: usize,
    /// `x - y`; zero in free components.
    gap: [f64; 3],
}

impl EvaluatedCost {
    fn add(&self, force: &[f64; 3], out: &mut [f64]) {
        for &(node, share) in self.shares.iter() {
            for i in 0..self.dim {
                out[node as usize * self.dim + i] += self.weight * share * force[i];
            }
        }
    }
}

/// Adds the derivative of a component of `sum_a c_a v_a`.
pub(super) fn add_component(shares: &[(u32, f64)], component: usize, dim: usize, out: &mut [f64]) {
    shares.iter().for_each(|&(node, share)| out[node as usize * dim + component] += share);
}

impl CostPoint for EvaluatedCost {
    fn value(&self) -> f64 {
        0.5 * self.weight * self.gap.iter().map(|gap| gap * gap).sum::<f64>()
    }

    fn add_partials(&self, out: &mut Partials) -> Result<(), ControlError> {
        self.add(&self.gap, &mut out.u);
        Ok(())
    }

    fn add_second_partials(&self, along: &Partials, out: &mut Partials) -> Result<(), ControlError> {
        let moved = mean(&self.shares, &along.u, self.dim);
        let wanted = std::array::from_fn(|i| if self.target[i].is_some() { moved[i] } else { 0.0 });
        self.add(&wanted, &mut out.u);
        Ok(())
    }

    fn outputs(&self, zero: &Partials) -> Result<Vec<Output>, ControlError> {
        let of = |(i, target): (usize, f64)| {
            let mut partials = zero.clone();
            add_component(&self.shares, i, self.dim, &mut partials.u);
            Output::watched(AXES[i], target + self.gap[i], "m", partials).aiming(target, self.weight)
        };
        Ok(self.target.iter().enumerate().filter_map(|(i, target)| Some((i, (*target)?))).map(of).collect())
    }

    /// The distance over the components that have a target.
    fn figures(&self) -> Result<Vec<Figure>, ControlError> {
        let distance = self.gap.iter().map(|gap| gap * gap).sum::<f64>().sqrt();
        Ok(vec![Figure::length(FigureKind::PositionDistance, distance)])
    }
}
