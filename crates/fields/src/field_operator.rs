//! Mass and stiffness of the basis functions of control fields.

use crate::error::ControlError;
use crate::grid::Corner;
use crate::map::{Basis, Space};
use crate::over_ranks::gathered;
use nastic_fem::Discretization;
use nastic_linear::{Factor, Graph, Ordering, Pattern, Pivots, SparseMatrix, Symbolic};
use std::sync::Arc;

/// Whether this rank counts a field in sums over ranks: fields over a body at the points of each, what is a contribution's own on the first alone, as all have it.
pub(crate) fn is_counted(disc: &Discretization, basis: &Basis) -> bool {
    !basis.is_of_contribution() || disc.over_ranks().is_none_or(|(_, share)| share.team().leads())
}

/// The consistent mass times m for one component: `int phi_i m dX`; over ranks the share of this one.
pub fn mass_product(disc: &Discretization, basis: &Basis, m: &[f64]) -> Vec<f64> {
    let mut out = vec![0.0; basis.len()];
    if !is_counted(disc, basis) {
        return out;
    }
    for (q, w) in basis.weights(disc).iter().enumerate() {
        let value: f64 = basis.at_point(q).map(|(i, shape)| shape * m[i]).sum();
        basis.at_point(q).for_each(|(i, shape)| out[i] += w * shape * value);
    }
    out
}

/// The stiffness times m for one component: `int grad phi_i . grad m dX`, or its analogue over faces; over ranks the share of this one.
pub fn stiffness_product(disc: &Discretization, basis: &Basis, m: &[f64]) -> Vec<f64> {
    let mut out = vec![0.0; basis.len()];
    if !is_counted(disc, basis) {
        return out;
    }
    for_each_stiffness(disc, basis, |unknowns, local| {
        let n = unknowns.len();
        for (a, &i) in unknowns.iter().enumerate() {
            let row = &local[a * n..(a + 1) * n];
            out[i as usize] += row.iter().zip(unknowns).map(|(k, &j)| k * m[j as usize]).sum::<f64>();
        }
    });
    out
}

/// Calls back with the unknowns and the dense stiffness of every cell (nodal fields), part of a cell in one grid cell (fields
/// on a grid) or inner face (cell fields).
fn for_each_stiffness(disc: &Discretization, basis: &Basis, mut each: impl FnMut(&[u32], &[f64])) {
    match basis.space() {
        Space::Uniform | Space::Region | Space::Point => {}
        Space::Cell => for_each_face(disc, basis, |pair, area, distance| {
            let k = area / distance;
            each(&pair, &[k, -k, -k, k]);
        }),
        Space::Node | Space::Grid(_) => {
            let gradients = basis.gradients(disc);
            let mut first = 0;
            let same = |a: &Vec<Corner>, b: &Vec<Corner>| a.iter().map(|(i, ..)| i).eq(b.iter().map(|(i, ..)| i));
            for points in gradients.chunk_by(same) {
                let unknowns: Vec<u32> = points[0].iter().map(|(i, ..)| *i).collect();
                let n = unknowns.len();
                let mut local = vec![0.0; n * n];
                for (basis, w) in points.iter().zip(&basis.weights(disc)[first..]) {
                    for (a, (_, _, left)) in basis.iter().enumerate() {
                        for (b, (_, _, right)) in basis.iter().enumerate() {
                            local[a * n + b] += w * (0..3).map(|j| left[j] * right[j]).sum::<f64>();
                        }
                    }
                }
                first += points.len();
                if n > 0 {
                    each(&unknowns, &local);
                }
            }
        }
    }
}

/// The unknowns on both sides of every inner face of the cells that a control acts on, its area, and the distance of the unknowns' places.
pub(crate) fn for_each_face(disc: &Discretization, basis: &Basis, mut each: impl FnMut([u32; 2], f64, f64)) {
    let mesh = disc.mesh();
    let unknown = |first: usize| basis.at_point(first).next().map_or(u32::MAX, |(i, _)| i as u32);
    let unknown_of: Vec<u32> = disc.points_of_cells().into_iter().map(|(first, _)| unknown(first)).collect();
    for &(here, there) in mesh.neighbours() {
        let (a, b) = (unknown_of[here.cell as usize], unknown_of[there.cell as usize]);
        if a == u32::MAX || b == u32::MAX {
            continue;
        }
        each([a, b], mesh.area(&[here]), distance(basis, [a, b]));
    }
    // faces to cells that other ranks have; a field that is constant in regions does not know whose they are
    let outer =
        disc.over_ranks().filter(|_| basis.space() == Space::Cell).map_or(&[][..], |(part, _)| part.outer_faces());
    for (here, there) in outer {
        let (a, b) = (unknown_of[here.cell as usize], basis.entities().binary_search(there));
        if let (false, Ok(b)) = (a == u32::MAX, b) {
            each([a, b as u32], mesh.area(&[*here]), distance(basis, [a, b as u32]));
        }
    }
}

