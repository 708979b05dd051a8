//! Materials that a motion compresses beyond what any bears.

use crate::lower::CaseMember;
use crate::warning::{EXTREME_DEFORMATION, Warning};
use nastic_language::number::short;

/// Below this J a material is compressed to a fifth of its volume.
const COMPRESSED: f64 = 0.2;

/// Warns of the smallest J of a state, with the instant of one in a motion; it is said once, of all instants together.
pub fn compression(member: CaseMember<'_>, min_j: f64, time: Option<f64>) -> Option<Warning> {
    let unit = member.problem().units().time().symbol;
    let of = time.map_or_else(
        || "the smallest J is".to_owned(),
        |time| format!("the smallest J of the motion, at t = {} {unit}, is", short(time)),
    );
    let message = format!("{of} {min_j:.3}: the material is compressed to this share of its volume");
    (min_j > 0.0 && min_j < COMPRESSED).then(|| Warning::new(&EXTREME_DEFORMATION, message).of(member.name()))
}
