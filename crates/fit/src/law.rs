use std::fmt;
use std::sync::Arc;

use nastic_energy::catalogue::{
    FitForm, FitStarts, FitVolume, Free, Inputs, MaterialRow, NetworkShape, Takes, materials,
};
use nastic_energy::network::Network;
use nastic_energy::{EnergyError, EnergyTerm, MaterialPoint, NeoHookeIsochoric};
use nastic_tensor::Vec3;

use crate::FitError;

/// A law whose parameters can be fitted, as its row in the catalogue says: those of its shape, and the bulk modulus apart. Fibres lie in the plane
/// of axes 1 and 2, along axis 1 or at equal angles to it.
#[derive(Clone, Copy)]
pub struct Law {
    row: &'static MaterialRow,
    pub(crate) form: &'static FitForm,
}

impl PartialEq for Law {
    fn eq(&self, other: &Self) -> bool {
        (self.name(), self.form.suffix) == (other.name(), other.form.suffix)
    }
}

impl fmt::Debug for Law {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(&self.label())
    }
}

/// A parameter of a `materials` block.
#[derive(Clone, Debug, PartialEq)]
pub enum Entry {
    /// A number.
    Number {
        /// It.
        value: f64,
        /// `"Pa"`, `"1"` of a pure number.
        unit: &'static str,
    },
    /// A unit vector.
    Direction([f64; 3]),
    /// A network.
    Network(Network),
}

/// What a law needs to know of the data: a modulus, and the largest `I1 - 3`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Scale {
    pub shear: f64,
    pub reach: f64,
}

const HERE: MaterialPoint = MaterialPoint { cell: 0, point: 0 };
/// At constant volume, in shear moduli.
const BULK: f64 = 1e3;

/// The neo-Hookean law of shear modulus 1 Pa for tests at constant volume.
pub(crate) fn unit_law() -> Result<NeoHookeIsochoric, EnergyError> {
    NeoHookeIsochoric::from_shear_bulk(1.0, BULK)
}

impl Law {
    /// Those of rows of a catalogue, the isotropic ones first.
    pub fn among(rows: impl IntoIterator<Item = &'static MaterialRow>) -> Vec<Law> {
        let laws = rows.into_iter().flat_map(|row| row.fit.iter().map(move |form| Law { row, form }));
        let (fibres, mut out): (Vec<Law>, Vec<Law>) = laws.partition(|law| law.has_fibers());
        out.extend(fibres);
        out
    }

    /// Those of the built-in laws.
    pub fn all() -> Vec<Law> {
        Self::among(materials())
    }

    /// The built-in one of a [`label`](Self::label).
    ///
    /// # Errors
    /// [`FitError::Unknown`] lists them.
    pub fn named(label: &str) -> Result<Law, FitError> {
        let known = || Self::all().into_iter().map(Law::label).collect::<Vec<_>>().join(", ");
        let found = Self::all().into_iter().find(|law| law.label() == label);
        found.ok_or_else(|| FitError::Unknown { found: label.to_owned(), known: known() })
    }

    /// Whether it has fibres: its response depends on the direction.
    pub fn has_fibers(self) -> bool {
        self.form.families > 0
    }

    /// Whether it is compared with others only where it is named.
    pub fn is_named_only(self) -> bool {
        self.form.named_only
    }

