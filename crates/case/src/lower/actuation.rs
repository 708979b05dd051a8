//! Actuations, and the values of their slots that nobody controls.

use super::context::Context;
use super::design as designs;
use super::field::SamplePoints;
use super::law_inputs::inputs;
use super::named::{attempt, complain_of_law};
use super::strides::Course;
use super::tension::beyond_limit;
use super::{coarse_steps, magnitude, named_groups, pressures, shape};
use crate::warning::{CONVEXITY, UNBALANCED_TURGOR, UNBOUNDED_ENERGY};
use nastic_control::{ControlError, Reduced};
use nastic_energy::catalogue::{ActuationRow, Parameter};
use nastic_energy::{Dielectric, EnergyTerm, MaterialPoint, Turgor};
use nastic_fem::catalogue::FormValues;
use nastic_fem::{AttachedLaw, DielectricBody, FreeShape, Solid};
use nastic_language::expression::{EvaluationError, Formula, dimension_of};
use nastic_language::quantity::Dimension;
use nastic_language::schema::{
    Actuation, Beginning, Case, Fixed, Input, Means, Parameter as Number, Time, VectorField, pulling, vector_at,
};
use nastic_language::syntax::At;
use std::collections::BTreeMap;
use std::sync::Arc;

pub(super) fn add(case: &Case, solid: &mut Solid, context: &mut Context<'_>) {
    for actuation in &case.actuation {
        match &actuation.means {
            Means::Law { .. } => add_law(case, actuation, solid, context),
            Means::Contribution { form, values, .. } => {
                let mut values = values.clone();
                if actuation.kind() == FreeShape::KIND {
                    shape::keep_loaded(case, &mut values);
                }
                if actuation.kind() == DielectricBody::KIND {
                    values.numbers.entry(EPS0).or_insert(context.units.permittivity());
                    check_permittivity(actuation, &values, context);
                    warn_of_field(&actuation.at, context);
                }
                if form.one_of {
                    let Some(slot) = driver(case, actuation, context) else { continue };
                    values.slot = slot;
                }
                attempt(solid, &actuation.at, context, |solid| (form.add)(solid, &actuation.name, &values));
            }
        }
    }
    if context.is_sound() {
        attempt(solid, &At::root().key("electrodes"), context, Solid::close_potential);
    }
}

/// No matter has less than the vacuum.
fn check_permittivity(actuation: &Actuation, values: &FormValues, context: &mut Context<'_>) {
    const RELATIVE: &str = "relative_permittivity";
    if let Some(below) = values.numbers.get(RELATIVE).filter(|relative| **relative < 1.0) {
        let message = format!("it is {below}, below 1, that of the vacuum: a rubber has 2 to 10");
        context.complain(&actuation.at.key(RELATIVE), message);
    }
}

/// An energy that falls without bound as J -> 0.
fn warn_of_field(at: &At, context: &mut Context<'_>) {
    let message = "the energy of a dielectric is not polyconvex and has no lower bound as J -> 0: no theorem gives a minimiser, \
                   and an equilibrium is a local minimum at best, up to the field of pull-in";
    context.warn(&UNBOUNDED_ENERGY, at, message.to_owned());
}

