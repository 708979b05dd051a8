//! The formula grammar: values, units, dimensions, errors, hostile text.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use nastic_language::expression::{Fault, Formula};
use nastic_language::quantity::{Dimension, Unit, Units};

fn formula(text: &str) -> Formula {
    Formula::parse(text, &Units::default()).unwrap_or_else(|error| panic!("{error}"))
}

fn value(text: &str) -> f64 {
    formula(text).at([1.0, 2.0, 3.0]).unwrap()
}

fn error(text: &str) -> String {
    Formula::parse(text, &Units::default()).map(|_| ()).unwrap_err().to_string()
}

/// The message of a formula that is no `wanted`; empty if it is one.
fn refusal(text: &str, wanted: Dimension) -> String {
    formula(text).check(wanted).err().unwrap_or_default()
}

#[test]
fn operators_bind_as_in_mathematics() {
    for (text, expected) in [
        ("1 + 2 * 3", 7.0),
        ("(1 + 2) * 3", 9.0),
        ("-2^2", -4.0),
        ("(-2)^2", 4.0),
        ("2^3^2", 512.0),
        ("2^-1", 0.5),
        ("-2^-2", -0.25),
        ("2 - 3 - 4", -5.0),
        ("16 / 4 / 2", 2.0),
        ("2 * -3", -6.0),
        ("--2", 2.0),
        ("- - -2", -2.0),
        ("+2", 2.0),
        ("1 - -1", 2.0),
        ("1e3", 1000.0),
        ("1.5E-2", 0.015),
        (".5 + 5.", 5.5),
        ("1 < 2", 1.0),
        ("2 < 1", 0.0),
        ("2 <= 2", 1.0),
        ("2 >= 3", 0.0),
        ("3 > 2", 1.0),
        ("2 == 2", 1.0),
        ("2 != 2", 0.0),
        ("1 + 1 < 3 * 1", 1.0),
        ("100 * (X < 0.6)", 0.0),
        ("100 * (X > 0.6)", 100.0),
        ("X + 10*Y + 100*Z", 321.0),
        ("-150e3 * Z / 0.2", -150e3 * 3.0 / 0.2),
        ("min(3, 1, 2)", 1.0),
        ("max(X, Y)", 2.0),
        ("abs(-4)", 4.0),
        ("sqrt(2)^2", 2.0f64.sqrt().powf(2.0)),
        ("log(exp(2))", 2.0f64.exp().ln()),
        ("sin(pi / 6)", (std::f64::consts::PI / 6.0).sin()),
        ("cos(0)", 1.0),
        ("tan(0)", 0.0),
    ] {
        assert_eq!(value(text), expected, "{text}");
    }
}

#[test]
fn units_become_numbers_of_the_case() {
    for (text, expected) in [
        ("100 kPa", 1e5),
        ("1 MPa", 1e6),
        ("2GPa", 2e9),
        ("30 mm", 0.03),
        ("1e-3m", 1e-3),
        ("3 cm", 0.03),
        ("7 um", 7e-6),
        ("7 µm", 7e-6),
        ("100 mT", 0.1),
        ("5 ms", 0.005),
        ("3 g", 0.003),
        ("2 km", 2000.0),
        ("1 kN", 1000.0),
        ("2 m^2", 2.0),
        ("2 mm^2", 2e-6),
        ("(2 mm)^2", 4e-6),
        ("3 mm^-1", 3000.0),
        ("5 N/m^2", 5.0),
        ("1 N / 2 m", 0.5),
        ("1000 kg/m^3 * 9.81 m/s^2", 9810.0),
        ("(1 + 2) kPa", 3000.0),
        ("sqrt(4) mm", 0.002),
        ("-150 kPa", -150e3),
        ("60 K", 60.0),
        ("2e-4 / K * 60 K", 0.012),
    ] {
        assert_eq!(value(text), expected, "{text}");
    }
}

#[test]
fn a_case_in_millimetres_computes_in_millimetres() {
    let unit = |name| Unit::named(name).unwrap();
    let units = Units::new(unit("mm"), unit("N"), unit("s"), unit("mT")).unwrap();
    for (text, expected) in [
        ("1 MPa", 1.0),
        ("100 kPa", 0.1),
        ("2 bar", 0.2),
        ("50 mbar", 5e-3),
        ("3 cm", 30.0),
        ("20 mT", 20.0),
        ("0.1 T", 100.0),
    ] {
        assert_eq!(Formula::parse(text, &units).unwrap().constant(), Some(expected), "{text}");
    }
    // Coordinates are in millimetres too, so 0.6 m is compared as 600.
    let step = Formula::parse("X < 0.6 m", &units).unwrap();
    assert_eq!(step.at([599.0, 0.0, 0.0]).unwrap(), 1.0);
    assert_eq!(step.at([601.0, 0.0, 0.0]).unwrap(), 0.0);
    assert_eq!(Formula::parse("5", &units).unwrap().constant(), Some(5.0));
    assert_eq!(units.label(Dimension::PRESSURE), "MPa");
    assert_eq!(units.label(Dimension::BODY_FORCE), "N/mm^3");
    assert_eq!(units.in_si(0.1, Dimension::PRESSURE), 1e5);
    // mu0 in T^2/Pa: a millitesla is 1e-3 T, a megapascal 1e6 Pa.
    let expected = 1.25663706e-6 * 1e6 * 1e6;
    assert!((units.permeability() / expected - 1.0).abs() < 1e-15);
    assert_eq!(Units::default().permeability(), 1.25663706e-6);
    assert!(Units::new(unit("Pa"), unit("N"), unit("s"), unit("T")).is_none());
}

