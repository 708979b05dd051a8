//! [`Reaction`]: the squared deviation of the force of a support from a wanted one.

use super::{
    Cost, CostContext, CostForm, CostPoint, Figure, FigureKind, IntoCost, Key, KeyKind, MotionPartials, Output,
    Partials, check_weight,
};
use crate::time::Timeline;
use nastic_fem::{Begin, Controls, Increment, Instant, Model, Solid, State, StateError};
use nastic_fields::{ControlError, Layout};
use nastic_linear::Symmetry;
use nastic_mesh::GroupNames;
use nastic_numeric::vector::{axpy, dot, norm};
use std::sync::Arc;

/// `j = (weight/2) (R - force)^2` with the force R along a unit vector d that supports, those that move too, exert on the body at the nodes of a named surface,
///
/// ```text
/// R = l . r(u, m),    l = d at the held unknowns D of these nodes, else 0
/// ```
///
/// r the residual of the equilibrium, which is zero on all unknowns that nothing holds. What grips take, a blocked force.
///
/// In a motion `M a` and the forces of damping and viscous laws are part of r ([`PrescribedUnknowns::held_forces`](nastic_fem::views::PrescribedUnknowns::held_forces)), as of
/// [`Solid::reactions`]; steps end at a stage, nothing slides with friction, and where controls move the body with inertia the scheme is `backward_euler`, in which the
/// acceleration of a state is the mean over its step.
///
/// Derivatives: `dR/du = K^T l`, `dR/dm = l . dr/dm`; second ones those of l . r: `(l . r)_uu du + (l . r)_um v` and so on. Units: force^2 times the weight's; in plane
/// strain per unit of depth.
/// Source: docs/model/costs.md.
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
        Key::SURFACE.about("Surface of the mesh that is held, or moved, in some components at least."),
        Key::new("direction", "Direction of the force.", KeyKind::Direction),
        Key::new("force", "The force that is wanted.", KeyKind::Number { unit: "N", default: None }),
    ],
    |on| {
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
    fn not_over_ranks(&self) -> Option<String> {
        None
    }

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
        if solid.model().unknowns().max_abs(&along) == 0.0 {
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

    fn depends_on_materials(&self) -> bool {
        true
    }

    fn spans_ranks(&self) -> bool {
        true
    }

    fn numbers(&self) -> Option<usize> {
        Some(1)
    }

    fn check_in_motion(&self, solid: &Solid, timeline: &Timeline, at_start: bool) -> Result<(), ControlError> {
        let (scheme, supports) = (timeline.scheme(), solid.supports());
        let refuse = |what: &str| Err(ControlError::Cost { what: format!("the reaction of a body in motion {what}") });
        if !scheme.ends_at_its_last_stage() {
            return refuse(
                "needs a scheme whose steps end at a stage: take backward_euler, bdf2, tr_bdf2, trapezoidal, newmark or quasi_static",
            );
        }
        if solid.model().contacts().parameters().iter().any(|(_, contact)| contact.friction.is_some()) {
            return refuse("with friction has no derivative here: leave \"friction\" out");
        }
        if scheme.is_quasi_static() {
            return Ok(());
        }
        let is_moved = (0..supports.fixed().len()).any(|dof| supports.fixed()[dof] && !supports.holds_still(dof));
        if is_moved && scheme.name() != "backward_euler" {
            return refuse("whose surfaces move takes mean accelerations: take backward_euler or quasi_static");
        }
        if at_start && timeline.begin() == Begin::Given {
            return refuse(
                "is not known at t = 0 where it begins at rest: let it count from the first step on, \"when\": { \"at\": [..] }",
            );
        }
        Ok(())
    }

    fn at(&self, at: &CostContext) -> Result<Arc<dyn CostPoint>, ControlError> {
        let Some(state) = at.state else {
            let what = "a reaction takes the equilibrium itself, not a displacement alone".to_owned();
            return Err(ControlError::Cost { what });
        };
        let model = at.solid.model();
        let reaction = model.unknowns().dot(&self.along, &model.prescribed_unknowns().held_forces(state)?);
        Ok(Arc::new(EvaluatedCost {
            along: self.along.clone(),
            gap: reaction - self.force,
            reaction,
            weight: self.weight,
            model: at.solid.model().clone(),
            state: state.clone(),
            layout: at.layout.clone(),
            m: at.m.to_vec(),
        }))
    }
}

/// `K^T l`, of a body over ranks the share of this one.
fn transposed(model: &Model, at: &Instant, l: &[f64]) -> Result<Vec<f64>, ControlError> {
    let mut out = vec![0.0; l.len()];
    // ranks agree on tangents, not on products of their own
    if model.properties().symmetry() == Symmetry::Symmetric
        && !model.ranks().is_over_ranks()
        && model.tangents().tangent_product(at, l, &mut out)?
    {
        return Ok(out);
    }
    out.fill(0.0);
    let mut matrix = model.tangents().matrix();
    model.tangents().add_tangent(at, &mut matrix)?;
    matrix.multiply_transposed(l, &mut out, true);
    Ok(out)
}

/// The cost evaluated.
#[derive(Debug)]
struct EvaluatedCost {
    along: Arc<[f64]>,
    reaction: f64,
    /// `R - force`
    gap: f64,
    weight: f64,
    model: Model,
    state: State,
    layout: Layout,
    m: Vec<f64>,
}

impl EvaluatedCost {
    fn unit(&self) -> &'static str {
        if self.model.discretization().dim() == 2 { "N/m" } else { "N" }
    }

    /// `dR/du`, `dR/dm`, and the latter by the values at the points.
    fn slopes(&self) -> Result<(Partials, Controls), ControlError> {
        let at = Instant::of(&self.state);
        let by_points = self.model.vjp(&at, &self.along)?.controls;
        let m = self.layout.control_vjp(&self.m, &by_points);
        Ok((Partials { u: transposed(&self.model, &at, &self.along)?, m }, by_points))
    }
}

