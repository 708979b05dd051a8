//! Pressures, tensions and loads far beyond the stiffness of the body: mostly a unit is wrong.

use super::context::Context;
use super::elements::Elastic;
use crate::lower::control_field::{Admitted, ControlField};
use crate::warning::BOUNDS;
use nastic_fem::Solid;
use nastic_language::number::short;
use nastic_language::quantity::{Dimension, Units};
use nastic_language::schema::{Case, Contact};
use nastic_language::syntax::At;

/// What exceeds Young's modulus of the stiffest material this many times was hardly meant.
const STIFF: f64 = 10.0;
/// A ramp that leaves the bounds of its control by this many times their range was hardly meant.
const BEYOND_BOUNDS: f64 = 2.0;

/// How a pressure compares with the stiffest material, where it is far beyond: `100 times Young's modulus of the stiffest material (1e5 Pa): ..`.
fn far_beyond(pressure: f64, solid: &Solid, units: Units) -> Option<String> {
    let unit = units.label(Dimension::PRESSURE);
    let stiffest = stiffest(solid).filter(|young| *young > 0.0 && pressure.is_finite())?;
    let ratio = pressure.abs() / stiffest;
    (ratio > STIFF).then(|| {
        format!(
            "{ratio:.0} times Young's modulus of the stiffest material ({stiffest:.3e} {unit}): is the unit right? Solves may fail \
             on the way there"
        )
    })
}

/// Young's modulus of the stiffest material; `None` where a law does not give its moduli, or has fibres, along which it is much stiffer.
fn stiffest(solid: &Solid) -> Option<f64> {
    extreme(solid, f64::max)
}

/// The same of the softest.
pub(super) fn softest(solid: &Solid) -> Option<f64> {
    extreme(solid, f64::min)
}

fn extreme(solid: &Solid, of: impl Fn(f64, f64) -> f64) -> Option<f64> {
    let points = solid.discretization().points_of_cells();
    let young =
        |(cell, (point, _)): (usize, &(usize, usize))| Elastic::isotropic(solid, cell, *point).map(Elastic::young);
    let mut all = points.iter().enumerate().map(young);
    let first = all.next()??;
    all.try_fold(first, |found, young| Some(of(found, young?)))
}

/// Bounds of tensions and pressures.
pub(super) fn check_bounds(case: &Case, controls: &[ControlField], solid: &Solid, context: &mut Context<'_>) {
    let unit = context.units.label(Dimension::PRESSURE);
    for field in controls.iter().filter(|field| field.unit == unit && !is_stiffness(case, field)) {
        let Admitted::Between { lower, upper } = field.admitted else { continue };
        let most = [lower, upper].into_iter().map(f64::abs).filter(|bound| bound.is_finite()).fold(0.0, f64::max);
        if let Some(beyond) = far_beyond(most, solid, context.units) {
            context.warn(&BOUNDS, &field.at, format!("the bounds reach {most:.3e} {unit}, {beyond}"));
        }
    }
}

/// Whether it is a number of a material, or the stiffness of a contact, which is a multiple of the body's.
fn is_stiffness(case: &Case, field: &ControlField) -> bool {
    let of_it = |of: &String| {
        case.contact.iter().flat_map(Contact::slots).any(|(name, _)| name == *of)
            || case.materials.iter().any(|material| material.number_of(of).is_some())
    };
    let own = case.load_cases.iter().flat_map(|block| &block.controls);
    case.controls.iter().chain(own).any(|control| control.at == field.at && of_it(&control.of))
}

/// A value that is given: of a slot in units of pressure, or a traction.
pub(super) fn check_given(largest: f64, solid: &Solid, at: &At, context: &mut Context<'_>) {
    if let Some(beyond) = far_beyond(largest, solid, context.units) {
        let unit = context.units.label(Dimension::PRESSURE);
        context.warn(&BOUNDS, at, format!("it reaches {} {unit}, {beyond}", short(largest)));
    }
}

/// A force per volume: over the body's size it is a pressure.
pub(super) fn check_body_force(largest: f64, solid: &Solid, at: &At, context: &mut Context<'_>) {
    if let Some(beyond) = far_beyond(largest * solid.mesh().diagonal(), solid, context.units) {
        context.warn(&BOUNDS, at, format!("over the size of the body this force is {beyond}"));
    }
}

/// What is wrong with an end of a ramp of a control: far outside of its bounds, or far beyond the material.
pub fn doubt_of_ramp(case: &Case, field: &ControlField, end: f64, solid: &Solid) -> Option<String> {
    let units = case.units;
    let (unit, to) = (&field.unit, format!("the ramp goes to {} {}", short(end), field.unit));
    if let Admitted::Between { lower, upper } = field.admitted
        && let Some(range) = field.admitted.range()
        && (end > upper + BEYOND_BOUNDS * range || end < lower - BEYOND_BOUNDS * range)
    {
        let bounds = format!("{} to {} {unit}", short(lower), short(upper));
        return Some(format!(
            "{to}, far outside of what the control may be, {bounds}: is the unit right? The ramp's ends are in the case's units where they bear none"
        ));
    }
    let is_pressure = *unit == units.label(Dimension::PRESSURE) && !is_stiffness(case, field);
    let beyond = far_beyond(end, solid, units).filter(|_| is_pressure)?;
    Some(format!("{to}, {beyond}"))
}
