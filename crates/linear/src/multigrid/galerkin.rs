//! The matrix of the next level, `P^T A P`.
//!
//! `A P` is made for a slab of rows at a time, in parallel, and its contributions are taken up at once, again in parallel:
//! row I of the product adds up `P_iI^T (A P)_iJ` over i ascending. So nothing large is held beside the product, and the
//! sums have the same order for any number of threads.

use std::sync::Arc;

use pulp::{Arch, Simd, WithSimd};

use super::chunks::{self, CHUNK};
use super::couplings::{BlockRows, Couplings, Symmetric};
use super::transfer::{Transfer, with_shape};

/// Chunks of one slab: enough for all threads, few enough for a cache.
const CHUNKS_PER_SLAB: usize = 16;
/// Rows of the product that one task forms.
const ROWS_PER_TASK: usize = 8;
/// No position among the columns of a row.
const NO_POSITION: u32 = u32::MAX;

/// The couplings of `P^T A P`.
pub(super) fn couplings(fine: &Couplings, transfer: &Transfer, parallel: bool) -> Arc<Couplings> {
    let rows = BlockRows::collect(
        transfer.rows.block_columns,
        transfer.rows.block_columns,
        parallel,
        || (vec![NO_POSITION; fine.rows.rows()], vec![NO_POSITION; transfer.rows.block_columns], Vec::new()),
        |(seen_fine, seen, reached): &mut (Vec<u32>, Vec<u32>, Vec<u32>), row, out| {
            let mark = row as u32;
            reached.clear();
            for &(i, _) in transfer.column(row) {
                for &j in &fine.rows.columns[fine.rows.row(i as usize)] {
                    if std::mem::replace(&mut seen_fine[j as usize], mark) != mark {
                        reached.push(j);
                    }
                }
            }
            // a node that nothing leads to stays, alone
            seen[row] = mark;
            out.push(mark);
            for &j in &*reached {
                for &column in &transfer.rows.columns[transfer.rows.row(j as usize)] {
                    if std::mem::replace(&mut seen[column as usize], mark) != mark {
                        out.push(column);
                    }
                }
            }
        },
    );
    Couplings::of_lower(transfer.shape.1, rows, parallel)
}

/// The stored values of `P^T A P` on its couplings; the diagonal entries of unknowns marked `idle`, whose rows and columns
/// are zero, become the mean of A's diagonal.
pub(super) fn product(
    fine: &Symmetric,
    transfer: &Transfer,
    coarse: &Couplings,
    idle: &[bool],
    parallel: bool,
) -> Vec<f64> {
    let mut values = vec![0.0; coarse.size.pow(2) * coarse.stored.last().copied().unwrap_or(0)];
    with_shape!(transfer.shape, product_of_blocks(fine, transfer, coarse, &mut values, parallel));
    let (n, diagonal) = (coarse.size, fine.mean_diagonal(parallel));
    for i in 0..coarse.rows.rows() {
        let at = n * n * (coarse.stored[i + 1] - 1);
        let block = &mut values[at..at + n * n];
        for r in 0..n {
            for c in 0..r {
                let mean = 0.5 * (block[n * r + c] + block[n * c + r]);
                (block[n * r + c], block[n * c + r]) = (mean, mean);
            }
            if idle[n * i + r] {
                block[(n + 1) * r] = diagonal;
            }
        }
    }
    values
}

fn product_of_blocks<const R: usize, const C: usize, const W: usize>(
    fine: &Symmetric,
    transfer: &Transfer,
    coarse: &Couplings,
    values: &mut [f64],
    parallel: bool,
) {
    let rows = fine.couplings.rows.rows();
    let mut targets = targets::<C>(coarse, values);
    let mut moved: Vec<Moved<R, W>> = (0..CHUNKS_PER_SLAB).map(|_| Moved::default()).collect();
    let nowhere = || vec![NO_POSITION; coarse.rows.rows()];
    for first in (0..rows).step_by(CHUNKS_PER_SLAB * CHUNK) {
        let last = (first + CHUNKS_PER_SLAB * CHUNK).min(rows);
        chunks::each_with(moved.iter_mut().collect(), parallel, nowhere, |place, k, moved| {
            let chunk = first + CHUNK * k..(first + CHUNK * (k + 1)).min(last);
            Arch::new().dispatch(Multiply::<R, C, W> { fine, transfer, rows: chunk, place, moved });
        });
        chunks::each_with(targets.iter_mut().collect(), parallel, nowhere, |place, _, target| {
            for (row, target) in target.iter_mut() {
                let column = transfer.column(*row);
                let done = target.done;
                let count = column[done..].partition_point(|&(i, _)| (i as usize) < last);
                if count > 0 {
                    target.done += count;
                    let (terms, sums) = (&column[done..done + count], &mut *target.sums);
                    let row = (*row, coarse, place.as_mut_slice());
                    Arch::new().dispatch(TakeUp {
                        row,
                        blocks: transfer.blocks::<R, C>(),
                        terms,
                        first,
                        moved: &moved,
                        sums,
                    });
                }
            }
        });
    }
}

/// The stored blocks of one row of the product, and how many of its terms are in them.
struct Target<'v, const C: usize> {
    done: usize,
    sums: &'v mut [[[f64; C]; C]],
}

