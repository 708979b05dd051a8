//! States as snapshots, under the names the case gives its controls.

use crate::lower::{CaseMember, TargetShape};
use nastic_control::{ControlError, StateFields};
use nastic_mesh::Snapshot;

/// Names of result arrays that no control may take.
pub(crate) const RESERVED: [&str; 10] =
    ["displacement", "adjoint", "J", "P", "cauchy_stress", "energy", "fiber", "B_r", "B_a", "region"];

/// The snapshot of a state: [`nastic_control::Reduced::snapshot_of`] with the case's names.
pub(crate) fn snapshot(member: CaseMember<'_>, fields: &StateFields<'_>) -> Result<Snapshot, ControlError> {
    let names: Vec<&str> = member.fields().map(|(_, field)| field.array.as_str()).collect();
    member.reduced().snapshot_of(&StateFields { names: &names, ..*fields })
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
