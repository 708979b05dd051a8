//! What the contacts of an equilibrium carry, and what deserves attention in them.

use crate::lower::CaseMember;
use crate::warning::{PENETRATED, THICK_LAYER, Warning};
use nastic_fem::{Instant, State, Touch};
use nastic_language::number::{quantity, short, vector};
use nastic_language::quantity::Dimension;

/// Above this share of the approach the mean gap that remains makes a layer thick.
const THICK: f64 = 0.05;

/// What the contacts of an equilibrium carry.
pub fn of_state(member: CaseMember<'_>, state: &State) -> Vec<(String, Touch)> {
    member.solid().model().touches(&Instant::of(state))
}

/// What is said of a contact that is pressed harder than its stiffness bears.
pub fn inside(member: CaseMember<'_>, name: &str, depth: &str) -> String {
    match member.case().contact.iter().any(|contact| contact.with.is_some() && contact.name() == name) {
        true => format!("the surfaces are {depth} nearer to each other than twice the thickness"),
        false => format!("the body is {depth} inside the obstacle"),
    }
}

/// What deserves attention in the contacts of an equilibrium.
pub fn warnings(member: CaseMember<'_>, state: &State) -> Vec<Warning> {
    let of = |value: f64| quantity(value, Dimension::LENGTH, member.problem().units());
    let mut out = Vec::new();
    for (name, touch) in of_state(member, state) {
        if touch.sunk > 0.0 {
            let (depth, place) = (of(touch.sunk), vector(&touch.deepest));
            let message = format!("contact \"{name}\": {} at {place}", inside(member, &name, &depth));
            out.push(Warning::new(&PENETRATED, message));
        }
        if touch.mean_gap.abs() > THICK * touch.approach && touch.approach > 0.0 {
            let (gap, approach) = (of(touch.mean_gap), of(touch.approach));
            let share = short((100.0 * touch.mean_gap.abs() / touch.approach).round());
            let message = format!(
                "contact \"{name}\": the gap in the layer is {gap} in the mean, {share} % of the {approach} by which the obstacle would \
                 overlap the undeformed body"
            );
            out.push(Warning::new(&THICK_LAYER, message));
        }
    }
    out
}
