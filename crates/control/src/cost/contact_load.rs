//! [`ContactLoad`]: how hard a contact presses.

use super::{
    ContactResultant, Cost, CostContext, CostForm, CostPoint, Figure, FigureKind, IntoCost, Key, KeyKind, Output,
    Partials, check_weight,
};
use nastic_fem::{Controls, Instant, Solid, TouchParameters};
use nastic_fields::{ControlError, Layout};
use nastic_numeric::vector::axpy;
use std::cell::Cell;
use std::sync::Arc;

/// The force that a contact presses with, or a smoothed maximum of its pressure:
///
/// ```text
/// j = weight sum_s w_s p_s,        j = weight (1/A sum_s w_s p_s^2q)^(1/2q)
/// ```
///
/// over the samples s of area w_s (A all of the surface) and pressure p_s; the power mean is never above the largest pressure, and between surfaces of bodies
/// goes over the places and pressures of [`Contacts::pressures`](nastic_fem::Contacts::pressures). Depends on the displacement, on the pose of the obstacle and on the stiffness. Units: N (N/m in plane strain), Pa. First derivatives alone.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactLoad {
    contact: String,
    /// q of a smoothed maximum.
    exponent: Option<u32>,
    weight: f64,
}

impl ContactLoad {
    /// The force of a contact.
    pub fn force(contact: &str) -> Self {
        ContactLoad { contact: contact.to_owned(), exponent: None, weight: 1.0 }
    }

    /// The smoothed largest pressure of a contact, by a power mean of exponent 2q.
    pub fn pressure(contact: &str, q: u32) -> Self {
        ContactLoad { exponent: Some(q), ..Self::force(contact) }
    }

    /// Factor.
    #[must_use]
    pub fn weight(self, weight: f64) -> Self {
        ContactLoad { weight, ..self }
    }
}

/// How the force stands in case files.
pub(super) const FORCE: CostForm = CostForm::new(
    "contact_force",
    "weight times the force that a contact presses with: the sum of its pressures times areas; or along a direction.",
    &[
        Key::CONTACT,
        Key::new(
            "direction",
            "Of an obstacle: its force on the body along it, with friction, in the place of the sum of pressures.",
            KeyKind::Direction,
        )
        .optional(),
    ],
    |on| {
        let contact: String = on.get("contact")?;
        match on.given("direction") {
            None => ContactLoad { contact, exponent: None, weight: on.weight }.bind(on.solid),
            Some(direction) => ContactResultant::along(&contact, direction).weight(on.weight).bind(on.solid),
        }
    },
)
.reported_at("contact")
.words(|words| match words.text("direction") {
    "" => format!("force that {} presses with", words.text("contact")),
    along => format!("force of {} on the body along ({along})", words.text("contact")),
});

/// How the smoothed largest pressure stands in case files.
pub(super) const PRESSURE: CostForm = CostForm::new(
    "contact_pressure",
    "weight times a smoothed largest pressure of a contact: the power mean over its surface, never above it.",
    &[
        Key::CONTACT,
        Key::new(
            "exponent",
            "q of the exponent 2q: the larger, the nearer to the largest pressure.",
            KeyKind::Count { default: Some(8) },
        )
        .optional(),
    ],
    |on| {
        let (contact, exponent) = (on.get("contact")?, Some(on.get("exponent")?));
        ContactLoad { contact, exponent, weight: on.weight }.bind(on.solid)
    },
)
.reported_at("contact")
.words(|words| {
    let (contact, exponent) = (words.text("contact"), 2 * u64::from(words.count("exponent")));
    format!("smoothed largest pressure of {contact}, power mean of exponent {exponent}")
});

impl IntoCost for ContactLoad {
    fn bind(self, solid: &Solid) -> Result<Box<dyn Cost>, ControlError> {
        let name = self.exponent.map_or("contact_force", |_| "contact_pressure");
        check_weight(name, self.weight)?;
        let own = contact_of(name, solid, &self.contact)?;
        if self.exponent == Some(0) {
            return Err(ControlError::Cost { what: format!("{name}: the exponent is 0; it is 1 or more") });
        }
        Ok(Box::new(OnBody { area: own.area, of: self, name }))
    }
}