impl CostPoint for EvaluatedCost {
    fn value(&self) -> f64 {
        0.5 * self.weight * self.gap * self.gap
    }

    fn add_partials(&self, out: &mut Partials) -> Result<(), ControlError> {
        let (by, _) = self.slopes()?;
        axpy(self.weight * self.gap, &by.u, &mut out.u);
        axpy(self.weight * self.gap, &by.m, &mut out.m);
        Ok(())
    }

    fn add_partials_in_motion(&self, _: &mut Partials, more: &mut MotionPartials) -> Result<(), ControlError> {
        more.held.resize(self.along.len(), 0.0);
        axpy(self.weight * self.gap, &self.along, &mut more.held);
        Ok(())
    }

    /// With `dR = R_u du + R_m v`: `weight (dR R_u + (R - force) ((l . r)_uu du + (l . r)_um v))`, and so by m.
    fn add_second_partials(&self, along: &Partials, out: &mut Partials) -> Result<(), ControlError> {
        let (by, by_points) = self.slopes()?;
        let change = dot(&by.u, &along.u) + dot(&by.m, &along.m);
        axpy(self.weight * change, &by.u, &mut out.u);
        axpy(self.weight * change, &by.m, &mut out.m);
        let controls = self.layout.change(&self.m, &along.m)?;
        let increment = Increment { u: &along.u, controls: &controls };
        let second = self.model.second_vjp(&Instant::of(&self.state), &self.along, &increment);
        let second = second.map_err(StateError::from)?;
        let slope = self.weight * self.gap;
        axpy(slope, &second.u, &mut out.u);
        axpy(slope, &self.layout.control_vjp(&self.m, &second.controls), &mut out.m);
        axpy(slope, &self.layout.second_vjp(&self.m, &along.m, &by_points), &mut out.m);
        Ok(())
    }

    fn outputs(&self, _: &Partials) -> Result<Vec<Output>, ControlError> {
        let output = Output::watched("", self.reaction, self.unit(), self.slopes()?.0);
        Ok(vec![output.aiming(self.reaction - self.gap, self.weight)])
    }

    fn figures(&self) -> Result<Vec<Figure>, ControlError> {
        Ok(vec![Figure { kind: FigureKind::Other("reaction"), value: self.reaction, unit: self.unit() }])
    }
}
