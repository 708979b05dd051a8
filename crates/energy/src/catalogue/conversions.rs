//! The moduli of laws by the other numbers that these may be written with; see the constructors of each law.

use crate::Conversion;
use nastic_tensor::HyperDual;

const fn rule(
    modulus: &'static str,
    from: &'static [&'static str],
    value: fn(&[HyperDual]) -> HyperDual,
) -> Conversion {
    Conversion { modulus, from, held: 0, value }
}

const YOUNG: &[&str] = &["young", "poisson"];
const YOUNG_SHARE: &[&str] = &["young", "poisson", "share"];
const SHEAR_SHARE: &[&str] = &["shear", "bulk", "share"];

/// Of all laws whose moduli are called so.
pub const SHARED: &[Conversion] = &[
    rule("mu", &["shear"], |p| p[0]),
    rule("mu", YOUNG, |p| shear(p[0], p[1])),
    rule("mu", &["c10"], |p| p[0] * of(2.0)),
    rule("lambda", &["shear", "bulk"], |p| lame(p[0], p[1])),
    rule("lambda", YOUNG, |p| lame(shear(p[0], p[1]), bulk(p[0], p[1]))),
    rule("lambda", &["c10", "d1"], |p| lame(p[0] * of(2.0), of(2.0) / p[1])),
    rule("kappa", &["bulk"], |p| p[0]),
    rule("kappa", YOUNG, |p| bulk(p[0], p[1])),
    rule("kappa", &["d1"], |p| of(2.0) / p[0]),
    rule("bulk", YOUNG, |p| bulk(p[0], p[1])),
    rule("bulk", &["d1"], |p| of(2.0) / p[0]),
];

pub const MOONEY_RIVLIN: &[Conversion] = &[
    rule("mu1", SHEAR_SHARE, |p| p[0] * p[2] * of(0.5)),
    rule("mu2", SHEAR_SHARE, |p| p[0] * (of(1.0) - p[2]) * of(0.5)),
    rule("mu3", SHEAR_SHARE, |p| third(p[0], p[1], p[2])),
    rule("mu1", YOUNG_SHARE, |p| shear(p[0], p[1]) * p[2] * of(0.5)),
    rule("mu2", YOUNG_SHARE, |p| shear(p[0], p[1]) * (of(1.0) - p[2]) * of(0.5)),
    rule("mu3", YOUNG_SHARE, |p| third(shear(p[0], p[1]), bulk(p[0], p[1]), p[2])),
    rule("mu1", &["c10"], |p| p[0]),
    rule("mu2", &["c01"], |p| p[0]),
    rule("mu3", &["c10", "c01", "d1"], |p| of(1.0) / p[2] - (p[0] * of(2.0) + p[1] * of(8.0)) * of(1.0 / 3.0)),
];

/// Poisson's ratio is 0.
pub const ARAP: &[Conversion] = &[rule("mu", &["young"], |p| p[0] * of(0.5))];

/// The ratio of shear modulus and mu is one of the locking stretch.
pub const ARRUDA_BOYCE: &[Conversion] = &[
    Conversion { held: 1, ..rule("mu", &["shear", "lambda_m"], |p| p[0] / ratio(p[1])) },
    Conversion { held: 1, ..rule("mu", &["young", "poisson", "lambda_m"], |p| shear(p[0], p[1]) / ratio(p[2])) },
];

fn of(x: f64) -> HyperDual {
    HyperDual::constant(x)
}

fn ratio(lambda_m: HyperDual) -> HyperDual {
    of(crate::ArrudaBoyce::shear_ratio(lambda_m.real()))
}

/// `E / (2 (1 + nu))`
fn shear(young: HyperDual, poisson: HyperDual) -> HyperDual {
    young / ((of(1.0) + poisson) * of(2.0))
}

/// `E / (3 (1 - 2 nu))`
fn bulk(young: HyperDual, poisson: HyperDual) -> HyperDual {
    young / ((of(1.0) - poisson * of(2.0)) * of(3.0))
}

/// `kappa - 2 mu / 3`
fn lame(shear: HyperDual, bulk: HyperDual) -> HyperDual {
    bulk - shear * of(2.0 / 3.0)
}

/// mu3 of Mooney-Rivlin: `(kappa + mu (2 U - 8/3)) / 2`
fn third(shear: HyperDual, bulk: HyperDual, share: HyperDual) -> HyperDual {
    (bulk + shear * (share * of(2.0) - of(8.0 / 3.0))) * of(0.5)
}
