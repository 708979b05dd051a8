//! Tables of JSON objects as CSV.

use serde_json::Value;

/// One row per object, a column per key in the order of first appearance; entries of objects and lists in columns of their
/// own, as `terms/NAME` and `scenarios/0`. Nothing stands where a row has no such entry, or null.
pub fn table<'v>(rows: impl IntoIterator<Item = &'v Value>) -> String {
    let rows: Vec<Vec<(String, String)>> = rows.into_iter().map(cells).collect();
    let mut head: Vec<&str> = Vec::new();
    for (name, _) in rows.iter().flatten() {
        if !head.contains(&name.as_str()) {
            head.push(name);
        }
    }
    let mut text = head.iter().map(|name| quoted(name)).collect::<Vec<_>>().join(",") + "\n";
    for row in &rows {
        let cell = |name: &&str| row.iter().find(|(known, _)| known == name).map_or("", |(_, cell)| cell.as_str());
        text += &(head.iter().map(cell).collect::<Vec<_>>().join(",") + "\n");
    }
    text
}

/// A text as one cell.
pub fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.to_owned() }
}

/// A name as a column: blanks, which some readers stumble over, are underscores.
pub fn column(name: &str) -> String {
    quoted(&name.replace(char::is_whitespace, "_"))
}

fn cells(row: &Value) -> Vec<(String, String)> {
    let mut out = Vec::new();
    for (name, value) in row.as_object().into_iter().flatten() {
        match value {
            Value::Object(own) => out.extend(own.iter().map(|(key, value)| (format!("{name}/{key}"), cell(value)))),
            Value::Array(own) => {
                out.extend(own.iter().enumerate().map(|(k, value)| (format!("{name}/{k}"), cell(value))));
            }
            other => out.push((name.clone(), cell(other))),
        }
    }
    out
}

fn cell(value: &Value) -> String {
    match value {
        Value::Null => String::new(),
        Value::String(text) => quoted(text),
        other => other.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn rows_have_all_columns_and_gaps_where_nothing_is_known() {
        let rows = [
            json!({ "trial": 0, "reason": "start", "cost": 2.5, "terms": { "a": 1.5, "b, c": 1 } }),
            json!({ "trial": 1, "reason": "no, \"never\"", "cost": null, "terms": {}, "scenarios": [1, 2] }),
        ];
        let expected = "trial,reason,cost,terms/a,\"terms/b, c\",scenarios/0,scenarios/1\n0,start,2.5,1.5,1,,\n\
                        1,\"no, \"\"never\"\"\",,,,1,2\n";
        assert_eq!(table(&rows), expected);
    }
}
