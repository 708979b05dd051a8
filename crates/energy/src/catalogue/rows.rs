use std::sync::Arc;

use super::{ActuationRow, Example, Made, MaterialRow, Parameter};
use crate::magnet::VACUUM_PERMEABILITY;
use crate::{
    FiberTension, Magnet, MagnetIsochoric, MagnetRotation, MooneyRivlin, NeoHooke, NeoHookeIsochoric,
    TransverseMooneyRivlin, Turgor,
};

pub const MATERIALS: &[MaterialRow] = &[
    MaterialRow {
        name: MooneyRivlin::NAME,
        about: "compressible Mooney-Rivlin",
        forms: &[
            &[pressure("mu1", 1e5), pressure("mu2", 2e4), pressure("mu3", 1e6)],
            SHEAR_BULK_SHARE,
            YOUNG_SHARE,
            &[pressure("c10", 4e4), pressure("c01", 1e4), compliance("d1", 4e-6)],
        ],
        make: |given| {
            Ok(Made::density(if given.form_has("young") {
                MooneyRivlin::from_young_poisson(
                    given.number("young")?,
                    given.number("poisson")?,
                    given.number("share")?,
                )?
            } else if given.form_has("shear") {
                MooneyRivlin::from_shear_bulk(given.number("shear")?, given.number("bulk")?, given.number("share")?)?
            } else if given.form_has("c10") {
                MooneyRivlin::from_c10_c01_d1(given.number("c10")?, given.number("c01")?, given.number("d1")?)?
            } else {
                MooneyRivlin::new(given.number("mu1")?, given.number("mu2")?, given.number("mu3")?)?
            }))
        },
    },
    MaterialRow {
        name: TransverseMooneyRivlin::NAME,
        about: "Mooney-Rivlin with stiffening fibres along `fiber`",
        forms: &[&[
            pressure("mu1", 1e5),
            pressure("mu2", 2e4),
            pressure("mu3", 3e5),
            pressure("mu4", 1e6),
            Parameter::direction("fiber", [0.6, 0.8, 0.0]),
        ]],
        make: |given| {
            Ok(Made::density(TransverseMooneyRivlin::new(
                given.number("mu1")?,
                given.number("mu2")?,
                given.number("mu3")?,
                given.number("mu4")?,
                given.direction("fiber")?,
            )?))
        },
    },
    MaterialRow {
        name: NeoHooke::NAME,
        about: "compressible neo-Hookean, polyconvex form",
        forms: &[&[pressure("mu", 1e5), pressure("lambda", 4e5)], SHEAR_BULK, YOUNG, C10_D1],
        make: |given| {
            Ok(Made::density(if given.form_has("young") {
                NeoHooke::from_young_poisson(given.number("young")?, given.number("poisson")?)?
            } else if given.form_has("shear") {
                NeoHooke::from_shear_bulk(given.number("shear")?, given.number("bulk")?)?
            } else if given.form_has("c10") {
                NeoHooke::from_c10_d1(given.number("c10")?, given.number("d1")?)?
            } else {
                NeoHooke::new(given.number("mu")?, given.number("lambda")?)?
            }))
        },
    },
    MaterialRow {
        name: NeoHookeIsochoric::NAME,
        about: "neo-Hookean, split into isochoric and volumetric parts",
        forms: &[&[pressure("mu", 1e5), pressure("kappa", 5e5)], SHEAR_BULK, YOUNG, C10_D1],
        make: |given| {
            Ok(Made::density(if given.form_has("young") {
                NeoHookeIsochoric::from_young_poisson(given.number("young")?, given.number("poisson")?)?
            } else if given.form_has("shear") {
                NeoHookeIsochoric::from_shear_bulk(given.number("shear")?, given.number("bulk")?)?
            } else if given.form_has("c10") {
                NeoHookeIsochoric::from_c10_d1(given.number("c10")?, given.number("d1")?)?
            } else {
                NeoHookeIsochoric::new(given.number("mu")?, given.number("kappa")?)?
            }))
        },
    },
];

pub const ACTUATIONS: &[ActuationRow] = &[
    ActuationRow {
        name: FiberTension::NAME,
        about: "fibre tension along `direction`; positive lengthens the fibre, negative contracts it",
        forms: &[&[Parameter::direction("direction", [0.6, 0.0, 0.8])]],
        example: Example { controls: &[1.5e5], towards: [[0.36, 0.0, 0.48], [0.0, 0.0, 0.0], [0.48, 0.0, 0.64]] },
        make: |given| Ok(Arc::new(FiberTension::along_field(given.direction("direction")?)?)),
    },
    ActuationRow {
        name: FiberTension::MUSCLE,
        about: "a muscle along `direction`; a positive contraction pulls, a negative one is refused",
        forms: &[&[Parameter::direction("direction", [0.6, 0.0, 0.8])]],
        example: Example { controls: &[1.5e5], towards: [[-0.36, 0.0, -0.48], [0.0, 0.0, 0.0], [-0.48, 0.0, -0.64]] },
        make: |given| Ok(Arc::new(FiberTension::along_field(given.direction("direction")?)?.muscle())),
    },
    ActuationRow {
        name: Turgor::NAME,
        about: "pressure inside the material; positive inflates",
        forms: &[&[]],
        example: Example { controls: &[1e5], towards: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] },
        make: |_| Ok(Arc::new(Turgor::new())),
    },
    ActuationRow {
        name: Magnet::NAME,
        about: "remanence in an applied field; the body turns its remanence into the field",
        forms: &[&[
            Parameter::choice("variant", &["F", "isochoric", "rotation"]).optional(),
            Parameter::number("mu0", "N/A^2", VACUUM_PERMEABILITY).optional(),
        ]],
        example: Example {
            controls: &[0.1, 0.0, 0.0, 0.0, 0.02, 0.0],
            towards: [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 0.0]],
        },
        make: |given| {
            let mu0 = given.number_or("mu0", VACUUM_PERMEABILITY);
            Ok(match given.word("variant") {
                Some("rotation") => Arc::new(MagnetRotation::with_permeability(mu0)?),
                Some("isochoric") => Arc::new(MagnetIsochoric::with_permeability(mu0)?),
                _ => Arc::new(Magnet::with_permeability(mu0)?),
            })
        },
    },
];

const SHEAR_BULK: &[Parameter] = &[pressure("shear", 1e5), pressure("bulk", 5e5)];
const SHEAR_BULK_SHARE: &[Parameter] = &[pressure("shear", 1e5), pressure("bulk", 5e5), number("share", 0.8)];
const YOUNG: &[Parameter] = &[pressure("young", 3e5), number("poisson", 0.4)];
const C10_D1: &[Parameter] = &[pressure("c10", 5e4), compliance("d1", 4e-6)];
const YOUNG_SHARE: &[Parameter] = &[pressure("young", 3e5), number("poisson", 0.4), number("share", 0.8)];

const fn pressure(name: &'static str, example: f64) -> Parameter {
    Parameter::number(name, "Pa", example)
}

const fn compliance(name: &'static str, example: f64) -> Parameter {
    Parameter::number(name, "1/Pa", example)
}

const fn number(name: &'static str, example: f64) -> Parameter {
    Parameter::number(name, "1", example)
}
