//! Sparse matrices of dense blocks, stored by rows: what multigrid smooths with and moves between levels with.

use std::ops::Range;

use rayon::prelude::*;

/// Block rows handled by one task. Fixed, so that nothing depends on the number of threads.
const CHUNK: usize = 512;

/// A sparse matrix of `rows() x columns()` blocks of `shape.0 x shape.1` values, columns ascending in every row.
///
/// A block is stored column by column. `S` is `f64` while matrices are multiplied with each other, and `f32` in the
/// cycle, which is bound by memory: rounding there changes the preconditioner and not the answer.
#[derive(Clone, Debug)]
pub(super) struct BlockMatrix<S> {
    pub shape: (usize, usize),
    pub block_columns: usize,
    pub starts: Vec<usize>,
    pub columns: Vec<u32>,
    pub values: Vec<S>,
}

/// Calls a function generic over two block sizes; the sizes that occur are those of rigid motions in one to three
/// dimensions.
macro_rules! with_shape {
    ($shape:expr, $otherwise:expr, $self:ident . $call:ident ( $($argument:expr),* )) => {
        match $shape {
            (3, 3) => $self.$call::<3, 3>($($argument),*),
            (3, 6) => $self.$call::<3, 6>($($argument),*),
            (6, 3) => $self.$call::<6, 3>($($argument),*),
            (6, 6) => $self.$call::<6, 6>($($argument),*),
            (2, 2) => $self.$call::<2, 2>($($argument),*),
            (2, 3) => $self.$call::<2, 3>($($argument),*),
            (3, 2) => $self.$call::<3, 2>($($argument),*),
            (1, 1) => $self.$call::<1, 1>($($argument),*),
            _ => $otherwise,
        }
    };
}

impl<S: Copy + Into<f64> + Send + Sync> BlockMatrix<S> {
    /// Number of block rows.
    pub fn rows(&self) -> usize {
        self.starts.len() - 1
    }

    /// The blocks of block row `i`, as a range of `columns`.
    pub fn row(&self, i: usize) -> Range<usize> {
        self.starts[i]..self.starts[i + 1]
    }

    /// The values of the k-th block.
    pub fn block(&self, k: usize) -> &[S] {
        let size = self.shape.0 * self.shape.1;
        &self.values[size * k..size * (k + 1)]
    }

    /// `y = A x`.
    pub fn multiply(&self, x: &[f64], y: &mut [f64], parallel: bool) {
        with_shape!(self.shape, (), self.product_by_rows(x, y, parallel, |y, ax| *y = ax));
    }

    /// `y -= A x`.
    pub fn subtract(&self, x: &[f64], y: &mut [f64], parallel: bool) {
        with_shape!(self.shape, (), self.product_by_rows(x, y, parallel, |y, ax| *y -= ax));
    }

    fn product_by_rows<const R: usize, const C: usize>(
        &self,
        x: &[f64],
        y: &mut [f64],
        parallel: bool,
        put: impl Fn(&mut f64, f64) + Sync,
    ) {
        let (x, _) = x.as_chunks::<C>();
        let (y, _) = y.as_chunks_mut::<R>();
        let (columns, _) = self.values.as_chunks::<R>();
        let chunk = |(k, y): (usize, &mut [[f64; R]])| {
            for (i, y) in y.iter_mut().enumerate() {
                let row = self.row(CHUNK * k + i);
                let mut sum = [0.0; R];
                let blocks = columns[C * row.start..C * row.end].chunks_exact(C);
                for (block, &j) in blocks.zip(&self.columns[row]) {
                    let x = &x[j as usize];
                    for c in 0..C {
                        for r in 0..R {
                            sum[r] += block[c][r].into() * x[c];
                        }
                    }
                }
                y.iter_mut().zip(sum).for_each(|(y, ax)| put(y, ax));
            }
        };
        if parallel && self.rows() > CHUNK {
            y.par_chunks_mut(CHUNK).enumerate().for_each(chunk);
        } else {
            y.chunks_mut(CHUNK).enumerate().for_each(chunk);
        }
    }

    /// The transpose.
    pub fn transposed(&self) -> Self {
        let (r, c) = self.shape;
        let mut starts = vec![0; self.block_columns + 1];
        self.columns.iter().for_each(|&j| starts[j as usize + 1] += 1);
        for j in 0..self.block_columns {
            starts[j + 1] += starts[j];
        }
        let (mut next, mut from, mut columns) = (starts.clone(), vec![0; self.columns.len()], self.columns.clone());
        for i in 0..self.rows() {
            for k in self.row(i) {
                let at = &mut next[self.columns[k] as usize];
                (from[*at], columns[*at]) = (k, i as u32);
                *at += 1;
            }
        }
        let mut values = Vec::with_capacity(self.values.len());
        for k in from {
            let block = self.block(k);
            values.extend((0..r * c).map(|at| block[r * (at % c) + at / c]));
        }
        BlockMatrix { shape: (c, r), block_columns: self.rows(), starts, columns, values }
    }
}

