//! Bodies that what acts on them hardly moves.

use crate::lower::CaseMember;
use crate::warning::{STILL, Warning};
use nastic_fem::State;
use nastic_language::number::short;
use nastic_numeric::vector::norm;

/// Share of the body's diagonal below which nobody sees a displacement.
const SEEN: f64 = 1e-5;

/// Warns of states in which something acts and no point moves visibly; a body at rest is no such one, nor a rigid body that already lies where it comes to.
pub fn stillness<'s>(member: CaseMember<'_>, states: impl IntoIterator<Item = &'s State>) -> Option<Warning> {
    let (mesh, model) = (member.mesh(), member.solid().model());
    let farthest = |state: &State| model.displacement(&state.u).chunks_exact(mesh.dim()).map(norm).fold(0.0, f64::max);
    let farthest = states.into_iter().map(farthest).fold(0.0, f64::max);
    let share = farthest / mesh.diagonal();
    let unit = member.problem().units().length().symbol;
    let when = if member.problem().is_motion() { "at any instant that is written" } else { "at the start controls" };
    let message =
        format!("{when} no point moves by more than {} {unit}, {} of the body's size", short(farthest), short(share));
    let case = &member.problem().case;
    let lies = !case.contact.is_empty() && case.materials.iter().all(|material| material.rigid);
    (share > 0.0 && share < SEEN && !lies).then(|| Warning::new(&STILL, message).of(member.name()))
}
