//! Nodes to typed values, every problem noted.

use crate::quantity::{Units, Want};
use crate::schema::hints::{self, Hint};
use crate::schema::json::{Definitions, annotated};
use crate::syntax::{At, Diagnostic, Document, Node, Property, Value, nearest, quoted};
use serde_json::Value as Json;

/// A type a key may have.
pub(crate) trait Read: Sized {
    /// The value when the key is left out; `None` makes the key required.
    fn absent() -> Option<Self> {
        None
    }

    /// Reads a node; `None` after at least one complaint to `reader`.
    fn read(node: &Node, at: &At, want: Want, reader: &mut Reader<'_>) -> Option<Self>;

    /// The JSON Schema of all nodes `read` accepts.
    fn schema(want: Want, definitions: &mut Definitions) -> Json;

    /// A default value, for the schema.
    fn to_json(&self) -> Option<Json> {
        None
    }
}

/// A block with fixed keys; made by `object!`.
pub(crate) trait Object: Sized {
    const NAME: &'static str;
    const ABOUT: &'static str;
    /// Exactly one of these must be there; empty for no such rule.
    const ALTERNATIVES: &'static [&'static str];

    fn names() -> Vec<&'static str>;
    fn keys(definitions: &mut Definitions) -> Vec<Key>;
    /// The block with no key given, unless one is required.
    fn defaults() -> Option<Self>;
    fn read_keys(node: &Node, at: &At, reader: &mut Reader<'_>) -> Option<Self>;
}

/// One key of a block, for the schema.
pub(crate) struct Key {
    pub(crate) name: &'static str,
    pub(crate) about: String,
    pub(crate) required: bool,
    pub(crate) default: Option<Json>,
    pub(crate) schema: Json,
}

impl Key {
    pub(crate) fn new<T: Read>(
        name: &'static str,
        about: &str,
        want: Want,
        default: Option<T>,
        definitions: &mut Definitions,
    ) -> Self {
        Self {
            name,
            about: about.trim().to_string(),
            required: default.is_none(),
            default: default.and_then(|value| value.to_json()),
            schema: T::schema(want, definitions),
        }
    }

    /// One whose schema says all of it.
    pub(crate) fn as_is(name: &'static str, required: bool, schema: Json) -> Self {
        Self { name, about: String::new(), required, default: None, schema }
    }

    /// Its schema with what it is for.
    pub(crate) fn described(self) -> Json {
        if self.about.is_empty() { self.schema } else { annotated(self.schema, &self.about, self.default) }
    }
}

/// One word of a `choice!`.
pub(crate) struct Choice {
    pub(crate) name: &'static str,
    pub(crate) about: &'static str,
    /// Of the value the word carries, if it carries one.
    pub(crate) schema: Option<fn(&mut Definitions) -> Json>,
}

/// A field's name without the mark of a Rust keyword.
pub(crate) fn key_name(field: &'static str) -> &'static str {
    field.strip_prefix("r#").unwrap_or(field)
}

/// Reads a block: an object, no unknown keys, no missing ones. `tag` is a key read elsewhere.
pub(crate) fn object<T: Object>(node: &Node, at: &At, tag: Option<&str>, reader: &mut Reader<'_>) -> Option<T> {
    let members = reader.members(node, at)?;
    let names = T::names();
    let known: Vec<&str> = tag.into_iter().chain(names).collect();
    reader.refuse_unknown(members, at, &known);
    let fits = check_alternatives(T::ALTERNATIVES, node, at, reader);
    T::read_keys(node, at, reader).filter(|_| fits)
}

/// Whether exactly one of these keys is there; true of no keys.
pub(crate) fn check_alternatives(keys: &[&str], node: &Node, at: &At, reader: &mut Reader<'_>) -> bool {
    let Value::Object(members) = &node.value else { return false };
    let given = members.iter().filter(|member| keys.contains(&member.key.as_str())).count();
    if keys.is_empty() || given == 1 {
        return true;
    }
    let list = keys.join("\", \"");
    reader.complain(node, at, format!("exactly one of \"{list}\" must be given, found {given}"));
    false
}

/// What reading needs, and what it found wrong.
pub(crate) struct Reader<'a> {
    pub(crate) document: &'a Document,
    pub(crate) units: Units,
    pub(crate) problems: Vec<Diagnostic>,
    /// What to say of words that mean nothing, beside the hints that hold for all files.
    pub(crate) hints: &'static [&'static [Hint]],
}

impl<'a> Reader<'a> {
    pub(crate) fn new(document: &'a Document, units: Units) -> Self {
        Self { document, units, problems: Vec::new(), hints: &[] }
    }

    /// Notes a problem at a node.
    pub(crate) fn complain(&mut self, node: &Node, at: &At, message: impl Into<String>) {
        self.problems.push(self.document.problem(&node.place, at, message));
    }

    /// Notes a problem at a path.
    pub(crate) fn complain_at(&mut self, at: &At, message: impl Into<String>) {
        self.problems.push(self.document.complain(at, message));
    }

    /// Notes that a node has the wrong type.
    pub(crate) fn expected(&mut self, node: &Node, at: &At, what: &str) {
        self.complain(node, at, format!("{what} was expected, found {}", node.what()));
    }

