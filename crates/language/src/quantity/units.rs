//! The consistent system of a case.

use crate::quantity::{Dimension, UNITS, Unit};

/// Vacuum permeability in N/A^2 = T^2/Pa.
const PERMEABILITY_SI: f64 = 1.25663706e-6;

/// Vacuum permittivity in F/m.
const PERMITTIVITY_SI: f64 = nastic_energy::dielectric::VACUUM_PERMITTIVITY;

/// The units of a case's plain numbers, mesh and results. Everything else follows: pressure = force / length^2,
/// mass = force time^2 / length.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Units {
    length: Unit,
    force: Unit,
    time: Unit,
    field: Unit,
}

impl Default for Units {
    fn default() -> Self {
        Self { length: Unit::METRE, force: Unit::NEWTON, time: Unit::SECOND, field: Unit::TESLA }
    }
}

impl Units {
    /// The system with these base units; `None` if one measures something else.
    #[must_use]
    pub fn new(length: Unit, force: Unit, time: Unit, field: Unit) -> Option<Self> {
        let kinds = [length, force, time, field].map(|unit| unit.dimension);
        (kinds == [Dimension::LENGTH, Dimension::FORCE, Dimension::TIME, Dimension::FIELD]).then_some(Self {
            length,
            force,
            time,
            field,
        })
    }

    /// The unit of length: "m".
    #[must_use]
    pub fn length(&self) -> Unit {
        self.length
    }

    /// The unit of force: "N".
    #[must_use]
    pub fn force(&self) -> Unit {
        self.force
    }

    /// The unit of time: "s".
    #[must_use]
    pub fn time(&self) -> Unit {
        self.time
    }

    /// The unit of the magnetic flux density: "T".
    #[must_use]
    pub fn field(&self) -> Unit {
        self.field
    }

    /// Multiplies an SI value into this system: 1 Pa is `in_case(1.0, PRESSURE)`. Rounded once.
    #[must_use]
    pub fn in_case(&self, value: f64, dimension: Dimension) -> f64 {
        self.convert(value, dimension, 0)
    }

    /// The SI value of a number of this system.
    #[must_use]
    pub fn in_si(&self, value: f64, dimension: Dimension) -> f64 {
        match self.decimals(dimension) {
            Some(decimals) => shift(value, decimals),
            None => value / self.in_case(1.0, dimension),
        }
    }

    /// `value` of `unit`^`power` in this system.
    #[must_use]
    pub fn value_of(&self, value: f64, unit: Unit, power: i32) -> f64 {
        match unit.dimension.power(f64::from(power)) {
            Some(dimension) => self.convert(value, dimension, unit.exponent.saturating_mul(power)),
            None => f64::NAN,
        }
    }

    /// Vacuum permeability mu0 in this system, field^2 / pressure (SI: 1.25663706e-6 N/A^2).
    #[must_use]
    pub fn permeability(&self) -> f64 {
        self.in_case(PERMEABILITY_SI, Dimension::PERMEABILITY)
    }

    /// Vacuum permittivity eps0 in this system, force time^2 / (field^2 length^4) (SI: 8.8541878128e-12 F/m).
    #[must_use]
    pub fn permittivity(&self) -> f64 {
        self.in_case(PERMITTIVITY_SI, Dimension::PERMITTIVITY)
    }

    /// How results of this system are labelled: "Pa", "MPa" (N and mm), or "kN/km^2" where no symbol fits.
    #[must_use]
    pub fn label(&self, dimension: Dimension) -> String {
        if dimension.is_none() {
            return "1".to_string();
        }
        let decimals = self.decimals(dimension);
        let fits = |unit: &&Unit| unit.dimension == dimension && Some(unit.exponent) == decimals;
        match UNITS.iter().find(fits) {
            Some(unit) => unit.symbol.to_string(),
            None => self.compose(dimension),
        }
    }

    /// In the order of [`Dimension::exponents`]; temperatures are in kelvin.
    fn bases(&self) -> [Unit; 5] {
        [self.length, self.force, self.time, self.field, Unit::KELVIN]
    }

    fn compose(&self, dimension: Dimension) -> String {
        let Some(exponents) = dimension.exponents() else { return "?".to_string() };
        let bases = self.bases();
        let part = |unit: Unit, e: i32| if e == 1 { unit.symbol.to_string() } else { format!("{}^{e}", unit.symbol) };
        let above: Vec<_> = bases.iter().zip(exponents).filter(|p| p.1 > 0).map(|(u, e)| part(*u, e)).collect();
        let below: Vec<_> = bases.iter().zip(exponents).filter(|p| p.1 < 0).map(|(u, e)| part(*u, -e)).collect();
        let above = if above.is_empty() { "1".to_string() } else { above.join("*") };
        below.iter().fold(above, |text, unit| format!("{text}/{unit}"))
    }

    fn convert(&self, value: f64, dimension: Dimension, extra: i32) -> f64 {
        match self.decimals(dimension) {
            Some(decimals) => shift(value, extra.saturating_sub(decimals)),
            None => f64::NAN,
        }
    }

    /// Powers of ten that one unit of this system is of the SI unit.
    fn decimals(&self, dimension: Dimension) -> Option<i32> {
        let bases = self.bases();
        let exponents = dimension.exponents()?;
        Some(bases.iter().zip(exponents).map(|(unit, e)| unit.exponent.saturating_mul(e)).sum())
    }
}

/// value * 10^decimals. Dividing by 10^n is exact where multiplying by an inexact 10^-n is not: 30 mm is 0.03 m.
fn shift(value: f64, decimals: i32) -> f64 {
    if decimals >= 0 { value * 10f64.powi(decimals) } else { value / 10f64.powi(decimals.saturating_neg()) }
}
