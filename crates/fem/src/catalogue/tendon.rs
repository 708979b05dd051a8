//! How tendons stand in case files.

use super::form::{Form, FormValues};
use super::key::{Key, KeyKind};
use crate::solid::Solid;
use nastic_body::error::FemError;
use nastic_forces::tendon::Tendon;
use nastic_forces::tendon::force::Drive;

const POINTS: Key = Key::new(
    "points",
    "Points of the reference body that the tendon passes, in order, straight between them: positions, or names of node sets, whose mean it is.",
    KeyKind::Points,
);
const SPACING: Key = Key::new(
    "spacing",
    "Adds guides on the straight lines between the points, no farther apart than this.",
    KeyKind::Positive { unit: "m" },
)
.optional();
const STIFFNESS: Key =
    Key::new("stiffness", "Force per elongation of the whole cable.", KeyKind::Positive { unit: "N/m" });

/// Under a given tension, or drawn in by a given length without stretching.
pub(super) const INEXTENSIBLE: Form = Form {
    about: "A tendon through points of the body, under a given tension, or drawn in by a given length without stretching; slack where it would have to push.",
    keys: &[POINTS, SPACING],
    slots: &Drive::EITHER,
    passive: false,
    one_of: true,
    add,
};

/// Elastic, drawn in by a given length.
pub(super) const ELASTIC: Form = Form {
    about: "An elastic tendon through points of the body, drawn in by a given length; slack where it would have to push.",
    keys: &[POINTS, SPACING, STIFFNESS],
    slots: &Drive::PULL,
    passive: true,
    one_of: false,
    add,
};

fn add(solid: Solid, name: &str, values: &FormValues) -> Result<Solid, FemError> {
    let mut tendon = Tendon::through(name, values.points.get("points").cloned().unwrap_or_default());
    tendon.spacing = values.numbers.get("spacing").copied();
    tendon.stiffness = values.numbers.get("stiffness").copied();
    tendon.inextensible = tendon.stiffness.is_none() && values.slot == Some(Drive::PULL[0].group);
    solid.tendon(tendon)
}
