//! The files of a new case.

use crate::cut::names_within;
use crate::error::RemeshError;
use crate::new_case::{CASE, CONTROLS, FIELDS, FieldSource, NewCase};
use crate::optimum::Optimum;
use crate::transfer::Transfer;
use nastic_io::write_atomically;
use nastic_mesh::{Mesh, Snapshot};
use nastic_result::controls::control_values;
use serde::Serialize;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Writes the case and the files that it names.
pub(crate) fn write_case(optimum: &Optimum, case: &NewCase, new: &Arc<Mesh>, out: &Path) -> Result<(), RemeshError> {
    let problem = &optimum.problem;
    let old = problem.mesh();
    if !case.fields.is_empty() {
        let transfer = Transfer::new(old, new.clone());
        let mut snapshot = Snapshot::new(new.clone());
        for (name, field) in &case.fields {
            snapshot = match field {
                FieldSource::Control { values, components, by_node: true } => {
                    snapshot.with_points(name, *components, transfer.nodes(values, *components)?)?
                }
                FieldSource::Control { values, components, .. } => {
                    snapshot.with_cells(name, *components, transfer.cells(values, *components)?)?
                }
                FieldSource::File { file, array } => {
                    let read = nastic_io::read_snapshot(file)?;
                    match (read.point_array(array), read.cell_array(array)) {
                        (Some(own), _) => {
                            snapshot.with_points(name, own.components, transfer.nodes(&own.values, own.components)?)?
                        }
                        (_, Some(own)) => {
                            snapshot.with_cells(name, own.components, transfer.cells(&own.values, own.components)?)?
                        }
                        // complained about when the case was read
                        _ => snapshot,
                    }
                }
            };
        }
        nastic_io::write_vtu(out.join(FIELDS), &snapshot)?;
    }
    let mut names = BTreeSet::new();
    names_within(&case.json, &mut names);
    if names.contains(CONTROLS) {
        write_json(out.join(CONTROLS), &control_values(problem, &problem.start))?;
    }
    write_json(out.join(CASE), &case.json)
}

pub(crate) fn write_json(file: PathBuf, value: &impl Serialize) -> Result<(), RemeshError> {
    let text = serde_json::to_string_pretty(value).unwrap_or_default() + "\n";
    Ok(write_atomically(file, |out| out.write_all(text.as_bytes()))?)
}
