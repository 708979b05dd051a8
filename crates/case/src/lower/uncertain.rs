//! [`Uncertain`]: numbers of materials that are held at their medians, with their slopes by random numbers.

use super::context::Context;
use nastic_control::{Reduced, Space};
use nastic_language::syntax::At;

/// An uncertain number of a material.
#[derive(Debug)]
pub(super) struct Uncertain {
    /// Index of the material.
    pub material: usize,
    /// The number, and as a control would name it.
    pub number: String,
    pub of: String,
    /// Its random parameter.
    pub at: At,
    /// Its path in the case.
    pub path: String,
    pub space: Space,
    pub medians: Vec<f64>,
    /// By random number, by value.
    pub slopes: Vec<Vec<f64>>,
    /// Named parts of a field over several regions, with the places of their values.
    pub parts: Vec<(String, Vec<usize>)>,
}

/// Makes the uncertain numbers of a member such.
pub(super) fn add(uncertain: &[Uncertain], mut reduced: Reduced, context: &mut Context<'_>) -> Option<Reduced> {
    for own in uncertain {
        reduced = context.take(&own.at, reduced.uncertain(&own.of, own.space, &own.medians))?;
    }
    Some(reduced)
}
