//! The unit suffixes.

use crate::quantity::Dimension;

/// One suffix: its value is 10^`exponent` in SI. Every unit is a power of ten, so conversions round once.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Unit {
    /// As written in a case.
    pub symbol: &'static str,
    /// What it measures.
    pub dimension: Dimension,
    /// Power of ten relative to SI.
    pub exponent: i32,
}

impl Unit {
    /// m
    pub const METRE: Self = Self::new("m", Dimension::LENGTH, 0);
    /// N
    pub const NEWTON: Self = Self::new("N", Dimension::FORCE, 0);
    /// s
    pub const SECOND: Self = Self::new("s", Dimension::TIME, 0);
    /// T
    pub const TESLA: Self = Self::new("T", Dimension::FIELD, 0);
    /// K, of differences: one degree Celsius is one too
    pub const KELVIN: Self = Self::new("K", Dimension::TEMPERATURE, 0);

    const fn new(symbol: &'static str, dimension: Dimension, exponent: i32) -> Self {
        Self { symbol, dimension, exponent }
    }

    /// The unit written so; the micro sign may be "u" or "µ".
    #[must_use]
    pub fn named(symbol: &str) -> Option<Self> {
        let plain = symbol.replace(['\u{b5}', '\u{3bc}'], "u");
        UNITS.iter().find(|unit| unit.symbol == plain).copied()
    }
}

/// All suffixes, in the order error messages list them.
pub const UNITS: &[Unit] = &[
    Unit::METRE,
    Unit::new("mm", Dimension::LENGTH, -3),
    Unit::new("um", Dimension::LENGTH, -6),
    Unit::new("cm", Dimension::LENGTH, -2),
    Unit::new("km", Dimension::LENGTH, 3),
    Unit::NEWTON,
    Unit::new("mN", Dimension::FORCE, -3),
    Unit::new("kN", Dimension::FORCE, 3),
    Unit::new("Pa", Dimension::PRESSURE, 0),
    Unit::new("kPa", Dimension::PRESSURE, 3),
    Unit::new("MPa", Dimension::PRESSURE, 6),
    Unit::new("GPa", Dimension::PRESSURE, 9),
    Unit::new("bar", Dimension::PRESSURE, 5),
    Unit::new("mbar", Dimension::PRESSURE, 2),
    Unit::TESLA,
    Unit::new("mT", Dimension::FIELD, -3),
    Unit::new("uT", Dimension::FIELD, -6),
    Unit::new("A", Dimension::CURRENT, 0),
    Unit::new("V", Dimension::VOLTAGE, 0),
    Unit::new("kV", Dimension::VOLTAGE, 3),
    Unit::new("MV", Dimension::VOLTAGE, 6),
    Unit::new("V/m", Dimension::ELECTRIC_FIELD, 0),
    Unit::new("mV/m", Dimension::ELECTRIC_FIELD, -3),
    Unit::new("uC", Dimension::CHARGE, -6),
    Unit::new("nC", Dimension::CHARGE, -9),
    Unit::new("pC", Dimension::CHARGE, -12),
    Unit::new("F", Dimension::CAPACITANCE, 0),
    Unit::new("kg", Dimension::MASS, 0),
    Unit::new("g", Dimension::MASS, -3),
    Unit::SECOND,
    Unit::new("ms", Dimension::TIME, -3),
    Unit::KELVIN,
];
