//! Physical dimensions of numbers.

use crate::quantity::UNITS;
use std::fmt;

/// Exponents over (length, force, time, field, temperature), as multiples of 1/60, so that roots stay exact.
///
/// Force stands where SI has mass: a mass is force * time^2 / length. The field is a magnetic flux density, kept apart
/// because nothing mechanical converts into it. A temperature is a difference of temperatures: none has an offset.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Dimension([i32; 5]);

const STEPS: i32 = 60;

impl Dimension {
    /// A plain number.
    pub const NONE: Self = Self::of(0, 0, 0, 0);
    /// m
    pub const LENGTH: Self = Self::of(1, 0, 0, 0);
    /// N
    pub const FORCE: Self = Self::of(0, 1, 0, 0);
    /// s
    pub const TIME: Self = Self::of(0, 0, 1, 0);
    /// T
    pub const FIELD: Self = Self::of(0, 0, 0, 1);
    /// K, a difference
    pub const TEMPERATURE: Self = Self([0, 0, 0, 0, STEPS]);
    /// 1/K
    pub const EXPANSION: Self = Self([0, 0, 0, 0, -STEPS]);
    /// Pa = N/m^2
    pub const PRESSURE: Self = Self::of(-2, 1, 0, 0);
    /// N/m
    pub const STIFFNESS: Self = Self::of(-1, 1, 0, 0);
    /// kg = N s^2/m
    pub const MASS: Self = Self::of(-1, 1, 2, 0);
    /// N/m^3
    pub const BODY_FORCE: Self = Self::of(-3, 1, 0, 0);
    /// kg/m^3 = N s^2/m^4
    pub const DENSITY: Self = Self::of(-4, 1, 2, 0);
    /// m/s
    pub const VELOCITY: Self = Self::of(1, 0, -1, 0);
    /// m/s^2
    pub const ACCELERATION: Self = Self::of(1, 0, -2, 0);
    /// Pa s
    pub const VISCOSITY: Self = Self::of(-2, 1, 1, 0);
    /// 1/s
    pub const RATE: Self = Self::of(0, 0, -1, 0);
    /// A = N/(T m)
    pub const CURRENT: Self = Self::of(-1, 1, 0, -1);
    /// V = W/A = T m^2/s
    pub const VOLTAGE: Self = Self::of(2, 0, -1, 1);
    /// C = A s
    pub const CHARGE: Self = Self::of(-1, 1, 1, -1);
    /// F = A s/V
    pub const CAPACITANCE: Self = Self::of(-3, 1, 2, -2);
    /// V/m
    pub const ELECTRIC_FIELD: Self = Self::of(1, 0, -1, 1);
    /// F/m = N/V^2
    pub const PERMITTIVITY: Self = Self::of(-4, 1, 2, -2);
    /// T^2/Pa = N/A^2, the vacuum permeability's
    pub const PERMEABILITY: Self = Self::of(2, -1, 0, 2);

    /// length^l force^f time^t field^b
    #[must_use]
    pub const fn of(length: i32, force: i32, time: i32, field: i32) -> Self {
        Self([length * STEPS, force * STEPS, time * STEPS, field * STEPS, 0])
    }

    /// True for a plain number.
    #[must_use]
    pub fn is_none(self) -> bool {
        self == Self::NONE
    }

    /// The dimension of a product; `None` when an exponent leaves every sensible range.
    #[must_use]
    pub fn times(self, other: Self) -> Option<Self> {
        self.combine(other, 1)
    }

    /// The dimension of a quotient; `None` as for [`Self::times`].
    #[must_use]
    pub fn over(self, other: Self) -> Option<Self> {
        self.combine(other, -1)
    }

    /// The dimension of a power; `None` when an exponent is no multiple of 1/60 or leaves every sensible range.
    #[must_use]
    pub fn power(self, exponent: f64) -> Option<Self> {
        let mut out = [0; 5];
        for (entry, own) in out.iter_mut().zip(self.0) {
            let wanted = f64::from(own) * exponent;
            let near = wanted.round();
            if !((wanted - near).abs() < 1e-6 && near.abs() < 1e6) {
                return None;
            }
            *entry = near as i32;
        }
        Some(Self(out))
    }

