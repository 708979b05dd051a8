//! The names of all that can be controlled.

use crate::error::ControlError;
use nastic_energy::SlotGroup;
use nastic_fem::{Controllable, Solid};

/// The meaning of a control's name: an actuation or contribution and a group of its slots; several where they share the name.
pub(crate) fn resolve(solid: &Solid, of: &str) -> Result<Vec<(usize, SlotGroup)>, ControlError> {
    let all = groups(solid);
    // The only slot of an actuation may be named as well.
    let is = |name: &str, group: &SlotGroup| {
        name == of || of.strip_prefix(name).and_then(|rest| rest.strip_prefix('.')) == Some(group.name)
    };
    let found: Vec<(usize, SlotGroup)> = all
        .iter()
        .filter(|(name, _, group)| is(name, group))
        .map(|&(_, actuation, group)| (actuation, group))
        .collect();
    if !found.is_empty() {
        return Ok(found);
    }
    let mut known: Vec<&str> = all.iter().map(|(name, ..)| name.as_str()).collect();
    known.dedup();
    Err(ControlError::UnknownControl { name: of.to_owned(), known: known.join(", ") })
}

/// Name, actuation and slots of all that can be controlled.
pub(crate) fn groups(solid: &Solid) -> Vec<(String, usize, SlotGroup)> {
    let mut all = Vec::new();
    let free = solid.model().free_shape().map(|(shape, _)| shape.name.as_str());
    for (k, what) in solid.model().controllable().into_iter().enumerate() {
        let groups = SlotGroup::of(what.slots);
        // numbers of the body beside one load do not change its name
        let is_load = |group: &&SlotGroup| !what.slots[group.first].is_design();
        let mut loads = groups.iter().filter(is_load);
        let lone = loads.next().filter(|_| loads.next().is_none()).copied();
        let shared = what.shared.map_or(0, |(_, slots)| groups.iter().filter(|group| group.first < slots).count());
        let count = |group: &SlotGroup| if lone == Some(*group) { 1 } else { groups.len() - shared };
        // what follows a free shape has no name of its own
        let follows =
            |group: &SlotGroup| what.shared.is_some_and(|(owner, slots)| free == Some(owner) && group.first < slots);
        let own = groups.iter().filter(|group| !follows(group));
        all.extend(own.map(|group| (name(&what, group, count(group)), k, *group)));
    }
    all
}

/// The name of one of several groups of slots.
fn name(what: &Controllable<'_>, group: &SlotGroup, groups: usize) -> String {
    match what.shared {
        Some((owner, slots)) if group.first < slots => format!("{owner}.{}", group.name),
        _ if groups > 1 => format!("{}.{}", what.name, group.name),
        _ => what.name.to_owned(),
    }
}
