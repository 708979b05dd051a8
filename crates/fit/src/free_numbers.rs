//! Free numbers of the laws: what the method of least squares moves, taken smoothly to admissible parameters.

use std::f64::consts::{FRAC_PI_2, PI};

use nastic_numeric::Random;

use crate::Law;
use crate::law::Scale;

/// Share of a border that printed digits do not pass.
const INSIDE: f64 = 1.0 - 1e-9;

impl Law {
    /// Free numbers to admissible parameters, smoothly: moduli that must be positive by `exp`, those that may vanish by squares, and
    /// `c20 = x^2 - sqrt(3 c10 c30)`, `jm > reach`, `lambda_m > 1`, `mu = 2 g / alpha` with g > 0 and alpha of a given sign (that of `signs`),
    /// `dispersion = (1 - cos x)/6`, an angle of fibres by the one between 0 and 90 degrees with the same two directions.
    pub(crate) fn decode(self, x: &[f64], scale: &Scale, signs: &[f64]) -> Vec<f64> {
        let Scale { shear, reach } = *scale;
        match self {
            Law::NeoHooke | Law::NeoHookeIsochoric => vec![shear * x[0].exp()],
            Law::MooneyRivlin => vec![0.5 * shear * x[0].exp(), 0.5 * shear * x[1] * x[1]],
            Law::Yeoh => {
                let (c10, c30) = (0.5 * shear * x[0].exp(), 0.5 * shear / (reach * reach) * x[2] * x[2]);
                vec![c10, 0.5 * shear / reach * x[1] * x[1] - INSIDE * (3.0 * c10 * c30).sqrt(), c30]
            }
            Law::Gent => vec![shear * x[0].exp(), reach * (1.0 + x[1].exp())],
            Law::ArrudaBoyce => vec![shear * x[0].exp(), 1.0 + x[1].exp()],
            Law::Ogden(_) => {
                let pair = |(x, sign): (&[f64], &f64)| {
                    let alpha = sign * x[1].exp();
                    [2.0 * shear * x[0].exp() / alpha, alpha]
                };
                x.chunks_exact(2).zip(signs).flat_map(pair).collect()
            }
            Law::TransverseMooneyRivlin => {
                vec![0.5 * shear * x[0].exp(), 0.5 * shear * x[1] * x[1], 0.5 * shear * x[2] * x[2]]
            }
            Law::HolzapfelGasserOgden(_) => {
                let fibers = [shear * x[0].exp(), shear * x[1].exp(), x[2].exp() / (reach * reach), dispersion(x[3])];
                fibers.into_iter().chain(x.get(4).map(|x| acute(*x).to_degrees())).collect()
            }
        }
    }

    /// Which free numbers are at an end of their parameter's range: squares that vanish, exponentials that do.
    pub(crate) fn on_border(self, x: &[f64]) -> Vec<bool> {
        let vanishes = |(k, x): (usize, &f64)| match (self, k) {
            (Law::MooneyRivlin, 1) | (Law::Yeoh, 1 | 2) | (Law::TransverseMooneyRivlin, 1 | 2) => x.abs() < 1e-2,
            (Law::HolzapfelGasserOgden(_), 3) => x.sin().abs() < 1e-2,
            (Law::HolzapfelGasserOgden(_), 4) => (2.0 * x).sin().abs() < 1e-2,
            _ => *x < -20.0,
        };
        x.iter().enumerate().map(vanishes).collect()
    }

    /// Where to begin: free numbers, and the signs of Ogden's powers.
    pub(crate) fn starts(self, random: &mut Random, count: usize) -> Vec<(Vec<f64>, Vec<f64>)> {
        let plain = |list: &[&[f64]]| list.iter().map(|x| (x.to_vec(), vec![])).collect();
        match self {
            Law::NeoHooke | Law::NeoHookeIsochoric => plain(&[&[0.0]]),
            Law::MooneyRivlin => plain(&[&[-0.2, 0.4], &[-1.0, 0.8]]),
            Law::Yeoh => plain(&[&[0.0, 0.3, 0.3], &[0.0, 0.1, 0.05], &[-0.5, 1.0, 0.5]]),
            Law::Gent => plain(&[&[0.0, -2.0], &[0.0, 0.0], &[-0.5, 2.0]]),
            Law::ArrudaBoyce => plain(&[&[0.0, 1.0], &[0.0, 2.0], &[0.0, 0.0]]),
            Law::TransverseMooneyRivlin => plain(&[&[-0.5, 0.4, 0.8], &[-1.0, 0.8, 1.5], &[-0.2, 0.1, 0.2]]),
            Law::HolzapfelGasserOgden(families) => fiber_starts(families),
            Law::Ogden(terms) => (0..count.max(1)).map(|k| ogden_start(terms.clamp(1, 4), k, random)).collect(),
        }
    }
}

/// Powers of either sign from 0.5 to 10; the moduli share the one of the data. The first start has the powers 2, -2, 5, 1.
fn ogden_start(terms: usize, k: usize, random: &mut Random) -> (Vec<f64>, Vec<f64>) {
    let (mut x, mut signs) = (Vec::new(), Vec::new());
    for n in 0..terms {
        let (share, size, sign): (f64, f64, f64) = if k == 0 {
            ([0.9, 0.05, 0.02, 0.02][n], [2.0, 2.0, 5.0, 1.0][n], [1.0, -1.0, 1.0, 1.0][n])
        } else {
            (
                f64::exp(-6.0 * random.unit()),
                0.5 * 20f64.powf(random.unit()),
                if random.unit() < 0.65 { 1.0 } else { -1.0 },
            )
        };
        x.extend([share.ln(), size.ln()]);
        signs.push(sign);
    }
    (x, signs)
}

/// Soft and stiff fibres, hardly and much dispersed, and for two families at 15, 45 and 75 degrees.
fn fiber_starts(families: usize) -> Vec<(Vec<f64>, Vec<f64>)> {
    let angles: &[Option<f64>] =
        if families < 2 { &[None] } else { &[Some(PI / 12.0), Some(PI / 4.0), Some(5.0 * PI / 12.0)] };
    let mut out = Vec::new();
    for angle in angles {
        for (share, stiffening) in [(-1.0, -1.0), (-2.0, 1.0)] {
            for spread in [0.6, 1.8] {
                out.push(([-0.5, share, stiffening, spread].into_iter().chain(*angle).collect(), vec![]));
            }
        }
    }
    out
}

/// 0 (all fibres along one direction) to 1/3 (isotropic).
fn dispersion(x: f64) -> f64 {
    (1.0 - x.cos()) / 6.0
}

/// The angle between 0 and a quarter turn of the families at `x` and `-x`.
fn acute(x: f64) -> f64 {
    let turned = x.rem_euclid(PI);
    if turned > FRAC_PI_2 { PI - turned } else { turned }
}
