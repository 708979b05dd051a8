//! Places of a mesh: the name of one group, or a list of names that stand for their union.

use crate::quantity::{Units, Want};
use crate::schema::json::{Definitions, any_of};
use crate::schema::read::{Read, Reader};
use crate::syntax::{At, Document, Node, Value, quoted};
use nastic_mesh::GroupNames;
use serde_json::{Value as Json, json};

/// The names that a node of a document holds, if they can be read; what is wrong with them is reported when the case is read.
#[must_use]
pub fn group_names(document: &Document, node: &Node, at: &At) -> Option<GroupNames> {
    GroupNames::read(node, at, Want::ANY, &mut Reader::new(document, Units::default()))
}

impl Read for GroupNames {
    fn read(node: &Node, at: &At, want: Want, reader: &mut Reader<'_>) -> Option<Self> {
        let Value::Array(entries) = &node.value else {
            if !matches!(node.value, Value::Text(_)) {
                reader.expected(node, at, "a name, or a list of names,");
                return None;
            }
            return String::read(node, at, want, reader).map(Self::from);
        };
        if entries.is_empty() {
            reader.complain(node, at, "a list of names needs at least one");
            return None;
        }
        let names = Vec::<String>::read(node, at, want, reader)?;
        let repeated = (0..names.len()).find(|&i| names[..i].contains(&names[i]));
        if let Some(i) = repeated {
            reader.complain(node, at, format!("{} is named twice", quoted(&names[i])));
        }
        (names.len() == entries.len() && repeated.is_none()).then(|| names.into())
    }

    fn schema(want: Want, definitions: &mut Definitions) -> Json {
        definitions.part("GroupNames", |definitions| {
            let name = String::schema(want, definitions);
            let list = json!({ "type": "array", "items": name, "minItems": 1, "uniqueItems": true });
            let mut schema = any_of(vec![name, list]);
            schema["description"] = "A name, or a list of names that stand for their union.".into();
            schema
        })
    }
}
