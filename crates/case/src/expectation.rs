//! The block `expect` against a result.

use nastic_language::schema::{Command, Expectation};
use serde_json::Value;
use std::collections::BTreeMap;
use std::fmt;

/// An expectation that was not met.
#[derive(Clone, PartialEq, Debug)]
pub struct Missed {
    /// Path in `result.json`.
    pub path: String,
    /// The value found, if there is a number.
    pub found: Option<f64>,
    /// The value expected.
    pub expected: f64,
    /// Largest deviation allowed.
    pub tolerance: f64,
    /// What there is instead of a number.
    pub instead: String,
}

impl fmt::Display for Missed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { path, expected, tolerance, .. } = self;
        match self.found {
            Some(found) => {
                let off = (found - expected).abs();
                write!(f, "{path} is {found}, expected {expected} within {tolerance:e} (off by {off:.3e})")
            }
            None => write!(f, "{path} was expected to be {expected}, but {}", self.instead),
        }
    }
}

/// How many expectations the command has, and which it missed. A command that was asked for something else than its
/// usual result is held only to the values that it has.
#[must_use]
pub fn judge(
    expect: &BTreeMap<String, Expectation>,
    command: &Command,
    usual: bool,
    result: &Value,
) -> (usize, Vec<Missed>) {
    let mut checked = 0;
    let mut missed = Vec::new();
    for (path, expectation) in expect {
        let mine = expectation.command.as_ref() == Some(command);
        if !mine && expectation.command.is_some() {
            continue;
        }
        let value = find(result, path);
        let found = value.and_then(Value::as_f64);
        if found.is_none() && !(mine && usual) {
            // Belongs to every command that has such a value.
            continue;
        }
        checked += 1;
        if !found.is_some_and(|found| expectation.is_met_by(found)) {
            let relative = expectation.relative.map_or(0.0, |part| part * expectation.value.abs());
            let instead = match value {
                None => format!("the result has no such value; {}", nearest(result, path)),
                Some(other) => format!("the result has {other} there"),
            };
            missed.push(Missed {
                path: path.clone(),
                found,
                expected: expectation.value,
                tolerance: expectation.absolute.unwrap_or(0.0).max(relative),
                instead,
            });
        }
    }
    (checked, missed)
}

/// The value at a path: keys and indices joined by slashes. Keys may hold slashes themselves.
#[must_use]
pub fn find<'v>(value: &'v Value, path: &str) -> Option<&'v Value> {
    if path.is_empty() {
        return Some(value);
    }
    match value {
        Value::Object(members) => members.iter().find_map(|(key, member)| {
            let rest = path.strip_prefix(key.as_str())?;
            if rest.is_empty() { Some(member) } else { find(member, rest.strip_prefix('/')?) }
        }),
        Value::Array(entries) => {
            let (index, rest) = path.split_once('/').unwrap_or((path, ""));
            find(entries.get(index.parse::<usize>().ok()?)?, rest)
        }
        _ => None,
    }
}

/// What there is at the deepest part of the path that exists.
fn nearest(result: &Value, path: &str) -> String {
    let mut part = path;
    loop {
        part = part.rsplit_once('/').map_or("", |(front, _)| front);
        let Some(value) = find(result, part) else { continue };
        let place = if part.is_empty() { "result.json".to_owned() } else { format!("\"{part}\"") };
        return match value {
            Value::Object(members) => {
                format!("{place} has: {}", members.keys().cloned().collect::<Vec<_>>().join(", "))
            }
            Value::Array(entries) => format!("{place} has {} entries", entries.len()),
            other => format!("{place} is {other}"),
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn paths_walk_objects_and_lists() {
        let value = json!({ "probes": { "tip": { "displacement": [1, 2, 3] } }, "a/b": { "c": 4 } });
        assert_eq!(find(&value, "probes/tip/displacement/2"), Some(&json!(3)));
        assert_eq!(find(&value, "a/b/c"), Some(&json!(4)));
        assert_eq!(find(&value, "probes/top"), None);
        assert_eq!(find(&value, "probes/tip/displacement/3"), None);
        assert_eq!(nearest(&value, "probes/top/x"), "\"probes\" has: tip");
        assert_eq!(nearest(&value, "cost"), "result.json has: probes, a/b");
    }
}
