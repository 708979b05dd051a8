//! Clouds as PLY, the Stanford polygon format: its vertices.

use super::bytes::{Bytes, Real};
use super::{At, PointCloud, ReadError, malformed, unsupported};
use std::io::{self, Write};
use std::path::Path;

/// What the header says.
struct Header {
    /// `None` for ASCII, else whether the largest byte comes first.
    big: Option<bool>,
    vertices: usize,
    properties: Vec<(String, Real)>,
    /// Where it ends: byte and line.
    end: (usize, u64),
}

pub(super) fn read(file: &Path, content: &[u8]) -> Result<Vec<[f64; 3]>, ReadError> {
    let header = Header::read(file, content)?;
    let column = |name: &str| header.properties.iter().position(|(own, _)| own == name);
    let (Some(x), Some(y), Some(z)) = (column("x"), column("y"), column("z")) else {
        return Err(malformed(file, "the header", At::Line(1), "its vertices have no x, y and z".to_owned()));
    };
    let rows = match header.big {
        None => ascii(file, content, &header)?,
        Some(big) => binary(file, content, &header, big)?,
    };
    Ok(rows.into_iter().map(|row| [row[x], row[y], row[z]]).collect())
}

fn ascii(file: &Path, content: &[u8], header: &Header) -> Result<Vec<Vec<f64>>, ReadError> {
    let text = String::from_utf8_lossy(&content[header.end.0..]);
    let mut lines = text.lines().enumerate();
    let mut rows = Vec::new();
    while rows.len() < header.vertices {
        let at = |k: usize| At::Line(header.end.1 + k as u64 + 1);
        let Some((k, line)) = lines.next() else {
            let what = format!("{} vertices, of which {} are there", header.vertices, rows.len());
            return Err(malformed(file, "the vertices", At::Line(header.end.1), what));
        };
        let row: Option<Vec<f64>> =
            line.split_whitespace().take(header.properties.len()).map(|word| word.parse().ok()).collect();
        match row {
            Some(row) if row.len() == header.properties.len() => rows.push(row),
            _ => {
                let what = format!("{line:?} where {} numbers were expected", header.properties.len());
                return Err(malformed(file, "the vertices", at(k), what));
            }
        }
    }
    Ok(rows)
}

fn binary(file: &Path, content: &[u8], header: &Header, big: bool) -> Result<Vec<Vec<f64>>, ReadError> {
    let mut bytes = Bytes::new(content, header.end.0, big);
    let mut rows = Vec::new();
    while rows.len() < header.vertices {
        let row: Option<Vec<f64>> = header.properties.iter().map(|(_, real)| bytes.next(*real)).collect();
        let short = || {
            let what = format!("{} vertices, of which {} are there", header.vertices, rows.len());
            malformed(file, "the vertices", At::Byte(content.len() as u64), what)
        };
        rows.push(row.ok_or_else(short)?);
    }
    Ok(rows)
}

impl Header {
    fn read(file: &Path, content: &[u8]) -> Result<Self, ReadError> {
        let mut header = Header { big: None, vertices: 0, properties: vec![], end: (0, 0) };
        // Elements before the vertices would have to be skipped, those behind them need not be read.
        let mut element = String::new();
        for line in content.split_inclusive(|byte| *byte == b'\n') {
            header.end = (header.end.0 + line.len(), header.end.1 + 1);
            let at = At::Line(header.end.1);
            let text = String::from_utf8_lossy(line);
            let words: Vec<&str> = text.split_whitespace().collect();
            match words[..] {
                ["ply"] if header.end.1 == 1 => {}
                _ if header.end.1 == 1 => {
                    return Err(malformed(file, "the header", at, "it does not begin with \"ply\"".to_owned()));
                }
                ["format", "ascii", _] => header.big = None,
                ["format", "binary_little_endian", _] => header.big = Some(false),
                ["format", "binary_big_endian", _] => header.big = Some(true),
                ["format", ..] => return Err(unsupported(file, "the header", at, text.trim().to_owned())),
                ["element", "vertex", count] => {
                    let bad = |_| malformed(file, "the header", at, format!("{count:?} vertices"));
                    (header.vertices, element) = (count.parse().map_err(bad)?, "vertex".to_owned());
                }
                ["element", name, _] if element.is_empty() => {
                    return Err(unsupported(file, "the header", at, format!("the element {name} before the vertices")));
                }
                ["element", name, _] => element = name.to_owned(),
                ["property", kind, name] if element == "vertex" => {
                    let real = real(kind)
                        .ok_or_else(|| unsupported(file, "the header", at, format!("numbers that are {kind}")))?;
                    header.properties.push((name.to_owned(), real));
                }
                ["property", "list", ..] if element == "vertex" => {
                    return Err(unsupported(file, "the header", at, "a list at each vertex".to_owned()));
                }
                ["end_header"] => return Ok(header),
                _ => {}
            }
        }
        Err(malformed(file, "the header", At::Line(header.end.1), "the file ends in it".to_owned()))
    }
}

fn real(name: &str) -> Option<Real> {
    Some(match name {
        "char" | "int8" => Real::I8,
        "uchar" | "uint8" => Real::U8,
        "short" | "int16" => Real::I16,
        "ushort" | "uint16" => Real::U16,
        "int" | "int32" => Real::I32,
        "uint" | "uint32" => Real::U32,
        "float" | "float32" => Real::F32,
        "double" | "float64" => Real::F64,
        _ => return None,
    })
}

pub(super) fn write(out: &mut dyn Write, cloud: &PointCloud) -> io::Result<()> {
    let count = cloud.points.len();
    write!(out, "ply\nformat binary_little_endian 1.0\nelement vertex {count}\n")?;
    write!(out, "property double x\nproperty double y\nproperty double z\nend_header\n")?;
    for x in cloud.points.iter().flatten() {
        out.write_all(&x.to_le_bytes())?;
    }
    Ok(())
}