    /// Whole exponents over (length, force, time, field, temperature); `None` if one is a fraction.
    #[must_use]
    pub fn exponents(self) -> Option<[i32; 5]> {
        self.0.iter().all(|e| e % STEPS == 0).then(|| self.0.map(|e| e / STEPS))
    }

    /// The units a reader of an error message may choose from: "Pa, kPa, MPa, GPa, bar, mbar".
    #[must_use]
    pub fn examples(self) -> String {
        let compound = [
            (Self::DENSITY, "kg/m^3"),
            (Self::VELOCITY, "m/s, mm/s"),
            (Self::ACCELERATION, "m/s^2"),
            (Self::VISCOSITY, "Pa*s"),
            (Self::RATE, "1/s"),
            (Self::EXPANSION, "1/K"),
        ];
        let symbols: Vec<_> = UNITS.iter().filter(|u| u.dimension == self).map(|u| u.symbol).collect();
        match compound.iter().find(|(dimension, _)| *dimension == self) {
            Some((_, examples)) => (*examples).to_string(),
            None if symbols.is_empty() => self.in_si(),
            None => symbols.join(", "),
        }
    }

    fn combine(self, other: Self, sign: i32) -> Option<Self> {
        let mut out = self.0;
        for (entry, theirs) in out.iter_mut().zip(other.0) {
            *entry = entry.checked_add(sign * theirs).filter(|e| e.abs() < 1_000_000)?;
        }
        Some(Self(out))
    }

    fn in_si(self) -> String {
        let mut above = Vec::new();
        let mut below = Vec::new();
        for (symbol, e) in ["m", "N", "s", "T", "K"].iter().zip(self.0) {
            let text = |e: i32| match (e / STEPS, e % STEPS) {
                (1, 0) => (*symbol).to_string(),
                (n, 0) => format!("{symbol}^{n}"),
                _ => format!("{symbol}^{}", f64::from(e) / f64::from(STEPS)),
            };
            match e.signum() {
                1 => above.push(text(e)),
                -1 => below.push(text(-e)),
                _ => {}
            }
        }
        let above = if above.is_empty() { "1".to_string() } else { above.join("*") };
        below.iter().fold(above, |text, unit| format!("{text}/{unit}"))
    }
}

/// With its article: "a pressure", "a plain number", "a quantity in N/m".
impl fmt::Display for Dimension {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let known = [
            (Self::NONE, "a plain number"),
            (Self::LENGTH, "a length"),
            (Self::FORCE, "a force"),
            (Self::TIME, "a time"),
            (Self::FIELD, "a magnetic field"),
            (Self::PRESSURE, "a pressure"),
            (Self::MASS, "a mass"),
            (Self::CURRENT, "an electric current"),
            (Self::BODY_FORCE, "a force per volume"),
            (Self::DENSITY, "a density"),
            (Self::VELOCITY, "a velocity"),
            (Self::ACCELERATION, "an acceleration"),
            (Self::VISCOSITY, "a viscosity"),
            (Self::RATE, "a rate (1 over a time)"),
            (Self::of(2, 0, 0, 0), "an area"),
            (Self::of(3, 0, 0, 0), "a volume"),
            (Self::of(-1, 0, 0, 0), "a curvature (1 over a length)"),
            (Self::PERMEABILITY, "a magnetic permeability"),
            (Self::VOLTAGE, "an electric voltage"),
            (Self::CHARGE, "an electric charge"),
            (Self::CAPACITANCE, "an electric capacitance"),
            (Self::ELECTRIC_FIELD, "an electric field"),
            (Self::PERMITTIVITY, "an electric permittivity"),
            (Self::TEMPERATURE, "a temperature difference"),
            (Self::EXPANSION, "a thermal expansion (1 over a temperature)"),
        ];
        match known.iter().find(|(dimension, _)| dimension == self) {
            Some((_, name)) => f.write_str(name),
            None => write!(f, "a quantity in {}", self.in_si()),
        }
    }
}
