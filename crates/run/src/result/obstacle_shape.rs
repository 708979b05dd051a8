//! Obstacles as bodies to be drawn.

use nastic_case::lower::{CaseMember, CaseProblem, mesh_again};
use nastic_fem::{Instant, State};
use nastic_language::schema::{Constraint, Cost, Obstacle, Shape, ShapeOrName};
use nastic_mesh::{CellKind, Mesh, RawMesh, Snapshot, box_mesh, rectangle};
use std::sync::Arc;

/// Cells per direction; odd, so that a layer in the middle can be stretched.
const CELLS: usize = 11;

/// Thickness of the plate that stands for a half-space, and half of its width, as shares of the body's diagonal.
const PLATE: [f64; 2] = [0.02, 0.75];

/// The obstacles of a member that rest, each once; a half-space, which has no end, as a plate in front of the body.
pub(crate) fn all(member: CaseMember<'_>) -> Vec<Snapshot> {
    let case = member.case();
    let own = |shape: &ShapeOrName| match shape {
        ShapeOrName::Shape(shape) => Some(shape.clone()),
        ShapeOrName::Name(_) => None,
    };
    let of_constraint = |block: &Constraint| block.obstacle.as_ref().and_then(|keep_out| own(&keep_out.shape));
    let of_cost = |block: &Cost| match block {
        Cost::Obstacle(block) => own(&block.shape),
        _ => None,
    };
    let mut meshes: Vec<Arc<Mesh>> = Vec::new();
    let at_rest =
        case.obstacles.iter().filter(|obstacle| !is_moved(member, obstacle)).map(|obstacle| obstacle.shape.clone());
    let shapes = case.constraints.iter().filter_map(of_constraint).chain(case.costs.iter().filter_map(of_cost));
    for mesh in at_rest.chain(shapes).filter_map(|shape| of_shape(&shape, member)) {
        if !meshes.iter().any(|known| known.points() == mesh.points()) {
            meshes.push(mesh);
        }
    }
    meshes.into_iter().map(Snapshot::new).collect()
}

fn of_shape(shape: &Shape, member: CaseMember<'_>) -> Option<Arc<Mesh>> {
    match shape {
        Shape::Mesh(source) => mesh_again(source, member.problem()),
        shape => mesh(shape, member.mesh()).map(Arc::new),
    }
}

/// Whether a pose is given for an obstacle that a contact touches, or controlled.
fn is_moved(member: CaseMember<'_>, obstacle: &Obstacle) -> bool {
    let parts = ["translation", "rotation"].map(|part| format!("{}.{part}", obstacle.name));
    let controlled = member.case().controls.iter().any(|control| parts.contains(&control.of));
    let touched = member.case().contact.iter().any(|contact| contact.obstacle == obstacle.name);
    touched && (controlled || obstacle.pose().next().is_some())
}

/// Whether obstacles of a member may move.
pub(crate) fn has_moved(member: CaseMember<'_>) -> bool {
    member.case().obstacles.iter().any(|obstacle| is_moved(member, obstacle))
}

/// The obstacles that may move, where they are in a state, as one mesh with a region for each.
pub(crate) fn moved(member: CaseMember<'_>, state: &State) -> Option<Arc<Mesh>> {
    let poses = member.solid().model().poses(&Instant::of(state));
    let mut raw = RawMesh::new("obstacles");
    for obstacle in member.case().obstacles.iter().filter(|obstacle| is_moved(member, obstacle)) {
        let (Some(pose), Some(mesh)) =
            (poses.iter().find(|pose| pose.name == obstacle.name), of_shape(&obstacle.shape, member))
        else {
            continue;
        };
        let (first, tag) = (raw.points.len() as u32, raw.names.len() as i32 + 1);
        raw.points.extend(mesh.points().iter().map(|x| pose.apply(*x)));
        raw.name_group(member.mesh().dim(), tag, &obstacle.name);
        for block in mesh.blocks() {
            for nodes in block.iter() {
                let nodes: Vec<u32> = nodes.iter().map(|node| first + node).collect();
                raw.push(block.kind, &nodes, &[tag]);
            }
        }
    }
    Mesh::build(raw).ok().map(Arc::new)
}

/// `obstacle_1.vtu` and so on for all members together, and the names of each member's own.
pub(crate) fn files(problem: &CaseProblem) -> (Vec<(String, Snapshot)>, Vec<Vec<String>>) {
    let mut files: Vec<(String, Snapshot)> = Vec::new();
    let mut name = |shape: Snapshot| {
        if let Some((known, _)) = files.iter().find(|(_, known)| known.mesh.points() == shape.mesh.points()) {
            return known.clone();
        }
        files.push((format!("obstacle_{}.vtu", files.len() + 1), shape));
        format!("obstacle_{}.vtu", files.len())
    };
    let names = problem.members().map(|member| all(member).into_iter().map(&mut name).collect()).collect();
    (files, names)
}