#[test]
fn units_of_the_wrong_kind_are_refused() {
    // a difference of temperatures has no offset, so no other unit
    let heat = refusal("60 mm", Dimension::TEMPERATURE);
    assert!(heat.ends_with("is a length, a temperature difference is wanted (K)"), "{heat}");
    let heat = refusal("60 K", Dimension::EXPANSION);
    assert!(heat.ends_with("a thermal expansion (1 over a temperature) is wanted (1/K)"), "{heat}");
    for text in ["60 \u{b0}C", "60 degC", "60 C"] {
        let said = Formula::parse(text, &Units::default()).unwrap_err().to_string();
        assert!(said.contains("a difference in degrees Celsius is the same number: \"60 K\""), "{said}");
    }
    let pressure = Dimension::PRESSURE;
    for text in [
        "5 mm",
        "X",
        "2 * 3 mm",
        "100 kPa * 2 m",
        "100 kPa * X",
        "1 m / 2 m",
        "sqrt(4 m^2)",
        "-(5 T)",
        "min(1 m, 2 m)",
        "5 N",
        "100 kPa^2",
    ] {
        assert!(refusal(text, pressure).starts_with("unit of the wrong kind"), "{text}");
    }
    assert_eq!(
        refusal("5 mm", pressure),
        "unit of the wrong kind: \"5 mm\" is a length, a pressure is wanted (Pa, kPa, MPa, GPa, bar, mbar)"
    );
    assert_eq!(refusal("3 N/m", Dimension::LENGTH).split(" is ").nth(1), Some("a quantity in N/m, a length"));
    assert_eq!(refusal("50 kPa", Dimension::NONE).split(", ").nth(1), Some("a plain number is wanted"));
}

#[test]
fn plain_numbers_fit_everywhere() {
    let pressure = Dimension::PRESSURE;
    for text in [
        "5",
        "-150e3 * Z / 0.2",
        "-150 kPa * Z / 0.2",
        "-150 kPa * Z / 0.2 m",
        "-150e3 * Z / 0.2 m",
        "100 kPa * (X < 0.6 m)",
        "100 kPa * (X < 0.6)",
        "-3e5 * (Z - 0.1) / 0.1 * (X < 0.6)",
        "2 * 100 kPa",
        "100 kPa + 5",
        "100 kPa * sin(pi * X / 0.2)",
        "1e5 * sin(X)",
        "1e5 * exp(-X)",
        "(X < 0.6)",
        "1e5 * (1 - X / 1 m)",
        "5 N / m^2",
        "1e5 * X^2",
        "sqrt(X^2 + Y^2) * 1e5",
        "max(0, 100 kPa - 5e4)",
        "100 kPa * 2^(X / 1 m)",
        "100 kPa * (X / 1 m)^0.5",
    ] {
        assert_eq!(refusal(text, pressure), "", "{text}");
    }
    assert_eq!(refusal("0.90 - sin(0.55) * (Z - 0.1)", Dimension::LENGTH), "");
    assert_eq!(refusal("X + 0.3*X^2", Dimension::LENGTH), "");
    assert_eq!(refusal("-Z / sqrt(X^2 + Z^2)", Dimension::NONE), "");
}

#[test]
fn contradictions_name_their_column() {
    for (text, message, column) in [
        ("1 m + 1 Pa", "a length and a pressure cannot be added", 5),
        ("X - 3 kPa", "a length and a pressure cannot be subtracted", 3),
        ("X < 2 kPa", "a length and a pressure cannot be compared", 3),
        ("max(1 m, 1 s)", "a length and a time cannot be compared", 1),
        ("X + X^2", "a length and an area cannot be added", 3),
        ("sin(3 m)", "\"sin\" takes a plain number, this is a length", 1),
        ("2 ^ (3 m)", "an exponent must be a plain number, this is a length", 3),
        ("(2 m) ^ X", "the exponent of a length must be a constant like 2 or 1/2", 7),
    ] {
        assert_eq!(error(text), format!("{message} at column {column} of \"{text}\""));
    }
}

