//! Lists of regions, surfaces and node sets: a union, everywhere a name may stand.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use crate::common;

use common::{CaseDirectory, with};
use nastic_case::lower::CaseProblem;
use nastic_language::schema::Command;
use nastic_language::syntax::Document;
use serde_json::Value;
use std::sync::Arc;

/// A strip of four unit squares with the regions "a" (two of them), "b" and "c", and a curve along each side: "low" and
/// "high" along x, "left" and "right" at the ends.
fn strip() -> String {
    strip_with(&[1, 1, 2, 3], false)
}

/// The same with other regions, 1 to 3, and 0 for a square without one; on request all squares are in "all" too.
fn strip_with(regions: &[usize; 4], all: bool) -> String {
    let mut nodes = String::new();
    for k in 0..5 {
        nodes += &format!("{} {k} 0 0\n{} {k} 1 0\n", 2 * k + 1, 2 * k + 2);
    }
    let mut elements: Vec<String> = vec!["1 2 4 4 1 2".into(), "1 2 5 5 9 10".into()];
    for (k, region) in regions.iter().enumerate() {
        let [a, b, c, d] = [2 * k + 1, 2 * k + 3, 2 * k + 4, 2 * k + 2];
        let tags = [(*region > 0).then_some(*region), all.then_some(8)];
        elements.extend(tags.iter().flatten().map(|tag| format!("3 2 {tag} {tag} {a} {b} {c} {d}")));
        elements.push(format!("1 2 6 6 {a} {b}"));
        elements.push(format!("1 2 7 7 {c} {d}"));
    }
    let elements: Vec<String> = elements.iter().enumerate().map(|(k, e)| format!("{} {e}", k + 1)).collect();
    let mut names = vec![(1, 4, "left"), (1, 5, "right"), (1, 6, "low"), (1, 7, "high")];
    names.extend([(2, 1, "a"), (2, 2, "b"), (2, 3, "c")].into_iter().filter(|(_, tag, _)| regions.contains(tag)));
    names.extend(all.then_some((2, 8, "all")));
    let count = names.len();
    let names: String = names.iter().map(|(dim, tag, name)| format!("{dim} {tag} \"{name}\"\n")).collect();
    format!(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n{count}\n{names}$EndPhysicalNames\n$Nodes\n10\n{nodes}$EndNodes\n\
         $Elements\n{}\n{}\n$EndElements\n",
        elements.len(),
        elements.join("\n")
    )
}

/// Every block that names groups names several.
const LISTS: &str = r#"{
  "nastic": 1,
  "mesh": "strip.msh",
  "materials": [ { "region": ["a", "c"], "law": "neo_hooke", "young": "100 kPa", "poisson": 0.3 },
                 { "region": "b", "law": "neo_hooke", "young": "200 kPa", "poisson": 0.3 } ],
  "supports": [ { "surface": ["left", "right"], "fix": "all" } ],
  "loads": [ { "surface": ["low", "high"], "traction": [0, "40 Pa"] }, { "region": ["a", "b"], "body_force": [0, "30 N/m^3 * X / 1 m"] } ],
  "actuation": [ { "name": "swelling", "kind": "turgor", "region": ["a", "b"], "pressure": "2 kPa" } ],
  "costs": [ { "kind": "tracking", "surface": ["low", "high"], "target": ["X", "Y"] },
             { "kind": "tracking", "name": "inside", "region": ["b", "c"], "target": ["X", "Y"] },
             { "kind": "smoothed_hausdorff", "target": "strip.msh", "region": ["a", "b"], "target_region": ["b", "c"],
               "phi": { "exponential": { "length": "1 m" } }, "stages": [ { "alpha": 1, "beta": 2, "gamma": 2 } ] } ],
  "probes": [ { "name": "middle", "point": [2, 0.5] } ]
}"#;

fn solve(case: &str) -> Value {
    let place = CaseDirectory::new();
    place.write("strip.msh", &strip());
    place.run(Command::Solve, case, &[]).unwrap_or_else(|error| panic!("{error}")).result
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value}"))
}

