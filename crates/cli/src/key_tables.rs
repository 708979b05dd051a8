//! A JSON Schema as tables of keys, in Markdown: `nastic schema --markdown`.

use serde_json::Value;
use std::fmt::Write;

/// Characters of a table cell; what is longer stands below the table.
const WIDEST: usize = 150;

/// A part of so many keys, all of which stand in a larger part, is named there and its keys are not repeated.
const REPEATED: usize = 5;

/// One table for each named part of a schema, its root first.
pub(crate) fn markdown(schema: &Value, title: &str, how: &str) -> String {
    let mut out = format!("# {title}\n\nMade by `{how}` from the schema that the program itself uses: do not edit.\n");
    let heads = schema["$defs"].as_object().into_iter().flatten();
    for (name, part) in std::iter::once((&title.to_owned(), schema)).chain(heads) {
        if name != title {
            let _ = write!(out, "\n## {name}\n");
        }
        out += &paragraph(part);
        if !part["properties"].is_null() {
            out += &table(&without_contained(part, &schema["$defs"]), &schema["$defs"]);
        } else {
            out += &choices(part, &schema["$defs"]);
        }
    }
    out
}

/// An object without the keys of smaller parts that it contains as they are; `contains` has their names.
fn without_contained(object: &Value, parts: &Value) -> Value {
    let mut own = object.clone();
    let size = |part: &Value| part["properties"].as_object().map_or(0, serde_json::Map::len);
    let mut smaller: Vec<_> = parts.as_object().into_iter().flatten().collect();
    smaller.retain(|(_, part)| size(part) >= REPEATED && size(part) < size(object));
    smaller.sort_by_key(|(_, part)| std::cmp::Reverse(size(part)));
    for (name, part) in smaller {
        let Some(keys) = own["properties"].as_object_mut() else { continue };
        let part = part["properties"].as_object();
        if part.into_iter().flatten().all(|(key, value)| keys.get(key) == Some(value)) {
            part.into_iter().flatten().for_each(|(key, _)| drop(keys.remove(key)));
            let contains = own["contains"].as_str().map_or_else(String::new, |before| format!("{before}, "));
            own["contains"] = format!("{contains}[{name}](#{})", name.to_lowercase()).into();
        }
    }
    own
}

/// What a part is.
fn paragraph(part: &Value) -> String {
    part["description"].as_str().map_or_else(String::new, |text| format!("\n{}\n", escape(text)))
}

/// The rows of an object, and below them what is too long for a cell.
fn table(object: &Value, parts: &Value) -> String {
    let mut out = "\n| Key | Takes | Meaning |\n|---|---|---|\n".to_owned();
    let mut notes = String::new();
    let is_required = |key: &str| object["required"].as_array().is_some_and(|all| all.iter().any(|one| one == key));
    for (key, value) in object["properties"].as_object().into_iter().flatten() {
        let (about, default) = (description(value, parts), &value["default"]);
        let default = if default.is_null() { String::new() } else { format!(" Default: {default}.") };
        let required = if is_required(key) { " **Required.**" } else { "" };
        let about = escape(&format!("{about}{default}{required}"));
        let (takes, meaning) = (takes_without_words(value), about.trim());
        let cells = [&takes, meaning].map(|text| text.chars().count() <= WIDEST);
        let short = |fits: bool, text: &str| if fits { text.to_owned() } else { "below".to_owned() };
        let _ = writeln!(out, "| `{key}` | {} | {} |", short(cells[0], &takes), short(cells[1], meaning));
        let long = [(cells[0], takes.as_str()), (cells[1], meaning)].into_iter().filter(|(fits, _)| !fits);
        long.for_each(|(_, text)| notes += &format!("* `{key}`: {text}\n"));
    }
    if object["properties"].is_object() && object["additionalProperties"].is_object() {
        let _ = writeln!(out, "| any other name | {} | what has this name |", takes(&object["additionalProperties"]));
    }
    if let Some(names) = object["contains"].as_str() {
        let _ = writeln!(out, "| all keys of | {names} | as there |");
    }
    if notes.is_empty() { out } else { format!("{out}\n{notes}") }
}

