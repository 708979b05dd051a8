//! The elements of an XML file that VTK has written, with the raw bytes of appended data, which no XML reader takes. Texts point
//! into the file.

use quick_xml::events::{BytesStart, Event};
use quick_xml::{Reader, XmlVersion};

use crate::error::ReadError;
use crate::source::{Source, brief};

/// An element with its attributes, its children and the text between them.
#[derive(Debug)]
pub(super) struct Element<'a> {
    pub name: String,
    pub attributes: Vec<(String, String)>,
    pub children: Vec<Element<'a>>,
    /// Text between the tags, without blank stretches.
    pub text: Vec<&'a [u8]>,
    /// Byte of the opening tag.
    pub start: usize,
}

impl<'a> Element<'a> {
    pub fn attribute(&self, name: &str) -> Option<&str> {
        self.attributes.iter().find(|(key, _)| *key == name).map(|(_, value)| value.as_str())
    }

    pub fn child(&self, name: &str) -> Option<&Element<'a>> {
        self.children.iter().find(|child| child.name == name)
    }

    pub fn children_named<'s>(&'s self, name: &'s str) -> impl Iterator<Item = &'s Element<'a>> {
        self.children.iter().filter(move |child| child.name == name)
    }
}

/// Deeper nesting than this is no VTK file.
const DEEPEST: usize = 32;

/// Parses a file into its root element.
pub(super) fn parse<'a>(source: &Source<'a>) -> Result<Element<'a>, ReadError> {
    let mut open = Open { source: *source, elements: Vec::new() };
    let (mut base, mut reader) = (0, reader_at(source.bytes));
    loop {
        let start = base + reader.buffer_position() as usize;
        let event = reader.read_event();
        let end = base + reader.buffer_position() as usize;
        let root = match event {
            Ok(Event::Start(tag)) => {
                open.begin(&tag, start)?;
                // raw appended data may hold anything: it ends at the last closing tag of the file
                if let Some(length) = open.raw(start, end)? {
                    (base, reader) = (end + length, reader_at(&source.bytes[end + length..]));
                }
                None
            }
            Ok(Event::Empty(tag)) => {
                open.begin(&tag, start)?;
                open.elements.pop().and_then(|element| open.finish(element))
            }
            Ok(Event::End(tag)) => open.end(tag.name().as_ref(), start)?,
            Ok(Event::Text(_)) => {
                open.text(start, end);
                None
            }
            Ok(Event::Comment(_) | Event::PI(_) | Event::Decl(_)) => None,
            Ok(Event::DocType(_) | Event::CData(_)) => {
                return Err(open.fail(start, "document types and CDATA are not read"));
            }
            Ok(Event::GeneralRef(_)) => return Err(open.fail(start, "text outside of attributes has an `&`")),
            Ok(Event::Eof) => {
                let what = match open.elements.last() {
                    Some(element) => format!("the file ends inside <{}>", element.name),
                    None => "the file holds no XML element".to_owned(),
                };
                return Err(open.fail(start, what));
            }
            Err(error) => return Err(open.fail(base + reader.error_position() as usize, error.to_string())),
        };
        if let Some(root) = root {
            return Ok(root);
        }
    }
}

fn reader_at(bytes: &[u8]) -> Reader<&[u8]> {
    let mut reader = Reader::from_reader(bytes);
    // names of closing tags are compared here, where raw data was skipped too
    let config = reader.config_mut();
    (config.check_end_names, config.allow_unmatched_ends) = (false, true);
    reader
}

/// Elements whose closing tag has not come yet, outermost first.
struct Open<'a> {
    source: Source<'a>,
    elements: Vec<Element<'a>>,
}

impl<'a> Open<'a> {
    fn begin(&mut self, tag: &BytesStart<'_>, start: usize) -> Result<(), ReadError> {
        let name = tag.name().as_ref().to_owned();
        if name.is_empty() || !name.bytes().all(|byte| byte.is_ascii_alphanumeric() || b"_:-.".contains(&byte)) {
            return Err(self.fail(start, format!("`<{}` is no XML tag", brief(&name))));
        }
        let attributes = tag.attributes().map(|attribute| {
            let attribute = attribute.map_err(|error| error.to_string())?;
            let value =
                attribute.normalized_value(XmlVersion::Implicit1_0).map_err(|error| error.to_string())?.into_owned();
            Ok((attribute.key.as_ref().to_owned(), value))
        });
        let attributes = attributes
            .collect::<Result<Vec<_>, String>>()
            .map_err(|what| self.fail(start, format!("<{name}>: {what}")))?;
        if self.elements.len() == DEEPEST {
            return Err(self.fail(start, format!("elements are nested more than {DEEPEST} deep")));
        }
        self.elements.push(Element { name, attributes, children: Vec::new(), text: Vec::new(), start });
        Ok(())
    }

    /// How long the raw data of the element just opened is, if it has some.
    fn raw(&mut self, start: usize, from: usize) -> Result<Option<usize>, ReadError> {
        const END: &[u8] = b"</AppendedData>";
        let is_raw = |e: &Element| e.name == "AppendedData" && e.attribute("encoding") == Some("raw");
        if !self.elements.last().is_some_and(is_raw) {
            return Ok(None);
        }
        let Some(length) = self.source.bytes[from..].windows(END.len()).rposition(|window| window == END) else {
            return Err(self.fail(start, "the appended data has no end"));
        };
        self.text(from, from + length);
        Ok(Some(length))
    }

    /// Text goes to the innermost open element.
    fn text(&mut self, from: usize, to: usize) {
        let raw = self.elements.last().is_some_and(|element| element.name == "AppendedData");
        let text = self.source.bytes[from..to].trim_ascii_start();
        let text = if raw { text } else { text.trim_ascii_end() };
        if let Some(innermost) = self.elements.last_mut().filter(|_| !text.is_empty()) {
            innermost.text.push(text);
        }
    }

    fn end(&mut self, name: &str, start: usize) -> Result<Option<Element<'a>>, ReadError> {
        match self.elements.pop() {
            Some(element) if element.name == name.trim() => Ok(self.finish(element)),
            Some(element) => Err(self.fail(start, format!("<{}> is closed by </{}>", element.name, brief(name)))),
            None => Err(self.fail(start, format!("</{}> closes nothing", brief(name)))),
        }
    }

    /// Hands a complete element to its parent, or back if it is the root.
    fn finish(&mut self, element: Element<'a>) -> Option<Element<'a>> {
        match self.elements.last_mut() {
            Some(parent) => {
                parent.children.push(element);
                None
            }
            None => Some(element),
        }
    }

    fn fail(&self, byte: usize, what: impl Into<String>) -> ReadError {
        let section = match self.elements.last() {
            Some(element) => format!("<{}>", element.name),
            None => "the XML header".to_owned(),
        };
        self.source.malformed(byte, section, what, "the file is truncated or no VTK XML file: write it again")
    }
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
