//! [`Couplings`]: which nodes of a level are coupled, and where the blocks of its matrix are stored.

use std::ops::Range;
use std::sync::Arc;

use super::chunks;
use crate::pattern::entries::Pattern;

/// Where blocks stand, by rows, columns ascending in every row.
#[derive(Debug, Default)]
pub(super) struct BlockRows {
    pub block_columns: usize,
    pub starts: Vec<usize>,
    pub columns: Vec<u32>,
}

impl BlockRows {
    /// From what a function appends for every row: its columns, in any order.
    pub fn collect<M>(
        rows: usize,
        block_columns: usize,
        parallel: bool,
        memory: impl Fn() -> M + Sync + Send,
        columns: impl Fn(&mut M, usize, &mut Vec<u32>) + Sync + Send,
    ) -> Self {
        let parts = chunks::map(rows, parallel, |range| {
            let (mut memory, mut ends, mut out) = (memory(), Vec::with_capacity(range.len()), Vec::new());
            for i in range {
                let first = out.len();
                columns(&mut memory, i, &mut out);
                out[first..].sort_unstable();
                ends.push(out.len());
            }
            (ends, out)
        });
        let total = parts.iter().map(|(_, columns)| columns.len()).sum();
        let mut all =
            BlockRows { block_columns, starts: Vec::with_capacity(rows + 1), columns: Vec::with_capacity(total) };
        all.starts.push(0);
        for (ends, columns) in parts {
            let before = all.columns.len();
            all.starts.extend(ends.iter().map(|end| before + end));
            all.columns.extend(columns);
        }
        all
    }

    /// Number of block rows.
    pub fn rows(&self) -> usize {
        self.starts.len() - 1
    }

    /// The blocks of block row `i`, as a range of `columns`.
    pub fn row(&self, i: usize) -> Range<usize> {
        self.starts[i]..self.starts[i + 1]
    }

    /// The number of block `(i, j)`.
    pub fn position(&self, i: usize, j: u32) -> Option<usize> {
        let row = self.row(i);
        self.columns[row.clone()].binary_search(&j).ok().map(|at| row.start + at)
    }

    /// Values, `size` per block, cut into those of a chunk of rows each.
    pub fn cut<'v, T>(&self, mut values: &'v mut [T], size: usize) -> Vec<&'v mut [T]> {
        let of_chunk = |first: usize| {
            let last = (first + chunks::CHUNK).min(self.rows());
            let (part, rest) =
                std::mem::take(&mut values).split_at_mut(size * (self.starts[last] - self.starts[first]));
            values = rest;
            part
        };
        (0..self.rows()).step_by(chunks::CHUNK).map(of_chunk).collect()
    }
}

/// The couplings of a symmetric matrix with `size x size` blocks of which one triangle is stored: both triangles by rows,
/// each block with the number of the stored one.
#[derive(Debug)]
pub(super) struct Couplings {
    /// Unknowns per node.
    pub size: usize,
    pub rows: BlockRows,
    /// By block: twice the number of the stored block, plus one where that is read transposed. Stored blocks stand column
    /// by column.
    pub codes: Vec<u32>,
    /// Stored blocks up to each row; of the finest level, whose blocks are stored otherwise, empty.
    pub stored: Vec<usize>,
}

impl Couplings {
    /// Those of an assembled matrix, nodes in mesh numbering. Couplings with nodes that are `fixed` in all components are
    /// left out.
    pub fn finest(pattern: &Pattern, fixed: &[bool], parallel: bool) -> Arc<Self> {
        let (size, nodes) = (pattern.dim(), pattern.nodes());
        let idle: Vec<bool> = fixed.chunks_exact(size).map(|node| !node.contains(&false)).collect();
        let mut starts = vec![0; nodes + 1];
        let couples = |row: usize, column: usize| row == column || !(idle[row] || idle[column]);
        visit(pattern, |row, column, _| {
            if couples(row, column) {
                starts[row + 1] += 1;
                if row != column {
                    starts[column + 1] += 1;
                }
            }
        });
        (0..nodes).for_each(|node| starts[node + 1] += starts[node]);
        let mut entries = vec![(0u32, 0u32); starts[nodes]];
        let mut next = starts.clone();
        visit(pattern, |row, column, k| {
            if !couples(row, column) {
                return;
            }
            let mut put = |row: usize, column: usize, code: usize| {
                entries[next[row]] = (column as u32, code as u32);
                next[row] += 1;
            };
            put(row, column, 2 * k);
            if row != column {
                put(column, row, 2 * k + 1);
            }
        });
        let rows = BlockRows { block_columns: nodes, starts, columns: Vec::new() };
        chunks::each(rows.cut(&mut entries, 1), parallel, |k, part| {
            let first = rows.starts[chunks::CHUNK * k];
            for i in chunks::CHUNK * k..(chunks::CHUNK * (k + 1)).min(nodes) {
                part[rows.starts[i] - first..rows.starts[i + 1] - first].sort_unstable();
            }
        });
        let (columns, codes) = entries.into_iter().unzip();
        Arc::new(Couplings { size, rows: BlockRows { columns, ..rows }, codes, stored: Vec::new() })
    }

