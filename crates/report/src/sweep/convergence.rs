//! How a figure converges over the meshes of a sweep: differences to the finest, observed orders.

use crate::record::{ConvergenceRecord, DiscretizationRecord, SweptRecord};
use crate::sweep::row::SweepRow;

/// Orders beyond are not those of elements: 1 beside the weakest corners, 2 p for energies with elements of order p.
const ORDERS: [f64; 2] = [0.25, 8.0];
/// Halvings of that range.
const HALVINGS: usize = 60;

/// A run on a mesh.
struct OnMesh<'r> {
    row: &'r SweepRow,
    size: &'r DiscretizationRecord,
    value: f64,
}

/// The convergence of a figure, where meshes are swept; for every combination of the other swept values the meshes from the coarsest to the finest.
pub(super) fn convergence(swept: &[SweptRecord], figure: &str, rows: &[SweepRow]) -> Option<Vec<ConvergenceRecord>> {
    swept.iter().find(|one| is_of_mesh(&one.path))?;
    let others = |row: &SweepRow| -> Vec<String> {
        row.values.iter().filter(|(path, _)| !is_of_mesh(path)).map(|(_, text)| text.clone()).collect()
    };
    let mut groups: Vec<Vec<String>> = Vec::new();
    rows.iter().map(others).for_each(|own| {
        if !groups.contains(&own) {
            groups.push(own)
        }
    });
    let of_group = |group: Vec<String>| {
        let own = rows.iter().filter(|row| row.is_done() && others(row) == group);
        let on_mesh = |row| Some(OnMesh { row, size: row.discretization.as_ref()?, value: row.number(figure)? });
        let mut meshes: Vec<OnMesh<'_>> = own.filter_map(on_mesh).collect();
        meshes.sort_by_key(|one| one.size.unknowns);
        records(figure, &meshes)
    };
    Some(groups.into_iter().flat_map(of_group).collect())
}

/// Whether a path of a case says what the mesh is.
fn is_of_mesh(path: &str) -> bool {
    path == "mesh" || path.starts_with("mesh/")
}

fn records(figure: &str, meshes: &[OnMesh<'_>]) -> Vec<ConvergenceRecord> {
    let Some(finest) = meshes.last().map(|last| last.value) else { return Vec::new() };
    let record = |(k, one): (usize, &OnMesh<'_>)| {
        let order = k.checked_sub(2).and_then(|first| order(&meshes[first..=k]));
        let difference = one.value - finest;
        ConvergenceRecord {
            run: one.row.directory.clone(),
            quantity: figure.to_owned(),
            cells: one.size.cells,
            unknowns: one.size.unknowns,
            value: one.value.into(),
            difference: difference.into(),
            relative_difference: (difference / finest.abs()).into(),
            order: order.into(),
        }
    };
    meshes.iter().enumerate().map(record).collect()
}

/// The p > 0 with
///
/// ```text
/// (q_1 - q_2) / (q_2 - q_3) = (h_1^p - h_2^p) / (h_2^p - h_3^p),   h = cells^(-1/dimensions)
/// ```
///
/// that the values q of three meshes show, from the coarsest to the finest: those of q + C h^p, Richardson's way with any ratios of sizes. None where the
/// values do not go one way, or the meshes do not become finer.
fn order(meshes: &[OnMesh<'_>]) -> Option<f64> {
    let [first, second, third] = meshes else { return None };
    let h = |one: &OnMesh<'_>| (one.size.cells as f64).powf(-1.0 / one.size.dimensions as f64);
    let h = [first, second, third].map(h);
    if !(h[0] > h[1] && h[1] > h[2]) {
        return None;
    }
    let wanted = (first.value - second.value) / (second.value - third.value);
    // in shares of the middle size, so that no power overflows; grows with p
    let [coarse, fine] = [h[0] / h[1], h[2] / h[1]];
    let excess = |p: f64| (coarse.powf(p) - 1.0) / (1.0 - fine.powf(p)) - wanted;
    let [mut low, mut high] = ORDERS;
    if !(excess(low) < 0.0 && excess(high) > 0.0) {
        return None;
    }
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if excess(middle) < 0.0 { low = middle } else { high = middle }
    }
    Some(0.5 * (low + high))
}
