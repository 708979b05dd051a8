use super::CheckedInputs;
use super::conversions;
use super::fits;
use super::formula_row::FORMULA;
use super::network_row::CONVEX_NETWORK;
use super::{Made, MaterialRow, Parameter};
use crate::{
    Arap, ArrudaBoyce, EnergyError, FiberFamily, Field, Gel, Gent, Guccione, HolzapfelGasserOgden, MooneyRivlin,
    NeoHooke, NeoHookeIsochoric, Ogden, SaintVenantKirchhoff, TransverseMooneyRivlin, Yeoh,
};

pub const MATERIALS: &[MaterialRow] = &[
    MaterialRow {
        name: MooneyRivlin::NAME,
        about: "compressible Mooney-Rivlin",
        existence: "polyconvex; W -> inf as J -> 0; coercive for mu2 > 0",
        reinforcing: false,
        forms: &[
            &[pressure("mu1", 1e5), pressure("mu2", 2e4), pressure("mu3", 1e6)],
            SHEAR_BULK_SHARE,
            YOUNG_SHARE,
            &[pressure("c10", 4e4), pressure("c01", 1e4), compliance("d1", 4e-6)],
        ],
        fit: fits::MOONEY_RIVLIN,
        make: |given| {
            Ok(Made::linear(if given.form_has("young") {
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
            })
            .by(conversions::MOONEY_RIVLIN))
        },
    },
    MaterialRow {
        name: TransverseMooneyRivlin::NAME,
        about: "Mooney-Rivlin with stiffening fibres along `fiber`",
        existence: "polyconvex; W -> inf as J -> 0; coercive for mu2 > 0",
        reinforcing: false,
        forms: &[&[
            pressure("mu1", 1e5),
            pressure("mu2", 2e4),
            pressure("mu3", 3e5),
            pressure("mu4", 1e6),
            Parameter::direction("fiber", [0.6, 0.8, 0.0]),
        ]],
        fit: fits::TRANSVERSE_MOONEY_RIVLIN,
        make: |given| {
            Ok(Made::linear(TransverseMooneyRivlin::new(
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
        existence: "polyconvex; W -> inf as J -> 0; not coercive: nothing bounds the cofactor",
        reinforcing: false,
        forms: &[&[pressure("mu", 1e5), pressure("lambda", 4e5)], SHEAR_BULK, YOUNG, C10_D1],
        fit: fits::NEO_HOOKE,
        make: |given| {
            Ok(Made::linear(if given.form_has("young") {
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
        name: Gel::NAME,
        about: "hydrogel in equilibrium with its solvent: Gaussian network and mixing of Flory and Huggins",
        existence: "polyconvex; W -> inf as J -> 0; not coercive: nothing bounds the cofactor",
        reinforcing: false,
        forms: &[
            &[pressure("network", 1e5), pressure("mixing", 1e7), number("chi", 0.1), number("swelling", 2.0)],
            &[pressure("network", 1e5), pressure("mixing", 1e7), number("chi", 0.1)],
        ],
        fit: &[],
        make: |given| {
            let [network, mixing, chi] = [given.number("network")?, given.number("mixing")?, given.number("chi")?];
            Ok(Made::linear(if given.form_has("swelling") {
                Gel::new(network, mixing, chi, given.number("swelling")?)?
            } else {
                Gel::in_solvent(network, mixing, chi)?
            }))
        },
    },
    MaterialRow {
        name: NeoHookeIsochoric::NAME,
        about: "neo-Hookean, split into isochoric and volumetric parts",
        existence: "polyconvex; W -> inf as J -> 0; not coercive: p = 3/2",
        reinforcing: false,
        forms: &[&[pressure("mu", 1e5), pressure("kappa", 5e5)], SHEAR_BULK, YOUNG, C10_D1],
        fit: fits::NEO_HOOKE,
        make: |given| {
            Ok(Made::linear(if given.form_has("young") {
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
    MaterialRow {
        name: Yeoh::NAME,
        about: "Yeoh: a cubic in the first invariant",
        existence: "polyconvex for c20 >= 0; W -> inf as J -> 0; coercive for c30 > 0",
        reinforcing: false,
        forms: &[
            &[pressure("c10", 5e4), pressure("c20", 1e3), pressure("c30", 1e2), pressure("bulk", 1e6)],
            &[pressure("c10", 5e4), pressure("c20", 1e3), pressure("c30", 1e2), compliance("d1", 2e-6)],
        ],
        fit: fits::YEOH,
        make: |given| {
            let [c10, c20, c30] = [given.number("c10")?, given.number("c20")?, given.number("c30")?];
            Ok(Made::linear(if given.form_has("d1") {
                Yeoh::from_d1(c10, c20, c30, given.number("d1")?)?
            } else {
                Yeoh::new(c10, c20, c30, given.number("bulk")?)?
            }))
        },
    },
    MaterialRow {
        name: Gent::NAME,
        about: "Gent: chains of limited length, J^(-2/3) |F|^2 - 3 < jm",
        existence: "polyconvex; W -> inf as J -> 0; coercive",
        reinforcing: false,
        forms: &[
            &[pressure("mu", 1e5), number("jm", 60.0), pressure("bulk", 1e6)],
            &[pressure("shear", 1e5), number("jm", 60.0), pressure("bulk", 1e6)],
            &[pressure("young", 3e5), number("poisson", 0.45), number("jm", 60.0)],
            &[pressure("mu", 1e5), number("jm", 60.0), compliance("d1", 2e-6)],
        ],
        fit: fits::GENT,
        make: |given| {
            let jm = given.number("jm")?;
            Ok(Made::linear(if given.form_has("young") {
                Gent::from_young_poisson(given.number("young")?, given.number("poisson")?, jm)?
            } else if given.form_has("d1") {
                Gent::from_d1(given.number("mu")?, jm, given.number("d1")?)?
            } else if given.form_has("shear") {
                Gent::from_shear_bulk(given.number("shear")?, jm, given.number("bulk")?)?
            } else {
                Gent::new(given.number("mu")?, jm, given.number("bulk")?)?
            }))
        },
    },
    MaterialRow {
        name: ArrudaBoyce::NAME,
        about: "Arruda-Boyce: eight chains, five terms",
        existence: "polyconvex; W -> inf as J -> 0; coercive",
        reinforcing: false,
        forms: &[
            &[pressure("mu", 1e5), number("lambda_m", 3.0), pressure("bulk", 1e6)],
            &[pressure("shear", 1e5), number("lambda_m", 3.0), pressure("bulk", 1e6)],
            &[pressure("young", 3e5), number("poisson", 0.45), number("lambda_m", 3.0)],
            &[pressure("mu", 1e5), number("lambda_m", 3.0), compliance("d1", 2e-6)],
        ],
        fit: fits::ARRUDA_BOYCE,
        make: |given| {
            let lambda_m = given.number("lambda_m")?;
            Ok(Made::linear(if given.form_has("young") {
                ArrudaBoyce::from_young_poisson(given.number("young")?, given.number("poisson")?, lambda_m)?
            } else if given.form_has("shear") {
                ArrudaBoyce::from_shear_bulk(given.number("shear")?, lambda_m, given.number("bulk")?)?
            } else if given.form_has("d1") {
                ArrudaBoyce::from_d1(given.number("mu")?, lambda_m, given.number("d1")?)?
            } else {
                ArrudaBoyce::new(given.number("mu")?, lambda_m, given.number("bulk")?)?
            })
            .by(conversions::ARRUDA_BOYCE))
        },
    },
    MaterialRow {
        name: Ogden::NAME,
        about: "Ogden: powers of the isochoric principal stretches",
        existence: "polyconvex if every alpha >= 3/2 or <= -3; W -> inf as J -> 0; coercive with an alpha >= 6, or by both signs",
        reinforcing: false,
        forms: &[
            &[OGDEN[0], OGDEN[1], pressure("bulk", 1e6)],
            &[OGDEN[0], OGDEN[1], OGDEN[2], OGDEN[3], pressure("bulk", 1e6)],
            &[OGDEN[0], OGDEN[1], OGDEN[2], OGDEN[3], OGDEN[4], OGDEN[5], pressure("bulk", 1e6)],
            &[OGDEN[0], OGDEN[1], OGDEN[2], OGDEN[3], OGDEN[4], OGDEN[5], OGDEN[6], OGDEN[7], pressure("bulk", 1e6)],
            &[OGDEN[0], OGDEN[1], compliance("d1", 2e-6)],
            &[OGDEN[0], OGDEN[1], OGDEN[2], OGDEN[3], compliance("d1", 2e-6)],
            &[OGDEN[0], OGDEN[1], OGDEN[2], OGDEN[3], OGDEN[4], OGDEN[5], compliance("d1", 2e-6)],
        ],
        fit: fits::OGDEN,
        make: |given| {
            let pairs = OGDEN.chunks_exact(2).filter(|pair| given.form_has(pair[0].name));
            let terms = pairs.map(|pair| Ok([given.number(pair[0].name)?, given.number(pair[1].name)?]));
            let terms = terms.collect::<Result<Vec<[Field<f64>; 2]>, EnergyError>>()?;
            Ok(Made::linear(if given.form_has("d1") {
                Ogden::from_d1(terms, given.number("d1")?)?
            } else {
                Ogden::new(terms, given.number("bulk")?)?
            }))
        },
    },
    MaterialRow {
        name: HolzapfelGasserOgden::NAME,
        about: "Holzapfel-Gasser-Ogden: one or two families of stiffening fibres with dispersion, in a neo-Hookean matrix",
        existence: "polyconvex; W -> inf as J -> 0; coercive for dispersion > 0",
        reinforcing: false,
        forms: &[
            &[pressure("mu", 1e5), FIBERS[0], FIBERS[1], FIBERS[2], FIBERS[3], FIBERS[4], pressure("bulk", 1e6)],
            &[
                pressure("mu", 1e5),
                FIBERS[0],
                FIBERS[1],
                FIBERS[2],
                FIBERS[3],
                FIBERS[4],
                FIBER2,
                pressure("bulk", 1e6),
            ],
            &[pressure("c10", 5e4), FIBERS[0], FIBERS[1], FIBERS[2], FIBERS[3], FIBERS[4], compliance("d1", 2e-6)],
            &[
                pressure("c10", 5e4),
                FIBERS[0],
                FIBERS[1],
                FIBERS[2],
                FIBERS[3],
                FIBERS[4],
                FIBER2,
                compliance("d1", 2e-6),
            ],
        ],
        fit: fits::HOLZAPFEL_GASSER_OGDEN,
        make: |given| {
            let second = if given.form_has("fiber2") { Some(given.direction("fiber2")?) } else { None };
            let (fibers, first) = (fibers(given)?, given.direction("fiber")?);
            let law = if given.form_has("c10") {
                let matrix = [given.number("c10")?, given.number("d1")?];
                HolzapfelGasserOgden::from_c10_d1(matrix, fibers, first, second)?
            } else {
                HolzapfelGasserOgden::new([given.number("mu")?, given.number("bulk")?], fibers, first, second)?
            };
            Ok(Made::linear(law))
        },
    },
    MaterialRow {
        name: FiberFamily::NAME,
        about: "a family of stiffening fibres with dispersion, which adds to the law of the matrix on the same region",
        existence: "polyconvex; growth and coercivity are those of the matrix",
        reinforcing: true,
        forms: &[&[
            FIBERS[0],
            number("k2", 0.1),
            number("dispersion", 0.3),
            Parameter::direction("fiber", [0.0, 0.6, 0.8]),
            number("toe", FiberFamily::TOE).optional(),
        ]],
        fit: &[],
        make: |given| {
            let [k1, k2, dispersion, toe] = fibers(given)?;
            let law = FiberFamily::new(k1, k2, dispersion, given.direction("fiber")?)?.with_toe(toe)?;
            Ok(Made::linear(law))
        },
    },
    MaterialRow {
        name: SaintVenantKirchhoff::NAME,
        about: "Saint Venant-Kirchhoff: linear in the Green-Lagrange strain; not polyconvex, softens in compression",
        existence: "not polyconvex; finite as J -> 0; growth |F|^4",
        reinforcing: false,
        forms: &[&[pressure("lambda", 4e5), pressure("mu", 1e5)], SHEAR_BULK, YOUNG],
        fit: &[],
        make: |given| {
            Ok(Made::linear(if given.form_has("young") {
                SaintVenantKirchhoff::from_young_poisson(given.number("young")?, given.number("poisson")?)?
            } else if given.form_has("shear") {
                SaintVenantKirchhoff::from_shear_bulk(given.number("shear")?, given.number("bulk")?)?
            } else {
                SaintVenantKirchhoff::new(given.number("lambda")?, given.number("mu")?)?
            }))
        },
    },
    MaterialRow {
        name: Arap::NAME,
        about: "as rigid as possible: squared distance of F from the rotations; not polyconvex, Poisson's ratio 0",
        existence: "not polyconvex; finite as J -> 0; not coercive: growth |F|^2",
        reinforcing: false,
        forms: &[&[pressure("mu", 1e5)], &[pressure("young", 2e5)]],
        fit: &[],
        make: |given| {
            Ok(Made::linear(if given.form_has("young") {
                Arap::from_young(given.number("young")?)?
            } else {
                Arap::new(given.number("mu")?)?
            })
            .by(conversions::ARAP))
        },
    },
    MaterialRow {
        name: Guccione::NAME,
        about: "Guccione: heart muscle, exponential in the Green-Lagrange strain, stiffer along `fiber`; not polyconvex",
        existence: "not polyconvex; W -> inf as J -> 0; growth of any power in tension",
        reinforcing: false,
        forms: &[&[
            pressure("c", 2e4),
            number("bf", 0.08),
            number("bt", 0.02),
            number("bfs", 0.04),
            pressure("bulk", 1e6),
            Parameter::direction("fiber", [0.6, 0.8, 0.0]),
        ]],
        fit: &[],
        make: |given| {
            let b = [given.number("bf")?, given.number("bt")?, given.number("bfs")?];
            let law = Guccione::new(given.number("c")?, b, given.number("bulk")?, given.direction("fiber")?)?;
            Ok(Made::linear(law))
        },
    },
    CONVEX_NETWORK,
    FORMULA,
];

/// `mu` and `alpha` of every term; any first ones fulfil the conditions of polyconvexity.
const OGDEN: &[Parameter] = &[
    pressure("mu1", 6e4),
    number("alpha1", 2.5),
    pressure("mu2", -5e3),
    number("alpha2", -3.5),
    pressure("mu3", 5e2),
    number("alpha3", 5.0),
    pressure("mu4", 2e4),
    number("alpha4", 1.8),
];
const FIBERS: &[Parameter] = &[
    pressure("k1", 4e5),
    number("k2", 0.3),
    number("dispersion", 0.1),
    Parameter::direction("fiber", [0.6, 0.8, 0.0]),
    // wide, for differences over its ends are not exact
    number("toe", 5.0).optional(),
];
const FIBER2: Parameter = Parameter::direction("fiber2", [0.6, -0.8, 0.0]);

/// `k1`, `k2`, dispersion and toe.
fn fibers(given: &CheckedInputs<'_>) -> Result<[Field<f64>; 4], EnergyError> {
    let toe = given.number_or("toe", FiberFamily::TOE);
    Ok([given.number("k1")?, given.number("k2")?, given.number("dispersion")?, toe])
}

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
