//! A `DataArray` of VTK: its header, and its numbers in text, base64 or raw bytes, plain or compressed.

use super::base64;
use super::compressor::Compressor;
use super::xml::Element;
use crate::error::ReadError;
use crate::grid::Numbers;
use crate::source::{Source, brief};

/// How a file stores binary numbers.
pub(super) struct Storage<'a> {
    source: Source<'a>,
    big_endian: bool,
    /// Bytes of a length in a header: 4 or 8.
    header: usize,
    compressor: Option<Compressor>,
    appended: Option<Appended<'a>>,
}

struct Appended<'a> {
    raw: bool,
    body: &'a [u8],
}

/// How long an array must be.
#[derive(Clone, Copy)]
pub(super) enum Expect {
    /// Entities times the array's own number of components.
    Tuples(u64),
    /// Anything.
    Any,
}

#[derive(Clone, Copy, PartialEq)]
enum Type {
    Signed(usize),
    Unsigned(usize),
    Real(usize),
}

impl Type {
    fn bytes(self) -> usize {
        match self {
            Type::Signed(bytes) | Type::Unsigned(bytes) | Type::Real(bytes) => bytes,
        }
    }
}

impl<'a> Storage<'a> {
    /// From the attributes of the root and the `AppendedData` element.
    pub fn new(source: Source<'a>, root: &Element<'a>) -> Result<Self, ReadError> {
        let unsupported = |what: String, advice: &str| source.unsupported(root.start, "<VTKFile>", what, advice);
        let big_endian = match root.attribute("byte_order") {
            None | Some("LittleEndian") => false,
            Some("BigEndian") => true,
            Some(other) => return Err(unsupported(format!("byte_order \"{}\"", brief(other)), "use LittleEndian")),
        };
        let header = match root.attribute("header_type") {
            None | Some("UInt32") => 4,
            Some("UInt64") => 8,
            Some(other) => return Err(unsupported(format!("header_type \"{}\"", brief(other)), "use UInt64")),
        };
        let compressor = match root.attribute("compressor") {
            None | Some("") => None,
            Some(name) => Some(Compressor::named(name).ok_or_else(|| {
                unsupported(format!("compressor \"{}\"", brief(name)), "save with zlib, LZ4, LZMA or uncompressed")
            })?),
        };
        let appended = match root.child("AppendedData") {
            None => None,
            Some(element) => {
                let malformed = |what: &str| {
                    source.malformed(element.start, "<AppendedData>", what, "the file is corrupt: write it again")
                };
                let raw = match element.attribute("encoding") {
                    Some("raw") => true,
                    Some("base64") | None => false,
                    Some(_) => return Err(malformed("the encoding is neither raw nor base64")),
                };
                let text = element.text.first().copied().unwrap_or_default();
                let body = text.strip_prefix(b"_").ok_or_else(|| malformed("the data does not begin with `_`"))?;
                Some(Appended { raw, body })
            }
        };
        Ok(Self { source, big_endian, header, compressor, appended })
    }

    /// Number of components per entity.
    pub fn components(&self, element: &Element) -> Result<usize, ReadError> {
        let text = match element.attribute("NumberOfComponents") {
            None | Some("") => return Ok(1),
            Some(text) => text,
        };
        match text.trim().parse::<usize>() {
            // More than this is a lie, not a tensor.
            Ok(components @ 1..=10_000) => Ok(components),
            _ => Err(self.malformed(element, format!("NumberOfComponents is \"{}\"", brief(text)))),
        }
    }

    /// Reads all numbers of an array.
    pub fn read(&self, element: &Element<'a>, expect: Expect) -> Result<Numbers, ReadError> {
        let kind = self.kind(element)?;
        let wanted = match expect {
            Expect::Any => None,
            Expect::Tuples(tuples) => {
                let values = tuples.checked_mul(self.components(element)? as u64);
                Some(values.ok_or_else(|| self.malformed(element, format!("{tuples} entities cannot be")))?)
            }
        };
        let numbers = match element.attribute("format") {
            Some("ascii") => self.text(element, kind)?,
            Some("binary") => {
                let bytes = self.inline(element, wanted.and_then(|n| n.checked_mul(kind.bytes() as u64)))?;
                self.convert(&bytes, kind)
            }
            Some("appended") => {
                let bytes = self.appended(element, wanted.and_then(|n| n.checked_mul(kind.bytes() as u64)))?;
                self.convert(&bytes, kind)
            }
            other => {
                let what = format!("format \"{}\"", brief(other.unwrap_or_default()));
                return Err(self.source.unsupported(
                    element.start,
                    describe(element),
                    what,
                    "use ascii, binary or appended",
                ));
            }
        };
        match wanted {
            Some(wanted) if numbers.len() as u64 != wanted => {
                Err(self.malformed(element, format!("{} values stand where {wanted} are needed", numbers.len())))
            }
            _ => Ok(numbers),
        }
    }

    fn kind(&self, element: &Element) -> Result<Type, ReadError> {
        Ok(match element.attribute("type").unwrap_or_default() {
            "Float64" => Type::Real(8),
            "Float32" => Type::Real(4),
            "Int8" => Type::Signed(1),
            "Int16" => Type::Signed(2),
            "Int32" => Type::Signed(4),
            "Int64" => Type::Signed(8),
            "UInt8" => Type::Unsigned(1),
            "UInt16" => Type::Unsigned(2),
            "UInt32" => Type::Unsigned(4),
            "UInt64" => Type::Unsigned(8),
            other => {
                return Err(self.source.unsupported(
                    element.start,
                    describe(element),
                    format!("type \"{}\"", brief(other)),
                    "use Float64, Float32 or an integer type",
                ));
            }
        })
    }