#[test]
fn a_list_of_groups_is_what_one_block_for_each_would_be() {
    let list = solve(LISTS);
    let split = |from: &str, one: &str, two: &str| with(&with(LISTS, from, one), "PLACE", two);
    let blocks = [
        (
            r#"{ "region": ["a", "c"], "law": "neo_hooke", "young": "100 kPa", "poisson": 0.3 }"#,
            r#"{ "region": "#,
            r#", "law": "neo_hooke", "young": "100 kPa", "poisson": 0.3 }"#,
            ["a", "c"],
        ),
        (
            r#"{ "surface": ["left", "right"], "fix": "all" }"#,
            r#"{ "surface": "#,
            r#", "fix": ["x", "y"] }"#,
            ["left", "right"],
        ),
        (
            r#"{ "surface": ["low", "high"], "traction": [0, "40 Pa"] }"#,
            r#"{ "surface": "#,
            r#", "traction": [0, "40 Pa"] }"#,
            ["low", "high"],
        ),
        (
            r#"{ "region": ["a", "b"], "body_force": [0, "30 N/m^3 * X / 1 m"] }"#,
            r#"{ "region": "#,
            r#", "body_force": [0, "30 N/m^3 * X / 1 m"] }"#,
            ["a", "b"],
        ),
        (
            r#"{ "name": "swelling", "kind": "turgor", "region": ["a", "b"], "pressure": "2 kPa" }"#,
            r#"{ "kind": "turgor", "pressure": "2 kPa", "region": "#,
            r#", "name": "NAME" }"#,
            ["a", "b"],
        ),
    ];
    for (from, before, after, names) in blocks {
        let one = |name: &str| format!("{before}\"{name}\"{after}").replace("NAME", name);
        let other = solve(&split(from, &format!("{}, PLACE", one(names[0])), &one(names[1])));
        for k in 0..2 {
            let path = format!("/probes/middle/displacement/{k}");
            let [x, y] = [&list, &other].map(|result| number(result.pointer(&path).unwrap()));
            assert!((x - y).abs() < 1e-9, "{from}: {x} {y}");
        }
    }
    let lifted = number(list.pointer("/probes/middle/displacement/1").unwrap());
    assert!(lifted > 1e-3, "{lifted}");
    let reaction = number(list.pointer("/reactions/left, right/1").unwrap());
    // Tractions over 8 m, a body force of 30 x over the first three metres.
    assert!((reaction + 8.0 * 40.0 + 30.0 * 4.5).abs() < 1e-3, "{reaction}");
}

