//! The names of all that can be controlled.

use crate::error::ControlError;
use nastic_energy::SlotGroup;
use nastic_fem::Solid;

/// Actuation and slots of a control's name.
pub(crate) fn resolve(solid: &Solid, of: &str) -> Result<(usize, SlotGroup), ControlError> {
    let all = groups(solid);
    // The only slot of an actuation may be named as well.
    let is = |name: &str, group: &SlotGroup| {
        name == of || of.strip_prefix(name).and_then(|rest| rest.strip_prefix('.')) == Some(group.name)
    };
    let found = all.iter().find(|(name, _, group)| is(name, group));
    found.map(|&(_, actuation, group)| (actuation, group)).ok_or_else(|| {
        let known = all.iter().map(|(name, ..)| name.as_str()).collect::<Vec<_>>().join(", ");
        ControlError::UnknownControl { name: of.to_owned(), known }
    })
}

/// Name, actuation and slots of all that can be controlled.
pub(crate) fn groups(solid: &Solid) -> Vec<(String, usize, SlotGroup)> {
    let mut all = Vec::new();
    for (k, what) in solid.model().controllable().into_iter().enumerate() {
        let groups = SlotGroup::of(what.slots);
        for group in &groups {
            let several = groups.len() > 1;
            let name = if several { format!("{}.{}", what.name, group.name) } else { what.name.to_owned() };
            all.push((name, k, *group));
        }
    }
    all
}
