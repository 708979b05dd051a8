//! JSON Schema (draft 2020-12) of blocks, from the same description the reader uses.

use crate::catalogue::Catalogue;
use crate::quantity::{Sign, Want};
use crate::schema::read::{Choice, Key, Object, Read};
use serde_json::{Map, Value as Json, json};
use std::collections::BTreeMap;

/// The named parts of the schema, each described once.
pub(crate) struct Definitions {
    parts: BTreeMap<String, Json>,
    /// The names that may stand in a case.
    pub(crate) catalogue: Catalogue,
}

impl Definitions {
    /// The schema of a whole file that is one `T`.
    pub(crate) fn document<T: Object>(title: &str, catalogue: &Catalogue) -> Json {
        let mut definitions = Self { parts: BTreeMap::new(), catalogue: catalogue.clone() };
        let root = definitions.describe::<T>(None);
        let mut schema = Map::new();
        schema.insert("$schema".into(), "https://json-schema.org/draft/2020-12/schema".into());
        schema.insert("title".into(), title.into());
        if let Json::Object(root) = root {
            schema.extend(root);
        }
        schema.insert("$defs".into(), Json::Object(definitions.parts.into_iter().collect()));
        Json::Object(schema)
    }

    /// A reference to the part `name`, which `build` describes when it is met first.
    pub(crate) fn part(&mut self, name: &str, build: impl FnOnce(&mut Self) -> Json) -> Json {
        if !self.parts.contains_key(name) {
            self.parts.insert(name.to_string(), Json::Null);
            let description = build(self);
            self.parts.insert(name.to_string(), description);
        }
        json!({ "$ref": format!("#/$defs/{name}") })
    }

    /// A block; `tag` is the key and value that chooses it.
    pub(crate) fn object<T: Object>(&mut self, tag: Option<(&str, &str)>) -> Json {
        self.part(T::NAME, |definitions| definitions.describe::<T>(tag))
    }

    /// Words, and words that carry values.
    pub(crate) fn choice(&mut self, choices: &[Choice]) -> Json {
        let word = |choice: &Choice| json!({ "const": choice.name, "description": choice.about.trim() });
        let mut options: Vec<Json> = choices.iter().filter(|choice| choice.schema.is_none()).map(word).collect();
        for choice in choices {
            let Some(schema) = choice.schema else { continue };
            let name = choice.name;
            options.push(json!({
                "type": "object",
                "description": choice.about.trim(),
                "properties": { name: schema(self) },
                "required": [name],
                "additionalProperties": false,
            }));
        }
        json!({ "oneOf": options })
    }

    fn describe<T: Object>(&mut self, tag: Option<(&str, &str)>) -> Json {
        block_schema(T::ABOUT, tag, T::keys(self), T::ALTERNATIVES)
    }
}

/// A block with these keys; `tag` is the key and value that chooses it, exactly one of `alternatives` must be there.
pub(crate) fn block_schema(about: &str, tag: Option<(&str, &str)>, keys: Vec<Key>, alternatives: &[&str]) -> Json {
    let mut properties = Map::new();
    let mut required = Vec::new();
    if let Some((key, value)) = tag {
        properties.insert(key.to_string(), json!({ "const": value }));
        required.push(key.to_string());
    }
    for key in keys {
        if key.required {
            required.push(key.name.to_string());
        }
        properties.insert(key.name.to_string(), key.described());
    }
    let mut out = Map::new();
    out.insert("type".into(), "object".into());
    out.insert("description".into(), about.trim().into());
    out.insert("properties".into(), properties.into());
    out.insert("required".into(), required.into());
    out.insert("additionalProperties".into(), false.into());
    if !alternatives.is_empty() {
        let one: Vec<Json> = alternatives.iter().map(|key| json!({ "required": [key] })).collect();
        out.insert("oneOf".into(), one.into());
    }
    Json::Object(out)
}

/// A number's schema: the type and what is wanted of it.
pub(crate) fn quantity(part: Json, want: Want) -> Json {
    let kind = want.dimension.map(|dimension| match dimension.is_none() {
        true => dimension.to_string(),
        false => format!("{dimension} ({})", dimension.examples()),
    });
    let sign = match want.sign {
        Sign::Any => None,
        Sign::NotNegative => Some("not negative".to_string()),
        Sign::Positive => Some("positive".to_string()),
    };
    let text: Vec<String> = kind.into_iter().chain(sign).collect();
    if text.is_empty() { part } else { annotated(part, &text.join(", "), None) }
}

/// Adds what the key is for in front of what its type says.
pub(crate) fn annotated(mut schema: Json, about: &str, default: Option<Json>) -> Json {
    if let Json::Object(map) = &mut schema {
        let text = match map.get("description").and_then(Json::as_str) {
            Some(own) => format!("{about} [{own}]"),
            None => about.to_string(),
        };
        map.insert("description".into(), text.into());
        if let Some(default) = default {
            map.insert("default".into(), default);
        }
    }
    schema
}

/// The least an integer may be.
pub(crate) fn minimum(want: Want) -> u64 {
    u64::from(want.sign == Sign::Positive)
}

/// One of several types.
pub(crate) fn any_of(options: Vec<Json>) -> Json {
    json!({ "anyOf": options })
}

/// A list of two or three entries.
pub(crate) fn vector<T: Read>(want: Want, definitions: &mut Definitions) -> Json {
    json!({ "type": "array", "items": T::schema(want, definitions), "minItems": 2, "maxItems": 3 })
}
