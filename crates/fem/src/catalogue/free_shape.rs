//! A free shape in case files.

use super::form::Form;
use super::key::{Key, KeyKind};
use nastic_body::body_energy::free_shape::FreeShape;
use nastic_energy::{ShapeModes, Slot};
use nastic_mesh::GroupNames;

/// How it stands in case files.
pub(super) const FORM: Form = Form {
    about: "The shape of the body itself by the nodes of its skin: they move along the outward normal of the drawn body, those inside follow.",
    keys: &[
        Key::REGION.about("Region whose nodes may move, or several; those of other cells stay."),
        Key::new("surface", "Surface of the mesh that moves, or several.", KeyKind::Surface),
        Key::new("keep", "Surfaces that stay as they are drawn; those of tractions do anyway.", KeyKind::Surface)
            .optional(),
        Key::new(
            "filter",
            "Length over which the displacement of the skin is smoothed: not shorter than the distance of its nodes.",
            KeyKind::Positive { unit: "m" },
        ),
        Key::new(
            "least_volume",
            "The share of every volume that is left, det G, above which the shape must stay.",
            KeyKind::Number { unit: "1", default: Some(ShapeModes::LEAST_VOLUME) },
        )
        .optional(),
    ],
    slots: &[Slot::design("displacement", "m", 0.0)],
    passive: false,
    one_of: false,
    add: |solid, name, values| {
        let named = |key: &str| values.names.get(key).filter(|names| !names.is_empty()).cloned().map(GroupNames::from);
        let names = |key: &str| named(key).unwrap_or_else(|| Vec::<String>::new().into());
        let length = values.numbers.get("filter").copied().unwrap_or(f64::NAN);
        let shape = FreeShape::of(name, names("region"), names("surface"), length);
        let (keep, least_volume) = (named("keep"), values.numbers.get("least_volume").copied());
        solid.free_shape(FreeShape { keep, least_volume, ..shape })
    },
};
