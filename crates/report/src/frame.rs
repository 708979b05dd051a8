//! Frames: a body at one moment of a run, as the three-dimensional view shows it.

use crate::carried::carried;
use crate::encode::quantised;
use crate::iterates::Iterates;
use crate::surface::BodySurface;
use nastic_mesh::{NamedArray, Snapshot};
use serde_json::{Map, Value, json};

/// How much of a state is shown.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Amount {
    /// All scalars and vectors.
    All,
    /// Positions, displacement and J.
    Shape,
}

/// Arrays that are no fields of a state to be looked at, or say what others do: the page finds distances for every state that it shows.
const LEFT_OUT: [&str; 5] = ["region", "tracked", "displacement", "nodal_mises", "target_distance"];
/// A triple that is no vector.
const STRETCHES: &str = "principal_stretches";
/// The field of the length of displacements.
pub(crate) const DISPLACEMENT: &str = "|u|";

/// A state as `{ "label", "x", "fields": { NAME: .. }, "vectors": { NAME: .. } }`: positions of the surface's nodes, scalars
/// by node or face, vectors at the faces that bear arrows. Vectors named in `material` are carried with the body.
pub(crate) fn of_snapshot(
    label: &str,
    shot: &Snapshot,
    surface: &BodySurface,
    amount: Amount,
    material: &[String],
) -> Value {
    let positions = shot.positions();
    let mut fields = Map::new();
    if let Some(u) = shot.point_array("displacement") {
        let length = |node: &u32| u.at(*node as usize).iter().map(|x| x * x).sum::<f64>().sqrt();
        let lengths: Vec<f64> = surface.nodes.iter().map(length).collect();
        fields.insert(DISPLACEMENT.into(), field("nodes", &lengths));
    }
    let cells = surface.cells();
    let is_shown = |array: &&NamedArray| {
        array.components == 1
            && !LEFT_OUT.contains(&array.name.as_str())
            && !array.name.starts_with("target_distance_")
            && (amount == Amount::All || array.name == "J")
    };
    for array in shot.point_data.iter().filter(is_shown) {
        let values: Vec<f64> = surface.nodes.iter().map(|node| array.values[*node as usize]).collect();
        fields.insert(array.name.clone(), field("nodes", &values));
    }
    for array in shot.cell_data.iter().filter(is_shown) {
        let values: Vec<f64> = cells.iter().map(|cell| array.values[*cell as usize]).collect();
        fields.insert(array.name.clone(), field("faces", &values));
    }
    let mut vectors = Map::new();
    let arrows = surface.arrow_faces();
    for array in
        shot.cell_data.iter().filter(|array| array.components == 3 && array.name != STRETCHES && amount == Amount::All)
    {
        let is_carried = material.contains(&array.name) || array.name.starts_with("direction_");
        let of = |face: &u32| {
            let cell = cells[*face as usize];
            let own = array.at(cell as usize);
            let vector = [own[0], own[1], own[2]];
            if is_carried { carried(&shot.mesh, &positions, cell, vector) } else { vector }
        };
        let values: Vec<f64> = arrows.iter().flat_map(of).collect();
        vectors.insert(array.name.clone(), quantised(&values, 3));
    }
    json!({ "label": label, "x": nodes(&positions, surface), "fields": fields, "vectors": vectors })
}

/// A kept iteration in the same form; `None` if it belongs to another surface.
pub(crate) fn of_iterate(iterates: &Iterates, index: usize, surface: &BodySurface) -> Option<Value> {
    let iteration = *iterates.iterations().get(index)?;
    let mut parts = iterates.parts(index).into_iter();
    let positions = parts.next()?;
    let faces = surface.cells().len();
    if iterates.nodes() != surface.nodes.len() || positions.len() != 3 * surface.nodes.len() {
        return None;
    }
    let (mut fields, mut vectors) = (Map::new(), Map::new());
    for (described, values) in iterates.fields().iter().zip(parts) {
        let (on, entities) = if described.on_nodes { ("nodes", surface.nodes.len()) } else { ("faces", faces) };
        if values.len() != entities * described.components {
            return None;
        }
        if described.components == 1 {
            fields.insert(described.name.clone(), field(on, &values));
        } else if described.components == 3 && !described.on_nodes {
            let at = |face: &u32| values[3 * *face as usize..][..3].to_vec();
            let arrows: Vec<f64> = surface.arrow_faces().iter().flat_map(at).collect();
            vectors.insert(described.name.clone(), quantised(&arrows, 3));
        }
    }
    let x = quantised(&positions, 3);
    Some(json!({ "label": format!("iteration {iteration}"), "x": x, "fields": fields, "vectors": vectors }))
}

/// A state moved on along a mode of its tangent, whose largest component becomes a tenth of the body's size.
pub(crate) fn of_mode(label: &str, shot: &Snapshot, mode: &NamedArray, surface: &BodySurface) -> Value {
    let most = mode.values.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    let factor = if most > 0.0 { 0.1 * shot.mesh.diagonal() / most } else { 0.0 };
    let moved = |(x, phi): (&[f64; 3], &[f64])| std::array::from_fn(|k| x[k] + factor * phi[k]);
    let positions: Vec<[f64; 3]> = shot.positions().iter().zip(mode.values.chunks_exact(3)).map(moved).collect();
    let length = |node: &u32| mode.at(*node as usize).iter().map(|x| x * x).sum::<f64>().sqrt();
    let lengths: Vec<f64> = surface.nodes.iter().map(length).collect();
    json!({
        "label": label, "x": nodes(&positions, surface),
        "fields": { "mode": field("nodes", &lengths) }, "vectors": {},
    })
}

/// Positions of the surface's nodes.
pub(crate) fn nodes(positions: &[[f64; 3]], surface: &BodySurface) -> Value {
    let values: Vec<f64> = surface.nodes.iter().flat_map(|node| positions[*node as usize]).collect();
    quantised(&values, 3)
}

fn field(on: &str, values: &[f64]) -> Value {
    let mut out = quantised(values, 1);
    out["on"] = json!(on);
    out
}
