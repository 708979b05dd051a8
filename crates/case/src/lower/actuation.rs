//! Actuations, and the values of their slots that nobody controls.

use super::context::Context;
use super::field::SamplePoints;
use super::material::inputs;
use super::named::{attempt, key_of};
use crate::quantity::{Dimension, Units};
use crate::schema::{Actuation, Case, Fixed};
use nastic_control::Reduced;
use nastic_fem::Solid;

pub(super) fn add(case: &Case, solid: &mut Solid, context: &mut Context<'_>) {
    for actuation in &case.actuation {
        let mesh = solid.mesh().clone();
        let Some(cells) = context.take(&actuation.at.key("region"), mesh.region(&actuation.region)) else { continue };
        let disc = solid.discretization().clone();
        let points = SamplePoints::of_body(case, &disc, cells);
        let Some(mut inputs) = inputs(&actuation.parameters, &actuation.at, &points, context) else { continue };
        if actuation.kind.parameters().iter().any(|p| p.name == MU0) && !actuation.parameters.contains_key(MU0) {
            inputs = inputs.number(MU0, context.units.permeability());
        }
        match actuation.kind.build(&inputs) {
            Ok(law) => {
                attempt(solid, &actuation.at, context, |solid| solid.actuate(&actuation.region, &actuation.name, law))
            }
            Err(error) => context.complain(&key_of(&actuation.at, &error), error),
        }
    }
}

/// The one constant with a unit: in the case's system unless given.
const MU0: &str = "mu0";

/// Sets the fixed values; `None` after a complaint that leaves no problem to go on with.
pub(super) fn fix(case: &Case, mut reduced: Reduced, context: &mut Context<'_>) -> Option<Reduced> {
    for actuation in &case.actuation {
        for (key, value) in &actuation.fixed {
            if let Some(control) = case.controls.iter().find(|control| controls(&control.of, actuation, key)) {
                let message = format!("{} controls this: remove the fixed value, or the control", control.at);
                context.complain(&actuation.at.key(key), message);
            } else {
                reduced = fix_slot(case, actuation, key, value, reduced, context)?;
            }
        }
    }
    Some(reduced)
}

/// Whether a control of this name sets the slot.
fn controls(of: &str, actuation: &Actuation, key: &str) -> bool {
    actuation.slots().iter().any(|(name, slot)| name == of && slot.key == key)
}

fn fix_slot(
    case: &Case,
    actuation: &Actuation,
    key: &str,
    value: &Fixed,
    reduced: Reduced,
    context: &mut Context<'_>,
) -> Option<Reduced> {
    let at = actuation.at.key(key);
    let disc = reduced.solid().discretization().clone();
    let attached = reduced.solid().body().actuations();
    let index = attached.iter().position(|a| a.name == actuation.name)?;
    let first = attached[index].law.slots().iter().position(|slot| slot.group == key)?;
    let points = SamplePoints::of_body(case, &disc, &attached[index].cells);
    let columns: Vec<Vec<f64>> = match value {
        Fixed::Scalar(value) => vec![points.scalars(value, &at, context)?],
        Fixed::Vector(value) => {
            let vectors = points.vectors(value, &at, context)?;
            (0..3).map(|k| vectors.iter().map(|v| v[k]).collect()).collect()
        }
    };
    if let (Some(limit), [values]) = (reduced.solid().body().fiber_limit(index), columns.as_slice()) {
        let most = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        if most > limit {
            context.warn(&at, beyond_limit(most, limit, context.units));
        }
    }
    let mut reduced = reduced;
    for (component, values) in columns.iter().enumerate() {
        let fixed = reduced.fix(index, first + component, values);
        reduced = context.take(&at, fixed)?;
    }
    Some(reduced)
}

/// What to say of a tension above the law's convexity bound.
pub(super) fn beyond_limit(tension: f64, limit: f64, units: Units) -> String {
    let unit = units.label(Dimension::PRESSURE);
    format!(
        "a tension of {tension} {unit} exceeds {limit} {unit}, up to which the law stays polyconvex: beyond it the \
         existence theorem does not hold and the body may have no equilibrium"
    )
}
