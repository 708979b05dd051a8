//! [`MeanDisplacement`]: how far a point, or the mean of a surface, region or node set, goes along a direction.

use super::position::{Of, Shares, mean, over_ranks, shares};
use super::{Cost, CostContext, CostForm, CostPoint, IntoCost, Key, KeyKind, Output, Partials, check_weight};
use nastic_fem::Solid;
use nastic_fields::ControlError;
use nastic_mesh::GroupNames;
use nastic_numeric::vector::{dot, norm};
use std::sync::Arc;

/// `j = weight d . u`, the mean displacement `u = int u dA / int dA` of a named surface (`dX` over a region, the mean over a node set), or that of one point, along a unit
/// vector d. On a surface with a uniform traction t along d it is, times |t| and the area, the work `int t . u dA` of the load: its compliance.
///
/// Derivative: `weight d . v`; the second one is zero. Unit: length.
#[derive(Clone, Debug)]
pub struct MeanDisplacement {
    of: Of,
    direction: [f64; 3],
    weight: f64,
}

impl MeanDisplacement {
    /// Of a named surface, or of the union of several, along a direction of any length but zero.
    pub fn surface(names: impl Into<GroupNames>, direction: [f64; 3]) -> Self {
        MeanDisplacement { of: Of::surface(names.into()), direction, weight: 1.0 }
    }

    /// Of the point that is at `point` in the reference body.
    pub fn point(point: [f64; 3], direction: [f64; 3]) -> Self {
        MeanDisplacement { of: Of::Point(point), direction, weight: 1.0 }
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
    "displacement",
    "weight times the displacement along a direction: the mean over a surface, region or node set, or that of one point.",
    &[
        Key::SURFACE.one_of(),
        Key::REGION.one_of(),
        Key::NODES.one_of(),
        Key::POINT.one_of(),
        Key::new("direction", "Direction along which it counts.", KeyKind::Direction),
    ],
    |on| {
        let of = on.given("point").map_or_else(|| on.place().map(Of::Part), |point| Ok(Of::Point(point)))?;
        MeanDisplacement { of, direction: on.get("direction")?, weight: on.weight }.bind(on.solid)
    },
)
.words(|words| {
    let place = words.given("point").map_or_else(|| words.place().to_owned(), |point| format!("the point ({point})"));
    format!("displacement of {place} along ({})", words.text("direction"))
});

impl IntoCost for MeanDisplacement {
    fn not_over_ranks(&self) -> Option<String> {
        None
    }

    fn bind(self, solid: &Solid) -> Result<Box<dyn Cost>, ControlError> {
        let factors = solid.model().ranks().all_accept(self.factors(solid))?;
        let (shares, _) = shares(&self.of, solid)?;
        Ok(Box::new(OnBody { shares: shares.into(), factors }))
    }
}

impl MeanDisplacement {
    /// `weight d`.
    fn factors(&self, solid: &Solid) -> Result<[f64; 3], ControlError> {
        let weight = check_weight("displacement", self.weight)?;
        let length = norm(&self.direction);
        let refuse = |what: String| Err(ControlError::Cost { what });
        if !(length > 0.0 && length.is_finite()) {
            return refuse(format!(
                "the direction {:?} of a displacement has no finite length but zero",
                self.direction
            ));
        }
        if solid.discretization().dim() == 2 && self.direction[2] != 0.0 {
            return refuse("a plane body moves in its plane: the direction of a displacement has no z".to_owned());
        }
        Ok(self.direction.map(|d| weight * d / length))
    }
}

/// [`MeanDisplacement`] bound to a body.
#[derive(Debug)]
struct OnBody {
    shares: Arc<Shares>,
    factors: [f64; 3],
}

impl Cost for OnBody {
    fn name(&self) -> &str {
        "displacement"
    }

    fn spans_ranks(&self) -> bool {
        true
    }

    fn at(&self, at: &CostContext) -> Result<Arc<dyn CostPoint>, ControlError> {
        let dim = at.solid.discretization().dim();
        let mut moved = mean(&self.shares, at.u, dim);
        over_ranks(at.solid, &mut moved);
        let value = dot(&self.factors, &moved);
        Ok(Arc::new(EvaluatedCost { shares: self.shares.clone(), factors: self.factors, dim, value }))
    }
}

/// The cost evaluated.
#[derive(Debug)]
struct EvaluatedCost {
    shares: Arc<Shares>,
    factors: [f64; 3],
    dim: usize,
    value: f64,
}

impl CostPoint for EvaluatedCost {
    fn value(&self) -> f64 {
        self.value
    }

    fn add_partials(&self, out: &mut Partials) -> Result<(), ControlError> {
        for (node, share) in self.shares.iter() {
            for i in 0..self.dim {
                out.u[*node as usize * self.dim + i] += share * self.factors[i];
            }
        }
        Ok(())
    }

    fn outputs(&self, zero: &Partials) -> Result<Vec<Output>, ControlError> {
        // |weight d|, d of length 1
        let (weight, mut partials) = (norm(&self.factors), zero.clone());
        self.add_partials(&mut partials)?;
        partials.u.iter_mut().for_each(|own| *own /= weight);
        Ok(vec![Output::watched("", self.value / weight, "m", partials)])
    }

    fn add_second_partials(&self, _: &Partials, _: &mut Partials) -> Result<(), ControlError> {
        Ok(())
    }
}