/// The slot that drives an actuation of which one does; none where nothing says so, and no answer after a complaint.
fn driver(case: &Case, actuation: &Actuation, context: &mut Context<'_>) -> Option<Option<&'static str>> {
    let controlled = |name: &str| case.controls.iter().any(|control| control.of == name);
    let slots = actuation.slots().into_iter();
    let drives = slots.filter(|(name, slot)| actuation.fixed.contains_key(slot.key) || controlled(name));
    let keys: Vec<&'static str> = drives.map(|(_, slot)| slot.key).collect();
    if let [first, second, ..] = keys[..] {
        let message = format!("\"{}\" is driven by its {first} and by its {second}: keep one of them", actuation.name);
        context.complain(&actuation.at, message);
        return None;
    }
    Some(keys.first().copied())
}

fn add_law(case: &Case, actuation: &Actuation, solid: &mut Solid, context: &mut Context<'_>) {
    let Means::Law { row, region, parameters, design } = &actuation.means else { return };
    let mesh = solid.mesh().clone();
    let Some(cells) = named_groups::cells(&mesh, region, &actuation.at.key("region"), context) else { return };
    let disc = solid.discretization().clone();
    let points = SamplePoints::of_body(case, &disc, &cells);
    let Some(mut inputs) = inputs(parameters, &actuation.at, &points, context) else { return };
    for (constant, value) in [(MU0, context.units.permeability()), (EPS0, context.units.permittivity())] {
        if takes(row, constant, parameters) && !parameters.contains_key(constant) {
            inputs = inputs.number(constant, value);
        }
    }
    match row.build(&inputs) {
        Ok(law) => {
            let law = with_direction(case, actuation, law);
            let Some(law) = designs::in_front(case, law, design, &points, context) else { return };
            attempt(solid, &actuation.at, context, |solid| solid.actuate(region, &actuation.name, law));
        }
        Err(error) => complain_of_law(&actuation.at, &error, context),
    }
    if row.name == Turgor::NAME && mesh.dim() == 3 && !only_deflates(case, actuation) {
        warn_of_growth(actuation, &cells, solid, context);
    }
    if row.name == Dielectric::NAME {
        warn_of_field(&actuation.at, context);
    }
}

/// The law, or, where its direction is a control, the one with that as slots.
fn with_direction(case: &Case, actuation: &Actuation, law: Arc<dyn EnergyTerm>) -> Arc<dyn EnergyTerm> {
    let is_control = |name: String| case.controls.iter().any(|control| control.of == name);
    let turns = actuation.direction().is_some_and(is_control);
    turns.then(|| law.with_direction_slots()).flatten().unwrap_or(law)
}

/// Whether a turgor has no positive pressure, which every law bears: that of a gel that dries.
fn only_deflates(case: &Case, actuation: &Actuation) -> bool {
    let negative = |value: Option<f64>| value.is_some_and(|pressure| pressure <= 0.0);
    let fixed = actuation.fixed.values().any(|value| matches!(value, Fixed::Scalar(own) if negative(own.constant())));
    let control = case.controls.iter().find(|control| control.of == actuation.name);
    let upper = control.and_then(|control| control.upper.as_ref()?.scalar()?.constant());
    fixed || negative(upper)
}

/// Warns of a turgor that outweighs the growth of the passive energy: `-m J` against exponents of `J` up to 1, where `J^(2/3)` is all that
/// `|F|^2` gives. In plane strain `|F|^2` bounds `J` itself.
fn warn_of_growth(actuation: &Actuation, cells: &[u32], solid: &Solid, context: &mut Context<'_>) {
    let points = solid.discretization().points_of_cells();
    let unbalanced = |&&cell: &&u32| {
        let at = MaterialPoint { cell: cell as usize, point: points[cell as usize].0 };
        let laws = solid.body().materials_of(at.cell).map(|law| law.existence(at));
        let stated = laws.reduce(|sum, next| Some(sum?.and(next?))).flatten();
        stated.is_some_and(|stated| !stated.growth.balances_pressure())
    };
    let count = cells.iter().filter(unbalanced).count();
    if count > 0 {
        let message = format!(
            "the law of {count} of its cells grows too slowly with the volume: with any positive pressure the energy has no lower bound, and \
             an equilibrium, if one is found, is a local minimum at best"
        );
        context.warn(&UNBALANCED_TURGOR, &actuation.at, message);
    }
}

/// Whether the body has an actuation; one that could not be built has been complained about.
pub(super) fn is_built(name: &str, reduced: &Reduced) -> bool {
    reduced.solid().model().controllable().iter().any(|has| has.name == name)
}

/// The constants with a unit: in the case's system unless given.
const MU0: &str = "mu0";
const EPS0: &str = "eps0";

/// Whether the row's set of parameters that is given has this one.
fn takes(row: &ActuationRow, constant: &str, given: &BTreeMap<&'static str, Input>) -> bool {
    let meant = |form: &&&[Parameter]| given.keys().all(|key| form.iter().any(|p| p.name == *key));
    row.forms.iter().filter(meant).any(|form| form.iter().any(|p| p.name == constant))
}

/// Sets the fixed values; `None` after a complaint that leaves no problem to go on with.
pub(super) fn fix(case: &Case, mut reduced: Reduced, context: &mut Context<'_>) -> Option<Reduced> {
    for actuation in case.actuation.iter().filter(|actuation| is_built(&actuation.name, &reduced)).collect::<Vec<_>>() {
        // a table that could not be read was complained about
        for (key, value) in actuation.fixed.iter().filter(|(_, value)| !matches!(value, Fixed::Table(_))) {
            if actuation.kind() == FreeShape::KIND {
                let message =
                    format!("a shape is what a control says: give {{ \"of\": \"{}\", \"start\": .. }}", actuation.name);
                context.complain(&actuation.at.key(key), message);
            } else if let Some(control) = case.controls.iter().find(|control| controls(&control.of, actuation, key)) {
                let message = format!("{} controls this: remove the fixed value, or the control", control.at);
                context.complain(&actuation.at.key(key), message);
            } else {
                reduced = fix_slot(case, actuation, key, value, reduced, context)?;
            }
        }
        check_growth(actuation, &reduced, context)?;
    }
    Some(reduced)
}

/// Refuses fixed values that together leave nothing of a body that grows by them.
fn check_growth(actuation: &Actuation, reduced: &Reduced, context: &mut Context<'_>) -> Option<()> {
    let body = reduced.solid().body();
    // a shape has no fixed values, and its start is looked at as a whole
    let grows = |own: &AttachedLaw| own.law.strain_map().is_some() && !own.is_shape();
    let k = body.actuations().iter().position(|own| own.name == actuation.name && grows(own));
    let refused = k.and_then(|k| {
        let (values, width) = (reduced.layout().fixed().values(k), reduced.layout().fixed().slots(k));
        body.refused_growth(k, |at, slot, _| values[at.point * width + slot])
    });
    let Some(why) = refused else { return Some(()) };
    let at = actuation.fixed.keys().next().map_or(actuation.at.clone(), |key| actuation.at.key(key));
    context.complain(&at, why);
    None
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
    let controllable = reduced.solid().model().controllable();
    let index = controllable.iter().position(|a| a.name == actuation.name)?;
    let first = controllable[index].slots.iter().position(|slot| slot.group == key)?;
    let only_pulls = controllable[index].slots[first].not_negative;
    let Some(cells) = controllable[index].cells else {
        if let Some(time) = &case.time
            && controllable[index].holds
        {
            check_rest(time, value, &at, context)?;
        }
        return fix_number(&actuation.name, &at, (key, only_pulls), value, (index, first), reduced, context);
    };
    let points = SamplePoints::of_body(case, &disc, cells);
    let first_values = columns(value, &points, &at, context)?;
    if let Some(dimension) = dimension_of(controllable[index].slots[first].unit) {
        let largest = longest(&first_values);
        magnitude::check_field(dimension, key, largest, "it reaches", &at, context);
        if dimension == Dimension::PRESSURE && !uses_time(value) {
            pressures::check_given(largest, reduced.solid(), &at, context);
        }
    }
    if let (Some(limit), [values]) = (reduced.solid().body().fiber_limit(index), first_values.as_slice()) {
        let most = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        if most > limit {
            context.warn(&CONVEXITY, &at, beyond_limit(most, limit, context.units));
        }
    }
    if only_pulls && first_values.iter().flatten().any(|value| *value < 0.0) {
        context.complain(&at, pulling(key).why);
        return None;
    }
    let mut reduced = reduced;
    for (component, values) in first_values.iter().enumerate() {
        let fixed = reduced.fix(index, first + component, values);
        reduced = context.take(&at, fixed)?;
    }
    if !uses_time(value) {
        return Some(reduced);
    }
    fix_in_time(value, &at, (index, first, only_pulls.then_some(key)), reduced, points.places(), context)
}

/// The length of the longest vector of some components by point.
fn longest(components: &[Vec<f64>]) -> f64 {
    let points = components.first().map_or(0, Vec::len);
    let square = |q: usize| components.iter().filter_map(|values| values.get(q)).map(|x| x * x).sum::<f64>();
    (0..points).map(square).fold(0.0, f64::max).sqrt()
}

/// The values at the points, component by component.
fn columns(value: &Fixed, points: &SamplePoints<'_>, at: &At, context: &mut Context<'_>) -> Option<Vec<Vec<f64>>> {
    Some(match value {
        Fixed::Scalar(value) => vec![points.scalars(value, at, context)?],
        Fixed::Vector(value) => {
            let vectors = points.vectors(value, at, context)?;
            (0..3).map(|k| vectors.iter().map(|v| v[k]).collect()).collect()
        }
        // one that could not be read was complained about
        Fixed::Table(_) => return None,
    })
}

pub(super) fn uses_time(value: &Fixed) -> bool {
    match value {
        Fixed::Scalar(Number::Formula(formula)) => formula.uses_time(),
        Fixed::Vector(VectorField::Formulas(entries)) => entries.iter().any(Formula::uses_time),
        _ => false,
    }
}

/// Lets the slots from `first` on follow a value that changes in time, at the places of the points.
pub(super) fn fix_in_time(
    value: &Fixed,
    at: &At,
    (index, first, only_pulls): (usize, usize, Option<&str>),
    mut reduced: Reduced,
    places: Vec<[f64; 3]>,
    context: &mut Context<'_>,
) -> Option<Reduced> {
    let formulas: Vec<Formula> = match value {
        Fixed::Scalar(Number::Formula(formula)) => vec![formula.clone()],
        Fixed::Vector(VectorField::Formulas(entries)) => {
            (0..3).map(|k| entries.get(k).cloned().unwrap_or_else(|| Formula::number(0.0))).collect()
        }
        _ => return None,
    };
    let instants = reduced.timeline()?.instants().to_vec();
    let places = Arc::new(places);
    let limit = reduced.solid().body().fiber_limit(index);
    if reduced.solid().model().controllable()[index].slots[first].group == "translation"
        && !at.as_str().starts_with("obstacles/")
    {
        let moved: Result<Vec<[f64; 3]>, _> = instants.iter().map(|t| vector_at_time(&formulas, *t)).collect();
        let moved = context.take(at, moved)?;
        Course { mesh: reduced.solid().mesh(), at, context }.check(&instants, &moved, None);
    }
    for (component, formula) in formulas.into_iter().enumerate() {
        let places = places.clone();
        coarse_steps::check(&instants, &formula, &places, at, context);
        let values = move |t: f64| {
            let formula = formula.at_time(t);
            places.iter().map(|place| formula.at(*place)).collect::<Result<Vec<f64>, _>>()
        };
        let each = instants.iter().map(|t| values(*t)).collect::<Result<Vec<_>, _>>();
        let each = context.take(at, each)?;
        let slot = &reduced.solid().model().controllable()[index].slots[first];
        if let Some(dimension) = dimension_of(slot.unit) {
            magnitude::check_field_in_time((dimension, slot.group), &each, at, context);
            if dimension == Dimension::PRESSURE {
                let largest = each.iter().flatten().map(|value| value.abs()).fold(0.0, f64::max);
                pressures::check_given(largest, reduced.solid(), at, context);
            }
        }
        let most = |values: &[f64]| values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let all = each.iter().map(|values| most(values)).fold(f64::NEG_INFINITY, f64::max);
        // that at t = 0 was looked at already
        if let Some(limit) = limit.filter(|limit| all > *limit && most(&each[0]) <= *limit) {
            context.warn(&CONVEXITY, at, beyond_limit(all, limit, context.units));
        }
        let body = reduced.solid().body();
        let of_growth = |at: &Vec<f64>| {
            body.refused_growth(index, |place, slot, rest| if slot == first { at[place.point] } else { rest })
        };
        if let Some(why) = each.iter().find_map(of_growth) {
            context.complain(at, why);
            return None;
        }
        if let Some(key) = only_pulls
            && each.iter().flatten().any(|value| *value < 0.0)
        {
            context.complain(at, pulling(key).why);
            return None;
        }
        let values = move |t: f64| values(t).map_err(|error| ControlError::Cost { what: error.to_string() });
        let fixed = reduced.fix_in_time(index, first + component, values);
        reduced = context.take(at, fixed)?;
    }
    Some(reduced)
}

/// Three components at an instant, of what does not vary in space.
pub(super) fn vector_at_time(formulas: &[Formula], t: f64) -> Result<[f64; 3], EvaluationError> {
    let now: Vec<Formula> = formulas.iter().map(|formula| formula.at_time(t)).collect();
    vector_at(&now, [0.0; 3])
}

/// The fixed value of a contribution as a whole: one number, or one vector.
pub(super) fn fix_number(
    name: &str,
    at: &At,
    (key, only_pulls): (&str, bool),
    value: &Fixed,
    (index, slot): (usize, usize),
    reduced: Reduced,
    context: &mut Context<'_>,
) -> Option<Reduced> {
    let Some(constants) = everywhere(value) else {
        let what = if matches!(value, Fixed::Scalar(_)) { "a number" } else { "numbers" };
        context.complain(at, format!("\"{name}\" has one {key}: give {what}, not a field"));
        return None;
    };
    let unit = reduced.solid().model().controllable()[index].slots[slot].unit;
    if let Fixed::Scalar(Number::Formula(formula)) = value
        && let Some(Err(why)) = dimension_of(unit).map(|dimension| formula.check(dimension))
    {
        context.complain(at, why);
        return None;
    }
    if only_pulls && constants.iter().any(|constant| *constant < 0.0) {
        context.complain(at, pulling(key).why);
        return None;
    }
    if dimension_of(unit) == Some(Dimension::PRESSURE) && !uses_time(value) {
        let largest = constants.iter().map(|value| value.abs()).fold(0.0, f64::max);
        pressures::check_given(largest, reduced.solid(), at, context);
    }
    let reduced = constants.iter().enumerate().try_fold(reduced, |reduced, (component, constant)| {
        let fixed = reduced.fix(index, slot + component, &[*constant]);
        context.take(at, fixed)
    })?;
    if !uses_time(value) {
        return Some(reduced);
    }
    fix_in_time(value, at, (index, slot, only_pulls.then_some(key)), reduced, vec![[0.0; 3]], context)
}

/// Refuses a surface that is elsewhere at t = 0 than on a body at rest.
fn check_rest(time: &Time, value: &Fixed, at: &At, context: &mut Context<'_>) -> Option<()> {
    let away = everywhere(value).is_some_and(|first| first.iter().any(|component| *component != 0.0));
    if time.start != Beginning::Rest || !away {
        return Some(());
    }
    let message = "is not zero at t = 0, where a body that begins at rest is undeformed: give a formula that is, or begin at the equilibrium, \
                   \"start\" in \"time\"";
    context.complain(at, message);
    None
}

/// The value of a contribution as a whole, one number or one vector, at the formula's instant; none of a field.
fn everywhere(value: &Fixed) -> Option<Vec<f64>> {
    match value {
        Fixed::Scalar(Number::Formula(formula)) if !formula.varies_in_space() => {
            formula.at([0.0; 3]).ok().map(|value| vec![value])
        }
        Fixed::Vector(VectorField::Formulas(entries)) if !entries.iter().any(Formula::varies_in_space) => {
            vector_at(entries, [0.0; 3]).ok().map(Vec::from)
        }
        _ => None,
    }
}
