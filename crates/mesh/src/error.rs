//! Errors of meshes and of queries on them.

use crate::CellKind;

/// An error of this crate. Cells and nodes are numbered as in the file they came from.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MeshError {
    /// The mesh cannot be used.
    #[error("{mesh}: {fault}")]
    Faulty {
        /// Name of the mesh (its file, or "box").
        mesh: String,
        /// What is wrong with it.
        fault: Box<Fault>,
    },
    /// No region, surface or node set has this name.
    #[error("{what} \"{name}\" not found in {mesh}; {}", offer(.known, .nearest))]
    UnknownName {
        /// "region", "surface" or "node set".
        what: &'static str,
        /// The name asked for.
        name: String,
        /// Name of the mesh.
        mesh: String,
        /// The names there are.
        known: Vec<String>,
        /// The one that may have been meant.
        nearest: Option<String>,
    },
    /// A generator was asked for something it cannot make.
    #[error("cannot generate {what}: {why}")]
    Generate {
        /// "a box" or "a rectangle".
        what: &'static str,
        /// What is wrong with the request, and what to try.
        why: String,
    },
    /// A mesh cannot be divided so.
    #[error("part {part} of {mesh}: {why}")]
    Part {
        /// Name of the mesh.
        mesh: String,
        /// Number of the part.
        part: u32,
        /// What is wrong, and what to try.
        why: String,
    },
    /// A point of space that no cell holds.
    #[error("{} is outside the body, which spans {} to {}{}", show(.point), show(.low), show(.high), near(.nearest))]
    OutsideBody {
        /// The point.
        point: [f64; 3],
        /// Least coordinates of the body.
        low: [f64; 3],
        /// Greatest coordinates of the body.
        high: [f64; 3],
        /// The nearest point of the body and its distance, where the body can be searched.
        nearest: Option<([f64; 3], f64)>,
    },
    /// An array does not fit the mesh it is attached to.
    #[error("array \"{name}\" has {found} values; {expected} needed ({entities} entities of {components} components)")]
    ArrayLength {
        /// Name of the array.
        name: String,
        /// Values given.
        found: usize,
        /// Values needed.
        expected: usize,
        /// Nodes or cells of the mesh.
        entities: usize,
        /// Components per entity.
        components: usize,
    },
}

fn near(nearest: &Option<([f64; 3], f64)>) -> String {
    let shown = |(x, distance)| format!("; the nearest point of it is {}, {distance:.3e} away", show(&x));
    nearest.map_or_else(String::new, shown)
}

fn show([x, y, z]: &[f64; 3]) -> String {
    format!("({x}, {y}, {z})")
}

/// Why a file from Gmsh has no cells of the body.
const ONLY_GROUPS: &str = "Gmsh saves only the elements of physical groups as soon as there is one: add `Physical Volume(\"body\") = {1};` to the \
    script (`Physical Surface(\"body\") = {1};` in plane strain) and mesh in three (two) dimensions, `gmsh -3`; or \
    `Mesh.SaveAll = 1;`, which may lose the names of groups";

