//! Numbers for people.

/// Five significant digits, with an exponent only where that reads better.
pub(crate) fn short(value: f64) -> String {
    let rounded: f64 = format!("{value:.4e}").parse().unwrap_or(value);
    if rounded == 0.0 {
        "0".to_owned()
    } else if (1e-3..1e6).contains(&rounded.abs()) || !rounded.is_finite() {
        format!("{rounded}")
    } else {
        let text = format!("{rounded:.4e}");
        match text.split_once('e') {
            Some((mantissa, exponent)) => {
                format!("{}e{exponent}", mantissa.trim_end_matches('0').trim_end_matches('.'))
            }
            None => text,
        }
    }
}

/// A number of a result with its unit; a dash where there is none.
pub(crate) fn number(value: impl Into<Option<f64>>, unit: &str) -> String {
    match value.into() {
        Some(x) if unit.is_empty() => short(x),
        Some(x) => format!("{} {unit}", short(x)),
        None => "–".to_owned(),
    }
}

/// A length in millimetres, whatever the case's unit is.
pub(crate) fn millimetres(value: f64, unit: &str) -> String {
    let factor = match unit {
        "m" => 1e3,
        "cm" => 10.0,
        "mm" => 1.0,
        "um" => 1e-3,
        "km" => 1e6,
        _ => return format!("{} {unit}", short(value)),
    };
    format!("{} mm", short(value * factor))
}

/// A time given in seconds, in milliseconds, seconds, minutes or hours.
#[must_use]
pub fn duration(seconds: f64) -> String {
    match seconds {
        s if s < 1.0 => format!("{:.0} ms", 1e3 * s),
        s if s < 120.0 => format!("{s:.1} s"),
        s if s < 7200.0 => format!("{:.1} min", s / 60.0),
        s => format!("{:.1} h", s / 3600.0),
    }
}

/// "1 thread", "2 threads".
pub(crate) fn count(n: usize, what: &str) -> String {
    if n == 1 { format!("1 {what}") } else { format!("{n} {what}s") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_well() {
        assert_eq!(short(-0.0), "0");
        assert_eq!(short(1234.5678), "1234.6");
        assert_eq!(short(1.5e-7), "1.5e-7");
        assert_eq!(millimetres(0.0123456, "m"), "12.346 mm");
        assert_eq!(millimetres(3.0, "ft"), "3 ft");
        assert_eq!(duration(0.0123), "12 ms");
        assert_eq!(duration(150.0), "2.5 min");
        assert_eq!(number(None, "Pa"), "–");
    }
}
