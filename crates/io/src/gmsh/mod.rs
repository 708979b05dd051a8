//! Gmsh's MSH files, formats 2.0 to 2.2 and 4.1, text and binary.
//!
//! Format: <https://gmsh.info/doc/texinfo/gmsh.html#MSH-file-format> (4.1) and the section "MSH file format version 2
//! (Legacy)" there.
//!
//! * Physical groups of the mesh's own dimension become regions, those one dimension lower surfaces, all others node
//!   sets. A group without a name bears its tag as name: `"3"`.
//! * First and second-order lines, triangles, quadrangles, tetrahedra and hexahedra, complete or serendipity; nodes
//!   are permuted to VTK's order.
//! * Tags may be sparse, in any order; parametric nodes, partitions and either byte order are taken; sections nobody
//!   needs are skipped.
//! * No count in a file is believed before the rest of the file is seen to be long enough for it.

mod content;
mod cursor;
mod element;
mod v2;
mod v4;

use std::collections::BTreeSet;
use std::path::Path;

use nastic_mesh::{Mesh, RawMesh};

use crate::error::ReadError;
use content::NodeTags;
use cursor::{Cursor, Encoding};

/// Reads a mesh from a Gmsh file. What was mended on the way is in [`Mesh::notes`].
///
/// # Errors
///
/// [`ReadError`] naming file, section, line (text) or byte (binary), and what to try.
pub fn read_gmsh(path: impl AsRef<Path>) -> Result<Mesh, ReadError> {
    read_gmsh_scaled(path, 1.0)
}

/// Reads a mesh from a Gmsh file, all lengths multiplied by `scale`: `1e-3` for a file in millimetres.
///
/// # Errors
///
/// As [`read_gmsh`], and [`ReadError::Scale`].
pub fn read_gmsh_scaled(path: impl AsRef<Path>, scale: f64) -> Result<Mesh, ReadError> {
    let path = path.as_ref();
    let bytes = std::fs::read(path).map_err(|source| ReadError::Open { file: path.to_owned(), source })?;
    parse_gmsh(path, &bytes, scale)
}

/// Reads a mesh from the bytes of a Gmsh file; `file` is the name that errors and the mesh bear.
///
/// # Errors
///
/// As [`read_gmsh_scaled`].
pub fn parse_gmsh(file: impl AsRef<Path>, bytes: &[u8], scale: f64) -> Result<Mesh, ReadError> {
    let file = file.as_ref();
    crate::check_scale(file, scale)?;
    let raw = raw(file, bytes, scale)?;
    Mesh::build(raw).map_err(ReadError::Mesh)
}

/// The two formats that are read.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Version {
    V2,
    V4,
}

fn raw(file: &Path, bytes: &[u8], scale: f64) -> Result<RawMesh, ReadError> {
    let mut cursor = Cursor::new(file, bytes);
    // `(0 "a comment")`, `(2 3)`: sections of ANSYS Fluent
    if bytes.trim_ascii_start().starts_with(b"(") {
        let stem = file.with_extension("").display().to_string();
        let advice = format!(
            "convert it by Python's meshio, with `meshio convert --input-format ansys {} {stem}.vtu`; names of zones are lost",
            file.display()
        );
        return Err(cursor.unsupported("a mesh of ANSYS Fluent, which ends in .msh too,", advice));
    }
    let mut reader = Reader { scale, ..Reader::default() };
    while let Some(section) = cursor.next_section()? {
        reader.section(&mut cursor, &section)?;
        cursor.end_section()?;
    }
    for section in ["MeshFormat", "Nodes", "Elements"] {
        if !reader.seen.contains(section) {
            return Err(cursor.malformed(
                format!("the file ends without ${section}"),
                "the file is truncated, or not a Gmsh mesh: write it again from Gmsh",
            ));
        }
    }
    let Reader { mut mesh, tags, .. } = reader;
    mesh.name = file.display().to_string();
    mesh.node_labels = tags.into_labels();
    Ok(mesh)
}

/// What has been read so far.
#[derive(Default)]
struct Reader {
    scale: f64,
    version: Option<Version>,
    seen: BTreeSet<&'static str>,
    mesh: RawMesh,
    tags: NodeTags,
    entities: v4::Entities,
}