impl BlockMatrix<f64> {
    /// `A B`; every row of the answer is made by one task, and rows do not depend on each other.
    pub fn times(&self, b: &Self, parallel: bool) -> Self {
        let shape = (self.shape.0, b.shape.1);
        let rows = |k: usize| {
            let rows = CHUNK * k..(CHUNK * (k + 1)).min(self.rows());
            match self.shape.1 {
                3 => with_shape!(shape, Rows::default(), self.rows_times_3(b, rows)),
                6 => with_shape!(shape, Rows::default(), self.rows_times_6(b, rows)),
                2 => with_shape!(shape, Rows::default(), self.rows_times_2(b, rows)),
                _ => with_shape!(shape, Rows::default(), self.rows_times_1(b, rows)),
            }
        };
        let chunks = 0..self.rows().div_ceil(CHUNK);
        let parts: Vec<Rows> =
            if parallel { chunks.into_par_iter().map(rows).collect() } else { chunks.map(rows).collect() };
        let mut product = BlockMatrix {
            shape,
            block_columns: b.block_columns,
            starts: vec![0],
            columns: Vec::with_capacity(parts.iter().map(|part| part.columns.len()).sum()),
            values: Vec::with_capacity(parts.iter().map(|part| part.values.len()).sum()),
        };
        for part in parts {
            let before = product.columns.len();
            product.starts.extend(part.ends.iter().map(|end| before + end));
            product.columns.extend(part.columns);
            product.values.extend(part.values);
        }
        product
    }

    fn rows_times_1<const R: usize, const C: usize>(&self, b: &Self, rows: Range<usize>) -> Rows {
        self.rows_times::<R, 1, C>(b, rows)
    }

    fn rows_times_2<const R: usize, const C: usize>(&self, b: &Self, rows: Range<usize>) -> Rows {
        self.rows_times::<R, 2, C>(b, rows)
    }

    fn rows_times_3<const R: usize, const C: usize>(&self, b: &Self, rows: Range<usize>) -> Rows {
        self.rows_times::<R, 3, C>(b, rows)
    }

    fn rows_times_6<const R: usize, const C: usize>(&self, b: &Self, rows: Range<usize>) -> Rows {
        self.rows_times::<R, 6, C>(b, rows)
    }

    /// Gustavson, ACM TOMS 4 (1978): rows of B are added up, scaled by the entries of a row of A.
    fn rows_times<const R: usize, const K: usize, const C: usize>(&self, b: &Self, rows: Range<usize>) -> Rows {
        let mut out = Rows::default();
        let (left, _) = self.values.as_chunks::<R>();
        let (right, _) = b.values.as_chunks::<K>();
        let mut place = vec![u32::MAX; b.block_columns];
        let mut sums: Vec<[f64; R]> = Vec::new();
        for i in rows {
            let first = out.columns.len();
            for &k in &self.columns[self.row(i)] {
                for &j in &b.columns[b.row(k as usize)] {
                    if place[j as usize] == u32::MAX {
                        place[j as usize] = 0;
                        out.columns.push(j);
                    }
                }
            }
            out.columns[first..].sort_unstable();
            out.columns[first..].iter().enumerate().for_each(|(at, &j)| place[j as usize] = at as u32);
            sums.clear();
            sums.resize(C * (out.columns.len() - first), [0.0; R]);
            for at in self.row(i) {
                let block = &left[K * at..K * (at + 1)];
                for of_b in b.row(self.columns[at] as usize) {
                    let factor = &right[C * of_b..C * (of_b + 1)];
                    let sum = &mut sums[C * place[b.columns[of_b] as usize] as usize..][..C];
                    for c in 0..C {
                        for k in 0..K {
                            for r in 0..R {
                                sum[c][r] += block[k][r] * factor[c][k];
                            }
                        }
                    }
                }
            }
            out.columns[first..].iter().for_each(|&j| place[j as usize] = u32::MAX);
            out.values.extend_from_slice(sums.as_flattened());
            out.ends.push(out.columns.len());
        }
        out
    }

    /// `A = (A + A^T) / 2` for a matrix that is symmetric but for rounding; the diagonal entries of unknowns marked
    /// `idle`, whose rows and columns are zero, become `diagonal`.
    pub fn symmetrise(&mut self, idle: &[bool], diagonal: f64) {
        let (n, size) = (self.shape.0, self.shape.0 * self.shape.1);
        for i in 0..self.rows() {
            for k in self.row(i) {
                let j = self.columns[k] as usize;
                if j > i {
                    continue;
                }
                let row = self.row(j);
                let Ok(at) = self.columns[row.clone()].binary_search(&(i as u32)) else { continue };
                let other = row.start + at;
                for r in 0..n {
                    for c in 0..n {
                        let (one, two) = (size * k + n * c + r, size * other + n * r + c);
                        let mean = 0.5 * (self.values[one] + self.values[two]);
                        (self.values[one], self.values[two]) = (mean, mean);
                    }
                    if i == j && idle[n * i + r] {
                        self.values[size * k + (n + 1) * r] = diagonal;
                    }
                }
            }
        }
    }

    /// The diagonal block of block row `i`.
    pub fn diagonal_block(&self, i: usize) -> Option<&[f64]> {
        let row = self.row(i);
        let at = self.columns[row.clone()].binary_search(&(i as u32)).ok()?;
        Some(self.block(row.start + at))
    }

    /// The same in single precision.
    pub fn rounded(&self) -> BlockMatrix<f32> {
        BlockMatrix {
            shape: self.shape,
            block_columns: self.block_columns,
            starts: self.starts.clone(),
            columns: self.columns.clone(),
            values: self.values.iter().map(|&value| value as f32).collect(),
        }
    }
}

/// Some rows of a product: where each ends, and what stands in them.
#[derive(Default)]
struct Rows {
    ends: Vec<usize>,
    columns: Vec<u32>,
    values: Vec<f64>,
}
