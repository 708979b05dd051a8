//! Whether a body is beyond a limit point whatever its contacts do: its own tangent, with all nodes held that touch or may touch something, has
//! directions in which it falls.

use super::scene::Scene;
use crate::problem::Problem;
use nastic::prelude::*;
use std::collections::BTreeSet;

/// Unknowns of a dense tangent at most.
const MOST_UNKNOWNS: usize = 2000;

/// The number of negative pivots, or why it was not looked for.
pub fn falling_directions(problem: &Problem, state: &State) -> Result<usize, &'static str> {
    let scene = Scene::new(problem).ok_or("a region is not known")?;
    let facts = scene.facts();
    if facts.chamber.is_some() || !scene.rigid_nodes().is_empty() {
        return Err("pressures and rigid bodies are not looked at");
    }
    let pairs = facts.pairs.iter().flat_map(|(_, surfaces)| surfaces);
    let surfaces = facts.touching.iter().map(|touching| &touching.surface).chain(pairs).chain(&facts.held);
    let fixed: BTreeSet<usize> = surfaces.flat_map(|name| scene.nodes_of(name)).collect();
    let mut number = vec![None; scene.places.len()];
    (0..number.len()).filter(|node| !fixed.contains(node)).enumerate().for_each(|(k, node)| number[node] = Some(k));
    let (dim, free) = (scene.dim, number.iter().flatten().count());
    if dim * free > MOST_UNKNOWNS {
        return Err("too many unknowns for a dense tangent");
    }
    let u = scene.vectors(&problem.solid.model().displacement(&state.u));
    let mut matrix = vec![vec![0.0; dim * free]; dim * free];
    for (c, nodes) in scene.soft_cells() {
        let own: Vec<Vec3> = nodes.iter().map(|node| u[*node]).collect();
        let tangent = scene.cell(c).tangent(&own, scene.size());
        let row = |local: usize| number[nodes[local / dim]].map(|k| dim * k + local % dim);
        for (j, column) in tangent.iter().enumerate() {
            for (i, value) in column.iter().enumerate() {
                if let (Some(i), Some(j)) = (row(i), row(j)) {
                    matrix[i][j] += value;
                }
            }
        }
    }
    Ok(negative_pivots(matrix))
}

/// Of the factorisation `L D L^T` without exchanges: Sylvester's law of inertia.
fn negative_pivots(mut a: Vec<Vec<f64>>) -> usize {
    let n = a.len();
    let mut negative = 0;
    for k in 0..n {
        let row = a[k].clone();
        negative += usize::from(row[k] < 0.0);
        for other in a.iter_mut().skip(k + 1) {
            let factor = other[k] / row[k];
            if factor != 0.0 {
                (k..n).for_each(|j| other[j] -= factor * row[j]);
            }
        }
    }
    negative
}
