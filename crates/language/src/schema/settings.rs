//! The key `set` of scenarios and load cases.

use crate::quantity::Want;
use crate::schema::case::CHANGEABLE;
use crate::schema::json::Definitions;
use crate::schema::read::{Read, Reader};
use crate::syntax::{At, Node, Setting, quoted};
use serde_json::{Value as Json, json};

/// `{ "path": value, ... }`: all settings of a variant. The values are read later, in their place.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Settings(pub Vec<Setting>);

impl Read for Settings {
    fn absent() -> Option<Self> {
        Some(Self::default())
    }

    fn read(node: &Node, at: &At, _: Want, reader: &mut Reader<'_>) -> Option<Self> {
        let members = reader.members(node, at)?;
        for member in members {
            check_path(&member.key, &at.key(&member.key), reader);
        }
        Some(Self(members.iter().map(|m| Setting { path: m.key.clone(), node: m.node.clone() }).collect()))
    }

    fn schema(_: Want, _: &mut Definitions) -> Json {
        let heads = CHANGEABLE.join("|");
        json!({ "type": "object", "propertyNames": { "pattern": format!("^(({heads})/|controls/[0-9]+/projection/eta$)") } })
    }
}

/// Whether a path is the threshold of a projection, which distinguishes eroded and dilated variants of one design.
fn is_threshold(path: &str) -> bool {
    let number = path.strip_prefix("controls/").and_then(|rest| rest.strip_suffix("/projection/eta"));
    number.is_some_and(|number| !number.is_empty() && number.bytes().all(|digit| digit.is_ascii_digit()))
}

/// Complains about a path outside the blocks that may vary.
pub(crate) fn check_path(path: &str, at: &At, reader: &mut Reader<'_>) {
    let (head, rest) = path.split_once('/').unwrap_or((path, ""));
    let of_load_case = at.as_str().starts_with("load_cases");
    if is_threshold(path) && !of_load_case {
        return;
    }
    if !CHANGEABLE.contains(&head) {
        let list = CHANGEABLE.join(", ");
        let message = format!(
            "{} cannot vary between scenarios or load cases, only {list} can, and \"controls/K/projection/eta\" between scenarios",
            quoted(head)
        );
        reader.complain_at(at, message);
    } else if rest.is_empty() {
        reader.complain_at(at, format!("a path to one value was expected, as in \"{head}/0/...\""));
    }
}
