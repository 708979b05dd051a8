//! States as snapshots, under the names the case gives its controls.

use super::summary;
use crate::lower::{CaseMember, ControlField, TargetShape};
use nastic_control::{ControlBlock, ControlError, StateFields};
use nastic_mesh::Snapshot;

use super::inspection::Inspection;

/// Names of result arrays that no control may take.
pub(crate) const RESERVED: [&str; 15] = [
    "mises",
    "displacement",
    "adjoint",
    "J",
    "P",
    "cauchy_stress",
    "energy",
    "fiber",
    "B_r",
    "B_a",
    "region",
    "intersecting",
    "failed",
    "min_J",
    "failure_rank",
];

/// The snapshot of a state: [`nastic_control::Reduced::snapshot_of`] with the case's names.
pub(crate) fn snapshot(member: CaseMember<'_>, fields: &StateFields<'_>) -> Result<Snapshot, ControlError> {
    let names: Vec<&str> = member.fields().map(|(_, field)| field.array.as_str()).collect();
    member.reduced().snapshot_of(&StateFields { names: &names, ..*fields })
}

/// Displacement and control fields alone, for the record of an optimisation's iterations.
pub(crate) fn iterate(member: CaseMember<'_>, fields: &StateFields<'_>) -> Result<Snapshot, ControlError> {
    let names: Vec<&str> = member.fields().map(|(_, field)| field.array.as_str()).collect();
    member.reduced().moved_controls(&StateFields { names: &names, ..*fields })
}

/// Names of the control fields that are vectors of the material, and turn with it.
pub(crate) fn material_vectors(member: CaseMember<'_>) -> Vec<String> {
    let of = |(block, field): (&ControlBlock, &ControlField)| {
        (summary::slot(member, block) == Some("remanence")).then(|| field.array.clone())
    };
    member.fields().filter_map(of).collect()
}

/// The same as [`snapshot`], with the cells marked where the body intersects itself: cell data `intersecting`, left out where it does not.
pub(crate) fn inspected(
    member: CaseMember<'_>,
    fields: &StateFields<'_>,
    found: Option<&Inspection>,
) -> Result<Snapshot, ControlError> {
    let shot = snapshot(member, fields)?;
    match found.and_then(|found| found.intersecting(member.mesh().cells())) {
        Some(marks) => Ok(shot.with_cells("intersecting", 1, marks)?),
        None => Ok(shot),
    }
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
