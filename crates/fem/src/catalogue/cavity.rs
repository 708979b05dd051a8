//! A cavity in case files.

use super::form::Form;
use super::key::{Key, KeyKind};
use nastic_energy::Slot;
use nastic_forces::cavity::{Cavity, PRESSURE, VOLUME};

/// How it stands in case files.
pub(super) const FORM: Form = Form {
    about: "A cavity behind a closed surface of the body, under a pressure or with an added volume.",
    keys: &[
        Key::new(
            "surface",
            "Surface of the mesh that bounds the cavity, or several that do so together.",
            KeyKind::Surface,
        ),
        Key::new(
            "lid",
            "Whether openings of the surface are closed by a lid that loads their rims.",
            KeyKind::Flag,
        )
        .optional(),
        Key::new(
            "open",
            "Whether the surface is open and the supports hold its rim: a membrane or a plate under a follower pressure.",
            KeyKind::Flag,
        )
        .optional(),
        Key::new(
            "filled",
            "Whether the surface is the outside of the body, whose own volume it is, like that of a drop.",
            KeyKind::Flag,
        )
        .optional(),
        Key::new(
            "symmetry",
            "Surfaces in the planes of symmetry on which the surface ends.",
            KeyKind::Surface,
        )
        .optional(),
    ],
    passive: false,
    slots: &[PRESSURE, Slot::scalar(VOLUME.group, "m^d")],
    one_of: true,
    add: |solid, name, values| {
        let mut cavity = Cavity::new(name, values.names.get("surface").cloned().unwrap_or_default());
        cavity.lid = values.flags.contains("lid");
        cavity.open = values.flags.contains("open");
        cavity.filled = values.flags.contains("filled");
        cavity.by_volume = values.slot == Some(VOLUME.group);
        cavity.symmetry = values.names.get("symmetry").cloned().unwrap_or_default();
        solid.cavity(cavity)
    },
};
