//! The subset of XML that VTK writes: elements, attributes, text, and the raw bytes of appended data, which no XML reader
//! takes. Every slice points into the file.

use std::borrow::Cow;
use std::path::Path;

use crate::error::{At, ReadError};

/// An element with its attributes, its children and the text between them.
#[derive(Debug)]
pub(super) struct Element<'a> {
    pub name: &'a str,
    pub attributes: Vec<(&'a str, Cow<'a, str>)>,
    pub children: Vec<Element<'a>>,
    /// Text between the tags, without blank stretches.
    pub text: Vec<&'a [u8]>,
    /// Byte of the opening tag.
    pub start: usize,
}

impl<'a> Element<'a> {
    pub fn attribute(&self, name: &str) -> Option<&str> {
        self.attributes.iter().find(|(key, _)| *key == name).map(|(_, value)| value.as_ref())
    }

    pub fn child(&self, name: &str) -> Option<&Element<'a>> {
        self.children.iter().find(|child| child.name == name)
    }

    pub fn children_named<'s>(&'s self, name: &'s str) -> impl Iterator<Item = &'s Element<'a>> {
        self.children.iter().filter(move |child| child.name == name)
    }
}

/// The file being read: who it is, for messages.
#[derive(Clone, Copy)]
pub(super) struct Source<'a> {
    pub file: &'a Path,
    pub bytes: &'a [u8],
}

impl Source<'_> {
    /// Line of a byte, from one.
    fn line(&self, byte: usize) -> At {
        let before = &self.bytes[..byte.min(self.bytes.len())];
        At::Line(before.iter().filter(|byte| **byte == b'\n').count() as u64 + 1)
    }

    pub fn malformed(
        &self,
        byte: usize,
        section: impl Into<String>,
        what: impl Into<String>,
        advice: impl Into<String>,
    ) -> ReadError {
        ReadError::Malformed {
            file: self.file.to_owned(),
            section: section.into(),
            at: self.line(byte),
            what: what.into(),
            advice: advice.into(),
        }
    }

    pub fn unsupported(
        &self,
        byte: usize,
        section: impl Into<String>,
        what: impl Into<String>,
        advice: impl Into<String>,
    ) -> ReadError {
        ReadError::Unsupported {
            file: self.file.to_owned(),
            section: section.into(),
            at: self.line(byte),
            what: what.into(),
            advice: advice.into(),
        }
    }
}

/// Parses a file into its root element.
pub(super) fn parse<'a>(source: &Source<'a>) -> Result<Element<'a>, ReadError> {
    Parser { source: *source, position: 0, open: Vec::new() }.run()
}

/// Deeper nesting than this is no VTK file.
const DEEPEST: usize = 32;

struct Parser<'a> {
    source: Source<'a>,
    position: usize,
    /// Elements whose closing tag has not come yet, outermost first.
    open: Vec<Element<'a>>,
}