#[test]
fn a_cost_over_a_list_is_the_sum_over_its_groups() {
    let value = |result: &Value, term: &str| number(&result["cost"]["terms"][term]);
    let list = solve(LISTS);
    let one = |from: &str, name: &str| solve(&with(LISTS, from, &format!("{name:?}")));
    let sides = r#"["low", "high"], "target""#;
    let both = ["low", "high"].map(|name| {
        let text = with(LISTS, sides, &format!("{name:?}, \"target\""));
        value(&solve(&text), "tracking")
    });
    let found = value(&list, "tracking");
    assert!((found - both[0] - both[1]).abs() < 1e-6 * found && both[0] > 0.0 && both[1] > 0.0, "{found} {both:?}");
    let parts = ["b", "c"].map(|name| value(&one(r#"["b", "c"]"#, name), "inside"));
    let found = value(&list, "inside");
    assert!((found - parts[0] - parts[1]).abs() < 1e-6 * found && parts[0] > 0.0, "{found} {parts:?}");
    // The body's squares 0 to 3 from the target's 2 to 4: every part of both counts.
    let distance = value(&list, "smoothed_hausdorff");
    let body = solve(&with(LISTS, r#""region": ["a", "b"], "target_region""#, r#""region": "a", "target_region""#));
    let target = solve(&with(LISTS, r#""target_region": ["b", "c"]"#, r#""target_region": "b""#));
    assert!(value(&body, "smoothed_hausdorff") > 1.1 * distance && value(&target, "smoothed_hausdorff") != distance);
}

#[test]
fn a_cavity_may_be_bounded_by_several_surfaces() {
    // The strip as a wall around nothing: the lower side alone encloses no room, which names what is missing.
    let text = r#"{ "nastic": 1, "mesh": { "box": { "size": [1, 1, 1], "cells": [1, 1, 1], "element": "hex8" } },
        "materials": [ { "region": "body", "law": "neo_hooke", "young": 1, "poisson": 0.3 } ],
        "supports": [ { "surface": "x-", "fix": ["x", "y", "z"] } ],
        "actuation": [ { "name": "air", "kind": "cavity", "surface": ["y-", "y+", "z-", "z+"], "pressure": 1 } ] }"#;
    let found = common::problems(text);
    assert!(found.contains("surface \"y-, y+, z-, z+\" of cavity \"air\" is open at 8 edges"), "{found}");
    for place in ["4 around (0, 0.5, 0.5)", "4 around (1, 0.5, 0.5)"] {
        assert!(found.contains(place), "{place}: {found}");
    }
}

#[test]
fn every_unknown_name_of_a_list_is_told() {
    let place = CaseDirectory::new();
    place.write("strip.msh", &strip());
    let text = with(LISTS, r#"["a", "c"]"#, r#"["a", "d", "e"]"#);
    let found = place.run(Command::Check, &text, &[]).unwrap_err().to_string();
    for part in ["materials/0/region/1: region \"d\"", "materials/0/region/2: region \"e\""] {
        assert!(found.contains(part), "{found}");
    }
    let found = common::problems(&with(common::BAR, r#""surface": "x-""#, r#""surface": ["x-", "x-"]"#));
    assert!(found.ends_with("supports/0/surface: \"x-\" is named twice"), "{found}");
    let found = common::problems(&with(common::BAR, r#""surface": "x-""#, r#""surface": []"#));
    assert!(found.ends_with("supports/0/surface: a list of names needs at least one"), "{found}");
}

/// A control by region on a mesh: the regions that have an unknown, or what is wrong.
fn unknowns(mesh: &str, region: &str) -> Result<Vec<String>, String> {
    let place = CaseDirectory::new();
    place.write("strip.msh", mesh);
    let text = format!(
        r#"{{ "nastic": 1, "mesh": "strip.msh",
        "materials": [ {{ "region": REGIONS, "law": "neo_hooke", "young": "100 kPa", "poisson": 0.3 }} ],
        "supports": [ {{ "surface": "left", "fix": "all" }} ],
        "actuation": [ {{ "name": "swelling", "kind": "turgor", "region": {region} }} ],
        "controls": [ {{ "of": "swelling", "space": "region", "start": "1 kPa * X / 1 m", "lower": 0, "upper": "5 kPa" }} ] }}"#
    );
    let all = if mesh.contains("\"all\"") { "\"all\"" } else { "[\"a\", \"b\", \"c\"]" };
    let file = place.write("case.json", &text.replace("REGIONS", all));
    let document = Document::open(&file).unwrap();
    let problem = CaseProblem::lower(document, Arc::default()).map_err(|problems| problems.to_string())?;
    let basis = &problem.member(0).layout().blocks()[0].basis;
    assert_eq!(problem.start.len(), basis.len());
    Ok((0..basis.len()).map(|k| format!("{} {}", basis.region(k), problem.start[k].round())).collect())
}

/// Starts are evaluated at the centres of the regions: x = 1 of a, 2.5 of b, 3.5 of c.
#[test]
fn a_control_by_region_follows_the_regions_named() {
    let (plain, double) = (strip(), strip_with(&[1, 1, 2, 3], true));
    assert_eq!(unknowns(&plain, r#"["a", "c"]"#).unwrap(), ["a 1000", "c 3500"]);
    assert_eq!(unknowns(&plain, r#""b""#).unwrap(), ["b 2500"]);
    // A group of all cells changes nothing, and stands for the regions that divide it.
    assert_eq!(unknowns(&double, r#"["a", "c"]"#).unwrap(), ["a 1000", "c 3500"]);
    assert_eq!(unknowns(&double, r#""b""#).unwrap(), ["b 2500"]);
    assert_eq!(unknowns(&double, r#""all""#).unwrap(), ["a 1000", "b 2500", "c 3500"]);
}

#[test]
fn a_control_by_region_is_refused_where_regions_leave_it_open() {
    let found = unknowns(&strip_with(&[1, 1, 2, 3], true), r#"["all", "b"]"#).unwrap_err();
    assert!(found.contains("controls/0: regions \"all\" and \"b\" share 1 cells"), "{found}");
    let found = unknowns(&strip_with(&[1, 1, 0, 0], true), r#""all""#).unwrap_err();
    assert!(found.contains("controls/0: 2 cells of region \"all\" are in none of its parts (a)"), "{found}");
}
