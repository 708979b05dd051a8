//! Electric numbers of states, in SI units whatever those of the case.

use crate::lower::CaseMember;
use nastic_fem::{DielectricBody, Inadmissible, Instant};
use nastic_language::quantity::Dimension;

/// What contributions report of a state: its name, that of the number, value. Voltages, charges and capacitances are in V, C and F.
///
/// # Errors
/// A state that a contribution does not admit.
pub fn quantities(member: CaseMember<'_>, at: &Instant) -> Result<Vec<(String, &'static str, f64)>, Inadmissible> {
    let mut all = member.solid().model().quantities(at)?;
    for (_, quantity, value) in &mut all {
        let dimension = match *quantity {
            "voltage" => Dimension::VOLTAGE,
            "charge" => Dimension::CHARGE,
            "capacitance" => Dimension::CAPACITANCE,
            _ => continue,
        };
        *value = member.problem().units().in_si(*value, dimension);
    }
    Ok(all)
}

/// What an array of a field is multiplied by in results: a potential is in V.
#[must_use]
pub fn factor(member: CaseMember<'_>, array: &str) -> f64 {
    match array {
        DielectricBody::POTENTIAL => member.problem().units().in_si(1.0, Dimension::VOLTAGE),
        _ => 1.0,
    }
}
