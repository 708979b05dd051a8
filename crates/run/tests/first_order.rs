//! Random fields by a sparse operator, and risks of first order: whole commands on small bodies.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use crate::common;

use common::{BAR, CaseDirectory, problems, with};
use nastic_language::schema::Command;
use serde_json::Value;

fn number(value: &Value, path: &str) -> f64 {
    let found = nastic_run::result::find(value, path).unwrap_or_else(|| panic!("no {path} in {value:#}"));
    found.as_f64().unwrap_or_else(|| panic!("{path} is {found}"))
}

/// A field by the operator on the nodes, log-normal or Gaussian; its numbers are told, a length below the cells is a warning, what no rule takes is refused.
#[test]
fn a_field_of_matern_in_a_case() {
    let field = |law: &str, rule: &str| {
        let block = format!(
            r#""scenarios": {{ "random": [ {{ "path": "materials/0/mu1", {law} }} ], "rule": {rule} }}, "probes""#
        );
        with(BAR, r#""probes""#, &block)
    };
    let matern = |law: &str, length: &str, modes: &str| {
        format!(
            r#""{law}": {{ "mean": "100 kPa", "deviation": "20 kPa", "length": "{length}", "modes": {modes}, "kernel": "matern" }}"#
        )
    };
    let place = CaseDirectory::new();
    for law in ["lognormal", "gaussian"] {
        let case = field(&matern(law, "0.5 m", "3"), r#"{ "lattice": 4 }"#);
        let result = place.run(Command::Gradient, &case, &[]).unwrap().result;
        assert_eq!(result["scenarios"].as_object().unwrap().len(), 4);
        let note = result["notes"][0].as_str().unwrap();
        assert!(note.starts_with("materials/0/mu1: 3 modes hold ") && note.contains("none is missing"), "{note}");
        assert!(note.contains("times its variance; the correlation "), "{note}");
        let costs: Vec<f64> = (0..4).map(|k| number(&result, &format!("scenarios/{k}/cost/total"))).collect();
        assert!(costs.windows(2).all(|pair| pair[0] != pair[1]), "{costs:?}");
    }
    let result =
        place.run(Command::Check, &field(&matern("lognormal", "1 mm", "3"), r#"{ "gauss": 1 }"#), &[]).unwrap().result;
    let warnings = result["warnings"].to_string();
    assert!(warnings.contains("the correlation length 0.001 m is below the mean size of the cells"), "{warnings}");
    let found = problems(&field(&matern("lognormal", "0.5 m", "20"), r#"{ "quasi_monte_carlo": 8 }"#));
    assert!(found.contains("20 laws are too many"), "{found}");
    let found = problems(&field(&matern("lognormal", "0.5 m", "3"), r#"{ "lattice": 12 }"#));
    assert!(found.contains("12 points; a lattice has a power of two"), "{found}");
    let wide = r#""gaussian": { "mean": "100 kPa", "deviation": "200 kPa", "length": "0.5 m", "modes": 3, "kernel": "matern" }"#;
    let found = problems(&field(wide, r#"{ "lattice": 8 }"#));
    assert!(found.contains("is no material") && found.contains("mu1"), "{found}");
}

/// Mean and deviation to first order: numbers in the result, the same as by scenarios for small deviations, and what it does not take.
#[test]
fn a_risk_of_first_order() {
    let first = |more: &str| {
        let block = format!(
            r#""scenarios": {{ "random": [
                {{ "path": "materials/0/mu1", "lognormal": {{ "mean": "100 kPa", "deviation": "2 kPa", "length": "0.5 m", "modes": 4, "kernel": "matern" }} }},
                {{ "path": "materials/0/mu3", "uniform": {{ "lower": "295 kPa", "upper": "305 kPa" }} }} ]{more} }},
              "risk": {{ "first_order": {{ "deviations": 2 }} }}, "probes""#
        );
        with(BAR, r#""probes""#, &block)
    };
    let place = CaseDirectory::new();
    let result = place.run(Command::Gradient, &first(""), &[]).unwrap().result;
    let found = &result["first_order"];
    let of = |key: &str| found[key].as_f64().unwrap();
    assert!((number(&result, "cost/total") - of("mean") - 2.0 * of("rounded")).abs() < 1e-12 * of("mean"));
    let sources = found["sources"].as_array().unwrap();
    let shares: f64 = sources.iter().map(|own| own["share"].as_f64().unwrap()).sum();
    assert!(sources.len() == 2 && (shares - 1.0).abs() < 1e-12, "{found}");
    assert!(
        sources[0]["parameter"] == "materials/0/mu1" && found["about"].as_str().unwrap().contains("medians"),
        "{found}"
    );
    // of small deviations
    let by_rule = ["risk=\"mean\"", r#"scenarios/rule={"gauss": 3}"#];
    let many = place.run(Command::Gradient, &first(""), &by_rule).unwrap().result;
    let deviation = number(&many, "risk/deviation");
    assert!((deviation / of("deviation") - 1.0).abs() < 0.02, "{deviation} and {}", of("deviation"));
    let said = place.text(Command::Check, &first(""), &[]);
    assert!(
        said.contains("2 standard deviations to first order in materials/0/mu1 (4 modes), materials/0/mu3"),
        "{said}"
    );
    assert!(problems(&first(r#", "rule": { "gauss": 2 }"#)).contains("makes no scenarios"));
    let elsewhere = with(&first(""), "materials/0/mu3", "costs/0/weight");
    assert!(problems(&elsewhere).contains("takes numbers of materials"), "{}", problems(&elsewhere));
    // what a cost has of the modulus beside the displacement would be left out
    for own in
        [r#""kind": "reaction", "surface": "x-", "direction": [1, 0, 0], "force": "1 N""#, r#""kind": "pump_work""#]
    {
        let stiff = with(&first(""), r#""costs": ["#, &format!(r#""costs": [ {{ {own} }},"#));
        assert!(problems(&stiff).contains("depends on numbers of materials"), "{}", problems(&stiff));
    }
    let cases =
        r#""load_cases": [ { "name": "a" }, { "name": "b", "set": { "materials/0/mu3": "400 kPa" } } ], "probes""#;
    let set = with(&first(""), r#""probes""#, cases);
    assert!(problems(&set).contains("the load case \"b\" sets it too"), "{}", problems(&set));
    let second = with(&first(""), r#""lbfgs""#, r#""newton_cg""#);
    assert!(
        problems(&second).contains("optimizer/method: \"newton_cg\" takes second derivatives"),
        "{}",
        problems(&second)
    );
    let listed = with(
        BAR,
        r#""probes""#,
        r#""scenarios": [ {}, {} ], "risk": { "first_order": { "deviations": 2 } }, "probes""#,
    );
    assert!(problems(&listed).contains("is about random parameters"), "{}", problems(&listed));
}
