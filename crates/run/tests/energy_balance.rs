//! The balance of energy in results, the warning about it, and the scheme that is taken beside contact.

#![allow(clippy::unwrap_used)] // a test may

use crate::common;

use common::{CaseDirectory, problems};
use nastic_language::schema::Command;
use serde_json::Value;

/// A soft block that is thrown onto a ball, as in a trial in which `tr_bdf2` made two and a half times its energy.
fn dropped(time: &str, friction: &str) -> String {
    format!(
        r#"{{ "nastic": 1, "mesh": {{ "box": {{ "size": [0.0159, 0.0193], "cells": [3, 2], "element": "quad8" }} }},
        "materials": [ {{ "region": "body", "law": "mooney_rivlin", "mu1": 317326.8, "mu2": 198783.5, "mu3": 16740778.5, "density": 1000 }} ],
        "loads": [ {{ "gravity": [0, -9.81] }} ],
        "obstacles": [ {{ "name": "ball", "shape": {{ "sphere": {{ "center": [0.00793, -0.03339], "radius": 0.03171 }} }} }} ],
        "contact": [ {{ "name": "below", "surface": "y-", "obstacle": "ball", "law": "log", "refine": 1{friction} }} ],
        "time": {{ "end": 0.0398, "step": 0.00165833333333333333, "start": "rest", "velocity": [0, -0.0986]{time} }} }}"#
    )
}

fn solve(text: &str) -> (CaseDirectory, Value) {
    let place = CaseDirectory::new();
    let result = place.run(Command::Solve, text, &[]).unwrap().result;
    (place, result)
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

/// The `energy` warnings of a result.
fn warned(result: &Value) -> Vec<String> {
    let all = result["warnings"].as_array().unwrap().iter();
    all.filter(|warning| warning["code"] == "energy")
        .map(|warning| warning["message"].as_str().unwrap().to_owned())
        .collect()
}

#[test]
fn a_scheme_that_creates_energy_is_warned_about() {
    let (_, result) = solve(&dropped(r#", "scheme": "tr_bdf2""#, ""));
    let balance = &result["time"]["energy_balance"];
    assert!(number(&balance["added"]) > 0.5 * number(&balance["span"]), "{balance}");
    let warned = warned(&result);
    assert!(warned.iter().any(|told| told.contains("\"tr_bdf2\" creates") && told.contains("t = ")), "{warned:?}");
}

#[test]
fn beside_contact_the_default_creates_none() {
    let (place, result) = solve(&dropped("", ""));
    assert_eq!(result["time"]["scheme"], "backward_euler");
    let balance = &result["time"]["energy_balance"];
    let span = number(&balance["span"]);
    assert!(number(&balance["added"]) < 1e-6 * span, "{balance}");
    assert!(number(&balance["unbalanced"]).abs() < 1e-6 * span, "{balance}");
    // what it takes out of the impact is said
    let warned = warned(&result);
    assert!(warned.len() == 1 && warned[0].contains("\"backward_euler\" takes"), "{warned:?}");
    let csv = std::fs::read_to_string(place.path("out/motion.csv")).unwrap();
    let mut rows = csv.lines().map(|line| line.split(',').map(str::to_owned).collect::<Vec<_>>());
    let head = rows.next().unwrap();
    let columns = [
        "kinetic_energy",
        "energy.elastic",
        "energy.contact",
        "energy.load_work",
        "energy.scheme",
        "energy.unbalanced",
    ];
    let columns = columns.map(|name| head.iter().position(|own| own == name).unwrap());
    let of = |row: &Vec<String>| columns.map(|k| row[k].parse::<f64>().unwrap());
    let rows: Vec<_> = rows.map(|row| of(&row)).collect();
    let closed = |[kinetic, elastic, contact, load, scheme, unbalanced]: [f64; 6]| {
        kinetic + elastic + contact - load - scheme - unbalanced
    };
    assert!(rows.iter().all(|row| (closed(*row) - closed(rows[0])).abs() < 1e-12 * span.max(1e-3)), "{rows:?}");
    assert_eq!(number(&balance["scheme"]), rows.last().unwrap()[4]);
    // without contact it is another
    let contact =
        r#""contact": [ { "name": "below", "surface": "y-", "obstacle": "ball", "law": "log", "refine": 1 } ],"#;
    let free = dropped("", "");
    assert!(free.contains(contact));
    let (_, free) = solve(&free.replace(contact, ""));
    assert_eq!(free["time"]["scheme"], "tr_bdf2");
}

#[test]
fn schemes_that_cannot_are_refused_by_name() {
    for (scheme, friction) in [
        ("implicit_midpoint", ""),
        ("generalized_alpha", ""),
        ("linearly_implicit_euler", ", \"friction\": 0.5, \"slip_speed\": \"1 mm/s\""),
    ] {
        let found = problems(&dropped(&format!(", \"scheme\": \"{scheme}\""), friction));
        assert!(found.contains(scheme) && found.contains("below"), "{found}");
    }
}