/// The distance of the places of two unknowns.
fn distance(basis: &Basis, [a, b]: [u32; 2]) -> f64 {
    let (x, y) = (basis.positions()[a as usize], basis.positions()[b as usize]);
    (0..3).map(|k| (x[k] - y[k]).powi(2)).sum::<f64>().sqrt()
}

/// Unknowns and the dense stiffness of them.
pub(crate) type Piece = (Vec<u32>, Vec<f64>);

/// The pieces of [`for_each_stiffness`] of all ranks, in their order; `None` of a body that one process has.
pub(crate) fn pieces_of_all(disc: &Discretization, basis: &Basis) -> Result<Option<Vec<Piece>>, ControlError> {
    let Some((_, share)) = disc.over_ranks() else { return Ok(None) };
    // each behind its number of unknowns
    let mut told = Vec::new();
    if is_counted(disc, basis) {
        for_each_stiffness(disc, basis, |unknowns, local| {
            told.push(unknowns.len() as f64);
            told.extend(unknowns.iter().map(|unknown| f64::from(*unknown)));
            told.extend(local);
        });
    }
    let mut pieces = Vec::new();
    for of_rank in gathered(share, &told)? {
        let mut rest = &of_rank[..];
        while let Some((count, behind)) = rest.split_first() {
            let n = *count as usize;
            let (unknowns, behind) = behind.split_at(n.min(behind.len()));
            let (local, behind) = behind.split_at((n * n).min(behind.len()));
            pieces.push((unknowns.iter().map(|unknown| *unknown as u32).collect(), local.to_vec()));
            rest = behind;
        }
    }
    Ok(Some(pieces))
}

/// `M + factor S` of the basis functions of one field, M lumped, factorised.
#[derive(Debug)]
pub struct FieldOperator {
    /// Itself.
    pub matrix: SparseMatrix,
    /// Its Cholesky factor.
    pub factor: Factor,
}

impl FieldOperator {
    /// Of nodal fields, with `factor = length^2`, over a whole body; and the lumped masses `int phi_i dX`.
    ///
    /// # Errors
    /// A factor that does not fit.
    pub fn of_nodes(disc: &Discretization, basis: &Basis, length: f64) -> Result<(Vec<f64>, Self), ControlError> {
        let mut masses = vec![0.0; basis.len()];
        for (q, w) in basis.weights(disc).iter().enumerate() {
            basis.at_point(q).for_each(|(i, shape)| masses[i] += w * shape);
        }
        let operator = FieldOperator::new(disc, basis, None, &masses, length * length)?;
        Ok((masses, operator))
    }

    /// From the integrals of the basis functions; with the pieces of all ranks, where there are several.
    pub(crate) fn new(
        disc: &Discretization,
        basis: &Basis,
        gathered: Option<Vec<Piece>>,
        masses: &[f64],
        factor: f64,
    ) -> Result<Self, ControlError> {
        let fail = |what: String| ControlError::Cost { what };
        let for_each_piece = |each: &mut dyn FnMut(&[u32], &[f64])| match &gathered {
            None => for_each_stiffness(disc, basis, each),
            Some(pieces) => pieces.iter().for_each(|(unknowns, local)| each(unknowns, local)),
        };
        let mut cliques: Vec<Vec<u32>> = (0..basis.len() as u32).map(|i| vec![i]).collect();
        for_each_piece(&mut |unknowns, _| cliques.push(unknowns.to_vec()));
        let graph =
            Graph::from_cliques(basis.len(), cliques.iter().map(Vec::as_slice)).map_err(|e| fail(e.to_string()))?;
        let ordering = Ordering::best(&graph, basis.positions()).map_err(|e| fail(e.to_string()))?;
        let pattern = Arc::new(Pattern::new(&graph, 1, ordering).map_err(|e| fail(e.to_string()))?);
        let mut matrix = SparseMatrix::zeros(pattern.clone());
        let mut add = |i: usize, j: usize, value: f64| {
            if let Some(at) = pattern.value_index(i, j) {
                matrix.values[at] += value;
            }
        };
        masses.iter().enumerate().for_each(|(i, mass)| add(i, i, *mass));
        for_each_piece(&mut |unknowns, local| {
            let n = unknowns.len();
            for a in 0..n {
                for b in 0..=a {
                    add(unknowns[a] as usize, unknowns[b] as usize, factor * local[a * n + b]);
                }
            }
        });
        let symbolic = Arc::new(Symbolic::new(&pattern));
        let factor = symbolic.factorize(&matrix, Pivots::Positive, true).map_err(|e| fail(e.to_string()))?;
        Ok(FieldOperator { matrix, factor })
    }
}
