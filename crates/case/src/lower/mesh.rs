//! Meshes of a case: from files, or generated.

use super::{context::Context, named_part};
use crate::lower::problem::CaseProblem;
use crate::warning::LOST_GROUPS;
use nastic_language::number::short;
use nastic_language::schema::{BodyBox, BoxMesh, BoxesMesh, Case, MeshFile, MeshSource, Vector};
use nastic_language::syntax::At;
use nastic_mesh::{Mesh, MeshError, box_mesh, rectangle};
use std::sync::Arc;

/// The body's mesh.
pub(super) fn body(case: &Case, context: &mut Context<'_>) -> Option<Arc<Mesh>> {
    let mesh = load(&case.mesh, &at(case), context)?;
    if case.surfaces.is_empty() && case.regions.is_empty() {
        return Some(mesh);
    }
    // by the pointer too: a program may give other arrays under one name
    let key = format!("{:p} {:?} {:?}", Arc::as_ptr(&mesh), case.surfaces, case.regions);
    context.mesh(key, |context| named_part::add(&mesh, case, context))
}

/// Where the body's mesh stands in the case.
pub(super) fn at(case: &Case) -> At {
    place(&case.mesh)
}

/// Where a mesh stands.
pub(super) fn place(source: &MeshSource) -> At {
    match source {
        MeshSource::File(file) => file.at.clone(),
        MeshSource::Box(block) => block.at.clone(),
        MeshSource::Boxes(boxes) => boxes.at.clone(),
    }
}

/// Reads or makes a mesh, once; what was mended is noted.
pub(super) fn load(source: &MeshSource, at: &At, context: &mut Context<'_>) -> Option<Arc<Mesh>> {
    if let MeshSource::File(file) = source
        && let Some(mesh) = context.document.mesh(&file.file)
    {
        return given(mesh, file.scale, at, context);
    }
    let key = match source {
        MeshSource::File(file) => format!("{} {}", file.file, file.scale),
        MeshSource::Box(block) => format!("{:?} {:?} {}", block.size, block.cells, block.element.0.name()),
        MeshSource::Boxes(boxes) => {
            let of = |body: &BodyBox| {
                let BodyBox { name, corner, size, cells, element, .. } = body;
                format!("{name:?} {corner:?} {size:?} {cells:?} {}", element.0.name())
            };
            boxes.boxes.iter().map(of).collect::<Vec<_>>().join(", ")
        }
    };
    context.mesh(key, |context| make(source, at, context))
}

/// The same mesh once more, for a drawing.
pub fn again(source: &MeshSource, problem: &CaseProblem) -> Option<Arc<Mesh>> {
    load(source, &place(source), &mut Context::new(&problem.document, *problem.units()))
}

/// A mesh that a program made.
fn given(mesh: &Arc<Mesh>, scale: f64, at: &At, context: &mut Context<'_>) -> Option<Arc<Mesh>> {
    if scale != 1.0 {
        context.complain(&at.key("scale"), "a mesh that is given as arrays has no scale: multiply its points");
        return None;
    }
    look_at_groups(mesh, at, context);
    Some(mesh.clone())
}

fn make(source: &MeshSource, at: &At, context: &mut Context<'_>) -> Option<Mesh> {
    let mesh = match source {
        MeshSource::File(file) => read(file, at, context)?,
        MeshSource::Box(block) => {
            check_size(block, &at.key("cells"), context)?;
            let mesh = generate(block);
            context.take(at, mesh)?
        }
        MeshSource::Boxes(BoxesMesh { boxes, .. }) => {
            boxes.iter().try_for_each(|body| check_size(&alone(body), &body.at.key("cells"), context))?;
            let mesh = beside(boxes);
            context.take(at, mesh)?
        }
    };
    look_at_groups(&mesh, at, context);
    Some(mesh)
}

/// Notes what was mended, and warns where the groups of cells were lost.
fn look_at_groups(mesh: &Mesh, at: &At, context: &mut Context<'_>) {
    mesh.notes().iter().for_each(|note| context.note(format!("{}: {note}", mesh.name())));
    if mesh.lost_regions().is_empty() {
        return;
    }
    let quoted = |name: &String| format!("\"{name}\"");
    let listed = mesh.lost_regions().iter().map(quoted).collect::<Vec<_>>().join(", ");
    let regions = mesh.regions().keys().map(quoted).collect::<Vec<_>>().join(", ");
    let name = mesh.name();
    context.warn(
        &LOST_GROUPS,
        at,
        format!("{name} names the groups of cells {listed}, but no cell bears one: its regions are {regions}"),
    );
}

fn read(file: &MeshFile, at: &At, context: &mut Context<'_>) -> Option<Mesh> {
    let path = context.file(&file.file);
    let mesh = nastic_io::read_mesh(&path, file.scale);
    // Named as the case names it: what a reader of messages knows.
    context.take(at, mesh).map(|mesh| mesh.named(file.file.clone()))
}

/// The least that a body takes by unknown, before anything is solved.
const BYTES: f64 = 600.0;
/// What takes less is not looked at: a lack of memory is found where it matters.
const SMALL: f64 = 1e8;

/// Complains of meshes that cannot fit into memory, before they are made.
fn check_size(block: &BoxMesh, at: &At, context: &mut Context<'_>) -> Option<()> {
    let kind = block.element.0;
    let Ok(Some(available)) = nastic_fem::available_memory() else { return Some(()) };
    let nodes: f64 = block.cells.iter().map(|cells| *cells as f64 * kind.order() as f64 + 1.0).product();
    let needed = BYTES * nodes * kind.dim() as f64;
    if needed <= SMALL.max(available as f64) {
        return Some(());
    }
    let message = format!(
        "a mesh of some {} nodes takes {} GB at least before anything is solved, {} are available: take fewer cells",
        short(nodes),
        short(needed / 1e9),
        short(available as f64 / 1e9)
    );
    context.complain(at, message);
    None
}

/// A box by itself.
fn alone(body: &BodyBox) -> BoxMesh {
    let BodyBox { at, size, cells, element, .. } = body.clone();
    BoxMesh { at, size, cells, element }
}

/// Boxes as bodies of one mesh.
fn beside(boxes: &[BodyBox]) -> Result<Mesh, MeshError> {
    let one = |body: &BodyBox| {
        let corner = body.corner.as_ref().map_or([0.0; 3], Vector::xyz);
        generate(&alone(body))?.mapped(|x| std::array::from_fn(|i| x[i] + corner[i]))
    };
    let bodies =
        boxes.iter().map(|body| Ok((body.name.as_str(), one(body)?))).collect::<Result<Vec<_>, MeshError>>()?;
    Mesh::together("boxes", &bodies)
}

fn generate(block: &BoxMesh) -> Result<Mesh, MeshError> {
    let kind = block.element.0;
    let cells = |k: usize| block.cells.get(k).copied().unwrap_or(1);
    let size = block.size.xyz();
    match kind.dim() {
        2 => rectangle([size[0], size[1]], [cells(0), cells(1)], kind),
        _ => box_mesh(size, [cells(0), cells(1), cells(2)], kind),
    }
}
