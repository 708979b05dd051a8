//! Numbers for people.

use crate::quantity::{Dimension, Units};

pub use nastic_numeric::format::short;

/// (x, y, z)
pub fn vector(values: &[f64]) -> String {
    format!("({})", values.iter().map(|x| short(*x)).collect::<Vec<_>>().join(", "))
}

/// A value with its unit, and in SI where that is another number.
pub fn quantity(value: f64, dimension: Dimension, units: &Units) -> String {
    if dimension.is_none() {
        return short(value);
    }
    if dimension == Dimension::DENSITY {
        return format!("{} kg/m^3", short(units.in_si(value, dimension)));
    }
    let (own, si) = (units.label(dimension), Units::default().label(dimension));
    if own == si {
        format!("{} {own}", short(value))
    } else {
        format!("{} {own} = {} {si}", short(value), short(units.in_si(value, dimension)))
    }
}

/// 1,234,567
pub fn grouped(count: usize) -> String {
    let digits = count.to_string();
    let mut out = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            out.push(',');
        }
        out.push(digit);
    }
    out
}

/// "1 cell", "3 cells"
pub fn count(n: usize, what: &str) -> String {
    format!("{} {what}{}", grouped(n), if n == 1 { "" } else { "s" })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_well() {
        assert_eq!(short(1e5), "100000");
        assert_eq!(short(0.1 + 0.2), "0.3");
        assert_eq!(short(-1.5e-7), "-1.5e-07");
        assert_eq!(short(-0.0), "0");
        assert_eq!(short(2e9), "2e+09");
        assert_eq!(short(f64::NEG_INFINITY), "-inf");
        assert_eq!(grouped(1234567), "1,234,567");
        assert_eq!(quantity(3e4, Dimension::PRESSURE, &Units::default()), "30000 Pa");
    }
}