    /// Of nodes of which nothing is known but their number: products stand for the entries.
    pub fn unknown(size: usize, nodes: usize) -> Arc<Self> {
        let rows = BlockRows { block_columns: nodes, starts: vec![0; nodes + 1], columns: Vec::new() };
        Arc::new(Couplings { size, rows, codes: Vec::new(), stored: Vec::new() })
    }

    /// Those of a level whose lower triangle is stored by rows, every block row by row.
    pub fn of_lower(size: usize, rows: BlockRows, parallel: bool) -> Arc<Self> {
        let below = |i: usize| rows.columns[rows.row(i)].partition_point(|&j| j as usize <= i);
        let mut stored = vec![0];
        for i in 0..rows.rows() {
            stored.push(stored[i] + below(i));
        }
        let mut codes = vec![0; rows.columns.len()];
        chunks::each(rows.cut(&mut codes, 1), parallel, |k, part| {
            let mut codes = part.iter_mut();
            for i in chunks::CHUNK * k..(chunks::CHUNK * (k + 1)).min(rows.rows()) {
                for ((at, &j), code) in rows.columns[rows.row(i)].iter().enumerate().zip(&mut codes) {
                    let j = j as usize;
                    // a pattern is symmetric: every block has its mirror image
                    let mirrored = || rows.position(j, i as u32).map_or(0, |at| stored[j] + at - rows.starts[j]);
                    *code = if j <= i { 2 * (stored[i] + at) as u32 + 1 } else { 2 * mirrored() as u32 };
                }
            }
        });
        Arc::new(Couplings { size, rows, codes, stored })
    }

    /// Number of unknowns.
    pub fn unknowns(&self) -> usize {
        self.size * self.rows.rows()
    }
}

/// A symmetric matrix in double precision, one triangle stored.
#[derive(Clone, Copy)]
pub(super) struct Symmetric<'a> {
    pub couplings: &'a Couplings,
    pub values: &'a [f64],
}

impl Symmetric<'_> {
    /// The block with a code, `[row][column]`.
    #[inline(always)]
    pub fn block<const N: usize>(&self, code: u32) -> [[f64; N]; N] {
        let stored = &self.values[N * N * (code >> 1) as usize..][..N * N];
        let mut block = [[0.0; N]; N];
        for r in 0..N {
            for c in 0..N {
                block[r][c] = if code & 1 == 0 { stored[r + N * c] } else { stored[N * r + c] };
            }
        }
        block
    }

    /// The stored values of the block with a code.
    pub fn stored(&self, code: u32) -> &[f64] {
        let size = self.couplings.size.pow(2);
        &self.values[size * (code >> 1) as usize..][..size]
    }

    /// The values of the diagonal block of a node; symmetric.
    pub fn diagonal(&self, i: usize) -> Option<&[f64]> {
        self.couplings.rows.position(i, i as u32).map(|at| self.stored(self.couplings.codes[at]))
    }

    /// The mean of the diagonal's absolute values.
    pub fn mean_diagonal(&self, parallel: bool) -> f64 {
        let (n, rows) = (self.couplings.size, self.couplings.rows.rows());
        let of_block = |block: &[f64]| (0..n).map(|r| block[(n + 1) * r].abs()).sum::<f64>();
        let of_row = |i| self.diagonal(i).map_or(0.0, of_block);
        let sum: f64 = chunks::map(rows, parallel, |range| range.map(of_row).sum::<f64>()).iter().sum();
        if sum > 0.0 { sum / (n * rows) as f64 } else { 1.0 }
    }
}

/// Calls with row, column (mesh nodes) and number of every stored block.
fn visit(pattern: &Pattern, mut call: impl FnMut(usize, usize, usize)) {
    let old = pattern.ordering().new_to_old();
    for (j, &column) in old.iter().enumerate() {
        let (first, rows) = pattern.column(j);
        for (k, &i) in rows.iter().enumerate() {
            call(old[i as usize] as usize, column as usize, first + k);
        }
    }
}
