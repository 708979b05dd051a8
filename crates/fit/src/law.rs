use std::sync::Arc;

use nastic_energy::catalogue::{Inputs, material};
use nastic_energy::{EnergyTerm, Place};
use nastic_tensor::Vec3;

use crate::FitError;

/// A law whose parameters can be fitted: those of its shape, and the bulk modulus apart. Fibres lie in the plane of axes 1 and 2, along axis 1 or
/// at equal angles to it.
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
    /// `transverse_mooney_rivlin`: `mu1`, `mu2`, `mu3`; fibres along axis 1.
    TransverseMooneyRivlin,
    /// `holzapfel_gasser_ogden` of one family along axis 1 (`mu`, `k1`, `k2`, `dispersion`), or of two at plus and minus `fiber_angle` (degrees).
    HolzapfelGasserOgden(usize),
}

/// A parameter of a `materials` block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Entry {
    /// A number in the unit of [`Law::unit`].
    Number(f64),
    /// A unit vector.
    Direction([f64; 3]),
}

/// What a law needs to know of the data: a modulus, and the largest `I1 - 3`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Scale {
    pub shear: f64,
    pub reach: f64,
}

const OGDEN: [&str; 8] = ["mu1", "alpha1", "mu2", "alpha2", "mu3", "alpha3", "mu4", "alpha4"];
const FIBERS: [&str; 5] = ["mu", "k1", "k2", "dispersion", "fiber_angle"];
const HERE: Place = Place { cell: 0, point: 0 };