/// What a contact of a name is made of.
///
/// # Errors
/// There is no contact of that name.
pub(super) fn contact_of(cost: &str, solid: &Solid, contact: &str) -> Result<TouchParameters, ControlError> {
    let known = solid.model().contacts().parameters();
    if let Some((_, own)) = known.iter().find(|(own, _)| *own == contact) {
        return Ok(*own);
    }
    let names: Vec<String> = known.iter().map(|(own, _)| format!("\"{own}\"")).collect();
    let there = if names.is_empty() { "there is none".to_owned() } else { names.join(", ") };
    Err(ControlError::Cost { what: format!("{cost}: no contact \"{contact}\"; {there}") })
}

#[derive(Debug)]
struct OnBody {
    of: ContactLoad,
    /// Of the surface.
    area: f64,
    name: &'static str,
}

#[derive(Debug)]
struct EvaluatedCost {
    value: f64,
    /// Largest pressure.
    largest: f64,
    force: f64,
    by_u: Vec<f64>,
    by_controls: Controls,
    factor: f64,
    weight: f64,
    unit: &'static str,
    layout: Layout,
    m: Vec<f64>,
}

impl Cost for OnBody {
    fn name(&self) -> &str {
        self.name
    }

    fn at(&self, at: &CostContext) -> Result<Arc<dyn CostPoint>, ControlError> {
        let controls = match at.state {
            Some(state) => state.controls.as_ref().clone(),
            None => at.layout.to_points(at.m)?,
        };
        let (instant, model) = (Instant::new(at.u, &controls, 1.0), at.solid.model());
        let gone = || ControlError::Cost { what: format!("{}: no contact \"{}\"", self.name, self.of.contact) };
        let (name, most) = (&self.of.contact, Cell::new(0.0_f64));
        let of_force = model.contacts().pressing(&instant, name, &|p| [p, 1.0]).ok_or_else(gone)??;
        let pressures = |by: &dyn Fn(f64) -> [f64; 2]| model.contacts().pressures(&instant, name, by).ok_or_else(gone);
        pressures(&|p| {
            most.set(most.get().max(p));
            [p, 0.0]
        })??;
        let (weight, force, largest) = (self.of.weight, of_force.value, most.get());
        let (found, value, factor) = match self.of.exponent {
            None => (of_force, weight * force, weight),
            Some(q) => {
                let (power, scale) = (2 * q as i32, if largest > 0.0 { largest } else { 1.0 });
                let found = pressures(&|p| {
                    let x = p / scale;
                    [x.powi(power), f64::from(power) * x.powi(power - 1) / scale]
                })??;
                let value = weight * scale * (found.value / self.area).powf(1.0 / f64::from(power));
                let factor = if found.value > 0.0 { value / (f64::from(power) * found.value) } else { 0.0 };
                (found, value, factor)
            }
        };
        let (layout, m) = (at.layout.clone(), at.m.to_vec());
        let (by_u, by_controls) = (found.by_u, found.by_controls);
        let unit = match (self.of.exponent, at.solid.mesh().dim()) {
            (Some(_), _) => "Pa",
            (None, 2) => "N/m",
            (None, _) => "N",
        };
        Ok(Arc::new(EvaluatedCost { value, largest, force, by_u, by_controls, factor, weight, unit, layout, m }))
    }
}

impl CostPoint for EvaluatedCost {
    fn value(&self) -> f64 {
        self.value
    }

    fn add_partials(&self, out: &mut Partials) -> Result<(), ControlError> {
        axpy(self.factor, &self.by_u, &mut out.u);
        axpy(self.factor, &self.layout.control_vjp(&self.m, &self.by_controls), &mut out.m);
        Ok(())
    }

    fn outputs(&self, zero: &Partials) -> Result<Vec<Output>, ControlError> {
        let (mut partials, weight) = (zero.clone(), self.weight);
        axpy(self.factor / weight, &self.by_u, &mut partials.u);
        axpy(self.factor / weight, &self.layout.control_vjp(&self.m, &self.by_controls), &mut partials.m);
        Ok(vec![Output::watched("", self.value / weight, self.unit, partials)])
    }

    fn figures(&self) -> Result<Vec<Figure>, ControlError> {
        let figure = |name, value, unit| Figure { kind: FigureKind::Other(name), value, unit };
        Ok(vec![figure("force", self.force, "N"), figure("largest_pressure", self.largest, "Pa")])
    }
}
