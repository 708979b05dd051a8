//! A moving support in case files.

use super::form::Form;
use super::key::{Key, KeyKind};
use nastic_forces::moving_support::MovingSupport;
use nastic_forces::rigid_motion::SLOTS;

/// How it stands in case files.
pub(super) const FORM: Form = Form {
    about: "A surface that is held and moves as a rigid body.",
    keys: &[
        Key::new("surface", "Surface or node set of the mesh, or several.", KeyKind::Surface),
        Key::new(
            "centre",
            "Point of the reference body about which it turns; the mean of its nodes if left out.",
            KeyKind::Point,
        )
        .optional(),
        Key::new(
            "fix",
            "Components that it holds, of x, y and z: along the others the surface slides freely. All if left out.",
            KeyKind::Components,
        )
        .optional(),
    ],
    slots: &SLOTS,
    passive: true,
    one_of: false,
    add: |solid, name, values| {
        let mut motion = MovingSupport::of(name, values.names.get("surface").cloned().unwrap_or_default());
        motion.centre = values.places.get("centre").copied();
        if let Some(components) = values.components.get("fix") {
            motion = motion.components(components);
        }
        solid.motion(motion)
    },
};
