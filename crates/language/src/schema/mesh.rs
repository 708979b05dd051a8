//! The block `mesh`, and other shapes given by a mesh.

use crate::quantity::Want;
use crate::schema::json::{Definitions, any_of};
use crate::schema::named::Element;
use crate::schema::read::{Read, Reader};
use crate::schema::value::Vector;
use crate::syntax::{At, Node, Value};
use serde_json::{Value as Json, json};

/// A mesh: from a file, or generated.
#[derive(Clone, PartialEq, Debug)]
pub enum MeshSource {
    /// Gmsh, VTK or Abaqus.
    File(MeshFile),
    /// A box or rectangle from the origin, with region "body" and surfaces "x-", "x+", "y-", ...
    Box(BoxMesh),
    /// Several of them, bodies that share no node.
    Boxes(BoxesMesh),
}

/// Boxes beside each other.
#[derive(Clone, PartialEq, Debug)]
pub struct BoxesMesh {
    /// Path of the list in the case.
    pub at: At,
    /// The boxes.
    pub boxes: Vec<BodyBox>,
}

/// A mesh file.
#[derive(Clone, PartialEq, Debug)]
pub struct MeshFile {
    /// Path of the block or text in the case.
    pub at: At,
    /// The file, relative to the case.
    pub file: String,
    /// Factor from the file's coordinates to the case's unit of length.
    pub scale: f64,
}

object! {
    /// A mesh from a file, or generated.
    pub struct MeshBlock one of [file, box, boxes] checked by check_scale {
        /// Gmsh (.msh), VTK (.vtu, .vtk) or Abaqus (.inp); relative to the case.
        pub file: Option<String>,
        /// Factor from the file's coordinates to the case's unit of length.
        pub scale: Option<f64> as POSITIVE,
        /// A generated box or rectangle with one corner in the origin.
        pub r#box: Option<BoxMesh>,
        /// Generated boxes or rectangles, bodies that share no node.
        pub boxes: Option<Vec<BodyBox>>,
    }
}

object! {
    /// A box (three entries) or rectangle in plane strain (two) with one corner in the origin: region "body", surfaces
    /// "x-", "x+", "y-", "y+", "z-", "z+".
    pub struct BoxMesh checked by check_box {
        /// Edge lengths.
        pub size: Vector as POSITIVE_LENGTH,
        /// Number of cells along each edge.
        pub cells: Vec<usize> as POSITIVE,
        /// Type of cell. Simplices split each box into 6, each rectangle into 2.
        pub element: Element,
    }
}

object! {
    /// One of several boxes (three entries) or rectangles in plane strain (two): a region of its name, surfaces "NAME.x-", "NAME.x+", ...
    pub struct BodyBox checked by check_body {
        /// Name of the region, and before the dot of the surfaces' names.
        pub name: String,
        /// Its corner with the least coordinates. Default: the origin.
        pub corner: Option<Vector> as LENGTH,
        /// Edge lengths.
        pub size: Vector as POSITIVE_LENGTH,
        /// Number of cells along each edge.
        pub cells: Vec<usize> as POSITIVE,
        /// Type of cell. Simplices split each box into 6, each rectangle into 2.
        pub element: Element,
    }
}

impl Read for MeshSource {
    fn read(node: &Node, at: &At, want: Want, reader: &mut Reader<'_>) -> Option<Self> {
        if let Value::Text(_) = node.value {
            let file = String::read(node, at, want, reader)?;
            return Some(Self::File(MeshFile { at: at.clone(), file, scale: 1.0 }));
        }
        if !matches!(node.value, Value::Object(_)) {
            reader.expected(node, at, "the name of a mesh file or an object { ... }");
            return None;
        }
        let block = MeshBlock::read(node, at, want, reader)?;
        match (block.file, block.r#box, block.boxes) {
            (Some(file), ..) => Some(Self::File(MeshFile { at: at.clone(), file, scale: block.scale.unwrap_or(1.0) })),
            (None, Some(generated), _) => Some(Self::Box(generated)),
            (None, None, boxes) => Some(Self::Boxes(BoxesMesh { at: at.key("boxes"), boxes: boxes? })),
        }
    }

    fn schema(want: Want, definitions: &mut Definitions) -> Json {
        any_of(vec![json!({ "type": "string", "minLength": 1 }), MeshBlock::schema(want, definitions)])
    }
}

fn check_scale(block: &MeshBlock, reader: &mut Reader<'_>) {
    if let Some(boxes) = &block.boxes {
        check_names(boxes, &block.at.key("boxes"), reader);
    }
    if (block.r#box.is_some() || block.boxes.is_some()) && block.scale.is_some() {
        reader.complain_at(&block.at.key("scale"), "a generated mesh has no scale: give its size");
    }
}

/// Unknowns of a generated mesh, at most: beyond it no machine that the program was tried on has the memory.
const MOST_UNKNOWNS: f64 = 4e6;

fn check_names(boxes: &[BodyBox], at: &At, reader: &mut Reader<'_>) {
    if boxes.is_empty() {
        reader.complain_at(at, "no box: give one at least");
    }
    for (k, body) in boxes.iter().enumerate() {
        if body.name.is_empty() || body.name.contains('/') {
            reader.complain_at(&body.at.key("name"), "a name has a character at least, and no \"/\"");
        }
        if boxes[..k].iter().any(|other| other.name == body.name) {
            reader.complain_at(&body.at.key("name"), format!("two boxes are named \"{}\"", body.name));
        }
        if body.element.0.dim() != boxes[0].element.0.dim() {
            reader.complain_at(&body.at.key("element"), "boxes and rectangles do not go together");
        }
    }
}

fn check_body(block: &BodyBox, reader: &mut Reader<'_>) {
    let BodyBox { at, corner, size, cells, element, .. } = block.clone();
    let wanted = element.0.dim();
    if corner.is_some_and(|corner| corner.entries().len() != wanted) {
        reader.complain_at(&at.key("corner"), format!("{wanted} entries wanted"));
    }
    check_box(&BoxMesh { at, size, cells, element }, reader);
}

fn check_box(block: &BoxMesh, reader: &mut Reader<'_>) {
    let order = block.element.0.order() as f64;
    // The lattice of nodes: an upper bound for serendipity kinds, exact for all others.
    let nodes: f64 = block.cells.iter().map(|&cells| cells as f64 * order + 1.0).product();
    let unknowns = nodes * block.cells.len() as f64;
    if unknowns > MOST_UNKNOWNS {
        let message = format!(
            "this box would have some {unknowns:.1e} unknowns; at most {MOST_UNKNOWNS:.0e} are taken: use fewer cells"
        );
        reader.complain_at(&block.at.key("cells"), message);
    }
    let wanted = block.element.0.dim();
    let given = [("size", block.size.entries().len()), ("cells", block.cells.len())];
    for (key, found) in given {
        if found != wanted {
            let name = block.element.0.name();
            let message =
                format!("\"{name}\" is a cell in {wanted} dimensions: {wanted} entries wanted, found {found}");
            reader.complain_at(&block.at.key(key), message);
        }
    }
}