    fn text(&self, element: &Element<'a>, kind: Type) -> Result<Numbers, ReadError> {
        let words = || {
            let pieces = element.text.iter();
            pieces.flat_map(|text| text.split(u8::is_ascii_whitespace)).filter(|word| !word.is_empty())
        };
        fn parse<T: std::str::FromStr>(word: &[u8]) -> Result<T, String> {
            let number = std::str::from_utf8(word).ok().and_then(|word| word.parse().ok());
            number.ok_or_else(|| format!("`{}` is not a number", brief(&String::from_utf8_lossy(word))))
        }
        let numbers = match kind {
            Type::Real(_) => words().map(parse).collect::<Result<_, _>>().map(Numbers::Reals),
            _ => words().map(parse).collect::<Result<_, _>>().map(Numbers::Integers),
        };
        numbers.map_err(|what| self.malformed(element, what))
    }

    fn inline(&self, element: &Element<'a>, limit: Option<u64>) -> Result<Vec<u8>, ReadError> {
        // Empty arrays may have no text at all.
        match element.text.as_slice() {
            [] => Ok(Vec::new()),
            [text] => self.unpack(element, &mut Stream::Base64(base64::Decoder::new(text)), limit),
            _ => Err(self.malformed(element, "its text is interrupted by other elements")),
        }
    }

    fn appended(&self, element: &Element<'a>, limit: Option<u64>) -> Result<Vec<u8>, ReadError> {
        let appended = self.appended.as_ref().ok_or_else(|| self.malformed(element, "there is no <AppendedData>"))?;
        let offset = element.attribute("offset").and_then(|text| text.trim().parse::<usize>().ok());
        let body = offset.and_then(|offset| appended.body.get(offset..));
        let body = body.ok_or_else(|| self.malformed(element, "its offset lies outside the appended data"))?;
        let mut stream = if appended.raw { Stream::Raw(body) } else { Stream::Base64(base64::Decoder::new(body)) };
        self.unpack(element, &mut stream, limit)
    }

    /// The bytes of an array, at most one more than `limit`.
    fn unpack(&self, element: &Element, stream: &mut Stream, limit: Option<u64>) -> Result<Vec<u8>, ReadError> {
        let short = || self.malformed(element, "its binary data ends early or is no base64");
        let Some(compressor) = self.compressor else {
            let length = self.length(stream).ok_or_else(short)?;
            return usize::try_from(length).ok().and_then(|length| stream.take(length)).ok_or_else(short);
        };
        let blocks = self.length(stream).ok_or_else(short)?;
        let block_size = self.length(stream).ok_or_else(short)?;
        let last_size = self.length(stream).ok_or_else(short)?;
        let mut sizes = Vec::new();
        for _ in 0..blocks {
            sizes.push(self.length(stream).ok_or_else(short)?);
        }
        let mut bytes = Vec::new();
        for (at, size) in sizes.iter().enumerate() {
            let packed = usize::try_from(*size).ok().and_then(|size| stream.take(size)).ok_or_else(short)?;
            let last = at + 1 == sizes.len() && last_size != 0;
            let unpacked = if last { last_size } else { block_size };
            let left = limit.map_or(unpacked, |limit| limit.saturating_sub(bytes.len() as u64) + 1);
            if !compressor.unpack(&packed, unpacked, left, &mut bytes) {
                return Err(self.malformed(element, format!("block {at} of its {compressor} data is corrupt")));
            }
        }
        Ok(bytes)
    }

    /// A length in a header.
    fn length(&self, stream: &mut Stream) -> Option<u64> {
        let bytes = stream.take(self.header)?;
        Some(self.word(&bytes))
    }

    /// An unsigned integer of up to eight bytes.
    fn word(&self, bytes: &[u8]) -> u64 {
        let push = |word: u64, byte: &u8| word << 8 | u64::from(*byte);
        if self.big_endian { bytes.iter().fold(0, push) } else { bytes.iter().rev().fold(0, push) }
    }

    fn convert(&self, bytes: &[u8], kind: Type) -> Numbers {
        let words = bytes.chunks_exact(kind.bytes()).map(|chunk| self.word(chunk));
        match kind {
            Type::Real(4) => Numbers::Reals(words.map(|word| f64::from(f32::from_bits(word as u32))).collect()),
            Type::Real(_) => Numbers::Reals(words.map(f64::from_bits).collect()),
            Type::Unsigned(_) => Numbers::Integers(words.map(|word| i64::try_from(word).unwrap_or(i64::MAX)).collect()),
            Type::Signed(size) => {
                let unused = 64 - 8 * size as u32;
                Numbers::Integers(words.map(|word| ((word << unused) as i64) >> unused).collect())
            }
        }
    }

    pub fn malformed(&self, element: &Element, what: impl Into<String>) -> ReadError {
        let advice = "the file is truncated or corrupt: write it again";
        self.source.malformed(element.start, describe(element), what, advice)
    }
}

/// Where binary numbers come from.
enum Stream<'a> {
    Raw(&'a [u8]),
    Base64(base64::Decoder<'a>),
}

impl Stream<'_> {
    fn take(&mut self, count: usize) -> Option<Vec<u8>> {
        match self {
            Stream::Raw(bytes) => {
                let (taken, rest) = bytes.split_at_checked(count)?;
                *bytes = rest;
                Some(taken.to_vec())
            }
            Stream::Base64(decoder) => decoder.take(count),
        }
    }
}

/// The array by its name, for messages.
pub(super) fn describe(element: &Element) -> String {
    match element.attribute("Name") {
        Some(name) => format!("<{}> \"{}\"", element.name, brief(name)),
        None => format!("<{}>", element.name),
    }
}
