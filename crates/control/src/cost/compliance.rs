//! [`Compliance`]: how far a surface of the deformed body gives way to a small probe force.

use super::{
    Cost, CostContext, CostForm, CostPoint, Figure, FigureKind, IntoCost, Key, KeyKind, Partials, check_weight,
};
use nastic_fem::{Increment, Instant, Model, QuadraturePoints, Solid, SolveOptions, StateError};
use nastic_fields::ControlError;
use nastic_linear::Symmetry;
use nastic_mesh::GroupNames;
use nastic_numeric::vector::{dot, norm};
use std::sync::Arc;

/// `j = weight c` with the compliance `c = f . v`, `K(u, m) v = f`: the mean displacement along a unit vector d of a named surface, for each
/// unit of a force along d spread evenly over it, `f_a = (1/A) int N_a d dA` over the reference surface; K is the tangent stiffness of the
/// equilibrium, loads and controls held. The inverse of the stiffness against a probe. It is negative only where the equilibrium is unstable, which is refused; a positive one
/// proves no stability.
///
/// Derivatives: `dc/du = -(v . K v)_u`, `dc/dm = -(v . K v)_m`, the second derivatives of `v . r` along v: third derivatives of the
/// energy. There are no second partials, which would take fourth ones. Cavities of given volume keep it, and taut tendons that cannot stretch their length: K is then the bordered tangent.
/// Units: length over force, in plane strain per unit of depth. Source: docs/model/costs.md.
#[derive(Clone, Debug)]
pub struct Compliance {
    surface: GroupNames,
    direction: [f64; 3],
    weight: f64,
}

impl Compliance {
    /// Of a named surface or the union of several, along a direction of any length but zero.
    pub fn surface(names: impl Into<GroupNames>, direction: [f64; 3]) -> Self {
        Compliance { surface: names.into(), direction, weight: 1.0 }
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
    "compliance",
    "weight times the compliance of a surface: its mean displacement along a direction for each unit of force along it.",
    &[
        Key::SURFACE.about("Surface of the mesh, on which the force is spread evenly."),
        Key::new("direction", "Direction of force and displacement.", KeyKind::Direction),
    ],
    |on| {
        let refuse = |what: &str| Err(ControlError::Cost { what: what.to_owned() });
        if on.in_motion {
            return refuse("the compliance of a body in motion: it is that of an equilibrium; take a static case");
        }
        if on.second {
            return refuse(
                "a compliance has no second derivatives, which the method of this case needs: take \"lbfgs\"",
            );
        }
        let (surface, direction) = (on.get("surface")?, on.get("direction")?);
        Compliance { surface, direction, weight: on.weight }.bind(on.solid)
    },
)
.words(|words| format!("displacement of {} along ({}) for a unit of force", words.place(), words.text("direction")));

impl IntoCost for Compliance {
    fn bind(self, solid: &Solid) -> Result<Box<dyn Cost>, ControlError> {
        let weight = check_weight("compliance", self.weight)?;
        let refuse = |what: String| Err(ControlError::Cost { what });
        let (mesh, dim) = (solid.mesh(), solid.discretization().dim());
        let length = norm(&self.direction);
        if !(length > 0.0 && length.is_finite()) {
            return refuse(format!("the direction {:?} of a compliance has no finite length but zero", self.direction));
        }
        if dim == 2 && self.direction[2] != 0.0 {
            return refuse("a plane body gives way in its plane: the direction of a compliance has no z".into());
        }
        if solid.model().properties().symmetry() != Symmetry::Symmetric {
            return refuse("a compliance needs contributions with symmetric tangents".into());
        }
        let facets = mesh.facets_of(&self.surface)?;
        let points = QuadraturePoints::of_facets(mesh, &facets, |k| k.rule_of_points(k.order() + 2));
        let share = |w: &f64| w / points.measure() / length;
        let forces = points.weights().iter().flat_map(|w| self.direction[..dim].iter().map(move |d| share(w) * d));
        let mut force = vec![0.0; solid.model().unknowns().len()];
        points.spread(&forces.collect::<Vec<_>>(), dim, &mut force);
        if force.iter().zip(solid.supports().fixed()).all(|(f, fixed)| *f == 0.0 || *fixed) {
            return refuse(format!(
                "surface \"{}\" of a compliance is held along its direction: no force moves it",
                self.surface
            ));
        }
        Ok(Box::new(OnBody { force, weight }))
    }
}

/// [`Compliance`] bound to a body.
#[derive(Debug)]
struct OnBody {
    force: Vec<f64>,
    weight: f64,
}

impl Cost for OnBody {
    fn name(&self) -> &str {
        "compliance"
    }

    fn depends_on_materials(&self) -> bool {
        true
    }

    fn at(&self, at: &CostContext) -> Result<Arc<dyn CostPoint>, ControlError> {
        let Some(state) = at.state else {
            let what = "a compliance takes the equilibrium itself, not a displacement alone".to_owned();
            return Err(ControlError::Cost { what });
        };
        let model = at.solid.model();
        let solved = model.adjoint(state, &[&self.force], &SolveOptions::default())?;
        let v = solved.lambda.into_iter().next().unwrap_or_default();
        let instant = Instant::of(state);
        let compliance = self.compliance(model, &instant, &v)?;
        if compliance <= 0.0 {
            let what =
                format!("the compliance is {compliance:.3e}, so the equilibrium is unstable: it gives way by itself");
            return Err(ControlError::Cost { what });
        }
        let zero = model.zero_controls();
        let along = Increment { u: &v, controls: &zero };
        let second = model.second_vjp(&instant, &v, &along);
        let second = second.map_err(StateError::from)?;
        let scaled = |values: Vec<f64>| values.into_iter().map(|d| -self.weight * d).collect();
        let m = at.layout.control_vjp(at.m, &second.controls);
        let partials = Partials { u: scaled(second.u), m: scaled(m) };
        Ok(Arc::new(EvaluatedCost { value: self.weight * compliance, compliance, partials }))
    }
}

impl OnBody {
    /// `2 f . v - v . K v`: that of f . v where v solves, with the square of the error of v elsewhere.
    fn compliance(&self, model: &Model, at: &Instant, v: &[f64]) -> Result<f64, ControlError> {
        let mut product = vec![0.0; v.len()];
        if !model.tangents().tangent_product(at, v, &mut product)? {
            if model.unknowns().multipliers() > 0 {
                let what = "a compliance beside a cavity of given volume or a tendon that cannot stretch needs contributions that give `add_tangent_product`";
                return Err(ControlError::Cost { what: what.to_owned() });
            }
            let mut matrix = model.tangents().matrix();
            model.tangents().add_tangent(at, &mut matrix)?;
            matrix.multiply(v, &mut product);
        }
        Ok(2.0 * dot(&self.force, v) - dot(v, &product))
    }
}

/// The cost evaluated.
#[derive(Debug)]
struct EvaluatedCost {
    value: f64,
    compliance: f64,
    partials: Partials,
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

    /// Its inverse.
    fn figures(&self) -> Result<Vec<Figure>, ControlError> {
        Ok(vec![Figure { kind: FigureKind::Other("stiffness"), value: 1.0 / self.compliance, unit: "N/m" }])
    }
}
