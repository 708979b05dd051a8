//! Every law, actuation, cost, obstacle, scheme, method and element that a case can name has a shipped case, or a command on `docs/features.md` that
//! `tutorials.rs` runs; the tables of that page say which.

#![allow(clippy::unwrap_used)] // a test may

use nastic_language::catalogue::Catalogue;
use nastic_language::schema::json_schema;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// What words a kind of feature has in the schema: the definitions whose key names it.
const KINDS: [(&str, &[&str], &str); 9] = [
    ("Law", &["Material"], "law"),
    ("Actuation", &["Actuation"], "kind"),
    ("Cost", &[], "kind"),
    ("Law of contact", &["Contact"], "law"),
    ("Formulation", &["Formulation"], ""),
    ("Scheme", &["Time"], "scheme"),
    ("Method", &["Optimizer"], "method"),
    ("Element", &["BoxMesh"], "element"),
    ("Obstacle", &[], ""),
];

fn file(name: &str) -> String {
    std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(name)).unwrap()
}

/// Words that a key may have, wherever it stands in a part of the schema; all words without a key.
fn words(part: &Value, key: &str, found: &mut BTreeSet<String>) {
    match part {
        Value::Object(entries) => {
            if let Some(named) = entries.get("properties").and_then(|properties| properties.get(key)) {
                words(named, "", found);
            }
            if key.is_empty() {
                found.extend(entries.get("const").and_then(Value::as_str).map(str::to_owned));
                let several = entries.get("enum").and_then(Value::as_array);
                found.extend(several.into_iter().flatten().filter_map(Value::as_str).map(str::to_owned));
            }
            entries.values().for_each(|entry| words(entry, key, found));
        }
        Value::Array(parts) => parts.iter().for_each(|part| words(part, key, found)),
        _ => {}
    }
}

/// The features of the schema by kind.
fn features() -> BTreeMap<&'static str, BTreeSet<String>> {
    let schema = json_schema(&Catalogue::standard());
    let definitions = schema["$defs"].as_object().unwrap();
    let of = |(kind, names, key): (&'static str, &[&str], &str)| {
        let mut found = BTreeSet::new();
        let is_cost = |name: &str| kind == "Cost" && (name.ends_with("Cost") || name == "SmoothedHausdorff");
        let parts = definitions.iter().filter(|(name, _)| names.contains(&name.as_str()) || is_cost(name));
        parts.for_each(|(_, part)| words(part, key, &mut found));
        if kind == "Obstacle" {
            let shapes = definitions["Obstacle"]["properties"]["shape"]["oneOf"].as_array().unwrap();
            found.extend(shapes.iter().flat_map(|shape| shape["properties"].as_object().unwrap().keys().cloned()));
            found.insert("grid".to_owned());
        }
        (kind, found)
    };
    KINDS.map(of).into()
}

/// Rows `| name | place |` of the tables whose first column is called so.
fn rows(page: &str, kind: &str) -> BTreeMap<String, String> {
    let head = format!("| {kind} | Where |");
    let table = page.lines().skip_while(|line| *line != head).skip(2).take_while(|line| line.starts_with('|'));
    let row = |line: &str| {
        let mut cells = line.trim_matches('|').split('|').map(str::trim);
        Some((cells.next()?.trim_matches('`').to_owned(), cells.next()?.to_owned()))
    };
    table.filter_map(row).collect()
}

/// What a reader may type of the page: its commands and files.
fn typed(page: &str) -> String {
    page.split("```").skip(1).step_by(2).filter(|block| !block.starts_with("text")).collect()
}

/// Whether a case or a command names it.
fn names(text: &str, feature: &str) -> bool {
    text.contains(&format!("\"{feature}\""))
        || text.split_whitespace().any(|word| word.ends_with(&format!("={feature}")))
}

#[test]
fn every_feature_has_a_case() {
    let page = file("docs/features.md");
    let typed = typed(&page);
    for (kind, features) in features() {
        assert!(features.len() > 1, "{kind}: {features:?}");
        let rows = rows(&page, kind);
        let listed: BTreeSet<String> = rows.keys().cloned().collect();
        assert_eq!(listed, features, "docs/features.md, {kind}");
        for (feature, place) in rows {
            let text = match place.split_once("](../") {
                Some((_, link)) => file(link.trim_end_matches(')')),
                None => typed.clone(),
            };
            assert!(names(&text, &feature), "docs/features.md: {kind} {feature} is not in {place}");
        }
    }
}