/// Why a mesh cannot be used. Cells, surface elements and nodes bear the numbers of the file where it gave some, else
/// their position counted from 0.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Fault {
    /// There is nothing to compute on.
    #[error("no volume cells and no plane cells. {}", ONLY_GROUPS)]
    NoCells,
    /// Connectivity that is not a whole number of elements, or labels that do not match it.
    #[error("{what}: {found} entries where {expected} are needed")]
    Inconsistent {
        /// Which list.
        what: String,
        /// Its length.
        found: usize,
        /// The length that would fit.
        expected: usize,
    },
    /// More nodes or elements than 32-bit numbers can count.
    #[error("{found} {what} are more than this program can number (at most {MAX_ENTITIES})")]
    TooMany {
        /// "nodes" or "elements".
        what: &'static str,
        /// How many.
        found: usize,
    },
    /// A coordinate that is NaN or infinite.
    #[error("node {node} has the coordinates ({}, {}, {}), which are not finite", point[0], point[1], point[2])]
    NotFinite {
        /// The node.
        node: u64,
        /// Its coordinates.
        point: [f64; 3],
    },
    /// An element that names a node the mesh does not have.
    #[error("{kind} {cell} names node index {node}, but there are {nodes} nodes (counted from 0)")]
    NodeOutOfRange {
        /// The element.
        cell: u64,
        /// Its kind.
        kind: CellKind,
        /// The index it names.
        node: u32,
        /// Number of nodes.
        nodes: usize,
    },
    /// A tagged vertex that names a node the mesh does not have.
    #[error("a vertex of group {tag} names node index {node}, but there are {nodes} nodes (counted from 0)")]
    VertexOutOfRange {
        /// The group.
        tag: i32,
        /// The index it names.
        node: u32,
        /// Number of nodes.
        nodes: usize,
    },
    /// An element that names a node twice.
    #[error(
        "{kind} {cell} names node {node} twice; collapsed elements are not supported: mesh it with tetrahedra or triangles there"
    )]
    RepeatedNode {
        /// The element.
        cell: u64,
        /// Its kind.
        kind: CellKind,
        /// The node.
        node: u64,
    },
    /// A cell without volume.
    #[error("{kind} {cell} has zero volume ({volume:e} for a diameter of {diameter:e})")]
    ZeroVolume {
        /// The cell.
        cell: u64,
        /// Its kind.
        kind: CellKind,
        /// Signed volume (area in the plane).
        volume: f64,
        /// Diagonal of its bounding box.
        diameter: f64,
    },
    /// A cell whose Jacobian changes sign: no renumbering of its nodes mends that.
    #[error(
        "{kind} {cell} is folded: its Jacobian runs from {lowest:e} to {highest:e}; check the order of its nodes, or refine and smooth the mesh there{}",
        untangled(*.kind)
    )]
    Folded {
        /// The cell.
        cell: u64,
        /// Its kind.
        kind: CellKind,
        /// Lowest Jacobian at its quadrature points and centre.
        lowest: f64,
        /// Highest one.
        highest: f64,
    },
    /// A cell whose volume would be negative where its nodes are moved to.
    #[error("{kind} {cell} is turned inside out by the move of its nodes")]
    InsideOut {
        /// The cell.
        cell: u64,
        /// Its kind.
        kind: CellKind,
    },
    /// A scale that is not a positive number.
    #[error("cannot scale by {factor}; a positive number is needed")]
    Scale {
        /// The number given.
        factor: f64,
    },
    /// Plane cells that do not lie in a plane of constant z.
    #[error(
        "no volume cells, and the plane cells are not at constant z: z = {z:e} at node {node}, {other_z:e} at node {other}. Membranes and shells are not supported: mesh the volume, or put the plane-strain section into z = 0. {}",
        ONLY_GROUPS
    )]
    Membrane {
        /// A node.
        node: u64,
        /// Its z.
        z: f64,
        /// Another node.
        other: u64,
        /// Its z.
        other_z: f64,
    },
    /// A facet that belongs to more than two cells.
    #[error("cells {} meet in one facet; a body has at most two on each", cells.iter().map(u64::to_string).collect::<Vec<_>>().join(", "))]
    NonManifold {
        /// The cells.
        cells: Vec<u64>,
    },
    /// Two cells that share the corners of a facet but not all its nodes.
    #[error("{} {} and {} {} share the corners of a facet but not its other nodes; mix only elements whose facets agree", kinds[0], cells[0], kinds[1], cells[1])]
    NonConforming {
        /// The two cells.
        cells: [u64; 2],
        /// Their kinds.
        kinds: [CellKind; 2],
    },
    /// Two cells that lie on the same side of their common facet.
    #[error("cells {} and {} overlap: both lie on the same side of their common facet", cells[0], cells[1])]
    Overlap {
        /// The two cells.
        cells: [u64; 2],
    },
    /// A surface element that is no facet of any cell.
    #[error(
        "{kind} {element} of surface \"{surface}\" is not a facet of any cell; surfaces must lie on the body, with its nodes"
    )]
    Dangling {
        /// The surface.
        surface: String,
        /// The element.
        element: u64,
        /// Its kind.
        kind: CellKind,
    },
}

/// What helps curved cells that are folded, whose midside nodes a mesh generator put onto the surface.
fn untangled(kind: CellKind) -> &'static str {
    match kind.order() {
        1 => "",
        _ => "; Gmsh untangles curved cells: -setnumber Mesh.HighOrderOptimize 2",
    }
}

/// Entities of a mesh: the numbers of six faces per cell fit into 32 bits.
pub(crate) const MAX_ENTITIES: usize = u32::MAX as usize / 8;

fn offer(known: &[String], nearest: &Option<String>) -> String {
    let list = if known.is_empty() { "it has none".to_owned() } else { format!("it has: {}", known.join(", ")) };
    match nearest {
        Some(name) => format!("{list}. Did you mean \"{name}\"?"),
        None => list,
    }
}
