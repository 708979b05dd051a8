//! Plain values: numbers with units, texts, lists, maps.

use crate::expression::Formula;
use crate::quantity::Want;
use crate::schema::json::{Definitions, minimum, quantity, vector};
use crate::schema::read::{Read, Reader};
use crate::syntax::{At, Node, Value, quoted};
use serde_json::{Value as Json, json};
use std::collections::BTreeMap;

/// Integers beyond this are not exact in JSON.
const LARGEST_INTEGER: f64 = 9_007_199_254_740_992.0;

impl Read for Formula {
    fn read(node: &Node, at: &At, want: Want, reader: &mut Reader<'_>) -> Option<Self> {
        let formula = match &node.value {
            Value::Number(value) => Self::number(*value),
            Value::Text(text) => match Self::parse(text, &reader.units) {
                Ok(formula) => formula,
                Err(error) => {
                    reader.complain(node, at, error.to_string());
                    return None;
                }
            },
            _ => {
                reader.expected(node, at, "a number, or a text with a unit or formula,");
                return None;
            }
        };
        if let Some(why) = unexpected_time(&formula, at, want, reader) {
            reader.complain(node, at, why);
            return None;
        }
        if let Some(Err(why)) = want.dimension.map(|dimension| formula.check(dimension)) {
            reader.complain(node, at, why);
            return None;
        }
        if let Some((value, why)) = formula.constant().and_then(|value| Some((value, want.refuses(value)?))) {
            reader.complain(node, at, format!("{why}, found {value}"));
            return None;
        }
        Some(formula)
    }

    fn schema(want: Want, definitions: &mut Definitions) -> Json {
        let part = definitions.part("Formula", |_| {
            json!({
                "type": ["number", "string"],
                "description": "A number in the case's units, or a text with units or a formula of X, Y, Z (and of the time t where it may change): \
                 \"100 kPa * (X < 0.6 m)\".",
            })
        });
        quantity(part, want)
    }
}

/// Why a formula cannot be one of the time here.
fn unexpected_time(formula: &Formula, at: &At, want: Want, reader: &Reader<'_>) -> Option<String> {
    if !formula.uses_time() {
        return None;
    }
    let text = quoted(formula.text());
    if !want.in_time && at.as_str().starts_with("supports/") {
        return Some(format!(
            "{text} depends on the time t, which supports do not: a surface that moves in time is an actuation, {{ \"name\": \"base\", \"kind\": \"motion\", \
             \"surface\": \"x-\", \"translation\": [\"5 mm * sin(20 * t / (1 s))\", 0, 0] }}"
        ));
    }
    if !want.in_time {
        return Some(format!(
            "{text} depends on the time t, which this does not: starts and bounds of controls, values of actuations, loads and targets may"
        ));
    }
    let still = reader.document.root().find("time").is_none();
    still.then(|| {
        format!("{text} depends on the time t, and the case is static: give \"time\": {{ \"end\": \"1 s\", \"step\": \"10 ms\" }}")
    })
}

/// The same everywhere: no X, Y, Z.
impl Read for f64 {
    fn read(node: &Node, at: &At, want: Want, reader: &mut Reader<'_>) -> Option<Self> {
        let formula = Formula::read(node, at, want, reader)?;
        if formula.constant().is_none() {
            let message = format!("{} depends on X, Y or Z, but one number is wanted", quoted(formula.text()));
            reader.complain(node, at, message);
        }
        formula.constant()
    }

    fn schema(want: Want, definitions: &mut Definitions) -> Json {
        let part = definitions.part("Constant", |_| {
            json!({
                "type": ["number", "string"],
                "description": "A number in the case's units, or a text with a unit: \"30 mm\", \"1/3\".",
            })
        });
        quantity(part, want)
    }

    fn to_json(&self) -> Option<Json> {
        Some((*self).into())
    }
}

impl Read for u64 {
    fn read(node: &Node, at: &At, want: Want, reader: &mut Reader<'_>) -> Option<Self> {
        let least = minimum(want);
        let Value::Number(value) = node.value else {
            reader.expected(node, at, "a whole number");
            return None;
        };
        if value.fract() != 0.0 || value > LARGEST_INTEGER || value < least as f64 {
            reader.complain(node, at, format!("a whole number of at least {least} was expected, found {value}"));
            return None;
        }
        Some(value as Self)
    }

    fn schema(want: Want, _: &mut Definitions) -> Json {
        json!({ "type": "integer", "minimum": minimum(want) })
    }

    fn to_json(&self) -> Option<Json> {
        Some((*self).into())
    }
}

impl Read for usize {
    fn read(node: &Node, at: &At, want: Want, reader: &mut Reader<'_>) -> Option<Self> {
        let value = u64::read(node, at, want, reader)?;
        let small = Self::try_from(value).ok();
        if small.is_none() {
            reader.complain(node, at, format!("{value} is too large"));
        }
        small
    }

