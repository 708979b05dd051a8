use std::sync::Arc;

use super::{ActuationRow, Example, Parameter};
use crate::dielectric::VACUUM_PERMITTIVITY;
use crate::magnet::VACUUM_PERMEABILITY;
use crate::{
    Dielectric, EnergyError, FiberTension, Field, GrowthTensor, KinematicGrowth, Magnet, MagnetIsochoric,
    MagnetRotation, ShapeModes, SpontaneousStrain, ThermalExpansion, Turgor,
};

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
    ActuationRow {
        name: Dielectric::NAME,
        about: "electric field across a film between electrodes, along `direction`: thins it and widens it, whatever its sign",
        forms: &[
            &[
                Parameter::number("relative_permittivity", "1", 3.0),
                Parameter::number("eps0", "F/m", VACUUM_PERMITTIVITY).optional(),
                FILM_NORMAL,
                BREAKDOWN,
            ],
            &[Parameter::number("permittivity", "F/m", 2.5e-11), FILM_NORMAL, BREAKDOWN],
        ],
        example: Example { controls: &[3e7], towards: [[0.28, 0.0, -0.96], [0.0, 1.0, 0.0], [-0.96, 0.0, -0.28]] },
        make: |given| {
            let direction = given.direction("direction")?;
            let film = if given.form_has("permittivity") {
                Dielectric::new(given.number("permittivity")?, direction)?
            } else {
                let eps0 = given.number_or("eps0", VACUUM_PERMITTIVITY);
                Dielectric::from_relative(given.number("relative_permittivity")?, eps0, direction)?
            };
            Ok(Arc::new(match given.number("breakdown") {
                Ok(strength) => film.with_breakdown(strength)?,
                Err(_) => film,
            }))
        },
    },
    ActuationRow {
        name: KinematicGrowth::NAME,
        about: "growth in all directions by the part `growth` of every length; a negative one shrinks",
        forms: &[&[]],
        example: Example { controls: &[0.1], towards: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] },
        make: |_| Ok(Arc::new(KinematicGrowth::isotropic())),
    },
    ActuationRow {
        name: KinematicGrowth::ALONG,
        about: "growth along `direction` alone by the part `growth` of lengths; a negative one shortens",
        forms: &[&[Parameter::direction("direction", [0.6, 0.0, 0.8])]],
        example: Example { controls: &[0.1], towards: [[0.36, 0.0, 0.48], [0.0, 0.0, 0.0], [0.48, 0.0, 0.64]] },
        make: |given| Ok(Arc::new(KinematicGrowth::along(given.direction("direction")?)?)),
    },
    ActuationRow {
        name: KinematicGrowth::ACROSS,
        about: "growth in the plane across `normal` by the part `growth` of lengths; a negative one shrinks",
        forms: &[&[Parameter::direction("normal", [0.6, 0.0, 0.8])]],
        example: Example { controls: &[0.1], towards: [[0.64, 0.0, -0.48], [0.0, 1.0, 0.0], [-0.48, 0.0, 0.36]] },
        make: |given| Ok(Arc::new(KinematicGrowth::across(given.direction("normal")?)?)),
    },
    ActuationRow {
        name: ThermalExpansion::NAME,
        about: "thermal expansion by a temperature, the difference to that without stress; positive heats",
        forms: &[
            &[Parameter::number("expansion", "1/K", 2e-4)],
            &[
                Parameter::number("expansion_along", "1/K", 5e-4),
                Parameter::number("expansion_across", "1/K", 2e-4),
                Parameter::direction("direction", [0.6, 0.0, 0.8]),
            ],
        ],
        example: Example { controls: &[100.0], towards: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] },
        make: |given| {
            Ok(Arc::new(if given.form_has("expansion") {
                ThermalExpansion::isotropic(given.number("expansion")?)?
            } else {
                let [along, across] = [given.number("expansion_along")?, given.number("expansion_across")?];
                ThermalExpansion::along(given.direction("direction")?, along, across)?
            }))
        },
    },
    ActuationRow {
        name: SpontaneousStrain::LCE,
        about: "liquid crystal elastomer: a strain along the director `direction` that keeps the volume; a negative one contracts",
        forms: &[&[Parameter::direction("direction", [0.6, 0.0, 0.8])]],
        example: Example { controls: &[0.1], towards: LENGTHENS },
        make: |given| Ok(Arc::new(SpontaneousStrain::elastomer(given.direction("direction")?)?)),
    },
    ActuationRow {
        name: SpontaneousStrain::MUSCLE,
        about: "muscle by active strain: fibres along `direction` are free of stress at a length shorter by the part `shortening`, at the same volume",
        forms: &[&[Parameter::direction("direction", [0.6, 0.0, 0.8])]],
        example: Example { controls: &[0.1], towards: SHORTENS },
        make: |given| Ok(Arc::new(SpontaneousStrain::muscle(given.direction("direction")?)?)),
    },
    ActuationRow {
        name: GrowthTensor::NAME,
        about: "growth by a symmetric tensor with the entries `xx` to `xy`; positive ones on the diagonal lengthen, the others shear",
        forms: &[&[]],
        example: Example {
            controls: &[0.1, -0.05, 0.08, 0.02, -0.03, 0.05],
            towards: [[1.0, 0.5, -0.3], [0.5, -0.5, 0.2], [-0.3, 0.2, 0.8]],
        },
        make: |_| Ok(Arc::new(GrowthTensor::new())),
    },
    ActuationRow {
        name: ShapeModes::NAME,
        about: "the shape of the body itself: its nodes move along `modes`, displacement fields without unit, and it is free of stress there; controls are the amplitudes, lengths",
        forms: &[&[
            Parameter::modes("modes", LARGER_AND_SHEARED),
            Parameter::number("least_volume", "1", ShapeModes::LEAST_VOLUME).optional(),
        ]],
        example: Example { controls: &[100.0, 50.0], towards: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.2], [0.0, 0.0, 1.0]] },
        make: |given| {
            let least = given.number_or("least_volume", ShapeModes::LEAST_VOLUME);
            let modes = ShapeModes::new(given.modes("modes")?)?;
            match least {
                Field::Uniform(least) => Ok(Arc::new(modes.with_least_volume(least)?)),
                _ => Err(EnergyError::ShapeModes {
                    why: "their \"least_volume\" is one number for all points".to_owned(),
                }),
            }
        },
    },
];

const LARGER_AND_SHEARED: &[(&str, [[f64; 3]; 3])] = &[
    ("size", [[1e-3, 0.0, 0.0], [0.0, 1e-3, 0.0], [0.0, 0.0, 1e-3]]),
    ("shear", [[0.0, 0.0, 0.0], [0.0, 0.0, 2e-3], [0.0, 0.0, 0.0]]),
];

/// Along the example direction, at the same volume.
const LENGTHENS: [[f64; 3]; 3] = [[0.04, 0.0, 0.72], [0.0, -0.5, 0.0], [0.72, 0.0, 0.46]];
const SHORTENS: [[f64; 3]; 3] = [[-0.04, 0.0, -0.72], [0.0, 0.5, 0.0], [-0.72, 0.0, -0.46]];

const FILM_NORMAL: Parameter = Parameter::direction("direction", [0.6, 0.0, 0.8]);
const BREAKDOWN: Parameter = Parameter::number("breakdown", "V/m", 1e8).optional();
