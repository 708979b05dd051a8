//! States as snapshots: everything a viewer may want to see.

use crate::lower::{CaseMember, TargetShape};
use nastic_control::{ControlBlock, Space};
use nastic_fem::State;
use nastic_mesh::{Mesh, MeshError, Snapshot};

/// A state, and what is known of it.
#[derive(Clone, Copy)]
pub(crate) struct View<'a> {
    pub state: &'a State,
    /// The member's own control vector.
    pub m: &'a [f64],
    /// Adjoint displacement, flat.
    pub adjoint: Option<&'a [f64]>,
    /// Gradient of the cost by its control vector.
    pub gradient: Option<&'a [f64]>,
}

/// Names of result arrays that no control may take.
pub(crate) const RESERVED: [&str; 10] =
    ["displacement", "adjoint", "J", "P", "cauchy_stress", "energy", "fiber", "B_r", "B_a", "region"];

/// The snapshot of a state: point data displacement, adjoint, nodal controls and their gradients; cell data the other
/// controls and gradients, J, stresses, energy and directions, averaged over each cell's reference volume.
pub(crate) fn snapshot(member: CaseMember<'_>, view: &View<'_>) -> Result<Snapshot, MeshError> {
    let (mesh, dim) = (member.mesh(), member.mesh().dim());
    let mut out = Snapshot::new(mesh.clone()).with_points("displacement", 3, padded(&view.state.u, dim))?;
    if let Some(adjoint) = view.adjoint {
        out = out.with_points("adjoint", 3, padded(adjoint, dim))?;
    }
    for (block, field) in member.fields() {
        out = with_field(out, member, block, &field.array, view.m)?;
        if let Some(gradient) = view.gradient {
            out = with_field(out, member, block, &format!("gradient_{}", field.array), gradient)?;
        }
    }
    out = with_fixed(out, member, view.state)?;
    with_state(out, member, view.state)
}

/// A control field, or its gradient.
fn with_field(
    out: Snapshot,
    member: CaseMember<'_>,
    block: &ControlBlock,
    name: &str,
    m: &[f64],
) -> Result<Snapshot, MeshError> {
    let (n, values) = (block.components, block.of(m));
    match block.map.space() {
        Space::Node => {
            let cells = &member.solid().body().actuations()[block.actuation].cells;
            out.with_points(name, n, nodal(member.mesh(), cells, block, values))
        }
        _ => out.with_cells(name, n, by_cell(member, block, values)),
    }
}

/// A nodal field on all nodes of the mesh, linear between corners; zero where it does not act.
fn nodal(mesh: &Mesh, cells: &[u32], block: &ControlBlock, values: &[f64]) -> Vec<f64> {
    let n = block.components;
    let mut out = vec![0.0; mesh.points().len() * n];
    let unknown = |node: u32| block.map.entities().binary_search(&node).ok();
    for &id in cells {
        let cell = mesh.cell(id as usize);
        let corners = cell.kind.corners();
        let mut shapes = vec![0.0; corners];
        for (a, &node) in cell.nodes.iter().enumerate().skip(corners) {
            cell.kind.corner_kind().shapes(&cell.kind.reference_nodes()[a], &mut shapes);
            for c in 0..n {
                let terms = cell.nodes.iter().zip(&shapes);
                out[node as usize * n + c] =
                    terms.filter_map(|(&corner, shape)| Some(shape * values[unknown(corner)? * n + c])).sum();
            }
        }
    }
    for (k, &node) in block.map.entities().iter().enumerate() {
        out[node as usize * n..][..n].copy_from_slice(&values[k * n..][..n]);
    }
    out
}

/// A field that is constant in each cell; zero where it does not act.
fn by_cell(member: CaseMember<'_>, block: &ControlBlock, values: &[f64]) -> Vec<f64> {
    let n = block.components;
    let mut out = vec![0.0; member.mesh().cells() * n];
    for (cell, (first, _)) in member.solid().discretization().points_of_cells().into_iter().enumerate() {
        if let Some((unknown, _)) = block.map.at_point(first).next() {
            out[cell * n..][..n].copy_from_slice(&values[unknown * n..][..n]);
        }
    }
    out
}

/// Slots nobody controls, and the fields of magnets.
fn with_fixed(mut out: Snapshot, member: CaseMember<'_>, state: &State) -> Result<Snapshot, MeshError> {
    let disc = member.solid().discretization();
    let cells = member.mesh().cells();
    let (mut remanence, mut field) = (None::<Vec<f64>>, None::<Vec<f64>>);
    for (k, attached) in member.solid().body().actuations().iter().enumerate() {
        let slots = attached.law.slots();
        let means = disc.cell_average(state.controls.values(k), slots.len());
        let columns = |first: usize, n: usize| -> Vec<f64> {
            (0..cells).flat_map(|cell| means[cell * slots.len() + first..][..n].to_vec()).collect()
        };
        let controlled = member.layout().blocks().iter().any(|block| block.actuation == k);
        if slots.len() == 1 && !controlled {
            out = out.with_cells(&attached.name, 1, columns(0, 1))?;
        }
        for (stem, total) in [("remanence", &mut remanence), ("field", &mut field)] {
            if let Some(first) = slots.iter().position(|slot| slot.name == format!("{stem}.x")) {
                let own = columns(first, 3);
                let total = total.get_or_insert_with(|| vec![0.0; own.len()]);
                total.iter_mut().zip(own).for_each(|(t, o)| *t += o);
            }
        }
    }
    for (name, total) in [("B_r", remanence), ("B_a", field)] {
        if let Some(total) = total {
            out = out.with_cells(name, 3, total)?;
        }
    }
    Ok(out)
}

/// What follows from the state alone; a state with an inverted cell has no such thing.
fn with_state(mut out: Snapshot, member: CaseMember<'_>, state: &State) -> Result<Snapshot, MeshError> {
    let Ok(fields) = member.solid().cell_fields(state) else { return Ok(out) };
    out = out.with_cells("J", 1, fields.j)?.with_cells("P", 9, fields.piola)?;
    out = out.with_cells("cauchy_stress", 9, fields.cauchy)?.with_cells("energy", 1, fields.energy)?;
    for (name, direction) in fields.directions {
        out = out.with_cells(&format!("direction_{name}"), 3, direction)?;
    }
    match fields.fiber {
        Some(fiber) => out.with_cells("fiber", 3, fiber),
        None => Ok(out),
    }
}

/// A target as it is shown: its mesh, or the body moved to where it is wanted.
pub(crate) fn target(shape: &TargetShape) -> Result<Snapshot, MeshError> {
    let out = Snapshot::new(shape.mesh.clone());
    if shape.displacement.is_empty() {
        return Ok(out);
    }
    let values = shape.displacement.iter().flat_map(|(u, _)| *u).collect();
    let flags = shape.displacement.iter().map(|(_, matters)| f64::from(*matters)).collect();
    out.with_points("displacement", 3, values)?.with_points("tracked", 1, flags)
}

/// Three components per node.
fn padded(u: &[f64], dim: usize) -> Vec<f64> {
    u.chunks_exact(dim).flat_map(|u| std::array::from_fn::<f64, 3, _>(|k| u.get(k).copied().unwrap_or(0.0))).collect()
}
