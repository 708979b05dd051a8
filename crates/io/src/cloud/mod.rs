//! Point clouds: CSV, NPY and PLY.

mod bytes;
mod csv;
mod npy;
mod ply;

use crate::error::{At, ReadError, WriteError};
use crate::{check_scale, other_format, write_atomically};
use std::io::Write;
use std::path::Path;

/// Points of a body: where they are, and where they were.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PointCloud {
    /// Numbers of the nodes, from zero.
    pub nodes: Vec<u32>,
    /// Their positions in the reference body.
    pub reference: Vec<[f64; 3]>,
    /// Where they are.
    pub points: Vec<[f64; 3]>,
}

/// Formats of clouds, by the end of their names.
const FORMATS: [&str; 3] = ["csv", "npy", "ply"];

/// Whether a name ends as those of clouds do.
pub fn is_cloud(path: &Path) -> bool {
    FORMATS.contains(&other_format::extension(path).as_str())
}

/// Reads the points of a `.csv`, `.npy` or `.ply` file, multiplied by `scale`; points of a plane have z = 0.
///
/// * CSV: columns named `x`, `y` and `z` (also `x [mm]`, whose unit is not looked at, or ParaView's `Points:0`), or without names the first two or three; commas, semicolons, tabs or
///   blanks between, decimal commas where commas separate nothing, `#` before remarks.
/// * NPY: an array of n rows of two or three numbers, integers or reals.
/// * PLY: the vertices, ASCII or binary.
///
/// # Errors
/// [`ReadError`]: the line or byte, and what to try; no points; a point that is not finite.
pub fn read_cloud(path: impl AsRef<Path>, scale: f64) -> Result<Vec<[f64; 3]>, ReadError> {
    let path = path.as_ref();
    check_scale(path, scale)?;
    let read = match other_format::extension(path).as_str() {
        "csv" => csv::read,
        "npy" => npy::read,
        "ply" => ply::read,
        _ => return Err(ReadError::CloudExtension { file: path.to_owned() }),
    };
    let content = std::fs::read(path).map_err(|source| ReadError::Open { file: path.to_owned(), source })?;
    let mut points = read(path, &content)?;
    if points.is_empty() {
        return Err(malformed(path, "the points", At::Line(1), "there are none".to_owned()));
    }
    points.iter_mut().flatten().for_each(|x| *x *= scale);
    match points.iter().position(|point| point.iter().any(|x| !x.is_finite())) {
        Some(k) => {
            let what = format!("point {k}, from zero, is {:?}", points[k]);
            Err(malformed(path, "the points", At::Line(k as u64 + 1), what))
        }
        None => Ok(points),
    }
}

/// Writes a cloud in the format of the file's name. CSV has the columns `node,X,Y,Z,x,y,z`, the others where the points are.
///
/// # Errors
/// [`WriteError`]; of another name too.
pub fn write_cloud(path: impl AsRef<Path>, cloud: &PointCloud) -> Result<(), WriteError> {
    let path = path.as_ref();
    let write = match other_format::extension(path).as_str() {
        "csv" => csv::write,
        "npy" => npy::write,
        "ply" => ply::write,
        _ => {
            return Err(WriteError::content(
                path,
                "point clouds are CSV, NPY or PLY",
                "end the name with .csv, .npy or .ply",
            ));
        }
    };
    write_atomically(path, |out: &mut dyn Write| write(out, cloud))
}

fn malformed(file: &Path, section: &str, at: At, what: String) -> ReadError {
    let advice = "write the cloud anew, as CSV with the columns x,y,z if in doubt".to_owned();
    ReadError::Malformed { file: file.to_owned(), section: section.to_owned(), at, what, advice }
}

fn unsupported(file: &Path, section: &str, at: At, what: String) -> ReadError {
    let advice = "write the cloud anew, as CSV with the columns x,y,z if in doubt".to_owned();
    ReadError::Unsupported { file: file.to_owned(), section: section.to_owned(), at, what, advice }
}
