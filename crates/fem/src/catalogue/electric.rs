//! Dielectric bodies and electrodes in case files.

use super::form::Form;
use super::key::{Key, KeyKind};
use nastic_energy::dielectric::VACUUM_PERMITTIVITY;
use nastic_forces::dielectric_body::DielectricBody;
use nastic_forces::electrode::Electrode;

/// How dielectric bodies stand in case files.
pub(super) const DIELECTRIC_BODY: Form = Form {
    about: "A dielectric whose electric potential is an unknown, in the field of the case's electrodes.",
    keys: &[
        Key::REGION,
        Key::new(
            "relative_permittivity",
            "Its permittivity as a multiple of that of the vacuum.",
            KeyKind::Positive { unit: "1" },
        ),
        Key::new(
            "breakdown",
            "The largest true field that it bears: reported, and warned of.",
            KeyKind::Positive { unit: "V/m" },
        )
        .optional(),
        Key::new(
            "eps0",
            "Permittivity of the vacuum; that of nature in the case's units if left out.",
            KeyKind::Positive { unit: "F/m" },
        )
        .optional(),
    ],
    slots: &[],
    passive: true,
    one_of: false,
    add: |solid, name, values| {
        let number = |key: &str| values.numbers.get(key).copied();
        let permittivity =
            number("relative_permittivity").unwrap_or_default() * number("eps0").unwrap_or(VACUUM_PERMITTIVITY);
        let region = values.names.get("region").cloned().unwrap_or_default();
        let body = DielectricBody::of(name, region, permittivity);
        solid.dielectric_body(&match number("breakdown") {
            None => body,
            Some(strength) => body.with_breakdown(strength),
        })
    },
};

/// How electrodes stand in case files, in a block of their own.
pub const ELECTRODE: Form = Form {
    about: "Nodes with one electric potential: that of a voltage, or that at which they have a charge.",
    keys: &[
        Key::SURFACE.optional(),
        Key::REGION.about("Region of the mesh, which conducts.").optional(),
        Key::NODES.optional(),
        Key::new("floating", "Whether it has no charge and a voltage that is found.", KeyKind::Flag).optional(),
    ],
    slots: &[Electrode::VOLTAGE, Electrode::CHARGE],
    passive: true,
    one_of: true,
    add: |solid, name, values| {
        let place = |key: &str| values.names.get(key).filter(|names| !names.is_empty()).cloned();
        let electrode = match place("region") {
            Some(region) => Electrode::within(name, region),
            None => Electrode::on(name, place("surface").or_else(|| place("nodes")).unwrap_or_default()),
        };
        let charged = values.slot == Some(Electrode::CHARGE.group);
        let floating = values.flags.contains("floating");
        solid.electrode(&match (floating, charged) {
            (true, _) => electrode.floating(),
            (false, true) => electrode.charged(),
            (false, false) => electrode,
        })
    },
};
