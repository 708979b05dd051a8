//! Arrays of VTU files on the body's mesh.

use super::context::Context;
use nastic_language::schema::{ArrayFile, Case, MeshSource};
use nastic_language::syntax::{At, quoted};
use nastic_mesh::{Mesh, NamedArray};

/// What an array's values belong to.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Entity {
    Node,
    Cell,
}

/// Values by node or cell of the body's mesh.
#[derive(Clone, Debug)]
pub(super) struct MeshArray {
    pub entity: Entity,
    pub components: usize,
    pub values: Vec<f64>,
}

/// Positions of two files are the same point within this share of the body's size.
const SAME: f64 = 1e-6;

/// Reads an array with one of these numbers of components. Where nodes and cells both have one of the name, `prefer` says
/// which is meant.
pub(super) fn read(
    file: &ArrayFile,
    at: &At,
    components: &[usize],
    prefer: Entity,
    case: &Case,
    mesh: &Mesh,
    context: &mut Context<'_>,
) -> Option<MeshArray> {
    let path = context.file(&file.file);
    let snapshot = context.snapshot(&path, &at.key("file"))?;
    if let Err(why) = check_mesh(&snapshot.mesh, mesh, scale(case)) {
        context.complain(&at.key("file"), format!("{} is not on the mesh of this case: {why}", file.file));
        return None;
    }
    let point = snapshot.point_array(&file.array).map(|array| (Entity::Node, array));
    let cell = snapshot.cell_array(&file.array).map(|array| (Entity::Cell, array));
    let found = if prefer == Entity::Node { point.or(cell) } else { cell.or(point) };
    let Some((entity, array)) = found else {
        let names = |arrays: &[NamedArray]| match arrays {
            [] => "none".to_owned(),
            some => some.iter().map(|a| a.name.clone()).collect::<Vec<_>>().join(", "),
        };
        let (points, cells) = (names(&snapshot.point_data), names(&snapshot.cell_data));
        let message = format!(
            "array {} not found in {}; it has the point arrays: {points}; the cell arrays: {cells}",
            quoted(&file.array),
            file.file
        );
        context.complain(&at.key("array"), message);
        return None;
    };
    if !components.contains(&array.components) {
        let wanted = components.iter().map(ToString::to_string).collect::<Vec<_>>().join(" or ");
        let message = format!("{} has {} components, {wanted} wanted", quoted(&file.array), array.components);
        context.complain(&at.key("array"), message);
        return None;
    }
    if let Some(bad) = array.values.iter().position(|value| !value.is_finite()) {
        let message = format!("{} is not finite at entry {bad} ({})", quoted(&file.array), array.values[bad]);
        context.complain(&at.key("array"), message);
        return None;
    }
    Some(MeshArray { entity, components: array.components, values: array.values.clone() })
}

/// Factor from the coordinates of the body's mesh file, 1 for a generated one.
fn scale(case: &Case) -> f64 {
    match &case.mesh {
        MeshSource::File(file) => file.scale,
        MeshSource::Box(_) | MeshSource::Boxes(_) => 1.0,
    }
}

/// Whether nodes and cells agree, the file's coordinates being scaled already or not.
fn check_mesh(found: &Mesh, mesh: &Mesh, scale: f64) -> Result<(), String> {
    let counts = |mesh: &Mesh| (mesh.points().len(), mesh.cells());
    if counts(found) != counts(mesh) {
        let ((nodes, cells), (wanted_nodes, wanted_cells)) = (counts(found), counts(mesh));
        return Err(format!("it has {nodes} nodes and {cells} cells, {wanted_nodes} and {wanted_cells} are wanted"));
    }
    let near = SAME * mesh.diagonal();
    let apart = |scale: f64| {
        let pairs = found.points().iter().zip(mesh.points()).enumerate();
        pairs.map(|(node, (a, b))| (node, distance(a.map(|x| x * scale), *b))).find(|(_, d)| *d > near)
    };
    match apart(1.0).and_then(|found| apart(scale).and(Some(found))) {
        None => Ok(()),
        Some((node, distance)) => Err(format!("its node {node} lies {distance:.3e} from the mesh's")),
    }
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()
}
