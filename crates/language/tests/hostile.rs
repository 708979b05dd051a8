//! Whole cases that nobody meant: truncated, and with values of every wrong type.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use nastic_language::schema::Case;
use nastic_language::syntax::Document;

const COMPLETE: &str = include_str!("cases/complete.json");
const MAGNETS: &str = include_str!("cases/magnets.json");
const SCENARIOS: &str = include_str!("cases/scenarios.json");

#[test]
fn truncated_and_shuffled_cases_never_panic() {
    let read = |text: &str| Document::parse("case.json", text).and_then(|document| Case::read(&document)).is_ok();
    for text in [COMPLETE, MAGNETS, SCENARIOS] {
        assert!(read(text));
        let last = text.rfind('}').unwrap();
        for end in text.char_indices().map(|(i, _)| i).filter(|end| *end <= last).step_by(7).chain([last]) {
            assert!(!read(&text[..end]), "a part of a case is no case: {:?}", &text[end.saturating_sub(40)..end]);
        }
    }
    // Values swapped for others of every type, everywhere.
    let odd =
        ["null", "-1e308", "\"\"", "\"1/0\"", "[]", "{}", "[[[]]]", "true", "\"X\"", "{\"file\": 1}", "\"\\u0000\""];
    let root = Document::parse("case.json", MAGNETS).unwrap();
    let mut paths = Vec::new();
    collect(&root.root().to_json(), "", &mut paths);
    assert!(paths.len() > 150, "{}", paths.len());
    for (i, path) in paths.iter().enumerate() {
        for k in 0..3 {
            let mut document = root.clone();
            document.set(&format!("{path}={}", odd[(i + 4 * k) % odd.len()])).unwrap();
            let _ = Case::read(&document);
        }
    }
}

fn collect(value: &serde_json::Value, path: &str, out: &mut Vec<String>) {
    let join = |key: &str| if path.is_empty() { key.to_string() } else { format!("{path}/{key}") };
    let entries: Vec<(String, &serde_json::Value)> = match value {
        serde_json::Value::Array(list) => list.iter().enumerate().map(|(i, v)| (join(&i.to_string()), v)).collect(),
        serde_json::Value::Object(map) => map.iter().map(|(k, v)| (join(k), v)).collect(),
        _ => Vec::new(),
    };
    for (path, value) in entries {
        collect(value, &path, out);
        out.push(path);
    }
}
