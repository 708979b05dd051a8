//! [`Reaction`]: the squared deviation of the force of a support from a wanted one.

use super::{
    Cost, CostContext, CostForm, CostKey, CostPoint, CostTakes, Figure, FigureKind, IntoCost, Partials, check_weight,
};
use crate::error::ControlError;
use nastic_fem::{Demand, Instant, Model, Solid};
use nastic_linear::Symmetry;
use nastic_mesh::GroupNames;
use nastic_numeric::vector::{dot, norm};
use std::sync::Arc;

/// `j = (weight/2) (R - force)^2` with the force R along a unit vector d that supports, those that move too, exert on the body at the nodes of a named surface,
///
/// ```text
/// R = l . r(u, m),    l = d at the held unknowns D of these nodes, else 0
/// ```
///
/// r the residual of the equilibrium, which is zero on all unknowns that nothing holds. What grips take, a blocked force.
///
/// Derivatives: `dR/du = K^T l`, `dR/dm = l . dr/dm`. There are no second partials. Units: force^2 times the weight's; in plane strain per unit of depth.
/// Source: docs/model.md section 5.
#[derive(Clone, Debug)]
pub struct Reaction {
    surface: GroupNames,
    direction: [f64; 3],
    force: f64,
    weight: f64,
}

impl Reaction {
    /// At a named surface or node set, or the union of several, along a direction of any length but zero.
    pub fn at(surface: impl Into<GroupNames>, direction: [f64; 3], force: f64) -> Self {
        Reaction { surface: surface.into(), direction, force, weight: 1.0 }
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
    "reaction",
    "weight/2 (R - force)^2, R the force along a direction that supports exert at a surface.",
    &[
        CostKey::SURFACE.about("Surface of the mesh that is held, or moved, in some components at least."),
        CostKey::new("direction", "Direction of the force.", CostTakes::Direction),
        CostKey::new("force", "The force that is wanted.", CostTakes::Number { unit: "N", default: None }),
    ],
    |on| {
        let refuse = |what: &str| Err(ControlError::Cost { what: what.to_owned() });
        if on.in_motion {
            return refuse(
                "the reaction of a body in motion is no cost: it takes accelerations of held nodes; take a static case",
            );
        }
        if on.second {
            return refuse("a reaction has no second derivatives, which the method of this case needs: take \"lbfgs\"");
        }
        let (surface, direction, force) = (on.get("surface")?, on.get("direction")?, on.get("force")?);
        Reaction { surface, direction, force, weight: on.weight }.bind(on.solid)
    },
)
.square()
.reported_at("surface")
.words(|words| {
    let (place, along) = (words.place(), words.text("direction"));
    format!("weight/2 (force of supports at {place} along ({along}) - {})^2", words.text("force"))
});

impl IntoCost for Reaction {
    fn bind(self, solid: &Solid) -> Result<Box<dyn Cost>, ControlError> {
        let weight = check_weight("reaction", self.weight)?;
        let refuse = |what: String| Err(ControlError::Cost { what });
        let dim = solid.discretization().dim();
        let length = norm(&self.direction);
        if !(length > 0.0 && length.is_finite()) {
            return refuse(format!("the direction {:?} of a reaction has no finite length but zero", self.direction));
        }
        if dim == 2 && self.direction[2] != 0.0 {
            return refuse("a plane body is held in its plane: the direction of a reaction has no z".into());
        }
        if !self.force.is_finite() {
            return refuse("the force of a reaction is not finite".into());
        }
        let mut along = vec![0.0; solid.model().unknowns().len()];
        let fixed = solid.supports().fixed();
        for node in solid.nodes_of(&self.surface)? {
            for (i, d) in self.direction[..dim].iter().enumerate() {
                let dof = node as usize * dim + i;
                along[dof] = if fixed[dof] { d / length } else { 0.0 };
            }
        }
        if along.iter().all(|d| *d == 0.0) {
            return refuse(format!(
                "nothing holds surface \"{}\" along the direction {:?} of a reaction: name one that a support or a motion holds",
                self.surface, self.direction
            ));
        }
        Ok(Box::new(OnBody { along: along.into(), force: self.force, weight }))
    }
}

/// [`Reaction`] bound to a body.
#[derive(Debug)]
struct OnBody {
    /// l
    along: Arc<[f64]>,
    force: f64,
    weight: f64,
}

impl Cost for OnBody {
    fn name(&self) -> &str {
        "reaction"
    }

    fn numbers(&self) -> Option<usize> {
        Some(1)
    }

    fn at(&self, at: &CostContext) -> Result<Arc<dyn CostPoint>, ControlError> {
        let Some(state) = at.state else {
            let what = "a reaction takes the equilibrium itself, not a displacement alone".to_owned();
            return Err(ControlError::Cost { what });
        };
        let (model, instant) = (at.solid.model(), Instant::of(state));
        let residual = model.evaluate(&instant, Demand { energy: false, force: true })?.force;
        let reaction = dot(&self.along, &residual);
        let slope = self.weight * (reaction - self.force);
        let scaled = |values: Vec<f64>| values.into_iter().map(|d| slope * d).collect();
        let by_points = model.vjp(&instant, &self.along)?.controls;
        let m = scaled(at.layout.control_vjp(at.m, &by_points));
        let partials = Partials { u: scaled(transposed(model, &instant, &self.along)?), m };
        let value = 0.5 * self.weight * (reaction - self.force).powi(2);
        Ok(Arc::new(EvaluatedCost { value, reaction, partials, plane: at.solid.mesh().dim() == 2 }))
    }
}

/// `K^T l`
fn transposed(model: &Model, at: &Instant, l: &[f64]) -> Result<Vec<f64>, ControlError> {
    let mut out = vec![0.0; l.len()];
    if model.symmetry() == Symmetry::Symmetric && model.tangent_product(at, l, &mut out)? {
        return Ok(out);
    }
    out.fill(0.0);
    let mut matrix = model.matrix();
    model.add_tangent(at, &mut matrix)?;
    matrix.multiply_transposed(l, &mut out, true);
    Ok(out)
}

/// The cost evaluated.
#[derive(Debug)]
struct EvaluatedCost {
    value: f64,
    reaction: f64,
    partials: Partials,
    plane: bool,
}

impl CostPoint for EvaluatedCost {
    fn value(&self) -> f64 {
        self.value
    }

    fn add_partials(&self, out: &mut Partials) -> Result<(), ControlError> {
        out.u.iter_mut().zip(&self.partials.u).for_each(|(out, d)| *out += d);
        out.m.iter_mut().zip(&self.partials.m).for_each(|(out, d)| *out += d);
        Ok(())
    }

    fn figures(&self) -> Result<Vec<Figure>, ControlError> {
        let unit = if self.plane { "N/m" } else { "N" };
        Ok(vec![Figure { kind: FigureKind::Other("reaction"), value: self.reaction, unit }])
    }
}