    /// Its name in case files.
    pub fn name(self) -> &'static str {
        self.row.name
    }

    /// Its name with the number of terms or families.
    pub fn label(self) -> String {
        format!("{}{}", self.row.name, self.form.suffix)
    }

    /// The parameters that a fit finds, by their names in case files (`fiber_angle` stands for two directions there: [`entries`](Self::entries)).
    pub fn parameters(self) -> Vec<&'static str> {
        self.form.numbers.iter().map(|number| number.name).collect()
    }

    /// The unit of a parameter: `"Pa"`, `"deg"` of an angle, `"1"` of pure numbers.
    pub fn unit(self, name: &str) -> &'static str {
        let own = self.form.numbers.iter().find(|number| self.form.network.is_some() && number.name == name);
        if let Some(number) = own {
            return if matches!(number.free, Free::Square { .. }) { "Pa" } else { "1" };
        }
        let of = |known: &Takes| if let Takes::Number { unit, .. } = known { Some(*unit) } else { None };
        let found = self.row.parameters().into_iter().find(|known| known.name == name);
        found.and_then(|known| of(&known.takes)).unwrap_or("deg")
    }

    /// Whether the value of its volumetric key depends on its other parameters.
    pub fn has_own_volume(self) -> bool {
        self.form.volume.least.is_some()
    }

    fn number(self, key: &'static str, value: f64) -> (&'static str, Entry) {
        (key, Entry::Number { value, unit: self.unit(key) })
    }

    /// The parameters of shape as a `materials` block has them: an angle of fibres becomes their directions.
    ///
    /// # Errors
    /// [`FitError::Parameters`] for too few or too many.
    pub fn entries(self, parameters: &[f64]) -> Result<Vec<(&'static str, Entry)>, FitError> {
        self.check(parameters)?;
        if let Some(shape) = self.form.network {
            let (network, scale) = shape.network(parameters);
            return Ok(vec![("network", Entry::Network(network)), self.number("scale", scale)]);
        }
        let numbers = self.form.numbers.iter().zip(parameters).map(|(number, value)| self.number(number.name, *value));
        let mut out: Vec<(&'static str, Entry)> = numbers.collect();
        match (self.form.families, parameters.last()) {
            (2, Some(angle)) => {
                let (sin, cos) = angle.to_radians().sin_cos();
                out.pop();
                out.push(("fiber", Entry::Direction([cos, sin, 0.0])));
                out.push(("fiber2", Entry::Direction([cos, -sin, 0.0])));
            }
            (1, _) => out.push(("fiber", Entry::Direction([1.0, 0.0, 0.0]))),
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
        let FitVolume { key, value, least } = self.form.volume;
        let value = value(parameters, bulk);
        if let Some(least) = least.filter(|_| value < 0.0) {
            return Err(FitError::SmallBulk { law: self.label(), bulk, least: least(parameters) });
        }
        out.push(self.number(key, value));
        Ok(out)
    }

    /// The law with these parameters and this bulk modulus (Pa).
    ///
    /// # Errors
    /// [`FitError::Parameters`] for too few or too many; [`FitError::Energy`], which names the parameter that the law refuses.
    pub fn build(self, parameters: &[f64], bulk: f64) -> Result<Arc<dyn EnergyTerm>, FitError> {
        let inputs =
            self.block(parameters, bulk)?.into_iter().fold(Inputs::new(), |inputs, (name, entry)| match entry {
                Entry::Number { value, .. } => inputs.number(name, value),
                Entry::Direction(along) => inputs.direction(name, Vec3::from(along)),
                Entry::Network(network) => inputs.network(name, network),
            });
        Ok(self.row.build(&inputs)?)
    }

    /// The law for tests at constant volume, where the bulk modulus takes no part: with one far above the shear moduli.
    ///
    /// # Errors
    /// As [`build`](Self::build).
    pub fn incompressible(self, parameters: &[f64]) -> Result<Arc<dyn EnergyTerm>, FitError> {
        let shear = self.shear(parameters)?;
        let stiffest = self.form.along.map_or(shear, |along| shear + along(parameters));
        self.build(parameters, BULK * stiffest)
    }

    /// Shear modulus at rest (Pa), across the fibres of a law that is not isotropic there.
    ///
    /// # Errors
    /// As [`build`](Self::build).
    pub fn shear(self, p: &[f64]) -> Result<f64, FitError> {
        self.check(p)?;
        if let Some(shape) = self.form.network {
            return Ok(shape.network(p).1);
        }
        Ok(match self.form.shear {
            Some(shear) => shear(p),
            None => self.build(p, BULK * p[0])?.moduli(HERE).map_or(p[0], |m| m.mu_t),
        })
    }

    /// Whether it is isotropic at rest, where Poisson's ratio is then one number: fibres of `holzapfel_gasser_ogden` begin to bear with their stretch.
    pub fn is_isotropic_at_rest(self) -> bool {
        self.form.along.is_none()
    }

    /// The shape of a network.
    pub(crate) fn network(self) -> Option<NetworkShape> {
        self.form.network
    }

    /// Whether it is a network, of which nothing is known in shapes of other kinds than those of the data.
    pub fn is_network(self) -> bool {
        self.form.network.is_some()
    }

    /// Whether its numbers are terms of a modulus and a power, whose order means nothing.
    pub(crate) fn has_terms(self) -> bool {
        matches!(self.form.starts, FitStarts::Powers)
    }

    fn check(self, parameters: &[f64]) -> Result<(), FitError> {
        let (expected, found) = (self.form.numbers.len(), parameters.len());
        if found == expected { Ok(()) } else { Err(FitError::Parameters { law: self.label(), expected, found }) }
    }
}