impl Law {
    /// The isotropic ones, Ogden's with one to three terms.
    pub const ISOTROPIC: [Law; 9] = [
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

    /// Those with fibres.
    pub const WITH_FIBERS: [Law; 3] =
        [Law::TransverseMooneyRivlin, Law::HolzapfelGasserOgden(1), Law::HolzapfelGasserOgden(2)];

    /// Whether it has fibres: its response depends on the direction.
    pub fn has_fibers(self) -> bool {
        matches!(self, Law::TransverseMooneyRivlin | Law::HolzapfelGasserOgden(_))
    }

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
            Law::TransverseMooneyRivlin => "transverse_mooney_rivlin",
            Law::HolzapfelGasserOgden(_) => "holzapfel_gasser_ogden",
        }
    }

    /// Its name with the number of terms or families.
    pub fn label(self) -> String {
        match self {
            Law::Ogden(terms) => format!("ogden_{terms}"),
            Law::HolzapfelGasserOgden(families) => format!("holzapfel_gasser_ogden_{families}"),
            other => other.name().to_owned(),
        }
    }

    /// The parameters that a fit finds, by their names in case files (`fiber_angle` stands for two directions there: [`entries`](Self::entries)).
    pub fn parameters(self) -> &'static [&'static str] {
        match self {
            Law::NeoHooke | Law::NeoHookeIsochoric => &["shear"],
            Law::MooneyRivlin => &["c10", "c01"],
            Law::Yeoh => &["c10", "c20", "c30"],
            Law::Gent => &["mu", "jm"],
            Law::ArrudaBoyce => &["mu", "lambda_m"],
            Law::Ogden(terms) => &OGDEN[..2 * terms.clamp(1, 4)],
            Law::TransverseMooneyRivlin => &["mu1", "mu2", "mu3"],
            Law::HolzapfelGasserOgden(families) => &FIBERS[..3 + families.clamp(1, 2)],
        }
    }

    /// The unit of a parameter: `"Pa"`, `"deg"`, `"1"` of pure numbers.
    pub fn unit(name: &str) -> &'static str {
        match name {
            "jm" | "lambda_m" | "k2" | "dispersion" => "1",
            "fiber_angle" => "deg",
            _ if name.starts_with("alpha") => "1",
            _ => "Pa",
        }
    }

    /// The key of the volumetric part, and its value for a bulk modulus (Pa).
    fn volumetric(self, p: &[f64], bulk: f64) -> (&'static str, f64) {
        match self {
            Law::MooneyRivlin => ("d1", 2.0 / bulk),
            // K = 4/3 mu1 + 16/3 mu2 + 20/9 mu3 + 2 mu4 at rest
            Law::TransverseMooneyRivlin => {
                ("mu4", 0.5 * bulk - p[0] * 2.0 / 3.0 - p[1] * 8.0 / 3.0 - p[2] * 10.0 / 9.0)
            }
            _ => ("bulk", bulk),
        }
    }

    /// The parameters of shape as a `materials` block has them: an angle of fibres becomes their directions.
    ///
    /// # Errors
    /// [`FitError::Parameters`] for too few or too many.
    pub fn entries(self, parameters: &[f64]) -> Result<Vec<(&'static str, Entry)>, FitError> {
        self.check(parameters)?;
        let named = self.parameters().iter().zip(parameters).filter(|(name, _)| **name != "fiber_angle");
        let mut out: Vec<(&'static str, Entry)> = named.map(|(name, value)| (*name, Entry::Number(*value))).collect();
        match (self, parameters.get(4)) {
            (Law::HolzapfelGasserOgden(2), Some(angle)) => {
                let (sin, cos) = angle.to_radians().sin_cos();
                out.push(("fiber", Entry::Direction([cos, sin, 0.0])));
                out.push(("fiber2", Entry::Direction([cos, -sin, 0.0])));
            }
            _ if self.has_fibers() => out.push(("fiber", Entry::Direction([1.0, 0.0, 0.0]))),
            _ => {}
        }
        Ok(out)
    }

    /// All of a `materials` block but its region and law: [`entries`](Self::entries) and the volumetric part of a bulk modulus (Pa).
    ///
    /// # Errors
    /// As [`entries`](Self::entries); [`FitError::SmallBulk`].
    pub fn block(self, parameters: &[f64], bulk: f64) -> Result<Vec<(&'static str, Entry)>, FitError> {
        let mut out = self.entries(parameters)?;
        let (key, value) = self.volumetric(parameters, bulk);
        if key == "mu4" && value < 0.0 {
            return Err(FitError::SmallBulk { law: self.label(), bulk, least: bulk - 2.0 * value });
        }
        out.push((key, Entry::Number(value)));
        Ok(out)
    }

    /// The law with these parameters and this bulk modulus (Pa).
    ///
    /// # Errors
    /// [`FitError::Parameters`] for too few or too many; [`FitError::Energy`], which names the parameter that the law refuses.
    pub fn build(self, parameters: &[f64], bulk: f64) -> Result<Arc<dyn EnergyTerm>, FitError> {
        let inputs =
            self.block(parameters, bulk)?.into_iter().fold(Inputs::new(), |inputs, (name, entry)| match entry {
                Entry::Number(value) => inputs.number(name, value),
                Entry::Direction(along) => inputs.direction(name, Vec3::from(along)),
            });
        Ok(material(self.name())?.build(&inputs)?)
    }

    /// The law for tests at constant volume, where the bulk modulus takes no part: with one far above the shear moduli.
    ///
    /// # Errors
    /// As [`build`](Self::build).
    pub fn incompressible(self, parameters: &[f64]) -> Result<Arc<dyn EnergyTerm>, FitError> {
        let stiffest = match self {
            Law::TransverseMooneyRivlin => self.shear(parameters)? + 2.0 * parameters[2],
            _ => self.shear(parameters)?,
        };
        self.build(parameters, 1e3 * stiffest)
    }

    /// Shear modulus at rest (Pa), across the fibres of a law that is not isotropic there.
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
            Law::TransverseMooneyRivlin => 2.0 * (p[0] + p[1]),
            Law::HolzapfelGasserOgden(_) => p[0],
        })
    }

    /// Whether it is isotropic at rest, where Poisson's ratio is then one number: fibres of `holzapfel_gasser_ogden` begin to bear with their stretch.
    pub fn is_isotropic_at_rest(self) -> bool {
        self != Law::TransverseMooneyRivlin
    }

    fn check(self, parameters: &[f64]) -> Result<(), FitError> {
        let (expected, found) = (self.parameters().len(), parameters.len());
        if found == expected { Ok(()) } else { Err(FitError::Parameters { law: self.label(), expected, found }) }
    }
}
