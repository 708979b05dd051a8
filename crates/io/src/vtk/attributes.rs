//! Arrays of cells, points and of the file: those that name groups are kept, all others passed over.

use super::cursor::Cursor;
use super::kind::Kind;
use crate::error::ReadError;
use crate::grid::{CORRUPT, GHOSTS, GridArray, TAGS, is_group};
use crate::source::brief;

/// What arrays belong to.
#[derive(Clone, Copy, Default, PartialEq, Eq)]
enum Entity {
    #[default]
    File,
    Point,
    Cell,
}

/// What is kept.
#[derive(Default)]
pub(super) struct Attributes {
    entity: Entity,
    /// How many there are of it.
    entities: u64,
    pub groups: Vec<GridArray>,
    pub tags: Option<GridArray>,
    pub ghosts: Option<GridArray>,
}

/// An array as its line says.
struct Header {
    name: String,
    kind: Kind,
    components: u64,
    tuples: u64,
}

impl Attributes {
    /// A section that is neither points nor cells.
    pub fn section(&mut self, cursor: &mut Cursor, word: &str) -> Result<(), ReadError> {
        if word == "METADATA" {
            // up to an empty line
            cursor.line();
            while cursor.line().is_some_and(|line| !line.is_empty()) {}
            return Ok(());
        }
        let words = cursor.words();
        let name = decoded(words.first().map_or("", String::as_str));
        let array = |cursor: &Cursor, components: u64| {
            let kind = cursor.kind(&words, 1)?;
            Ok::<_, ReadError>(Header { name: name.clone(), kind, components, tuples: self.entities })
        };
        match word {
            "CELL_DATA" | "POINT_DATA" => {
                self.entity = if word == "CELL_DATA" { Entity::Cell } else { Entity::Point };
                self.entities = cursor.count(&words, 0)?;
                Ok(())
            }
            "FIELD" => {
                let arrays = cursor.count(&words, 1)?;
                (0..arrays).try_for_each(|_| self.field(cursor))
            }
            "SCALARS" => {
                let components = if words.len() > 2 { cursor.count(&words, 2)? } else { 1 };
                let header = array(cursor, components)?;
                if cursor.take_word("LOOKUP_TABLE") {
                    cursor.line();
                }
                self.array(cursor, header)
            }
            "COLOR_SCALARS" => {
                let kind = if cursor.source.binary { Kind::Unsigned(1) } else { Kind::Real(4) };
                let (components, tuples) = (cursor.count(&words, 1)?, self.entities);
                self.array(cursor, Header { name, kind, components, tuples })
            }
            "LOOKUP_TABLE" => {
                let kind = if cursor.source.binary { Kind::Unsigned(1) } else { Kind::Real(4) };
                let tuples = cursor.count(&words, 1)?;
                cursor.skip(kind, tuples.saturating_mul(4))
            }
            "VECTORS" | "NORMALS" => array(cursor, 3).and_then(|header| self.array(cursor, header)),
            "TENSORS" => array(cursor, 9).and_then(|header| self.array(cursor, header)),
            "TENSORS6" => array(cursor, 6).and_then(|header| self.array(cursor, header)),
            "GLOBAL_IDS" | "PEDIGREE_IDS" | "EDGE_FLAGS" => {
                array(cursor, 1).and_then(|header| self.array(cursor, header))
            }
            "TEXTURE_COORDINATES" => {
                let (components, tuples) = (cursor.count(&words, 1)?, self.entities);
                let kind = cursor.kind(&words, 2)?;
                self.array(cursor, Header { name, kind, components, tuples })
            }
            _ => Err(cursor.malformed(format!("there is no section {}", brief(word)), CORRUPT)),
        }
    }

    /// An array of a `FIELD`.
    fn field(&mut self, cursor: &mut Cursor) -> Result<(), ReadError> {
        while cursor.take_word("METADATA") {
            self.section(cursor, "METADATA")?;
        }
        if cursor.take_word("NULL_ARRAY") {
            cursor.line();
            return Ok(());
        }
        // the end of the line before it
        let words = loop {
            match cursor.line() {
                Some(line) if line.is_empty() => {}
                line => break line.unwrap_or_default().split_whitespace().map(str::to_owned).collect::<Vec<_>>(),
            }
        };
        let (components, tuples) = (cursor.count(&words, 1)?, cursor.count(&words, 2)?);
        let (name, kind) = (decoded(&words[0]), cursor.kind(&words, 3)?);
        self.array(cursor, Header { name, kind, components, tuples })
    }

    fn array(&mut self, cursor: &mut Cursor, header: Header) -> Result<(), ReadError> {
        let Header { name, kind, components, tuples } = header;
        let count = components.checked_mul(tuples);
        let count =
            count.ok_or_else(|| cursor.malformed(format!("{components} x {tuples} values cannot be"), CORRUPT))?;
        let is_group = self.entity == Entity::File && is_group(&name);
        let is_ghosts = self.entity == Entity::Cell && name == GHOSTS;
        let is_tags = self.entity == Entity::Cell && self.tags.is_none() && TAGS.contains(&name.as_str());
        if !is_group && !is_ghosts && !is_tags {
            return cursor.skip(kind, count);
        }
        let section = format!("the array \"{}\"", brief(&name));
        let (byte, numbers) = (cursor.mark, cursor.numbers(kind, count)?);
        let components = usize::try_from(components).unwrap_or(usize::MAX);
        let array = GridArray { name, components, numbers, section, byte };
        match (is_ghosts, is_tags) {
            (true, _) => self.ghosts = Some(array),
            (_, true) => self.tags = Some(array),
            _ => self.groups.push(array),
        }
        Ok(())
    }
}

/// A name as VTK encodes it: % and two hexadecimal digits for what is no printable letter.
fn decoded(name: &str) -> String {
    let (mut out, mut rest) = (Vec::new(), name.as_bytes());
    while let Some((first, behind)) = rest.split_first() {
        let code = behind.get(..2).filter(|_| *first == b'%').and_then(|code| std::str::from_utf8(code).ok());
        match code.and_then(|code| u8::from_str_radix(code, 16).ok()) {
            Some(byte) => {
                out.push(byte);
                rest = &behind[2..];
            }
            None => {
                out.push(*first);
                rest = behind;
            }
        }
    }
    String::from_utf8_lossy(&out).into_owned()
}
