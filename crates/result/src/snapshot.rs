//! States as snapshots, under the names the case gives its controls.

use crate::controls;
use crate::files::Beside;
use crate::inspection::Inspection;
use nastic_case::electric;
use nastic_case::lower::obstacle_shape;
use nastic_case::lower::result_array::TARGET_DISTANCE;
use nastic_case::lower::{CaseMember, ControlField, TargetShape};
use nastic_control::{ControlBlock, ControlError, StateFields};
use nastic_fem::{Instant, State};
use nastic_mesh::{Shape, Snapshot};
use rayon::prelude::*;

/// The snapshot of a state: [`nastic_control::Reduced::snapshot_of`] with the case's names.
///
/// # Errors
/// An array that does not fit its mesh.
pub fn snapshot(member: CaseMember<'_>, fields: &StateFields<'_>) -> Result<Snapshot, ControlError> {
    let names: Vec<&str> = member.fields().map(|(_, field)| field.array.as_str()).collect();
    let shot = member.reduced().snapshot_of(&StateFields { names: &names, ..*fields })?;
    let mut shot = Snapshot { obstacles: obstacle_shape::moved(member, fields.state), ..shot };
    for array in &mut shot.point_data {
        let factor = electric::factor(member, &array.name);
        if factor != 1.0 {
            array.values.iter_mut().for_each(|value| *value *= factor);
        }
    }
    Ok(shot)
}

/// What its states have beside the body.
pub fn beside(member: CaseMember<'_>) -> Beside {
    let rest = member.solid().rest();
    let lines = member.solid().model().lines(&Instant::new(&rest.u, &rest.controls, 0.0));
    Beside { lines: lines.is_ok_and(|lines| !lines.is_empty()), obstacles: obstacle_shape::has_moved(member) }
}

/// Displacement and control fields alone, for the record of an optimisation's iterations.
///
/// # Errors
/// An array that does not fit its mesh.
pub fn iterate(member: CaseMember<'_>, fields: &StateFields<'_>) -> Result<Snapshot, ControlError> {
    let names: Vec<&str> = member.fields().map(|(_, field)| field.array.as_str()).collect();
    member.reduced().moved_controls(&StateFields { names: &names, ..*fields })
}

/// The displaced body with vectors of the control space as arrays `CONTROL_NAME`.
///
/// # Errors
/// An array that does not fit its mesh.
pub fn control_fields(
    member: CaseMember<'_>,
    state: &State,
    vectors: &[(&str, Vec<f64>)],
) -> Result<Snapshot, ControlError> {
    vectors.iter().try_fold(member.reduced().moved(state)?, |shot, (name, vector)| {
        let names: Vec<String> = member.fields().map(|(_, field)| format!("{}_{name}", field.array)).collect();
        member.reduced().with_controls(shot, vector, &names.iter().map(String::as_str).collect::<Vec<_>>())
    })
}

/// Names of the control fields that are vectors of the material, and turn with it.
pub fn material_vectors(member: CaseMember<'_>) -> Vec<String> {
    let of = |(block, field): (&ControlBlock, &ControlField)| {
        (controls::slot(member, block) == Some("remanence")).then(|| field.array.clone())
    };
    member.fields().filter_map(of).collect()
}

/// The same as [`snapshot`], with the cells marked where the body intersects itself: cell data `intersecting`, left out where it does not.
///
/// # Errors
/// An array that does not fit its mesh.
pub fn inspected(
    member: CaseMember<'_>,
    fields: &StateFields<'_>,
    found: Option<&Inspection>,
) -> Result<Snapshot, ControlError> {
    let shot = with_distances(member, snapshot(member, fields)?)?;
    match found.and_then(|found| found.intersecting(member.mesh().cells())) {
        Some(marks) => Ok(shot.with_cells("intersecting", 1, marks)?),
        None => Ok(shot),
    }
}

/// The snapshot of a state without the fields that look at it in another way: what iterations and pictures need.
///
/// # Errors
/// An array that does not fit its mesh.
pub fn plain(member: CaseMember<'_>, fields: &StateFields<'_>) -> Result<Snapshot, ControlError> {
    snapshot(member, &StateFields { detailed: false, ..*fields })
}

/// Adds how far every node is from the targets: point data `target_distance` of the first, `target_distance_COST` of further
/// ones. Of a target shape the distance from its nearest point, 0 inside; of tracked nodes that from where they should be, 0 elsewhere.
fn with_distances(member: CaseMember<'_>, mut shot: Snapshot) -> Result<Snapshot, ControlError> {
    let positions = shot.positions();
    for (k, target) in member.targets().iter().enumerate() {
        let name = if k == 0 { TARGET_DISTANCE.to_owned() } else { format!("{TARGET_DISTANCE}_{}", target.cost) };
        if let Some(distances) = distances(target, &positions) {
            shot = shot.with_points(&name, 1, distances)?.in_single(&[&name]);
        }
    }
    Ok(shot)
}

/// `None` of a shape that searches cannot use.
fn distances(target: &TargetShape, positions: &[[f64; 3]]) -> Option<Vec<f64>> {
    if target.displacement.is_empty() {
        let shape = Shape::of(&target.mesh, target.mesh.points(), target.regions.as_ref()).ok()?;
        return Some(positions.par_iter().map(|x| shape.distance(*x)).collect());
    }
    let distance = |(node, x): (usize, &[f64; 3])| {
        let (wanted, (u, matters)) = (target.mesh.points()[node], target.displacement[node]);
        let squared: f64 = (0..3).map(|c| (x[c] - wanted[c] - u[c]).powi(2)).sum();
        if matters { squared.sqrt() } else { 0.0 }
    };
    Some(positions.iter().enumerate().map(distance).collect())
}

/// A target as it is shown: its mesh, or the body moved to where it is wanted.
pub(crate) fn target(shape: &TargetShape) -> Result<Snapshot, ControlError> {
    let out = Snapshot::new(shape.mesh.clone());
    if shape.displacement.is_empty() {
        return Ok(out);
    }
    let values = shape.displacement.iter().flat_map(|(u, _)| *u).collect();
    let flags = shape.displacement.iter().map(|(_, matters)| f64::from(*matters)).collect();
    Ok(out.with_points("displacement", 3, values)?.with_points("tracked", 1, flags)?)
}
