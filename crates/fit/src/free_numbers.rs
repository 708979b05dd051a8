//! Free numbers of the laws: what the method of least squares moves, taken smoothly to admissible parameters.

use std::f64::consts::{FRAC_PI_2, PI};

use nastic_energy::catalogue::{FitNumber, FitStarts, Free};
use nastic_numeric::Random;

use crate::Law;
use crate::law::Scale;

impl Law {
    /// Free numbers to admissible parameters; `signs` are those of powers.
    pub(crate) fn decode(self, x: &[f64], scale: &Scale, signs: &[f64]) -> Vec<f64> {
        let Scale { shear, reach } = *scale;
        let mut signs = signs.iter();
        let value = |(number, &x): (&FitNumber, &f64)| match number.free {
            Free::Modulus { factor } => factor * shear * x.exp(),
            Free::Square { factor, power } => factor * shear / reach.powi(power) * x * x,
            Free::Above { reach: false } => 1.0 + x.exp(),
            Free::Above { reach: true } => reach * (1.0 + x.exp()),
            Free::PerReach => x.exp() / (reach * reach),
            Free::Weight { power } => x * x / reach.powi(power),
            Free::Any => x,
            Free::Power => signs.next().map_or(1.0, |sign| *sign) * x.exp(),
            Free::Dispersion => dispersion(x),
            Free::Angle => acute(x).to_degrees(),
        };
        let mut out: Vec<f64> = self.form.numbers.iter().zip(x).map(value).collect();
        if let Some(couple) = self.form.couple.filter(|_| out.len() == self.form.numbers.len()) {
            couple(&mut out);
        }
        out
    }

    /// The derivative of a number of a network by its free number.
    pub(crate) fn weight_slope(self, k: usize, x: f64, scale: &Scale) -> f64 {
        let Scale { shear, reach } = *scale;
        match self.form.numbers[k].free {
            Free::Square { factor, power } => 2.0 * factor * shear / reach.powi(power) * x,
            Free::Weight { power } => 2.0 * x / reach.powi(power),
            _ => 1.0,
        }
    }

    /// Which free numbers are at an end of their parameter's range: squares that vanish, exponentials that do.
    pub(crate) fn on_border(self, x: &[f64]) -> Vec<bool> {
        let vanishes = |(number, x): (&FitNumber, &f64)| match number.free {
            Free::Square { .. } | Free::Weight { .. } => x.abs() < 1e-2,
            Free::Any => false,
            Free::Dispersion => x.sin().abs() < 1e-2,
            Free::Angle => (2.0 * x).sin().abs() < 1e-2,
            Free::Modulus { .. } | Free::Above { .. } | Free::PerReach | Free::Power => *x < -20.0,
        };
        self.form.numbers.iter().zip(x).map(vanishes).collect()
    }

    /// Whether a free number is a square, above the least value of a parameter.
    pub(crate) fn has_least(self, k: usize) -> bool {
        self.form.numbers.get(k).is_some_and(|number| matches!(number.free, Free::Square { .. }))
    }

    /// Where to begin: free numbers, and the signs of powers.
    pub(crate) fn starts(self, random: &mut Random, count: usize) -> Vec<(Vec<f64>, Vec<f64>)> {
        match self.form.starts {
            FitStarts::Random => {
                let start =
                    |random: &mut Random| self.form.numbers.iter().map(|number| drawn(number, random)).collect();
                (0..count.max(1)).map(|_| (start(random), vec![])).collect()
            }
            FitStarts::At(list) => list.iter().map(|x| (x.to_vec(), vec![])).collect(),
            FitStarts::Powers => {
                let terms = self.form.numbers.len() / 2;
                (0..count.max(1)).map(|k| powers_start(terms, k, random)).collect()
            }
        }
    }
}

/// Of a network: weights from a hundredth to ten times what takes an input to 1, arguments of units that begin below zero, energies a share of G R.
fn drawn(number: &FitNumber, random: &mut Random) -> f64 {
    match number.free {
        Free::Any => 1.0 - 6.0 * random.unit(),
        Free::Weight { power: 0 } => random.unit(),
        Free::Weight { .. } => 0.1 * 30f64.powf(random.unit()),
        _ => 0.1 * 10f64.powf(random.unit()),
    }
}

/// Powers of either sign from 0.5 to 10; the moduli share the one of the data. The first start has the powers 2, -2, 5, 1.
fn powers_start(terms: usize, k: usize, random: &mut Random) -> (Vec<f64>, Vec<f64>) {
    let (mut x, mut signs) = (Vec::new(), Vec::new());
    for n in 0..terms {
        let (share, size, sign): (f64, f64, f64) = if k == 0 {
            ([0.9, 0.05, 0.02, 0.02][n % 4], [2.0, 2.0, 5.0, 1.0][n % 4], [1.0, -1.0, 1.0, 1.0][n % 4])
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

/// 0 (all fibres along one direction) to 1/3 (isotropic).
fn dispersion(x: f64) -> f64 {
    (1.0 - x.cos()) / 6.0
}

/// The angle between 0 and a quarter turn of the families at `x` and `-x`.
fn acute(x: f64) -> f64 {
    let turned = x.rem_euclid(PI);
    if turned > FRAC_PI_2 { PI - turned } else { turned }
}
