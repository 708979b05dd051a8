//! Numbers as text.

/// Mantissa with `digits` digits after the point, and an exponent with its sign and at least two digits, so that columns of numbers
/// line up: `1.250e-03`. NaN and infinities as they are.
#[must_use]
pub fn scientific(value: f64, digits: usize) -> String {
    let text = format!("{value:.digits$e}");
    match text.split_once('e') {
        Some((mantissa, exponent)) => {
            let (sign, exponent) = exponent.strip_prefix('-').map_or(('+', exponent), |rest| ('-', rest));
            format!("{mantissa}e{sign}{exponent:0>2}")
        }
        None => text,
    }
}

/// Six significant digits, without an exponent where that reads well.
#[must_use]
pub fn short(value: f64) -> String {
    let rounded: f64 = format!("{value:.5e}").parse().unwrap_or(value);
    if rounded == 0.0 {
        // without the sign that -0.0 has
        "0".to_owned()
    } else if (1e-3..1e6).contains(&rounded.abs()) || !rounded.is_finite() {
        format!("{rounded}")
    } else {
        let text = scientific(rounded, 5);
        match text.split_once('e') {
            Some((mantissa, exponent)) => {
                format!("{}e{exponent}", mantissa.trim_end_matches('0').trim_end_matches('.'))
            }
            None => text,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::scientific;

    #[test]
    fn exponents_have_a_sign_and_two_digits() {
        assert_eq!(scientific(1.0, 2), "1.00e+00");
        assert_eq!(scientific(-1.25e-103, 1), "-1.2e-103");
        assert_eq!(scientific(f64::NAN, 2), "NaN");
    }
}
