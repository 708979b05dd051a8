//! The page of case files has every key and every kind that the schema knows.

#![allow(clippy::unwrap_used)] // a test may

use nastic::case::catalogue::Catalogue;
use nastic::case::schema::json_schema;
use serde_json::Value;
use std::collections::BTreeSet;
use std::path::Path;

/// Keys of objects, and words that a key must have (`"kind": "tendon"`), all the way down.
fn names(schema: &Value, found: &mut BTreeSet<String>) {
    match schema {
        Value::Object(parts) => {
            if let Some(Value::Object(properties)) = parts.get("properties") {
                found.extend(properties.keys().cloned());
            }
            found.extend(parts.get("const").and_then(Value::as_str).map(str::to_owned));
            parts.values().for_each(|part| names(part, found));
        }
        Value::Array(parts) => parts.iter().for_each(|part| names(part, found)),
        _ => {}
    }
}

#[test]
fn the_page_of_case_files_has_every_key_of_the_schema() {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/case-files.md");
    let page = std::fs::read_to_string(page).unwrap();
    let words: BTreeSet<&str> = page.split(|c: char| !(c.is_ascii_alphanumeric() || "_$".contains(c))).collect();
    let mut known = BTreeSet::new();
    names(&json_schema(&Catalogue::standard()), &mut known);
    assert!(known.len() > 150, "{}", known.len());
    let missing: Vec<&String> = known.iter().filter(|name| !words.contains(name.as_str())).collect();
    assert!(missing.is_empty(), "docs/case-files.md does not have {missing:?}");
}
