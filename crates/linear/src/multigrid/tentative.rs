//! The tentative prolongator: near-kernel modes, cut up by aggregates and made orthonormal on each.

use super::aggregation::ALONE;
use super::block_matrix::BlockMatrix;
use nastic_numeric::vector::norm;

/// A mode that keeps less than this share of its length after orthogonalisation adds nothing on its aggregate.
const DEPENDENT: f64 = 1e-6;

/// Interpolation from the next level, one block per node, with what that level inherits.
pub(super) struct Tentative {
    pub prolongator: BlockMatrix<f64>,
    /// The modes on the next level: `count x count` values per aggregate, column by column.
    pub modes: Vec<f64>,
    /// Unknowns of the next level that stand for no mode of their aggregate (too few nodes carry it).
    pub idle: Vec<bool>,
}

/// `T R = modes` with orthonormal columns of T on each aggregate; `modes` has `dim x count` values per node.
pub(super) fn tentative(of_node: &[u32], aggregates: usize, modes: &[f64], (dim, count): (usize, usize)) -> Tentative {
    let mut members = vec![Vec::new(); aggregates];
    for (node, &aggregate) in of_node.iter().enumerate().filter(|&(_, &aggregate)| aggregate != ALONE) {
        members[aggregate as usize].push(node);
    }
    let mut blocks = vec![0.0; modes.len()];
    let mut out = vec![0.0; aggregates * count * count];
    let mut idle = vec![false; aggregates * count];
    for (a, nodes) in members.iter().enumerate() {
        let of_mode = |m: usize| {
            let part = |&node: &usize| &modes[dim * (count * node + m)..][..dim];
            nodes.iter().flat_map(part).copied().collect::<Vec<f64>>()
        };
        let mut columns: Vec<Vec<f64>> = (0..count).map(of_mode).collect();
        let triangle = &mut out[count * count * a..count * count * (a + 1)];
        orthonormalise(&mut columns, triangle, &mut idle[count * a..count * (a + 1)]);
        for (m, column) in columns.iter().enumerate() {
            for (&node, part) in nodes.iter().zip(column.chunks_exact(dim)) {
                blocks[dim * (count * node + m)..][..dim].copy_from_slice(part);
            }
        }
    }
    let mut prolongator = BlockMatrix {
        shape: (dim, count),
        block_columns: aggregates,
        starts: vec![0],
        columns: Vec::with_capacity(of_node.len()),
        values: Vec::with_capacity(blocks.len()),
    };
    for (node, &aggregate) in of_node.iter().enumerate() {
        if aggregate != ALONE {
            prolongator.columns.push(aggregate);
            prolongator.values.extend_from_slice(&blocks[dim * count * node..dim * count * (node + 1)]);
        }
        prolongator.starts.push(prolongator.columns.len());
    }
    Tentative { prolongator, modes: out, idle }
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
        if length > DEPENDENT * whole {
            column.iter_mut().for_each(|value| *value /= length);
            triangle[count * m + m] = length;
        } else {
            column.fill(0.0);
            idle[m] = true;
        }
    }
}
