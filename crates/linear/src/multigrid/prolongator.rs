//! Smoothed prolongators, `P = (1 - omega D^-1 A) T`.

use pulp::{Arch, Simd, WithSimd};

use super::aggregation::{Aggregates, NO_AGGREGATE};
use super::block_matrix::BlockMatrix;
use super::chunks::{self, CHUNK};
use super::couplings::{BlockRows, Couplings};
use super::smoother::Smoother;
use super::tentative::Tentative;
use super::transfer::{Transfer, with_shape};

/// `omega = DAMPING / bound`.
const DAMPING: f64 = 4.0 / 3.0;
/// No position among the columns of a row, or among members.
const NO_POSITION: u32 = u32::MAX;

/// Where P has blocks: every node with the aggregates of all it is coupled with.
pub(super) fn rows(couplings: &Couplings, aggregates: &Aggregates, parallel: bool) -> BlockRows {
    let size = (couplings.rows.rows(), aggregates.count());
    BlockRows::collect(
        size.0,
        size.1,
        parallel,
        || (),
        |(), i, out| {
            let first = out.len();
            for &j in &couplings.rows.columns[couplings.rows.row(i)] {
                let aggregate = aggregates.of_node[j as usize];
                if aggregate != NO_AGGREGATE && !out[first..].contains(&aggregate) {
                    out.push(aggregate);
                }
            }
        },
    )
}

/// Sets the values of P, which are rounded as those of the matrix are.
pub(super) fn smooth(
    matrix: &BlockMatrix,
    smoother: &Smoother,
    aggregates: &Aggregates,
    tentative: &Tentative,
    transfer: &mut Transfer,
    parallel: bool,
) {
    let mut slots = vec![NO_POSITION; aggregates.of_node.len()];
    aggregates.members.columns.iter().enumerate().for_each(|(slot, &node)| slots[node as usize] = slot as u32);
    transfer.values.resize(transfer.shape.0 * transfer.shape.1 * transfer.rows.columns.len(), 0.0);
    let work = Smooth { matrix, smoother, of_node: &aggregates.of_node, slots: &slots, blocks: &tentative.blocks };
    with_shape!(transfer.shape, work.all(transfer, parallel));
}

struct Smooth<'a> {
    matrix: &'a BlockMatrix,
    smoother: &'a Smoother,
    of_node: &'a [u32],
    /// Place of a node's block among those of the tentative prolongator.
    slots: &'a [u32],
    blocks: &'a [f64],
}

impl Smooth<'_> {
    fn all<const R: usize, const C: usize, const W: usize>(&self, transfer: &mut Transfer, parallel: bool) {
        let rows = &transfer.rows;
        let parts = rows.cut(&mut transfer.values, R * C);
        let nowhere = || vec![NO_POSITION; rows.block_columns];
        chunks::each_with(parts, parallel, nowhere, |place, k, values| {
            Arch::new().dispatch(Chunk::<R, C, W> { of: self, rows, first: CHUNK * k, values, place });
        });
    }
}

struct Chunk<'a, const R: usize, const C: usize, const W: usize> {
    of: &'a Smooth<'a>,
    rows: &'a BlockRows,
    first: usize,
    values: &'a mut [f32],
    place: &'a mut [u32],
}

impl<const R: usize, const C: usize, const W: usize> WithSimd for Chunk<'_, R, C, W> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Chunk { of, rows, first, values, place } = self;
        let (couplings, omega) = (&*of.matrix.couplings, DAMPING / of.smoother.bound);
        let (tentative, _) = of.blocks.as_chunks::<C>().0.as_chunks::<R>();
        let (mut values, _) = values.as_chunks_mut::<C>().0.as_chunks_mut::<R>();
        let mut sums: Vec<[[f64; W]; R]> = Vec::new();
        let last = (first + CHUNK).min(couplings.rows.rows());
        for i in first..last {
            let columns = &rows.columns[rows.row(i)];
            columns.iter().enumerate().for_each(|(at, &column)| place[column as usize] = at as u32);
            sums.clear();
            sums.resize(columns.len(), [[0.0; W]; R]);
            for at in couplings.rows.row(i) {
                let j = couplings.rows.columns[at] as usize;
                if of.slots[j] == NO_POSITION {
                    continue;
                }
                let (a, t) = (of.matrix.block::<R>(at), &tentative[of.slots[j] as usize]);
                add_product(a, t, &mut sums[place[of.of_node[j] as usize] as usize]);
            }
            let inverse = of.smoother.inverse_block::<R>(i);
            let (own, rest) = std::mem::take(&mut values).split_at_mut(columns.len());
            values = rest;
            for ((out, sum), &column) in own.iter_mut().zip(&sums).zip(columns) {
                let mut block = [[0.0; C]; R];
                if of.of_node[i] == column {
                    block = tentative[of.slots[i] as usize];
                }
                for r in 0..R {
                    for k in 0..R {
                        let factor = omega * f64::from(inverse[k][r]);
                        (0..C).for_each(|c| block[r][c] -= factor * sum[k][c]);
                    }
                    (0..C).for_each(|c| out[r][c] = block[r][c] as f32);
                }
            }
        }
    }
}

/// `sum += a t` with a stored column by column, rows of the sum padded to W numbers.
#[inline(always)]
fn add_product<const R: usize, const C: usize, const W: usize>(
    a: &[[f32; R]],
    t: &[[f64; C]; R],
    sum: &mut [[f64; W]; R],
) {
    let mut wide = [[0.0; W]; R];
    for k in 0..R {
        wide[k][..C].copy_from_slice(&t[k]);
    }
    for r in 0..R {
        let mut row = sum[r];
        for k in 0..R {
            let factor = f64::from(a[k][r]);
            for c in 0..W {
                row[c] += factor * wide[k][c];
            }
        }
        sum[r] = row;
    }
}
