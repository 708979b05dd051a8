//! [`ContactSlip`]: how much a contact slips, beside its slip speed.

use super::contact_load::contact_of;
use super::{Cost, CostContext, CostForm, CostPoint, IntoCost, Key, KeyKind, MotionPartials, Partials, check_weight};
use nastic_fem::{ContactSum, Controls, Instant, Solid, State, TimeStep};
use nastic_fields::{ControlError, Layout};
use nastic_numeric::vector::axpy;
use std::sync::Arc;

/// How fast a contact with friction slides at the end of a step, as a share of its slip speed e: a power mean over its samples s of area w_s, pressure p_s and
/// velocity of sliding v_s, weighted by the pressures,
///
/// ```text
/// j = weight (sum_s w_s p_s (|v_s|/e)^2q / sum_s w_s p_s)^(1/2q)
/// ```
///
/// zero where nothing touches. What sticks creeps at `e (1 - sqrt(1 - r))`, r the share of the friction cone that it takes, so that a bound of `1 - sqrt(1 - r)`
/// leaves a margin of `1 - r` to slipping, and 1 means that it begins; beyond that j grows with the speed, so that its derivative leads back. The
/// mean is never above the fastest sample. Velocities are those of the time scheme, and of the obstacle over the step.
///
/// Of motions alone. Units: the weight's. First derivatives alone.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactSlip {
    contact: String,
    exponent: u32,
    weight: f64,
}

impl ContactSlip {
    /// Of a contact with friction, by a power mean of exponent 2q.
    pub fn of(contact: &str, q: u32) -> Self {
        ContactSlip { contact: contact.to_owned(), exponent: q, weight: 1.0 }
    }

    /// Factor.
    #[must_use]
    pub fn weight(self, weight: f64) -> Self {
        ContactSlip { weight, ..self }
    }
}

const NAME: &str = "contact_slip";
/// Largest exponent q: the power 2q of speeds up to 1e9 times the slip speed is finite.
const MAX_EXPONENT: u32 = 16;

/// How it stands in case files.
pub(super) const FORM: CostForm = CostForm::new(
    NAME,
    "weight times how fast a contact with friction slides, as a share of its slip speed: a power mean over what presses.",
    &[
        Key::CONTACT,
        Key::new(
            "exponent",
            "q of the exponent 2q: the larger, the nearer to the fastest sample.",
            KeyKind::Count { default: Some(4) },
        )
        .optional(),
    ],
    |on| ContactSlip { contact: on.get("contact")?, exponent: on.get("exponent")?, weight: on.weight }.bind(on.solid),
)
.reported_at("contact")
.words(|words| {
    let (contact, exponent) = (words.text("contact"), 2 * u64::from(words.count("exponent")));
    format!("slip of {contact} beside its slip speed, power mean of exponent {exponent}")
});

impl IntoCost for ContactSlip {
    fn bind(self, solid: &Solid) -> Result<Box<dyn Cost>, ControlError> {
        check_weight(NAME, self.weight)?;
        let refuse = |what: String| Err(ControlError::Cost { what: format!("{NAME}: {what}") });
        if contact_of(NAME, solid, &self.contact)?.friction.is_none() {
            let what = format!("the contact \"{}\" has no friction: what slips is not held back", self.contact);
            return refuse(what);
        }
        if !(1..=MAX_EXPONENT).contains(&self.exponent) {
            return refuse(format!("the exponent is {}; it is 1 to {MAX_EXPONENT}", self.exponent));
        }
        Ok(Box::new(OnBody(self)))
    }
}

#[derive(Debug)]
struct OnBody(ContactSlip);

impl OnBody {
    /// `sum_s w_s p_s (|v_s|/e)^2q` and, with q = 0, what that is divided by.
    fn sums(&self, at: &CostContext, state: &State, step: &TimeStep) -> Result<[ContactSum; 2], ControlError> {
        let instant = Instant::of(state).in_step(step);
        let of = &self.0;
        let gone = || ControlError::Cost { what: format!("{NAME}: no contact \"{}\" with friction", of.contact) };
        let sum = |q: u32| at.solid.model().contacts().slipping(&instant, &of.contact, q).ok_or_else(gone);
        Ok([sum(of.exponent)??, sum(0)??])
    }
}

impl Cost for OnBody {
    fn name(&self) -> &str {
        NAME
    }

    fn needs_step(&self) -> bool {
        true
    }

    fn at(&self, at: &CostContext) -> Result<Arc<dyn CostPoint>, ControlError> {
        let (Some(state), Some(begin)) = (at.state, at.step) else {
            return Ok(Arc::new(EvaluatedCost { value: 0.0, parts: None }));
        };
        let before = State { time: begin.time, controls: begin.controls.clone(), ..state.clone() };
        let [slipping, pressing] = self.sums(at, state, &TimeStep::between(&before, state))?;
        if slipping.value <= 0.0 || pressing.value <= 0.0 {
            return Ok(Arc::new(EvaluatedCost { value: 0.0, parts: None }));
        }
        let power = 2.0 * f64::from(self.0.exponent);
        let value = self.0.weight * (slipping.value / pressing.value).powf(1.0 / power);
        let factors = [value / (power * slipping.value), -value / (power * pressing.value)];
        let layout = at.layout.clone();
        let parts = Parts { sums: [slipping, pressing], factors, layout, m: [at.m.to_vec(), begin.m.clone()] };
        Ok(Arc::new(EvaluatedCost { value, parts: Some(parts) }))
    }
}

#[derive(Debug)]
struct EvaluatedCost {
    value: f64,
    /// `None` where nothing slides.
    parts: Option<Parts>,
}

#[derive(Debug)]
struct Parts {
    sums: [ContactSum; 2],
    /// Derivatives of the value by them.
    factors: [f64; 2],
    layout: Layout,
    /// At the end of the step and at its beginning.
    m: [Vec<f64>; 2],
}

impl Parts {
    fn by_controls(&self, m: &[f64], of: impl Fn(&ContactSum) -> &Controls) -> Vec<f64> {
        let mut sum = vec![0.0; self.layout.len()];
        for (slipping, factor) in self.sums.iter().zip(self.factors) {
            axpy(factor, &self.layout.control_vjp(m, of(slipping)), &mut sum);
        }
        sum
    }
}

impl CostPoint for EvaluatedCost {
    fn value(&self) -> f64 {
        self.value
    }

    fn add_partials(&self, out: &mut Partials) -> Result<(), ControlError> {
        let Some(parts) = &self.parts else { return Ok(()) };
        parts.sums.iter().zip(parts.factors).for_each(|(sum, factor)| axpy(factor, &sum.by_u, &mut out.u));
        axpy(1.0, &parts.by_controls(&parts.m[0], |sum| &sum.by_others.controls), &mut out.m);
        Ok(())
    }

    fn add_partials_in_motion(&self, out: &mut Partials, more: &mut MotionPartials) -> Result<(), ControlError> {
        self.add_partials(out)?;
        let Some(parts) = &self.parts else { return Ok(()) };
        let before = parts.by_controls(&parts.m[1], |sum| &sum.by_others.before.controls);
        for (sum, factor) in parts.sums.iter().zip(parts.factors) {
            more.add(factor, &MotionPartials { velocity: sum.by_others.velocity.clone(), ..MotionPartials::default() });
        }
        more.add(1.0, &MotionPartials { before, ..MotionPartials::default() });
        Ok(())
    }
}
