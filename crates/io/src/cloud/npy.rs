//! Clouds as NPY, NumPy's format of one array.
//!
//! Source: numpy.lib.format, versions 1.0 to 3.0.

use super::bytes::{Bytes, Real};
use super::{At, PointCloud, ReadError, malformed, unsupported};
use std::io::{self, Write};
use std::path::Path;

const MAGIC: &[u8] = b"\x93NUMPY";
/// The header ends at a multiple of it.
const ALIGNED: usize = 64;

pub(super) fn read(file: &Path, content: &[u8]) -> Result<Vec<[f64; 3]>, ReadError> {
    let bad = |at: usize, what: String| malformed(file, "the header", At::Byte(at as u64), what);
    if !content.starts_with(MAGIC) {
        return Err(bad(0, "it does not begin with \\x93NUMPY".to_owned()));
    }
    let wide = content.get(6).is_some_and(|major| *major >= 2);
    let length = match (wide, content.get(8..12)) {
        (false, Some(bytes)) => usize::from(u16::from_le_bytes([bytes[0], bytes[1]])),
        (true, Some(bytes)) => u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]) as usize,
        (_, None) => return Err(bad(8, "the file ends in it".to_owned())),
    };
    let begin = if wide { 12 } else { 10 };
    let header = content.get(begin..begin + length).ok_or_else(|| bad(begin, "the file ends in it".to_owned()))?;
    let header = String::from_utf8_lossy(header);
    let kind = after(&header, "'descr':").unwrap_or_default().trim().trim_matches(['\'', '"']).to_owned();
    let Some(real) = kind.get(1..).and_then(real) else {
        return Err(unsupported(file, "the header", At::Byte(begin as u64), format!("an array of {kind:?}")));
    };
    let big = kind.starts_with('>');
    let shape = header.split("'shape':").nth(1).and_then(|rest| rest.split(['(', ')']).nth(1)).unwrap_or_default();
    let sides: Vec<usize> = shape.split(',').filter_map(|side| side.trim().parse().ok()).collect();
    let [rows, columns @ (2 | 3)] = sides[..] else {
        let what = format!("an array of shape ({shape}), where (n, 2) or (n, 3) is needed");
        return Err(unsupported(file, "the header", At::Byte(begin as u64), what));
    };
    let by_column = after(&header, "'fortran_order':").is_some_and(|word| word.trim() == "True");
    let mut bytes = Bytes::new(content, begin + length, big);
    let mut points = Vec::new();
    let available = (content.len() - begin - length) / real.size();
    if rows.checked_mul(columns).is_none_or(|count| count > available) {
        let what = format!("{rows} x {columns} numbers, of which {available} are there");
        return Err(malformed(file, "the array", At::Byte(content.len() as u64), what));
    }
    points.resize(rows, [0.0; 3]);
    for k in 0..rows * columns {
        let (row, column) = if by_column { (k % rows, k / rows) } else { (k / columns, k % columns) };
        points[row][column] = bytes.next(real).unwrap_or(f64::NAN);
    }
    Ok(points)
}

/// By NumPy's letter and number of bytes.
fn real(kind: &str) -> Option<Real> {
    Some(match kind {
        "i1" => Real::I8,
        "u1" => Real::U8,
        "i2" => Real::I16,
        "u2" => Real::U16,
        "i4" => Real::I32,
        "u4" => Real::U32,
        "i8" => Real::I64,
        "u8" => Real::U64,
        "f4" => Real::F32,
        "f8" => Real::F64,
        _ => return None,
    })
}

/// What stands behind a key, up to the next comma.
fn after<'h>(header: &'h str, key: &str) -> Option<&'h str> {
    header.split(key).nth(1)?.split(',').next()
}

pub(super) fn write(out: &mut dyn Write, cloud: &PointCloud) -> io::Result<()> {
    let dict = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': ({}, 3), }}", cloud.points.len());
    let length = (MAGIC.len() + 4 + dict.len() + 1).next_multiple_of(ALIGNED) - MAGIC.len() - 4;
    out.write_all(MAGIC)?;
    out.write_all(&[1, 0])?;
    out.write_all(&u16::try_from(length).unwrap_or(u16::MAX).to_le_bytes())?;
    writeln!(out, "{dict:width$}", width = length - 1)?;
    for x in cloud.points.iter().flatten() {
        out.write_all(&x.to_le_bytes())?;
    }
    Ok(())
}
