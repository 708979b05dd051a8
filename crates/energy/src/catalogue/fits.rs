//! The [`FitForm`]s of the rows.

use super::fit_form::{FitForm, FitNumber, FitStarts, FitVolume, Free};
use std::f64::consts::PI;

/// `neo_hooke` and `neo_hooke_isochoric`.
pub const NEO_HOOKE: &[FitForm] =
    &[FitForm { shear: Some(|p| p[0]), ..FitForm::new(&[FitNumber::modulus("shear", 1.0)], FitStarts::At(&[&[0.0]])) }];

/// `mooney_rivlin`.
pub const MOONEY_RIVLIN: &[FitForm] = &[FitForm {
    shear: Some(|p| 2.0 * (p[0] + p[1])),
    volume: FitVolume::D1,
    ..FitForm::new(
        &[FitNumber::modulus("c10", 0.5), FitNumber::square("c01", 0.5, 0)],
        FitStarts::At(&[&[-0.2, 0.4], &[-1.0, 0.8]]),
    )
}];

/// Share of a border that printed digits do not pass.
const INSIDE: f64 = 1.0 - 1e-9;

/// `yeoh`: `c20` may be negative, to `-sqrt(3 c10 c30)`.
pub const YEOH: &[FitForm] = &[FitForm {
    shear: Some(|p| 2.0 * p[0]),
    couple: Some(|p| p[1] -= INSIDE * (3.0 * p[0] * p[2]).sqrt()),
    ..FitForm::new(
        &[FitNumber::modulus("c10", 0.5), FitNumber::square("c20", 0.5, 1), FitNumber::square("c30", 0.5, 2)],
        FitStarts::At(&[&[0.0, 0.3, 0.3], &[0.0, 0.1, 0.05], &[-0.5, 1.0, 0.5]]),
    )
}];

/// `gent`.
pub const GENT: &[FitForm] = &[FitForm {
    shear: Some(|p| p[0]),
    ..FitForm::new(
        &[FitNumber::modulus("mu", 1.0), FitNumber::new("jm", Free::Above { reach: true })],
        FitStarts::At(&[&[0.0, -2.0], &[0.0, 0.0], &[-0.5, 2.0]]),
    )
}];

/// `arruda_boyce`.
pub const ARRUDA_BOYCE: &[FitForm] = &[FitForm::new(
    &[FitNumber::modulus("mu", 1.0), FitNumber::new("lambda_m", Free::Above { reach: false })],
    FitStarts::At(&[&[0.0, 1.0], &[0.0, 2.0], &[0.0, 0.0]]),
)];

/// `mu_i = 2 g_i / alpha_i` with `g_i > 0`.
const OGDEN_TERMS: [FitNumber; 8] = [
    FitNumber::modulus("mu1", 2.0),
    FitNumber::new("alpha1", Free::Power),
    FitNumber::modulus("mu2", 2.0),
    FitNumber::new("alpha2", Free::Power),
    FitNumber::modulus("mu3", 2.0),
    FitNumber::new("alpha3", Free::Power),
    FitNumber::modulus("mu4", 2.0),
    FitNumber::new("alpha4", Free::Power),
];

const fn ogden(suffix: &'static str, numbers: &'static [FitNumber]) -> FitForm {
    FitForm {
        suffix,
        shear: Some(|p| p.chunks_exact(2).map(|pair| 0.5 * pair[0] * pair[1]).sum()),
        couple: Some(|p| p.chunks_exact_mut(2).for_each(|pair| pair[0] /= pair[1])),
        ..FitForm::new(numbers, FitStarts::Powers)
    }
}

/// `ogden` of one to four terms.
pub const OGDEN: &[FitForm] = &[
    ogden("_1", OGDEN_TERMS.split_at(2).0),
    ogden("_2", OGDEN_TERMS.split_at(4).0),
    ogden("_3", OGDEN_TERMS.split_at(6).0),
    FitForm { named_only: true, ..ogden("_4", &OGDEN_TERMS) },
];

/// `transverse_mooney_rivlin`; `K = 4/3 mu1 + 16/3 mu2 + 20/9 mu3 + 2 mu4` at rest.
pub const TRANSVERSE_MOONEY_RIVLIN: &[FitForm] = &[FitForm {
    families: 1,
    shear: Some(|p| 2.0 * (p[0] + p[1])),
    along: Some(|p| 2.0 * p[2]),
    volume: FitVolume {
        key: "mu4",
        value: |p, bulk| 0.5 * bulk - p[0] * 2.0 / 3.0 - p[1] * 8.0 / 3.0 - p[2] * 10.0 / 9.0,
        least: Some(|p| 2.0 * (p[0] * 2.0 / 3.0 + p[1] * 8.0 / 3.0 + p[2] * 10.0 / 9.0)),
    },
    ..FitForm::new(
        &[FitNumber::modulus("mu1", 0.5), FitNumber::square("mu2", 0.5, 0), FitNumber::square("mu3", 0.5, 0)],
        FitStarts::At(&[&[-0.5, 0.4, 0.8], &[-1.0, 0.8, 1.5], &[-0.2, 0.1, 0.2]]),
    )
}];

const FIBERS: [FitNumber; 5] = [
    FitNumber::modulus("mu", 1.0),
    FitNumber::modulus("k1", 1.0),
    FitNumber::new("k2", Free::PerReach),
    FitNumber::new("dispersion", Free::Dispersion),
    FitNumber::new("fiber_angle", Free::Angle),
];

/// Soft and stiff fibres, hardly and much dispersed, and for two families at 15, 45 and 75 degrees.
const fn fibers_at(angle: f64) -> [[f64; 5]; 4] {
    [
        [-0.5, -1.0, -1.0, 0.6, angle],
        [-0.5, -1.0, -1.0, 1.8, angle],
        [-0.5, -2.0, 1.0, 0.6, angle],
        [-0.5, -2.0, 1.0, 1.8, angle],
    ]
}
const FIRST: [[f64; 5]; 4] = fibers_at(PI / 12.0);
const MIDDLE: [[f64; 5]; 4] = fibers_at(PI / 4.0);
const LAST: [[f64; 5]; 4] = fibers_at(5.0 * PI / 12.0);

/// `holzapfel_gasser_ogden` of one family and of two.
pub const HOLZAPFEL_GASSER_OGDEN: &[FitForm] = &[
    FitForm {
        suffix: "_1",
        families: 1,
        shear: Some(|p| p[0]),
        ..FitForm::new(
            FIBERS.split_at(4).0,
            FitStarts::At(&[
                FIRST[0].split_at(4).0,
                FIRST[1].split_at(4).0,
                FIRST[2].split_at(4).0,
                FIRST[3].split_at(4).0,
            ]),
        )
    },
    FitForm {
        suffix: "_2",
        families: 2,
        shear: Some(|p| p[0]),
        ..FitForm::new(
            &FIBERS,
            FitStarts::At(&[
                &FIRST[0], &FIRST[1], &FIRST[2], &FIRST[3], &MIDDLE[0], &MIDDLE[1], &MIDDLE[2], &MIDDLE[3], &LAST[0],
                &LAST[1], &LAST[2], &LAST[3],
            ]),
        )
    },
];