/// What a key means: its own sentence, else that of the named part it takes.
fn description<'a>(value: &'a Value, parts: &'a Value) -> &'a str {
    let part = value["$ref"].as_str().and_then(|part| part.strip_prefix("#/$defs/"));
    let of_part = || part.and_then(|part| parts[part]["description"].as_str());
    value["description"].as_str().or_else(of_part).unwrap_or_default()
}

/// The members of a part that is one of several: a table for each that has keys, a line for each that has none.
fn choices(part: &Value, parts: &Value) -> String {
    let (mut lines, mut tables) = (String::new(), String::new());
    for one in ["oneOf", "anyOf"].iter().flat_map(|key| part[*key].as_array().into_iter().flatten()) {
        let about = one["description"].as_str().map_or_else(String::new, |about| format!(": {}", escape(about)));
        if one["properties"].is_null() {
            let _ = writeln!(lines, "* {}{about}", takes_without_words(one));
        } else {
            let _ = write!(tables, "\n**{}**{about}\n{}", kind(one), table(one, parts));
        }
    }
    let lines = if lines.is_empty() { lines } else { format!("\n{lines}") };
    lines + &tables
}

/// What distinguishes a member: the constant that its keys have, or its first key.
fn kind(object: &Value) -> String {
    let mut keys = object["properties"].as_object().into_iter().flatten();
    let constant = keys.clone().find_map(|(key, value)| Some(format!("`\"{key}\": {}`", value.get("const")?)));
    constant.or_else(|| keys.next().map(|(key, _)| format!("`{key}`"))).unwrap_or_default()
}

/// What a key takes, in few words.
fn takes(value: &Value) -> String {
    let mut all = members(value);
    all.dedup();
    all.join(" or ")
}

fn takes_without_words(value: &Value) -> String {
    let text = takes(value);
    if text.is_empty() { "anything".to_owned() } else { text }
}

fn members(value: &Value) -> Vec<String> {
    if let Some(part) = value["$ref"].as_str().and_then(|part| part.strip_prefix("#/$defs/")) {
        return vec![format!("[{part}](#{})", part.to_lowercase())];
    }
    if let Some(constant) = value.get("const") {
        return vec![format!("`{constant}`")];
    }
    if let Some(words) = value["enum"].as_array() {
        return words.iter().map(|word| format!("`{word}`")).collect();
    }
    for key in ["anyOf", "oneOf", "allOf"] {
        if let Some(all) = value[key].as_array() {
            return all.iter().flat_map(members).collect();
        }
    }
    match &value["type"] {
        Value::String(kind) => of_kind(kind, value),
        Value::Array(kinds) => kinds.iter().filter_map(Value::as_str).flat_map(|kind| of_kind(kind, value)).collect(),
        _ => vec![],
    }
}

fn of_kind(kind: &str, value: &Value) -> Vec<String> {
    let of = |inner: &Value, what: &str| match takes(inner) {
        inner if inner.is_empty() => what.to_owned(),
        inner => format!("{what} of {inner}"),
    };
    vec![match kind {
        "array" => of(&value["items"], "list"),
        "object" if value["additionalProperties"].is_object() => of(&value["additionalProperties"], "names"),
        "object" => object(value),
        "string" => "text".to_owned(),
        "boolean" => "true or false".to_owned(),
        other => other.to_owned(),
    }]
}

/// An object that has no name of its own.
fn object(value: &Value) -> String {
    let keys: Vec<String> =
        value["properties"].as_object().into_iter().flatten().map(|(key, _)| format!("`{key}`")).collect();
    if keys.is_empty() { "object".to_owned() } else { format!("{{ {} }}", keys.join(", ")) }
}

/// One line, in which no bar ends a cell.
fn escape(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ").replace('|', "\\|")
}