/// The rows of the product, a few to a task.
#[allow(clippy::type_complexity)] // chunks of numbered rows
fn targets<'v, const C: usize>(coarse: &Couplings, values: &'v mut [f64]) -> Vec<Vec<(usize, Target<'v, C>)>> {
    let (mut rest, _) = values.as_chunks_mut::<C>().0.as_chunks_mut::<C>();
    let mut of_row = |row: usize| {
        let (sums, others) = std::mem::take(&mut rest).split_at_mut(coarse.stored[row + 1] - coarse.stored[row]);
        rest = others;
        (row, Target { done: 0, sums })
    };
    let rows = coarse.rows.rows();
    (0..rows)
        .step_by(ROWS_PER_TASK)
        .map(|first| (first..(first + ROWS_PER_TASK).min(rows)).map(&mut of_row).collect())
        .collect()
}

/// `A P` in a chunk of rows; rows of blocks are padded to W numbers, a register of the widest instructions.
struct Moved<const R: usize, const W: usize> {
    ends: Vec<usize>,
    columns: Vec<u32>,
    blocks: Vec<[[f64; W]; R]>,
}

impl<const R: usize, const W: usize> Default for Moved<R, W> {
    fn default() -> Self {
        Moved { ends: Vec::new(), columns: Vec::new(), blocks: Vec::new() }
    }
}

struct Multiply<'a, const R: usize, const C: usize, const W: usize> {
    fine: &'a Symmetric<'a>,
    transfer: &'a Transfer,
    rows: std::ops::Range<usize>,
    place: &'a mut Vec<u32>,
    moved: &'a mut Moved<R, W>,
}

impl<const R: usize, const C: usize, const W: usize> WithSimd for Multiply<'_, R, C, W> {
    type Output = ();

    /// Gustavson, ACM TOMS 4 (1978): rows of P are added up, scaled by the entries of a row of A.
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Multiply { fine, transfer, rows, place, moved } = self;
        let (all, blocks) = (&fine.couplings.rows, transfer.blocks::<R, C>());
        moved.ends.clear();
        moved.columns.clear();
        moved.blocks.clear();
        let mut row = Vec::new();
        for i in rows {
            let first = moved.columns.len();
            // the blocks of a row stand apart in memory: fetched together, they do not wait for each other
            row.clear();
            row.extend(fine.couplings.codes[all.row(i)].iter().map(|&code| fine.block::<R>(code)));
            for (a, &j) in row.iter().zip(&all.columns[all.row(i)]) {
                let of_p = transfer.rows.row(j as usize);
                for (block, &column) in blocks[of_p.clone()].iter().zip(&transfer.rows.columns[of_p]) {
                    let at = &mut place[column as usize];
                    if *at == NO_POSITION {
                        *at = (moved.columns.len() - first) as u32;
                        moved.columns.push(column);
                        moved.blocks.push([[0.0; W]; R]);
                    }
                    let sum = &mut moved.blocks[first + *at as usize];
                    add_product(a, block, sum);
                }
            }
            moved.columns[first..].iter().for_each(|&column| place[column as usize] = NO_POSITION);
            moved.ends.push(moved.columns.len());
        }
    }
}

struct TakeUp<'a, const R: usize, const C: usize, const W: usize> {
    row: (usize, &'a Couplings, &'a mut [u32]),
    blocks: &'a [[[f32; C]; R]],
    terms: &'a [(u32, u32)],
    /// First row of the slab.
    first: usize,
    moved: &'a [Moved<R, W>],
    sums: &'a mut [[[f64; C]; C]],
}

impl<const R: usize, const C: usize, const W: usize> WithSimd for TakeUp<'_, R, C, W> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let (row, coarse, place) = self.row;
        let own = coarse.rows.row(row);
        let columns = &coarse.rows.columns[own][..self.sums.len()];
        columns.iter().enumerate().for_each(|(at, &column)| place[column as usize] = at as u32);
        for &(i, k) in self.terms {
            let p = &self.blocks[k as usize];
            let local = i as usize - self.first;
            let (moved, local) = (&self.moved[local / CHUNK], local % CHUNK);
            let range = if local == 0 { 0 } else { moved.ends[local - 1] }..moved.ends[local];
            for (term, &column) in moved.blocks[range.clone()].iter().zip(&moved.columns[range]) {
                if column as usize > row {
                    continue;
                }
                add_transposed_product(p, term, &mut self.sums[place[column as usize] as usize]);
            }
        }
        columns.iter().for_each(|&column| place[column as usize] = NO_POSITION);
    }
}

/// `sum += a b`, rows of the sum padded to W numbers.
#[inline(always)]
fn add_product<const R: usize, const C: usize, const W: usize>(
    a: &[[f64; R]; R],
    b: &[[f32; C]; R],
    sum: &mut [[f64; W]; R],
) {
    let mut wide = [[0.0; W]; R];
    for k in 0..R {
        for c in 0..C {
            wide[k][c] = f64::from(b[k][c]);
        }
    }
    for r in 0..R {
        let mut row = sum[r];
        for k in 0..R {
            for c in 0..W {
                row[c] += a[r][k] * wide[k][c];
            }
        }
        sum[r] = row;
    }
}

/// `sum += a^T b`, rows of b padded.
#[inline(always)]
fn add_transposed_product<const R: usize, const C: usize, const W: usize>(
    a: &[[f32; C]; R],
    b: &[[f64; W]; R],
    sum: &mut [[f64; C]; C],
) {
    for i in 0..C {
        let mut row = [0.0; W];
        for r in 0..R {
            let factor = f64::from(a[r][i]);
            for j in 0..W {
                row[j] += factor * b[r][j];
            }
        }
        (0..C).for_each(|j| sum[i][j] += row[j]);
    }
}
