//! Meshes from legacy VTK files.

use crate::error::{At, ReadError};
use nastic_mesh::{CellKind, Mesh, RawMesh};
use std::path::Path;
use std::str::FromStr;

/// Reads the mesh of a legacy VTK file (ASCII, unstructured grid), all lengths multiplied by `scale`; its cells are the region `body`.
///
/// # Errors
/// [`ReadError`]: line and what to try; a binary file and other data sets are named as not supported.
pub fn read_vtk(path: impl AsRef<Path>, scale: f64) -> Result<Mesh, ReadError> {
    let path = path.as_ref();
    crate::check_scale(path, scale)?;
    let bytes = std::fs::read(path).map_err(|source| ReadError::Open { file: path.to_owned(), source })?;
    let text = String::from_utf8_lossy(&bytes);
    let mut file = File::new(path, &text);
    let mut raw = RawMesh::new(path.display().to_string());
    raw.name_group(3, 1, "body");
    raw.name_group(2, 1, "body");
    file.header()?;
    let (mut cells, mut done): (Vec<Vec<u32>>, bool) = (Vec::new(), false);
    while let Some(word) = file.word() {
        match word.to_ascii_uppercase().as_str() {
            "POINTS" => {
                let count: usize = file.number("POINTS")?;
                file.word();
                for _ in 0..count {
                    raw.points.push([file.number("POINTS")?, file.number("POINTS")?, file.number("POINTS")?]);
                }
            }
            "CELLS" => {
                let count: usize = file.number("CELLS")?;
                let _: usize = file.number("CELLS")?;
                for _ in 0..count {
                    let nodes: usize = file.number("CELLS")?;
                    cells.push((0..nodes).map(|_| file.number("CELLS")).collect::<Result<_, _>>()?);
                }
            }
            "CELL_TYPES" => {
                let count: usize = file.number("CELL_TYPES")?;
                if count != cells.len() {
                    return Err(file.malformed("CELL_TYPES", format!("{count} types for {} cells", cells.len())));
                }
                for nodes in &cells {
                    file.add(&mut raw, nodes)?;
                }
                done = true;
                break;
            }
            "METADATA" | "POINT_DATA" | "CELL_DATA" => break,
            other => return Err(file.malformed("the mesh", format!("{other:?} where a section was expected"))),
        }
    }
    if !done {
        return Err(file.malformed("CELL_TYPES", "the file ends before it".to_owned()));
    }
    raw.scale(scale);
    Ok(Mesh::build(raw)?)
}

/// Words of a file, with the line that they are on.
struct File<'f> {
    path: &'f Path,
    lines: std::iter::Enumerate<std::str::Lines<'f>>,
    words: std::str::SplitWhitespace<'f>,
    line: u64,
}

impl<'f> File<'f> {
    fn new(path: &'f Path, text: &'f str) -> Self {
        File { path, lines: text.lines().enumerate(), words: "".split_whitespace(), line: 0 }
    }

    fn header(&mut self) -> Result<(), ReadError> {
        let mut line = || self.lines.next().map_or("", |(_, line)| line.trim());
        let (first, _title, encoding, grid) = (line(), line(), line(), line());
        self.line = 4;
        if !first.starts_with("# vtk DataFile Version") {
            return Err(self.malformed("the header", "it does not begin with \"# vtk DataFile Version\"".to_owned()));
        }
        if !encoding.eq_ignore_ascii_case("ASCII") {
            return Err(self.unsupported(3, format!("a file that is {encoding}")));
        }
        if !grid.eq_ignore_ascii_case("DATASET UNSTRUCTURED_GRID") {
            return Err(self.unsupported(4, format!("{grid:?}")));
        }
        Ok(())
    }

    fn word(&mut self) -> Option<&'f str> {
        loop {
            if let Some(word) = self.words.next() {
                return Some(word);
            }
            let (index, line) = self.lines.next()?;
            self.line = index as u64 + 1;
            self.words = line.split_whitespace();
        }
    }

    fn number<T: FromStr>(&mut self, section: &str) -> Result<T, ReadError> {
        match self.word() {
            Some(word) => word.parse().map_err(|_| self.malformed(section, format!("{word:?} is not such a number"))),
            None => Err(self.malformed(section, "the file ends in it".to_owned())),
        }
    }

    fn add(&mut self, raw: &mut RawMesh, nodes: &[u32]) -> Result<(), ReadError> {
        let vtk: u8 = self.number("CELL_TYPES")?;
        let Some(kind) = CellKind::from_vtk(vtk) else {
            return Err(self.unsupported(self.line, format!("a cell of VTK type {vtk}")));
        };
        let points = raw.points.len();
        if nodes.len() != kind.nodes() || nodes.iter().any(|&node| node as usize >= points) {
            let what = format!("a {} of the nodes {nodes:?}, of {points}", kind.name());
            return Err(self.malformed("CELLS", what));
        }
        raw.push(kind, nodes, if kind.dim() >= 2 { &[1] } else { &[] });
        Ok(())
    }

    fn malformed(&self, section: &str, what: String) -> ReadError {
        let (file, section, at) = (self.path.to_owned(), section.to_owned(), At::Line(self.line));
        ReadError::Malformed { file, section, at, what, advice: "write the file anew, as ASCII".to_owned() }
    }

    fn unsupported(&self, line: u64, what: String) -> ReadError {
        let (file, section, at) = (self.path.to_owned(), "the header".to_owned(), At::Line(line));
        let advice = "write an unstructured grid as ASCII, or convert it to .vtu".to_owned();
        ReadError::Unsupported { file, section, at, what, advice }
    }
}
