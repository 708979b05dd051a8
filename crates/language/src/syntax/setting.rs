//! One value put in the place of another.

use crate::syntax::diagnostic::{Diagnostic, Diagnostics};
use crate::syntax::nearest;
use crate::syntax::node::{Node, Property, SourcePosition, Value};
use crate::syntax::parse::parse;
use crate::syntax::path::behind;

/// A path and the value it shall have: from `--set path=value`, or from the `set` of a scenario or load case.
#[derive(Clone, PartialEq, Debug)]
pub struct Setting {
    /// `materials/0/mu1`
    pub path: String,
    /// The value, which remembers where it was written.
    pub node: Node,
}

impl Setting {
    /// From the option `path=value`: the value is JSON if it reads as JSON, otherwise a text.
    ///
    /// # Errors
    ///
    /// No "=", or no path before it.
    pub fn option(text: &str) -> Result<Self, Diagnostics> {
        let place = SourcePosition::Option(text.into());
        match text.split_once('=') {
            Some((path, value)) if !path.trim().is_empty() => {
                let path = path.trim().trim_matches('/').to_string();
                Ok(Self { path, node: value_of(value.trim(), &place) })
            }
            _ => Err(complaint(&place, "", "", "path=value was expected, as in materials/0/mu1=90 kPa").into()),
        }
    }

    /// The diagnostic of this setting; `file` names the case it was read from.
    pub(super) fn complaint(&self, file: &str, message: &str) -> Diagnostic {
        complaint(&self.node.place, file, &self.path, message)
    }

    /// Puts the value into `root`. The last step of the path may be a new key; everything before it must exist.
    pub(super) fn apply(&self, root: &mut Node) -> Result<(), String> {
        put(root, &self.path, "", &self.node)
    }
}

pub(super) fn complaint(place: &SourcePosition, named: &str, path: &str, message: &str) -> Diagnostic {
    let (file, line, column) = match place {
        SourcePosition::Text { line, column } => (named.to_string(), *line, *column),
        SourcePosition::Option(text) => (format!("--set {text}"), 0, 0),
    };
    Diagnostic { file, path: path.to_string(), line, column, message: message.to_string() }
}

fn value_of(text: &str, place: &SourcePosition) -> Node {
    let mut problems = Vec::new();
    match parse("", text, &mut problems) {
        Some(mut node) if problems.is_empty() => {
            replace_places(&mut node, place);
            node
        }
        _ => Node { value: Value::Text(text.to_string()), place: place.clone() },
    }
}

fn replace_places(node: &mut Node, place: &SourcePosition) {
    node.place = place.clone();
    match &mut node.value {
        Value::Array(entries) => entries.iter_mut().for_each(|entry| replace_places(entry, place)),
        Value::Object(members) => {
            for member in members {
                member.place = place.clone();
                replace_places(&mut member.node, place);
            }
        }
        _ => {}
    }
}

/// `done` is the part of the path already walked, for messages.
fn put(node: &mut Node, path: &str, done: &str, new: &Node) -> Result<(), String> {
    if path.is_empty() {
        *node = new.clone();
        return Ok(());
    }
    let here = if done.is_empty() { "the case".to_string() } else { format!("\"{done}\"") };
    let what = node.what();
    match &mut node.value {
        Value::Object(members) => {
            let fitting = members.iter().filter(|m| behind(path, &m.key).is_some());
            let best = fitting.max_by_key(|m| m.key.len()).map(|m| m.key.clone());
            if let Some(member) = members.iter_mut().find(|m| Some(&m.key) == best.as_ref()) {
                let rest = behind(path, &member.key).unwrap_or("");
                let done = join(done, &member.key);
                return put(&mut member.node, rest, &done, new);
            }
            let Some((missing, _)) = path.split_once('/') else {
                members.push(Property { key: path.to_string(), place: new.place.clone(), node: new.clone() });
                return Ok(());
            };
            let known: Vec<&str> = members.iter().map(|m| m.key.as_str()).collect();
            Err(format!("{here} has no \"{missing}\"{}", nearest::clause(missing, &known)))
        }
        Value::Array(entries) => {
            let (index, rest) = path.split_once('/').unwrap_or((path, ""));
            let count = entries.len();
            match index.parse::<usize>().ok().and_then(|i| entries.get_mut(i)) {
                Some(entry) => put(entry, rest, &join(done, index), new),
                None if count == 0 => Err(format!("{here} is an empty list, it has no \"{index}\"")),
                None => Err(format!("{here} has no entry \"{index}\": its entries are 0 to {}", count - 1)),
            }
        }
        _ => Err(format!("{here} is {what}, it has no \"{path}\"")),
    }
}

fn join(done: &str, key: &str) -> String {
    if done.is_empty() { key.to_string() } else { format!("{done}/{key}") }
}