/// A block of cells along the axes of a plane or of space, one corner at the origin.
fn block(size: [f64; 3], cells: [usize; 3], dim: usize) -> Option<Mesh> {
    match dim {
        2 => rectangle([size[0], size[1]], [cells[0], cells[1]], CellKind::Quad4).ok(),
        _ => box_mesh(size, cells, CellKind::Hex8).ok(),
    }
}

/// A ball or a capsule of bricks, a plate, a box.
fn mesh(shape: &Shape, body: &Mesh) -> Option<Mesh> {
    let dim = body.dim();
    let (from, to, radius) = match shape {
        Shape::Sphere(sphere) => (sphere.center.xyz(), sphere.center.xyz(), sphere.radius),
        Shape::Capsule(capsule) => (capsule.from.xyz(), capsule.to.xyz(), capsule.radius),
        Shape::Box(corners) => {
            let [low, high] = corners.corners();
            let size = std::array::from_fn(|i| high[i] - low[i]);
            let at = |x: [f64; 3]| std::array::from_fn(|i| low[i] + x[i]);
            return block(size, [CELLS; 3], dim)?.mapped(at).ok();
        }
        Shape::Mesh(_) => return None,
        Shape::HalfSpace(half) => return plate(half.point.xyz(), half.normal.xyz(), body),
    };
    let along: [f64; 3] = std::array::from_fn(|i| to[i] - from[i]);
    let length = norm(&along);
    let last = dim - 1;
    let axis = if length > 0.0 { along.map(|a| a / length) } else { std::array::from_fn(|i| f64::from(i == last)) };
    let frame = frame(axis, dim);
    let cube = block([2.0; 3], [CELLS; 3], dim)?;
    let place = |x: [f64; 3]| {
        // The cube to the unit ball: the same direction, the largest coordinate for a length.
        let p: [f64; 3] = std::array::from_fn(|i| if i < dim { x[i] - 1.0 } else { 0.0 });
        let (size, largest) = (norm(&p), p.iter().fold(0.0, |most: f64, p| most.max(p.abs())));
        let q = p.map(|p| if size > 0.0 { radius * p * largest / size } else { 0.0 });
        let end = if p[last] > 0.0 { to } else { from };
        std::array::from_fn(|i| end[i] + (0..3).map(|k| q[k] * frame[k][i]).sum::<f64>())
    };
    cube.mapped(place).ok()
}

/// Of the half-space behind a plane the part next to the body.
fn plate(point: [f64; 3], normal: [f64; 3], body: &Mesh) -> Option<Mesh> {
    let (dim, normal) = (body.dim(), normal.map(|n| n / norm(&normal)));
    let count = body.points().len() as f64;
    let center: [f64; 3] = std::array::from_fn(|i| body.points().iter().map(|x| x[i]).sum::<f64>() / count);
    let away: f64 = (0..3).map(|i| normal[i] * (center[i] - point[i])).sum();
    let [thickness, reach] = PLATE.map(|share| share * body.diagonal());
    let frame = frame(normal, dim);
    let (mut size, mut cells) = ([2.0 * reach; 3], [CELLS; 3]);
    (size[dim - 1], cells[dim - 1]) = (thickness, 1);
    let slab = block(size, cells, dim)?;
    let place = |x: [f64; 3]| {
        let local: [f64; 3] = std::array::from_fn(|k| match k + 1 {
            k if k < dim => x[k - 1] - reach,
            k if k == dim => x[k - 1] - thickness - away,
            _ => 0.0,
        });
        std::array::from_fn(|i| center[i] + (0..3).map(|k| local[k] * frame[k][i]).sum::<f64>())
    };
    slab.mapped(place).ok()
}

fn norm(v: &[f64; 3]) -> f64 {
    v.iter().map(|v| v * v).sum::<f64>().sqrt()
}

/// An orthonormal, right-handed frame with this vector as the third, in a plane as the second.
fn frame(c: [f64; 3], dim: usize) -> [[f64; 3]; 3] {
    if dim == 2 {
        return [[c[1], -c[0], 0.0], c, [0.0, 0.0, 1.0]];
    }
    let helper = if c[0].abs() < 0.9 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
    let cross =
        |a: [f64; 3], b: [f64; 3]| [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    let b = cross(c, helper);
    let size = norm(&b);
    let b = b.map(|b| b / size);
    [cross(b, c), b, c]
}
