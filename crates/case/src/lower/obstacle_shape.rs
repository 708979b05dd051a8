//! Obstacles as bodies to be drawn.

use crate::lower::mesh::again as mesh_again;
use crate::lower::obstacle::obstacle_of;
use crate::lower::{CaseMember, CaseProblem};
use nastic_fem::{Instant, State};
use nastic_language::schema::{Constraint, Cost, Obstacle, Shape, ShapeOrName};
use nastic_mesh::{Mesh, RawMesh, Snapshot};
use std::sync::Arc;

/// The obstacles of a member that rest, each once; a half-space, which has no end, as a plate in front of the body.
pub fn all(member: CaseMember<'_>) -> Vec<Snapshot> {
    let case = member.case();
    let own = |shape: &ShapeOrName| match shape {
        ShapeOrName::Shape(shape) => Some(shape.clone()),
        ShapeOrName::Name(_) => None,
    };
    let of_constraint = |block: &Constraint| block.obstacle.as_ref().and_then(|keep_out| own(&keep_out.shape));
    let of_costs = case.costs.iter().flat_map(Cost::shapes).filter_map(|(shape, _)| own(shape));
    let mut meshes: Vec<Arc<Mesh>> = Vec::new();
    let at_rest =
        case.obstacles.iter().filter(|obstacle| !is_moved(member, obstacle)).map(|obstacle| obstacle.shape.clone());
    let shapes = case.constraints.iter().filter_map(of_constraint).chain(of_costs);
    for mesh in at_rest.chain(shapes).filter_map(|shape| of_shape(&shape, member)) {
        if !meshes.iter().any(|known| known.points() == mesh.points()) {
            meshes.push(mesh);
        }
    }
    meshes.into_iter().map(Snapshot::new).collect()
}

/// The names of the obstacles of a member; of a shape that a constraint or a cost has of its own the name of that.
pub fn names(member: CaseMember<'_>) -> Vec<String> {
    let case = member.case();
    let is_own = |shape: &ShapeOrName| matches!(shape, ShapeOrName::Shape(_));
    let of_constraint = |block: &&Constraint| block.obstacle.as_ref().is_some_and(|keep_out| is_own(&keep_out.shape));
    let of_cost = |cost: &&Cost| cost.shapes().any(|(shape, _)| is_own(shape));
    let named = case.obstacles.iter().map(|obstacle| obstacle.name.as_str());
    let named = named.chain(case.constraints.iter().filter(of_constraint).map(Constraint::name));
    let mut names: Vec<String> = Vec::new();
    for name in named.chain(case.costs.iter().filter(of_cost).map(Cost::name)) {
        if !names.iter().any(|known| known == name) {
            names.push(name.to_owned());
        }
    }
    names
}

fn of_shape(shape: &Shape, member: CaseMember<'_>) -> Option<Arc<Mesh>> {
    match shape {
        Shape::Mesh(source) => mesh_again(source, member.problem()),
        shape => obstacle_of(shape)?.drawn(member.mesh()).map(Arc::new),
    }
}

/// Whether a pose is given for an obstacle that a contact touches, or controlled.
fn is_moved(member: CaseMember<'_>, obstacle: &Obstacle) -> bool {
    let parts = ["translation", "rotation"].map(|part| format!("{}.{part}", obstacle.name));
    let controlled = member.case().controls.iter().any(|control| parts.contains(&control.of));
    let touched = member.case().contact.iter().any(|contact| contact.is_on(&obstacle.name));
    touched && (controlled || obstacle.pose().next().is_some())
}

/// Whether obstacles of a member may move.
pub fn has_moved(member: CaseMember<'_>) -> bool {
    member.case().obstacles.iter().any(|obstacle| is_moved(member, obstacle))
}

/// The obstacles that may move, where they are in a state, as one mesh with a region for each.
pub fn moved(member: CaseMember<'_>, state: &State) -> Option<Arc<Mesh>> {
    let poses = member.solid().model().contacts().poses(&Instant::of(state));
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
pub fn files(problem: &CaseProblem) -> (Vec<(String, Snapshot)>, Vec<Vec<String>>) {
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
