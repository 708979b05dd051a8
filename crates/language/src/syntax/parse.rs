//! Text to nodes.

use crate::syntax::diagnostic::Diagnostic;
use crate::syntax::node::{Node, Property, SourcePosition, Value};
use crate::syntax::path::At;
use jsonc_parser::common::Ranged;
use jsonc_parser::{CollectOptions, ParseOptions, ast, parse_to_ast};
use std::collections::HashMap;
use std::collections::hash_map::Entry;

/// The root node. Comments and trailing commas are allowed, every other liberty is not.
///
/// Problems that leave the structure readable (a key given twice, a number out of range) are added to `problems`;
/// `None` means the text is no JSON at all, and why was added too.
pub(super) fn parse(name: &str, text: &str, problems: &mut Vec<Diagnostic>) -> Option<Node> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let options = ParseOptions {
        allow_comments: true,
        allow_trailing_commas: true,
        allow_loose_object_property_names: false,
        allow_missing_commas: false,
        allow_single_quoted_strings: false,
        allow_hexadecimal_numbers: false,
        allow_unary_plus_numbers: false,
        allow_bare_decimal_point_numbers: false,
        allow_non_finite_numbers: false,
        allow_extended_string_escapes: false,
    };
    let mut reading = Reading { name, lines: Lines::new(text), problems };
    match parse_to_ast(text, &CollectOptions::default(), &options) {
        Ok(result) => match result.value {
            Some(root) => Some(reading.node(&root, &At::root())),
            None => {
                reading.complain(0, &At::root(), "the file is empty: a case is one JSON object { ... }".to_string());
                None
            }
        },
        Err(error) => {
            let message = format!("no valid JSON: {}", lower_first(&error.kind().to_string()));
            reading.complain(error.range().start, &At::root(), message);
            None
        }
    }
}

struct Reading<'a> {
    name: &'a str,
    lines: Lines<'a>,
    problems: &'a mut Vec<Diagnostic>,
}

impl Reading<'_> {
    fn node(&mut self, from: &ast::Value<'_>, at: &At) -> Node {
        let value = match from {
            ast::Value::NullKeyword(_) => Value::Null,
            ast::Value::BooleanLit(literal) => Value::Bool(literal.value),
            ast::Value::NumberLit(literal) => Value::Number(self.number(literal, at)),
            ast::Value::StringLit(literal) => Value::Text(literal.value.to_string()),
            ast::Value::Array(array) => {
                Value::Array(array.elements.iter().enumerate().map(|(i, e)| self.node(e, &at.index(i))).collect())
            }
            ast::Value::Object(object) => Value::Object(self.members(object, at)),
        };
        Node { value, place: self.lines.place(from.start()) }
    }

    fn members(&mut self, object: &ast::Object<'_>, at: &At) -> Vec<Property> {
        let mut members: Vec<Property> = Vec::with_capacity(object.properties.len());
        let mut first_places = HashMap::with_capacity(object.properties.len());
        for property in &object.properties {
            let key = property.name.as_str().to_string();
            let start = property.name.start();
            let own = at.key(&key);
            let node = self.node(&property.value, &own);
            match first_places.entry(key.clone()) {
                Entry::Vacant(free) => {
                    let place = free.insert(self.lines.place(start)).clone();
                    members.push(Property { key, place, node });
                }
                Entry::Occupied(first) => {
                    let line = if let SourcePosition::Text { line, .. } = first.get() { *line } else { 0 };
                    self.complain(start, &own, format!("this key was given before, in line {line}"));
                }
            }
        }
        members
    }

    fn number(&mut self, literal: &ast::NumberLit<'_>, at: &At) -> f64 {
        match literal.value.parse::<f64>() {
            Ok(value) if value.is_finite() => value,
            _ => {
                let message = format!("{} is beyond the range of numbers", shortened(literal.value));
                self.complain(literal.range.start, at, message);
                // Any number will do; 1 passes every demand of sign, so that no second complaint follows.
                1.0
            }
        }
    }

    fn complain(&mut self, offset: usize, at: &At, message: String) {
        let SourcePosition::Text { line, column } = self.lines.place(offset) else { return };
        self.problems.push(Diagnostic { file: self.name.to_string(), path: at.to_string(), line, column, message });
    }
}

/// Byte offsets to lines and columns.
struct Lines<'a> {
    text: &'a str,
    starts: Vec<usize>,
    /// Characters before every [`BLOCK`] of bytes: a file may be one long line.
    before: Vec<usize>,
}

/// Bytes in a block whose characters are counted once.
const BLOCK: usize = 256;

impl<'a> Lines<'a> {
    fn new(text: &'a str) -> Self {
        let breaks = text.bytes().enumerate().filter(|(_, byte)| *byte == b'\n').map(|(i, _)| i + 1);
        let blocks = text.as_bytes().chunks(BLOCK).scan(0, |sum, block| {
            let before = *sum;
            *sum += characters(block);
            Some(before)
        });
        Self { text, starts: std::iter::once(0).chain(breaks).collect(), before: blocks.collect() }
    }

    fn place(&self, offset: usize) -> SourcePosition {
        let line = self.starts.partition_point(|start| *start <= offset).max(1);
        let column = self.characters_before(offset).saturating_sub(self.characters_before(self.starts[line - 1])) + 1;
        SourcePosition::Text { line, column }
    }

    fn characters_before(&self, offset: usize) -> usize {
        let block = offset / BLOCK;
        let rest = self.text.as_bytes().get(block * BLOCK..offset).unwrap_or_default();
        self.before.get(block).map_or(0, |before| before + characters(rest))
    }
}

/// Characters that begin in some bytes of a text.
fn characters(bytes: &[u8]) -> usize {
    bytes.iter().filter(|byte| **byte & 0xc0 != 0x80).count()
}

fn lower_first(text: &str) -> String {
    let mut chars = text.chars();
    chars.next().map_or(String::new(), |first| first.to_lowercase().chain(chars).collect())
}

fn shortened(text: &str) -> String {
    if text.chars().count() <= 40 { text.to_string() } else { text.chars().take(37).chain("...".chars()).collect() }
}
