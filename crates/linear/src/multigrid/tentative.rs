//! The tentative prolongator: near-kernel modes, cut up by aggregates and made orthonormal on each.

use super::aggregation::Aggregates;
use super::chunks::{self, CHUNK};
use nastic_numeric::vector::norm;

/// Share of a mode after orthogonalisation below which it is dependent on its aggregate.
const DEPENDENCE_TOLERANCE: f64 = 1e-6;

/// Interpolation from the next level, one block per node, with what that level inherits.
pub(super) struct Tentative {
    /// The block of every member of an aggregate, row by row, in the order of [`Aggregates::members`].
    pub blocks: Vec<f64>,
    /// The modes on the next level: `count x count` values per aggregate, column by column.
    pub modes: Vec<f64>,
    /// Unknowns of the next level without a mode of their aggregate (which has too few nodes).
    pub idle: Vec<bool>,
}

/// `T R = modes` with orthonormal columns of T on each aggregate; `modes` has `dim x count` values per node, column by column.
pub(super) fn tentative(aggregates: &Aggregates, modes: &[f64], dim: usize, count: usize, parallel: bool) -> Tentative {
    let members = &aggregates.members;
    let mut blocks = vec![0.0; dim * count * members.columns.len()];
    let mut out = vec![0.0; aggregates.count() * count * count];
    let mut idle = vec![false; aggregates.count() * count];
    let of_aggregates = chunks::rows(&mut out, count * count).zip(chunks::rows(&mut idle, count));
    let parts = members.cut(&mut blocks, dim * count).into_iter().zip(of_aggregates).collect();
    chunks::each(parts, parallel, |k, (mut blocks, (out, idle)): (&mut [f64], (&mut [f64], &mut [bool]))| {
        let mut columns = vec![Vec::new(); count];
        let of_one = out.chunks_exact_mut(count * count).zip(idle.chunks_exact_mut(count));
        for (a, (triangle, idle)) in of_one.enumerate() {
            let nodes = &members.columns[members.row(CHUNK * k + a)];
            for (m, column) in columns.iter_mut().enumerate() {
                column.clear();
                nodes
                    .iter()
                    .for_each(|&node| column.extend_from_slice(&modes[dim * (count * node as usize + m)..][..dim]));
            }
            orthonormalise(&mut columns, triangle, idle);
            let (own, rest) = std::mem::take(&mut blocks).split_at_mut(dim * count * nodes.len());
            blocks = rest;
            own.iter_mut().enumerate().for_each(|(at, value)| *value = columns[at % count][at / count]);
        }
    });
    Tentative { blocks, modes: out, idle }
}

/// Gram and Schmidt, twice over; `triangle` (column by column) receives the coefficients.
fn orthonormalise(columns: &mut [Vec<f64>], triangle: &mut [f64], idle: &mut [bool]) {
    let count = columns.len();
    for m in 0..count {
        let (done, rest) = columns.split_at_mut(m);
        let column = &mut rest[0];
        let whole = norm(column);
        for _ in 0..2 {
            for (k, other) in done.iter().enumerate() {
                let share: f64 = other.iter().zip(column.iter()).map(|(a, b)| a * b).sum();
                column.iter_mut().zip(other).for_each(|(value, other)| *value -= share * other);
                triangle[count * m + k] += share;
            }
        }
        let length = norm(column);
        if length > DEPENDENCE_TOLERANCE * whole {
            column.iter_mut().for_each(|value| *value /= length);
            triangle[count * m + m] = length;
        } else {
            column.fill(0.0);
            idle[m] = true;
        }
    }
}
