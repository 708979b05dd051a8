use std::sync::Arc;

use nastic_energy::catalogue::{Inputs, material};
use nastic_energy::{EnergyTerm, Place};
use nastic_numeric::Random;

use crate::FitError;

/// An isotropic law whose parameters can be fitted: those of its shape, and the bulk modulus apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Law {
    /// `neo_hooke`: `shear`.
    NeoHooke,
    /// `neo_hooke_isochoric`: `shear`.
    NeoHookeIsochoric,
    /// `mooney_rivlin`: `c10`, `c01`.
    MooneyRivlin,
    /// `yeoh`: `c10`, `c20`, `c30`.
    Yeoh,
    /// `gent`: `mu`, `jm`.
    Gent,
    /// `arruda_boyce`: `mu`, `lambda_m`.
    ArrudaBoyce,
    /// `ogden` of one to four terms: `mu1`, `alpha1`, ..
    Ogden(usize),
}

/// What a law needs to know of the data: a modulus, and the largest `I1 - 3`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Scale {
    pub shear: f64,
    pub reach: f64,
}

const OGDEN: [&str; 8] = ["mu1", "alpha1", "mu2", "alpha2", "mu3", "alpha3", "mu4", "alpha4"];
/// Share of a border that printed digits do not pass.
const INSIDE: f64 = 1.0 - 1e-9;
const HERE: Place = Place { cell: 0, point: 0 };

impl Law {
    /// All of them, Ogden's with one to three terms.
    pub const ALL: [Law; 9] = [
        Law::NeoHooke,
        Law::NeoHookeIsochoric,
        Law::MooneyRivlin,
        Law::Yeoh,
        Law::Gent,
        Law::ArrudaBoyce,
        Law::Ogden(1),
        Law::Ogden(2),
        Law::Ogden(3),
    ];

    /// Its name in case files.
    pub fn name(self) -> &'static str {
        match self {
            Law::NeoHooke => "neo_hooke",
            Law::NeoHookeIsochoric => "neo_hooke_isochoric",
            Law::MooneyRivlin => "mooney_rivlin",
            Law::Yeoh => "yeoh",
            Law::Gent => "gent",
            Law::ArrudaBoyce => "arruda_boyce",
            Law::Ogden(_) => "ogden",
        }
    }

    /// Its name with the number of terms.
    pub fn label(self) -> String {
        match self {
            Law::Ogden(terms) => format!("ogden_{terms}"),
            other => other.name().to_owned(),
        }
    }

    /// The parameters that a fit finds, by their names in case files.
    pub fn parameters(self) -> &'static [&'static str] {
        match self {
            Law::NeoHooke | Law::NeoHookeIsochoric => &["shear"],
            Law::MooneyRivlin => &["c10", "c01"],
            Law::Yeoh => &["c10", "c20", "c30"],
            Law::Gent => &["mu", "jm"],
            Law::ArrudaBoyce => &["mu", "lambda_m"],
            Law::Ogden(terms) => &OGDEN[..2 * terms.clamp(1, 4)],
        }
    }

    /// Whether a parameter is a pressure; the others are pure numbers.
    pub fn is_pressure(name: &str) -> bool {
        !(name == "jm" || name == "lambda_m" || name.starts_with("alpha"))
    }

    /// The key of the volumetric part, and its value for a bulk modulus (Pa).
    pub fn volumetric(self, bulk: f64) -> (&'static str, f64) {
        if self == Law::MooneyRivlin { ("d1", 2.0 / bulk) } else { ("bulk", bulk) }
    }

    /// The law with these parameters and this bulk modulus (Pa).
    ///
    /// # Errors
    /// [`FitError::Parameters`] for too few or too many; [`FitError::Energy`], which names the parameter that the law refuses.
    pub fn build(self, parameters: &[f64], bulk: f64) -> Result<Arc<dyn EnergyTerm>, FitError> {
        self.check(parameters)?;
        let (key, value) = self.volumetric(bulk);
        let named = self.parameters().iter().zip(parameters);
        let inputs = named.fold(Inputs::new().number(key, value), |inputs, (name, value)| inputs.number(name, *value));
        Ok(material(self.name())?.build(&inputs)?)
    }

    /// The law for tests at constant volume, where the bulk modulus takes no part: with one far above the shear modulus.
    ///
    /// # Errors
    /// As [`build`](Self::build).
    pub fn incompressible(self, parameters: &[f64]) -> Result<Arc<dyn EnergyTerm>, FitError> {
        self.build(parameters, 1e3 * self.shear(parameters)?)
    }

    /// Shear modulus at rest (Pa).
    ///
    /// # Errors
    /// As [`build`](Self::build).
    pub fn shear(self, p: &[f64]) -> Result<f64, FitError> {
        self.check(p)?;
        Ok(match self {
            Law::NeoHooke | Law::NeoHookeIsochoric | Law::Gent => p[0],
            Law::MooneyRivlin => 2.0 * (p[0] + p[1]),
            Law::Yeoh => 2.0 * p[0],
            Law::ArrudaBoyce => self.build(p, 1e3 * p[0])?.moduli(HERE).map_or(p[0], |m| m.mu_t),
            Law::Ogden(_) => p.chunks_exact(2).map(|pair| 0.5 * pair[0] * pair[1]).sum(),
        })
    }

    fn check(self, parameters: &[f64]) -> Result<(), FitError> {
        let (expected, found) = (self.parameters().len(), parameters.len());
        if found == expected { Ok(()) } else { Err(FitError::Parameters { law: self.label(), expected, found }) }
    }

    /// Free numbers to admissible parameters, smoothly: moduli that must be positive by `exp`, those that may vanish by squares, and
    /// `c20 = x^2 - sqrt(3 c10 c30)`, `jm > reach`, `lambda_m > 1`, `mu = 2 g / alpha` with g > 0 and alpha of a given sign (that of `signs`).
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
        }
    }

    /// Which free numbers are at an end of their parameter's range: squares that vanish, exponentials that do.
    pub(crate) fn on_border(self, x: &[f64]) -> Vec<bool> {
        let square = |k: usize| matches!((self, k), (Law::MooneyRivlin, 1) | (Law::Yeoh, 1 | 2));
        let vanishes = |(k, x): (usize, &f64)| if square(k) { x.abs() < 1e-2 } else { *x < -20.0 };
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