    fn schema(want: Want, definitions: &mut Definitions) -> Json {
        u64::schema(want, definitions)
    }

    fn to_json(&self) -> Option<Json> {
        Some((*self).into())
    }
}

impl Read for bool {
    fn read(node: &Node, at: &At, _: Want, reader: &mut Reader<'_>) -> Option<Self> {
        let Value::Bool(value) = node.value else {
            reader.expected(node, at, "true or false");
            return None;
        };
        Some(value)
    }

    fn schema(_: Want, _: &mut Definitions) -> Json {
        json!({ "type": "boolean" })
    }

    fn to_json(&self) -> Option<Json> {
        Some((*self).into())
    }
}

impl Read for String {
    fn read(node: &Node, at: &At, _: Want, reader: &mut Reader<'_>) -> Option<Self> {
        match &node.value {
            Value::Text(text) if text.trim().is_empty() => {
                reader.complain(node, at, "this text must not be empty");
                None
            }
            Value::Text(text) => Some(text.clone()),
            _ => {
                reader.expected(node, at, "a text");
                None
            }
        }
    }

    fn schema(_: Want, _: &mut Definitions) -> Json {
        json!({ "type": "string", "minLength": 1 })
    }
}

impl<T: Read> Read for Option<T> {
    fn absent() -> Option<Self> {
        Some(None)
    }

    fn read(node: &Node, at: &At, want: Want, reader: &mut Reader<'_>) -> Option<Self> {
        T::read(node, at, want, reader).map(Some)
    }

    fn schema(want: Want, definitions: &mut Definitions) -> Json {
        T::schema(want, definitions)
    }
}

/// Large blocks of enums.
impl<T: Read> Read for Box<T> {
    fn absent() -> Option<Self> {
        T::absent().map(Self::new)
    }

    fn read(node: &Node, at: &At, want: Want, reader: &mut Reader<'_>) -> Option<Self> {
        T::read(node, at, want, reader).map(Self::new)
    }

    fn schema(want: Want, definitions: &mut Definitions) -> Json {
        T::schema(want, definitions)
    }
}

/// Entries that cannot be read are complained about and left out, so that the others are still checked.
impl<T: Read> Read for Vec<T> {
    fn read(node: &Node, at: &At, want: Want, reader: &mut Reader<'_>) -> Option<Self> {
        let Value::Array(entries) = &node.value else {
            reader.expected(node, at, "a list [ ... ]");
            return None;
        };
        let entries = entries.iter().enumerate();
        Some(entries.filter_map(|(i, entry)| T::read(entry, &at.index(i), want, reader)).collect())
    }

    fn schema(want: Want, definitions: &mut Definitions) -> Json {
        json!({ "type": "array", "items": T::schema(want, definitions) })
    }
}

impl<T: Read> Read for BTreeMap<String, T> {
    fn read(node: &Node, at: &At, want: Want, reader: &mut Reader<'_>) -> Option<Self> {
        let members = reader.members(node, at)?;
        let read = members.iter().filter_map(|member| {
            let value = T::read(&member.node, &at.key(&member.key), want, reader)?;
            Some((member.key.clone(), value))
        });
        Some(read.collect())
    }

    fn schema(want: Want, definitions: &mut Definitions) -> Json {
        json!({ "type": "object", "additionalProperties": T::schema(want, definitions) })
    }
}

/// Two or three constant entries.
#[derive(Clone, PartialEq, Debug)]
pub struct Vector(Vec<f64>);

impl Vector {
    /// As written: two or three entries.
    #[must_use]
    pub fn entries(&self) -> &[f64] {
        &self.0
    }

    /// With zero for a third entry left out.
    #[must_use]
    pub fn xyz(&self) -> [f64; 3] {
        std::array::from_fn(|i| self.0.get(i).copied().unwrap_or(0.0))
    }
}

impl Read for Vector {
    fn read(node: &Node, at: &At, want: Want, reader: &mut Reader<'_>) -> Option<Self> {
        entries(node, at, want, reader).map(Self)
    }

    fn schema(want: Want, definitions: &mut Definitions) -> Json {
        vector::<f64>(want, definitions)
    }
}

/// Two or three entries, all of which must be readable.
pub(crate) fn entries<T: Read>(node: &Node, at: &At, want: Want, reader: &mut Reader<'_>) -> Option<Vec<T>> {
    let Value::Array(nodes) = &node.value else {
        reader.expected(node, at, "a list of two or three entries");
        return None;
    };
    let read = Vec::<T>::read(node, at, want, reader)?;
    if !(2..=3).contains(&nodes.len()) {
        reader.complain(node, at, format!("two or three entries were expected, found {}", nodes.len()));
        return None;
    }
    (read.len() == nodes.len()).then_some(read)
}