impl Reader {
    fn section(&mut self, cursor: &mut Cursor, name: &str) -> Result<(), ReadError> {
        let version = match (self.version, name) {
            (_, "MeshFormat") => {
                self.once(cursor, "MeshFormat")?;
                self.version = Some(format(cursor)?);
                return Ok(());
            }
            (_, "Comments") => return cursor.skip_section(),
            (Some(version), _) => version,
            (None, _) => {
                return Err(cursor.malformed(
                    "the file does not begin with $MeshFormat",
                    "is it a Gmsh mesh (.msh)? Formats 2.2 and 4.1 are read",
                ));
            }
        };
        match (name, version) {
            ("PhysicalNames", _) => names(cursor, &mut self.mesh),
            ("Entities" | "PartitionedEntities", Version::V4) => {
                v4::entities(cursor, name == "PartitionedEntities", &mut self.entities)
            }
            ("Nodes" | "ParametricNodes", _) => {
                self.once(cursor, "Nodes")?;
                let (mesh, tags) = (&mut self.mesh, &mut self.tags);
                match version {
                    Version::V2 => v2::nodes(cursor, name == "ParametricNodes", self.scale, mesh, tags),
                    Version::V4 => v4::nodes(cursor, self.scale, mesh, tags),
                }
            }
            ("Elements", _) => {
                self.once(cursor, "Elements")?;
                if !self.seen.contains("Nodes") {
                    return Err(cursor.malformed("elements stand before the nodes", "write the file again from Gmsh"));
                }
                match version {
                    Version::V2 => v2::elements(cursor, &mut self.mesh, &self.tags),
                    Version::V4 => v4::elements(cursor, &self.entities, &mut self.mesh, &self.tags),
                }
            }
            _ => cursor.skip_section(),
        }
    }

    fn once(&mut self, cursor: &Cursor, name: &'static str) -> Result<(), ReadError> {
        if self.seen.insert(name) {
            return Ok(());
        }
        Err(cursor.malformed(format!("a second ${name}"), "keep one mesh per file"))
    }
}

/// `$MeshFormat`: version, encoding, size of reals.
fn format(cursor: &mut Cursor) -> Result<Version, ReadError> {
    let line = cursor.line()?;
    let words: Vec<&str> = line.split_whitespace().collect();
    let [number, kind, size] = words[..] else {
        return Err(cursor.malformed(
            format!("expected version, file type and data size, found {} words", words.len()),
            "is it a Gmsh mesh (.msh)? Formats 2.2 and 4.1 are read",
        ));
    };
    // by value: Netgen writes 2.000000
    let version = match number.parse::<f64>() {
        Ok(value) if (2.0..3.0).contains(&value) => Version::V2,
        Ok(value) if (4.1..5.0).contains(&value) => Version::V4,
        _ => {
            return Err(cursor.unsupported(
                format!("format {}", number.escape_debug()),
                "save as 4.1 or 2.2: gmsh FILE -save -format msh41",
            ));
        }
    };
    if size != "8" {
        return Err(cursor.unsupported(format!("data size {}", size.escape_debug()), "save with data size 8"));
    }
    match kind {
        "0" => {}
        "1" => {
            cursor.set_encoding(Encoding::Binary { swap: false });
            // The writer's own number one shows its byte order.
            match cursor.int()? {
                1 => {}
                other if other.swap_bytes() == 1 => cursor.set_encoding(Encoding::Binary { swap: true }),
                _ => {
                    return Err(cursor.malformed(
                        "the number that tells the byte order is not 1",
                        "the file is corrupt, or was copied in text mode: copy it again as binary",
                    ));
                }
            }
        }
        _ => {
            return Err(cursor.malformed(
                format!("file type {} is neither 0 (text) nor 1 (binary)", kind.escape_debug()),
                "write the file again from Gmsh",
            ));
        }
    }
    Ok(version)
}

/// `$PhysicalNames`: text in either encoding.
fn names(cursor: &mut Cursor, mesh: &mut RawMesh) -> Result<(), ReadError> {
    let count = cursor.text_count("physical names", 6)?;
    let mut padded = Vec::new();
    for _ in 0..count {
        let line = cursor.line()?;
        let parsed = line.split_once('"').and_then(|(numbers, rest)| {
            let mut numbers = numbers.split_whitespace();
            let dimension = numbers.next()?.parse::<usize>().ok().filter(|dimension| *dimension <= 3)?;
            let tag = numbers.next()?.parse::<i32>().ok()?.saturating_abs();
            Some((dimension, tag, rest.strip_suffix('"')?))
        });
        let Some((dimension, tag, name)) = parsed else {
            return Err(cursor.malformed(
                "expected `dimension tag \"name\"`",
                "write the file again from Gmsh; a name may not hold line breaks",
            ));
        };
        if name.trim() != name {
            padded.push(format!("\"{}\"", name.trim()));
        }
        mesh.name_group(dimension, tag, name.trim());
    }
    if !padded.is_empty() {
        mesh.notes
            .push(format!("blanks around names of groups dropped: {} (files of MED have them)", padded.join(", ")));
    }
    Ok(())
}