impl<'a> Parser<'a> {
    fn run(mut self) -> Result<Element<'a>, ReadError> {
        loop {
            self.text();
            let start = self.position;
            let rest = &self.source.bytes[start..];
            if rest.is_empty() {
                let open = self.open.iter().map(|element| element.name).collect::<Vec<_>>();
                let what = match open.last() {
                    Some(name) => format!("the file ends inside <{name}>"),
                    None => "the file holds no XML element".to_owned(),
                };
                return Err(self.fail(start, what));
            }
            if rest.starts_with(b"<?") {
                self.skip_past(b"?>")?;
            } else if rest.starts_with(b"<!--") {
                self.skip_past(b"-->")?;
            } else if rest.starts_with(b"<!") {
                return Err(self.fail(start, "document types and CDATA are not read"));
            } else if rest.starts_with(b"</") {
                if let Some(root) = self.close()? {
                    return Ok(root);
                }
            } else if let Some(root) = self.element()? {
                return Ok(root);
            }
        }
    }

    /// Text up to the next tag goes to the innermost open element.
    fn text(&mut self) {
        let rest = &self.source.bytes[self.position..];
        let length = rest.iter().position(|byte| *byte == b'<').unwrap_or(rest.len());
        self.position += length;
        let text = rest[..length].trim_ascii();
        if let Some(innermost) = self.open.last_mut().filter(|_| !text.is_empty()) {
            innermost.text.push(text);
        }
    }

    fn close(&mut self) -> Result<Option<Element<'a>>, ReadError> {
        let start = self.position;
        let tag = self.tag()?;
        let name = tag.trim_start_matches('/').trim();
        match self.open.pop() {
            Some(element) if element.name == name => Ok(self.finish(element)),
            Some(element) => Err(self.fail(start, format!("<{}> is closed by </{}>", element.name, brief(name)))),
            None => Err(self.fail(start, format!("</{}> closes nothing", brief(name)))),
        }
    }

    /// Hands a complete element to its parent, or back if it is the root.
    fn finish(&mut self, element: Element<'a>) -> Option<Element<'a>> {
        match self.open.last_mut() {
            Some(parent) => {
                parent.children.push(element);
                None
            }
            None => Some(element),
        }
    }

    fn element(&mut self) -> Result<Option<Element<'a>>, ReadError> {
        let start = self.position;
        let tag = self.tag()?;
        let (tag, empty) = match tag.strip_suffix('/') {
            Some(tag) => (tag, true),
            None => (tag, false),
        };
        let split = tag.find(|c: char| c.is_ascii_whitespace()).unwrap_or(tag.len());
        let (name, rest) = tag.split_at(split);
        if name.is_empty() || !name.bytes().all(|byte| byte.is_ascii_alphanumeric() || b"_:-.".contains(&byte)) {
            return Err(self.fail(start, format!("`<{}` is no XML tag", brief(tag))));
        }
        let attributes = self.attributes(start, rest)?;
        let element = Element { name, attributes, children: Vec::new(), text: Vec::new(), start };
        if empty {
            return Ok(self.finish(element));
        }
        if self.open.len() == DEEPEST {
            return Err(self.fail(start, format!("elements are nested more than {DEEPEST} deep")));
        }
        let raw = name == "AppendedData" && element.attribute("encoding") == Some("raw");
        self.open.push(element);
        if raw {
            self.raw(start)?;
        }
        Ok(None)
    }

    /// Raw appended data may hold anything: it ends at the last closing tag of the file.
    fn raw(&mut self, start: usize) -> Result<(), ReadError> {
        const END: &[u8] = b"</AppendedData>";
        let rest = &self.source.bytes[self.position..];
        let Some(length) = rest.windows(END.len()).rposition(|window| window == END) else {
            return Err(self.fail(start, "the appended data has no end"));
        };
        let body = &rest[..length];
        let blank = body.iter().position(|byte| !byte.is_ascii_whitespace()).unwrap_or(length);
        if let Some(element) = self.open.last_mut() {
            element.text.push(&body[blank..]);
        }
        self.position += length;
        Ok(())
    }

    /// The inside of the tag that starts here; goes past it.
    fn tag(&mut self) -> Result<&'a str, ReadError> {
        let start = self.position;
        let rest = &self.source.bytes[start + 1..];
        let mut quote = None;
        for (length, byte) in rest.iter().enumerate() {
            match (quote, byte) {
                (None, b'>') => {
                    self.position = start + 1 + length + 1;
                    let inside = std::str::from_utf8(&rest[..length]);
                    return inside.map_err(|_| self.fail(start, "a tag is not text (UTF-8)"));
                }
                (None, b'"' | b'\'') => quote = Some(byte),
                (Some(open), byte) if open == byte => quote = None,
                _ => {}
            }
        }
        Err(self.fail(start, "the file ends inside a tag"))
    }

    fn attributes(&self, start: usize, text: &'a str) -> Result<Vec<(&'a str, Cow<'a, str>)>, ReadError> {
        let mut attributes = Vec::new();
        let mut rest = text.trim();
        while !rest.is_empty() {
            let parsed = rest.split_once('=').and_then(|(key, value)| {
                let value = value.trim_start();
                let quote = value.chars().next().filter(|c| *c == '"' || *c == '\'')?;
                let (value, after) = value[1..].split_once(quote)?;
                Some((key.trim(), unescape(value)?, after.trim_start()))
            });
            let Some((key, value, after)) = parsed else {
                return Err(self.fail(start, format!("`{}` is no XML attribute", brief(rest))));
            };
            attributes.push((key, value));
            rest = after;
        }
        Ok(attributes)
    }

    fn skip_past(&mut self, end: &[u8]) -> Result<(), ReadError> {
        let rest = &self.source.bytes[self.position..];
        match rest.windows(end.len()).position(|window| window == end) {
            Some(at) => {
                self.position += at + end.len();
                Ok(())
            }
            None => Err(self.fail(self.position, "the file ends inside a comment")),
        }
    }

    fn fail(&self, byte: usize, what: impl Into<String>) -> ReadError {
        let section = match self.open.last() {
            Some(element) => format!("<{}>", element.name),
            None => "the XML header".to_owned(),
        };
        self.source.malformed(byte, section, what, "the file is truncated or no VTK XML file: write it again")
    }
}

/// The start of a text, printable and short enough for a message.
pub(super) fn brief(text: &str) -> String {
    text.chars().take(40).map(|c| if c.is_control() { '?' } else { c }).collect()
}

/// Replaces XML's entities.
fn unescape(text: &str) -> Option<Cow<'_, str>> {
    if !text.contains('&') {
        return Some(Cow::Borrowed(text));
    }
    let mut out = String::with_capacity(text.len());
    let mut parts = text.split('&');
    out.push_str(parts.next()?);
    for part in parts {
        let (entity, rest) = part.split_once(';')?;
        let character = match entity {
            "amp" => '&',
            "lt" => '<',
            "gt" => '>',
            "quot" => '"',
            "apos" => '\'',
            _ => {
                let code = entity.strip_prefix('#')?;
                let code = match code.strip_prefix('x') {
                    Some(hexadecimal) => u32::from_str_radix(hexadecimal, 16).ok()?,
                    None => code.parse().ok()?,
                };
                char::from_u32(code)?
            }
        };
        out.push(character);
        out.push_str(rest);
    }
    Some(Cow::Owned(out))
}

/// Text that may stand in an attribute of XML.
pub fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            c if c.is_control() => out.push_str(&format!("&#{};", u32::from(c))),
            c => out.push(c),
        }
    }
    out
}
