//! [`ContactResultant`]: the force of an obstacle on the body along a direction.

use super::contact_load::contact_of;
use super::{
    Cost, CostContext, CostPoint, Figure, FigureKind, IntoCost, MotionPartials, Output, Partials, check_weight,
};
use nastic_fem::{ContactSum, Instant, Solid, State, TimeStep};
use nastic_fields::{ControlError, Layout};
use nastic_numeric::vector::{axpy, norm};
use std::sync::Arc;

/// The force of an obstacle on the body by one of its contacts along a unit vector d, friction included,
///
/// ```text
/// j = weight d . sum_s w_s t_s
/// ```
///
/// over the samples s of area w_s and traction t_s (docs/contact.md): how heavy the body lies on a floor, what carries it. Friction acts in steps in time, at the velocities of
/// the time scheme; zero where a motion begins. Depends on displacement and velocity, on the pose at both ends of the step, on stiffness and coefficient.
/// Not between surfaces of bodies, not with lagged friction, which depends on the displacement before. Units: N (N/m in plane strain). First derivatives alone.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactResultant {
    contact: String,
    direction: [f64; 3],
    weight: f64,
}

const NAME: &str = "contact_force";

impl ContactResultant {
    /// Of a contact with an obstacle, along a direction of any length but zero.
    pub fn along(contact: &str, direction: [f64; 3]) -> Self {
        ContactResultant { contact: contact.to_owned(), direction, weight: 1.0 }
    }

    /// Factor.
    #[must_use]
    pub fn weight(self, weight: f64) -> Self {
        ContactResultant { weight, ..self }
    }
}

impl IntoCost for ContactResultant {
    fn bind(self, solid: &Solid) -> Result<Box<dyn Cost>, ControlError> {
        check_weight(NAME, self.weight)?;
        let refuse = |what: String| Err(ControlError::Cost { what: format!("{NAME}: {what}") });
        let (own, length) = (contact_of(NAME, solid, &self.contact)?, norm(&self.direction));
        if !(length > 0.0 && length.is_finite()) {
            return refuse(format!("the direction {:?} has no finite length but zero", self.direction));
        }
        if solid.discretization().dim() == 2 && self.direction[2] != 0.0 {
            return refuse("a plane body is pushed in its plane: the direction has no z".to_owned());
        }
        if own.lagged {
            return refuse(format!(
                "along a direction it does not go with the lagged friction of \"{}\": leave \"lagged\" or the direction out",
                self.contact
            ));
        }
        let direction = self.direction.map(|d| d / length);
        if solid.model().contacts().resultant(&Instant::of(&solid.rest()), &self.contact, direction).is_none() {
            return refuse(format!(
                "along a direction it is of a contact with an obstacle, and \"{}\" is between surfaces: leave the direction out",
                self.contact
            ));
        }
        Ok(Box::new(OnBody { slides: own.friction.is_some(), of: ContactResultant { direction, ..self } }))
    }
}

#[derive(Debug)]
struct OnBody {
    of: ContactResultant,
    /// Whether there is friction.
    slides: bool,
}

impl Cost for OnBody {
    fn name(&self) -> &str {
        NAME
    }

    fn needs_step(&self) -> bool {
        self.slides
    }

    fn at(&self, at: &CostContext) -> Result<Arc<dyn CostPoint>, ControlError> {
        let controls = at.layout.to_points(at.m)?;
        let step = at.state.zip(at.step).map(|(state, begin)| {
            let before = State { time: begin.time, controls: begin.controls.clone(), ..state.clone() };
            TimeStep::between(&before, state)
        });
        // a state has the multipliers of rigid bodies behind its displacement, which velocities are as long as
        let instant = at.state.map_or_else(|| Instant::new(at.u, &controls, 1.0), Instant::of);
        let instant = step.as_ref().map_or(instant, |step| instant.in_step(step));
        let found = at.solid.model().contacts().resultant(&instant, &self.of.contact, self.of.direction);
        let gone = || ControlError::Cost { what: format!("{NAME}: no contact \"{}\"", self.of.contact) };
        Ok(Arc::new(EvaluatedCost {
            sum: found.ok_or_else(gone)??,
            weight: self.of.weight,
            unit: if at.solid.mesh().dim() == 2 { "N/m" } else { "N" },
            layout: at.layout.clone(),
            m: at.m.to_vec(),
            before: at.step.map(|begin| begin.m.clone()),
        }))
    }
}

#[derive(Debug)]
struct EvaluatedCost {
    sum: ContactSum,
    weight: f64,
    unit: &'static str,
    layout: Layout,
    m: Vec<f64>,
    /// The control vector at the beginning of the step.
    before: Option<Vec<f64>>,
}

impl CostPoint for EvaluatedCost {
    fn value(&self) -> f64 {
        self.weight * self.sum.value
    }

    fn add_partials(&self, out: &mut Partials) -> Result<(), ControlError> {
        axpy(self.weight, &self.sum.by_u, &mut out.u);
        axpy(self.weight, &self.layout.control_vjp(&self.m, &self.sum.by_others.controls), &mut out.m);
        Ok(())
    }

    fn add_partials_in_motion(&self, out: &mut Partials, more: &mut MotionPartials) -> Result<(), ControlError> {
        self.add_partials(out)?;
        let Some(m) = &self.before else { return Ok(()) };
        let by = &self.sum.by_others;
        let before = self.layout.control_vjp(m, &by.before.controls);
        more.add(self.weight, &MotionPartials { velocity: by.velocity.clone(), before, ..MotionPartials::default() });
        Ok(())
    }

    fn outputs(&self, zero: &Partials) -> Result<Vec<Output>, ControlError> {
        let mut partials = zero.clone();
        axpy(1.0, &self.sum.by_u, &mut partials.u);
        axpy(1.0, &self.layout.control_vjp(&self.m, &self.sum.by_others.controls), &mut partials.m);
        Ok(vec![Output::watched("", self.sum.value, self.unit, partials)])
    }

    fn figures(&self) -> Result<Vec<Figure>, ControlError> {
        Ok(vec![Figure { kind: FigureKind::Other("force_along"), value: self.sum.value, unit: "N" }])
    }
}