#[test]
fn syntax_errors_say_what_was_expected_and_where() {
    for (text, part, column) in [
        ("", "a number, a name or \"(\" was expected, found the end", 1),
        ("1 +", "a number, a name or \"(\" was expected, found the end", 4),
        ("* 2", "found \"*\"", 1),
        ("100 kpa", "an operator was expected, found \"kpa\": did you mean \"kPa\"?", 5),
        ("2 X", "products need \"*\"", 3),
        ("2 (X)", "products need \"*\"", 3),
        ("100 ** 2", "found \"*\"", 6),
        ("x", "unknown name \"x\": did you mean \"X\"?", 1),
        ("sine(1)", "unknown name \"sine\": did you mean \"sin\"?", 1),
        ("sin 1", "\"sin\" is a function: \"(\" was expected", 5),
        ("sin(1, 2)", "\"sin\" takes one argument", 6),
        ("max(1)", "\"max\" needs at least two arguments", 6),
        ("(1", "\")\" was expected, found the end", 3),
        ("1)", "this \")\" was never opened", 2),
        ("1 < 2 < 3", "comparisons cannot be chained", 7),
        ("1e", "an exponent needs digits", 1),
        ("1e999", "is no finite number", 1),
        (".", "a point without digits", 1),
        ("1..2", "an operator was expected", 3),
        ("2 @ 3", "\"@\" has no meaning in a formula", 3),
        ("1; 2", "\";\" has no meaning in a formula", 2),
        ("X = 2", "\"=\" has no meaning in a formula", 3),
        ("2 m^1.5", "the power of a unit must be a whole number", 5),
        ("2 m^1000000000", "the power of a unit must be a whole number", 5),
        ("2 m^X", "the power of a unit must be a whole number", 5),
        ("2 m^2^2", "a power of a unit's power needs parentheses", 6),
        ("1 / 0", "division by zero", 3),
        ("sqrt(-1)", "square root of a negative number", 1),
        ("log(0)", "logarithm of a number that is not positive", 1),
        ("(-8)^(1/3)", "power without a real value", 5),
        ("1e300 * 1e300", "value beyond the range of numbers", 7),
    ] {
        let message = error(text);
        assert!(message.contains(part), "{text}: {message}");
        assert!(message.contains(&format!(" at column {column} of ")), "{text}: {message}");
    }
}

#[test]
fn a_value_that_is_no_number_names_its_point() {
    let error = formula("1 / (X - 0.5)").at([0.5, 0.25, 0.0]).unwrap_err();
    assert_eq!(error.fault, Fault::DivisionByZero);
    assert_eq!(error.to_string(), "division by zero at column 3 of \"1 / (X - 0.5)\", at the point (0.5, 0.25, 0)");
    assert_eq!(formula("log(X)").at([0.0; 3]).unwrap_err().fault, Fault::LogOfNotPositive);
    assert_eq!(formula("sqrt(X)").at([-1.0, 0.0, 0.0]).unwrap_err().fault, Fault::RootOfNegative);
    assert_eq!(formula("X^-1").at([0.0; 3]).unwrap_err().fault, Fault::Power);
    assert_eq!(formula("exp(X)").at([1e4, 0.0, 0.0]).unwrap_err().fault, Fault::Overflow);
}

#[test]
fn constants_are_known_without_a_point() {
    assert_eq!(formula("2 * 3 mm").constant(), Some(0.006));
    assert_eq!(formula("X - X").constant(), None);
    assert_eq!(Formula::number(4.5).constant(), Some(4.5));
    assert_eq!(Formula::number(4.5).text(), "4.5");
}

#[test]
fn depth_and_length_cannot_exhaust_the_stack() {
    let deep = |n: usize| format!("{}1{}", "(".repeat(n), ")".repeat(n));
    assert_eq!(value(&deep(60)), 1.0);
    for text in [deep(100_000), "(".repeat(100_000), "sin(".repeat(100_000), "2^".repeat(100_000)] {
        assert!(error(&text).contains("nested deeper"));
    }
    assert_eq!(value(&format!("{}1", "-".repeat(100_000))), 1.0);
    assert_eq!(value(&format!("0{}", "+1".repeat(100_000))), 1e5);
    assert!(error(&"X*".repeat(100_000)).contains("found the end"));
    assert!(error(&format!("1{}", "*X".repeat(100_000))).contains("sensible power"));
    assert!(error(&"q".repeat(100_000)).len() < 1000, "messages stay readable");
}

#[test]
fn garbage_never_panics() {
    let pieces = [
        "1", "2.5e3", "e", ".", "X", "Y", "pi", "sin", "max", "min", "(", ")", ",", "^", "-", "+", "*", "/", "<", "<=",
        "==", "!", "kPa", "mm", "µm", "T", " ", "\t", "\u{0}", "é", "🦀", "\"", "1e-400", "9e307", "0",
    ];
    let mut state = 0x9e37_79b9_7f4a_7c15u64;
    let mut next = |n: usize| {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state % n as u64) as usize
    };
    let mut parsed = 0;
    for _ in 0..20_000 {
        let text: String = (0..1 + next(12)).map(|_| pieces[next(pieces.len())]).collect();
        if let Ok(formula) = Formula::parse(&text, &Units::default()) {
            parsed += 1;
            let _ = formula.check(Dimension::PRESSURE);
            if let Ok(value) = formula.at([0.5, 0.0, -1.0]) {
                assert!(value.is_finite(), "{text}");
            }
        }
    }
    assert!(parsed > 100, "the loop should also meet valid formulas, met {parsed}");
}
