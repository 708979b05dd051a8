//! What the contacts of an equilibrium carry, and what deserves attention in them.

use crate::lower::CaseMember;
use crate::warning::{BETWEEN_NODES, FEW_FACETS, PENETRATED, THICK_LAYER, Warning};
use nastic_fem::{Instant, State, Touch, TouchParameters};
use nastic_language::number::{quantity, short, vector};
use nastic_language::quantity::Dimension;
use nastic_language::schema::{Cost, KeyValue};

/// Above this share of the approach the mean gap that remains makes a layer thick.
const THICK: f64 = 0.05;
/// Above this share of the approach, or of the body's diagonal where there is none, what is inside of an obstacle between samples is said.
const BETWEEN: [f64; 2] = [0.1, 0.01];

/// What the contacts of an equilibrium carry.
pub fn of_state(member: CaseMember<'_>, state: &State) -> Vec<(String, Touch)> {
    member.solid().model().contacts().touches(&Instant::of(state))
}

/// What is said of a contact that is pressed harder than its stiffness bears, at a place or an instant.
pub fn penetrated(member: CaseMember<'_>, name: &str, depth: f64, at: &str) -> Warning {
    let depth = quantity(depth, Dimension::LENGTH, member.problem().units());
    let inside = match member.case().contact.iter().any(|contact| contact.with.is_some() && contact.name() == name) {
        true => format!("the surfaces are {depth} nearer to each other than twice the thickness"),
        false => format!("the body is {depth} inside the obstacle"),
    };
    Warning::new(&PENETRATED, format!("contact \"{name}\": {inside} {at}"))
}

/// What the model gives of a contact, by its name.
pub fn parameters(member: CaseMember<'_>, name: &str) -> Option<TouchParameters> {
    let all = member.solid().model().contacts().parameters();
    all.into_iter().find(|(known, _)| known == name).map(|(_, parameters)| parameters)
}

/// Whether a body is deep inside of an obstacle between its samples: deeper than the layer is thick, and than a share of the approach, or of the body's diagonal
/// where there is none.
pub fn is_between(member: CaseMember<'_>, thickness: f64, [depth, approach]: [f64; 2]) -> bool {
    let [of_approach, of_diagonal] = BETWEEN;
    let least = if approach > 0.0 { of_approach * approach } else { of_diagonal * member.mesh().diagonal() };
    depth > thickness.max(least)
}

/// What is said of that.
pub fn between(member: CaseMember<'_>, name: &str, depth: f64, approach: f64, place: &str) -> Warning {
    let of = |value: f64| quantity(value, Dimension::LENGTH, member.problem().units());
    let mut message =
        format!("contact \"{name}\": between its samples the body is {} inside the obstacle {place}", of(depth));
    if approach > 0.0 {
        let share = short((100.0 * depth / approach).round());
        message += &format!(", {share} % of the {} by which it would overlap the undeformed body", of(approach));
    }
    Warning::new(&BETWEEN_NODES, message)
}

/// Facets of the contact's surface, of a mean size, on which a pressure is one of the mesh.
const FEW: f64 = 2.0;

/// What is said of a contact that touches over so large an area, if its largest pressure is a cost or a constraint.
pub fn few_facets(member: CaseMember<'_>, name: &str, area: f64, at: &str) -> Option<Warning> {
    let case = member.case();
    let bounded = case.constraints.iter().filter_map(|constraint| constraint.cost.as_ref());
    let of_it = |cost: &Cost| match cost {
        Cost::Term(term) => {
            let is_of_it = |value: &KeyValue| matches!(value, KeyValue::Contact(of) if of == name);
            term.form.name == "contact_pressure" && term.values.values().any(is_of_it)
        }
        _ => false,
    };
    if !case.costs.iter().chain(bounded).any(of_it) {
        return None;
    }
    let contact = case.contact.iter().find(|contact| contact.name() == name)?;
    let facets = member.mesh().facets_of(&contact.surface).ok()?;
    let mean = member.mesh().area(&facets) / facets.len() as f64;
    let touched = area / mean;
    (touched > 0.0 && touched < FEW).then(|| {
        let touched = short((10.0 * touched).round() / 10.0);
        Warning::new(
            &FEW_FACETS,
            format!(
                "contact \"{name}\" acts on the area of {touched} facets{at}: its largest pressure is one of the mesh"
            ),
        )
    })
}

/// What deserves attention in the contacts of an equilibrium.
pub fn warnings(member: CaseMember<'_>, state: &State) -> Vec<Warning> {
    let of = |value: f64| quantity(value, Dimension::LENGTH, member.problem().units());
    let mut out = Vec::new();
    for (name, touch) in of_state(member, state) {
        if touch.sunk > 0.0 {
            out.push(penetrated(member, &name, touch.sunk, &format!("at {}", vector(&touch.deepest))));
        }
        out.extend(few_facets(member, &name, touch.area, ""));
        if touch.mean_gap.abs() > THICK * touch.approach && touch.approach > 0.0 {
            let (gap, approach) = (of(touch.mean_gap), of(touch.approach));
            let share = short((100.0 * touch.mean_gap.abs() / touch.approach).round());
            let message = format!(
                "contact \"{name}\": the gap in the layer is {gap} in the mean, {share} % of the {approach} by which the obstacle would \
                 overlap the undeformed body"
            );
            out.push(Warning::new(&THICK_LAYER, message));
        }
        if let (Some((gap, place)), Some(of)) = (touch.between, parameters(member, &name)) {
            let depth = -gap - of.inset;
            if is_between(member, of.thickness, [depth, touch.approach]) {
                out.push(between(member, &name, depth, touch.approach, &format!("at {}", vector(&place))));
            }
        }
    }
    out
}
