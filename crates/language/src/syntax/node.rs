//! JSON values with their places.

use crate::syntax::path::behind;
use std::sync::Arc;

/// Where a value was written.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum SourcePosition {
    /// In the case file; both from 1, columns in characters.
    Text {
        /// Line.
        line: usize,
        /// Column.
        column: usize,
    },
    /// In this `--set` option.
    Option(Arc<str>),
}

/// A value and its place.
#[derive(Clone, PartialEq, Debug)]
pub struct Node {
    /// What.
    pub value: Value,
    /// Where.
    pub place: SourcePosition,
}

/// A JSON value; objects keep the order of the file.
#[derive(Clone, PartialEq, Debug)]
pub enum Value {
    /// null
    Null,
    /// true or false
    Bool(bool),
    /// Finite.
    Number(f64),
    /// Without its quotes and escapes.
    Text(String),
    /// [...]
    Array(Vec<Node>),
    /// {...}
    Object(Vec<Property>),
}

/// A key and its value.
#[derive(Clone, PartialEq, Debug)]
pub struct Property {
    /// The key.
    pub key: String,
    /// Where the key stands.
    pub place: SourcePosition,
    /// The value.
    pub node: Node,
}

impl Node {
    /// The member of an object, or the entry of an array, at the end of a path.
    #[must_use]
    pub fn find(&self, path: &str) -> Option<&Self> {
        if path.is_empty() {
            return Some(self);
        }
        match &self.value {
            // Keys may hold slashes themselves ("probes/tip/displacement/2"), so every fitting key is tried.
            Value::Object(members) => members.iter().find_map(|member| member.node.find(behind(path, &member.key)?)),
            Value::Array(entries) => {
                let (index, rest) = path.split_once('/').unwrap_or((path, ""));
                entries.get(index.parse::<usize>().ok()?)?.find(rest)
            }
            _ => None,
        }
    }

    /// "an object", "a text": for messages.
    #[must_use]
    pub fn what(&self) -> &'static str {
        match &self.value {
            Value::Null => "null",
            Value::Bool(_) => "true or false",
            Value::Number(_) => "a number",
            Value::Text(_) => "a text",
            Value::Array(_) => "a list",
            Value::Object(_) => "an object",
        }
    }

    /// A value that was written nowhere, with line 0.
    #[must_use]
    pub fn from_json(value: &serde_json::Value) -> Self {
        use serde_json::Value as Json;
        let place = SourcePosition::Text { line: 0, column: 0 };
        let property = |(key, value): (&String, &Json)| Property {
            key: key.clone(),
            place: place.clone(),
            node: Self::from_json(value),
        };
        let own = match value {
            Json::Null => Value::Null,
            Json::Bool(value) => Value::Bool(*value),
            // Every number of this library reads as one: it keeps no digits beyond.
            Json::Number(value) => Value::Number(value.as_f64().unwrap_or(f64::NAN)),
            Json::String(text) => Value::Text(text.clone()),
            Json::Array(entries) => Value::Array(entries.iter().map(Self::from_json).collect()),
            Json::Object(members) => Value::Object(members.iter().map(property).collect()),
        };
        Self { value: own, place }
    }

    /// The same value without its place; numbers without a fraction become integers.
    #[must_use]
    pub fn to_json(&self) -> serde_json::Value {
        match &self.value {
            Value::Null => serde_json::Value::Null,
            Value::Bool(value) => (*value).into(),
            Value::Number(value) if value.fract() == 0.0 && value.abs() < 9e15 => (*value as i64).into(),
            Value::Number(value) => (*value).into(),
            Value::Text(text) => text.as_str().into(),
            Value::Array(entries) => entries.iter().map(Self::to_json).collect(),
            Value::Object(members) => members.iter().map(|m| (m.key.clone(), m.node.to_json())).collect(),
        }
    }
}