    /// The members of an object.
    pub(crate) fn members<'n>(&mut self, node: &'n Node, at: &At) -> Option<&'n [Property]> {
        match &node.value {
            Value::Object(members) => Some(members),
            _ => {
                self.expected(node, at, "an object { ... }");
                None
            }
        }
    }

    /// Reads one key of a block.
    pub(crate) fn key<T: Read>(
        &mut self,
        node: &Node,
        at: &At,
        name: &'static str,
        about: &str,
        want: Want,
        default: Option<T>,
    ) -> Option<T> {
        self.key_by(node, at, name, about, default, |node, at, reader| T::read(node, at, want, reader))
    }

    /// The same of a key that is read so.
    pub(crate) fn key_by<T>(
        &mut self,
        node: &Node,
        at: &At,
        name: &str,
        about: &str,
        default: Option<T>,
        read: impl FnOnce(&Node, &At, &mut Self) -> Option<T>,
    ) -> Option<T> {
        let Value::Object(members) = &node.value else { return None };
        match members.iter().find(|member| member.key == name) {
            // Complained about already; going on with the default lets the other checks of the block speak.
            Some(member) => read(&member.node, &at.key(name), self).or(default),
            None => {
                if default.is_none() {
                    self.complain(node, at, format!("missing key \"{name}\": {}", first_sentence(about)));
                }
                default
            }
        }
    }

    /// Complains about every key that is not known.
    pub(crate) fn refuse_unknown(&mut self, members: &[Property], at: &At, known: &[&str]) {
        for member in members {
            if !known.contains(&member.key.as_str()) {
                let clause = self.clause(&member.key, at, known);
                let message = format!("unknown key {}{clause}", quoted(&member.key));
                self.problems.push(self.document.problem(&member.place, &at.key(&member.key), message));
            }
        }
    }

    /// The value of the key that decides about the other keys.
    pub(crate) fn tag<'k>(&mut self, node: &Node, at: &At, tag: &str, known: &[&'k str]) -> Option<&'k str> {
        let members = self.members(node, at)?;
        let Some(member) = members.iter().find(|member| member.key == tag) else {
            self.complain(node, at, format!("missing key \"{tag}\" (one of: {})", known.join(", ")));
            return None;
        };
        self.word(&member.node, &at.key(tag), tag, known)
    }

    /// The word or `{ "word": value }` of a `choice!`.
    pub(crate) fn choose<'n>(
        &mut self,
        node: &'n Node,
        at: &At,
        choices: &'static [Choice],
    ) -> Option<(&'static str, Option<&'n Node>)> {
        let words: Vec<&'static str> = choices.iter().filter(|c| c.schema.is_none()).map(|c| c.name).collect();
        let keys: Vec<&'static str> = choices.iter().filter(|c| c.schema.is_some()).map(|c| c.name).collect();
        match &node.value {
            Value::Text(text) if keys.contains(&text.as_str()) => {
                self.complain(node, at, format!("\"{text}\" needs its values: {{ \"{text}\": ... }}"));
                None
            }
            Value::Text(_) => {
                let all: Vec<&'static str> = choices.iter().map(|c| c.name).collect();
                self.word(node, at, "name", &all).map(|word| (word, None))
            }
            Value::Object(members) if !keys.is_empty() => {
                self.refuse_unknown(members, at, &keys);
                let found: Vec<_> = members.iter().filter(|m| keys.contains(&m.key.as_str())).collect();
                let [member] = found.as_slice() else {
                    if members.len() != 1 {
                        self.complain(node, at, format!("exactly one key was expected (one of: {})", keys.join(", ")));
                    }
                    return None;
                };
                let name = keys.iter().find(|key| **key == member.key)?;
                Some((name, Some(&member.node)))
            }
            _ => {
                let text = (!words.is_empty()).then(|| format!("a text (one of: {})", words.join(", ")));
                let object = (!keys.is_empty()).then(|| format!("{{ \"{}\": ... }}", keys.join("\": ... } or { \"")));
                let both: Vec<_> = text.into_iter().chain(object).collect();
                self.expected(node, at, &both.join(" or "));
                None
            }
        }
    }

    /// One of the known words.
    pub(crate) fn word<'k>(&mut self, node: &Node, at: &At, what: &str, known: &[&'k str]) -> Option<&'k str> {
        let Value::Text(text) = &node.value else {
            self.expected(node, at, &format!("a text (one of: {})", known.join(", ")));
            return None;
        };
        let found = known.iter().find(|word| *word == text).copied();
        if found.is_none() {
            self.complain(node, at, format!("unknown {what} {}{}", quoted(text), self.clause(text, at, known)));
        }
        found
    }

    /// What an unknown word is called here, or the nearest known one.
    fn clause(&self, word: &str, at: &At, known: &[&str]) -> String {
        match hints::say(word, at, self.hints) {
            Some(hint) => format!(": {hint} (one of: {})", known.join(", ")),
            None => nearest::clause(word, known),
        }
    }
}

fn first_sentence(about: &str) -> &str {
    let about = about.trim();
    about.split_once(". ").map_or(about, |(first, _)| first).trim_end_matches('.')
}
