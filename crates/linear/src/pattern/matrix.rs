//! Sparse matrices on a [`Pattern`].

use std::ops::Range;
use std::sync::Arc;

use rayon::prelude::*;

use super::element_block::ElementBlock;
use super::entries::Pattern;
use super::skew::{self, SkewBlocks};
use crate::error::{FactorError, NotCoupled};

/// Parts of a product.
const MAX_PARTS: usize = 8;
/// Blocks of a part of a product.
const MIN_PART_BLOCKS: usize = 10_000;
/// Rows of a product added up by one task.
const ROWS_PER_TASK: usize = 4096;

/// Whether a matrix equals its transpose.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Symmetry {
    /// `A = A^T`.
    Symmetric,
    /// Any matrix whose pattern is symmetric.
    General,
}

/// A sparse matrix `A = S + W + sum_e E_e`, S symmetric and W skew; see [`Pattern`] for the layout of either. Most have no W. The E are
/// blocks [beyond the pattern](Self::add_beyond); most matrices have none.
#[derive(Clone, Debug)]
pub struct SparseMatrix {
    pub(super) pattern: Arc<Pattern>,
    /// The stored blocks of the symmetric part.
    pub values: Vec<f64>,
    /// Those of the skew part, where there is one: block `(i, j)`, `i >= j`; `W_ji = -W_ij^T`.
    pub(super) skew: Option<Vec<f64>>,
    pub(super) beyond: Vec<ElementBlock>,
    /// What makes a preconditioner of the symmetric part.
    pub(super) aside: Vec<ElementBlock>,
    /// Places in a node's block of the components that what is added has; all of them where there are none.
    pub(super) components: Option<Vec<usize>>,
}

/// Products of a matrix with vectors, see [`SparseMatrix::products`].
pub(crate) struct EntryProducts<'a> {
    matrix: &'a SparseMatrix,
    skew: Option<(SkewBlocks, &'a [f64])>,
    transposed: bool,
}

impl EntryProducts<'_> {
    /// `y = A x` or `A^T x`, always summed in the same order; `parallel` uses all threads of the current rayon pool.
    pub fn multiply(&self, x: &[f64], y: &mut [f64], parallel: bool) {
        let (matrix, dim) = (self.matrix, self.matrix.pattern.dim());
        matrix.multiply_symmetric(x, y, parallel);
        if let Some((blocks, values)) = &self.skew {
            blocks.add_product(dim, values, if self.transposed { -1.0 } else { 1.0 }, x, y);
        }
        matrix.beyond.iter().for_each(|block| block.add_product(dim, x, y, self.transposed));
    }
}

impl SparseMatrix {
    /// The zero matrix.
    pub fn zeros(pattern: Arc<Pattern>) -> Self {
        let values = vec![0.0; pattern.values()];
        Self { values, ..Self::without_values(pattern) }
    }

    /// A matrix without entries, which products replace.
    pub fn without_values(pattern: Arc<Pattern>) -> Self {
        Self { pattern, values: Vec::new(), skew: None, beyond: Vec::new(), aside: Vec::new(), components: None }
    }

    /// The zero matrix of a symmetry: a general one has room for a skew part.
    pub fn with_symmetry(pattern: Arc<Pattern>, symmetry: Symmetry) -> Self {
        let skew = (symmetry == Symmetry::General).then(|| vec![0.0; pattern.values()]);
        Self { skew, ..Self::zeros(pattern) }
    }

    /// Whether it has no skew part.
    pub fn is_symmetric(&self) -> bool {
        self.skew.is_none()
    }

    /// The symmetric part, `(A + A^T) / 2`.
    #[must_use]
    pub fn symmetric_part(&self) -> SparseMatrix {
        let beyond = self.beyond.iter().map(ElementBlock::symmetric_part).collect();
        SparseMatrix { beyond, values: self.values.clone(), ..Self::without_values(self.pattern.clone()) }
    }

    /// What stands in for the matrix as a preconditioner: its symmetric part with the element matrices that were [set aside](Self::add_aside).
    #[must_use]
    pub fn stand_in(&self) -> SparseMatrix {
        let mut out = self.symmetric_part();
        for block in &self.aside {
            if let Ok(map) = out.pattern.scatter_map(&block.nodes) {
                out.add_element(&map, &block.entries);
            }
        }
        out
    }

    /// The element matrices set aside.
    pub(crate) fn aside(&self) -> &Vec<ElementBlock> {
        &self.aside
    }

    /// The same, to be changed as the matrix is.
    pub(crate) fn aside_mut(&mut self) -> &mut Vec<ElementBlock> {
        &mut self.aside
    }

    /// The blocks beyond the pattern.
    pub fn beyond(&self) -> &[ElementBlock] {
        &self.beyond
    }

    /// Puts other blocks beyond the pattern in the place of its own.
    pub(crate) fn set_beyond(&mut self, beyond: Vec<ElementBlock>) {
        self.beyond = beyond;
    }

    /// The stored blocks of the skew part, where there is one.
    pub(crate) fn skew(&self) -> Option<&Vec<f64>> {
        self.skew.as_ref()
    }

    /// The same to change.
    pub(crate) fn skew_mut(&mut self) -> Option<&mut Vec<f64>> {
        self.skew.as_mut()
    }

    /// Takes the values of the pattern of another matrix, block by block, at the blocks with these codes.
    pub(crate) fn copy_blocks(&mut self, from: &SparseMatrix, codes: &[u32]) {
        let dim = self.pattern.dim();
        let copy = |into: &mut [f64], from: &[f64], sign: f64| {
            for (block, &code) in from.chunks_exact(dim * dim).zip(codes) {
                let into = &mut into[dim * dim * (code >> 1) as usize..][..dim * dim];
                match code & 1 {
                    0 => into.copy_from_slice(block),
                    _ => (0..dim * dim).for_each(|at| into[at] = sign * block[dim * (at % dim) + at / dim]),
                }
            }
        };
        copy(&mut self.values, &from.values, 1.0);
        if let (Some(into), Some(from)) = (&mut self.skew, &from.skew) {
            copy(into, from, -1.0);
        }
    }

    /// The matrix of the absolute values of the symmetric part, `|S|_ij = |S_ij|`; blocks beyond the pattern each by itself, which
    /// bounds it.
    #[must_use]
    pub fn magnitudes(&self) -> SparseMatrix {
        let values = self.values.iter().map(|value| value.abs()).collect();
        let beyond = self.beyond.iter().map(|block| block.symmetric_part().map(f64::abs)).collect();
        SparseMatrix { beyond, values, ..Self::without_values(self.pattern.clone()) }
    }

    /// Its pattern.
    pub fn pattern(&self) -> &Arc<Pattern> {
        &self.pattern
    }

    /// Sets all values to zero.
    pub fn clear(&mut self) {
        self.values.fill(0.0);
        self.beyond.clear();
        self.aside.clear();
        if let Some(skew) = &mut self.skew {
            skew.fill(0.0);
        }
    }

    /// Entry `(row, column)`, dofs by mesh node; zero where nothing was added.
    pub fn get(&self, row: usize, column: usize) -> f64 {
        let symmetric = self.pattern.value_index(row, column).map_or(0.0, |at| self.values[at]);
        let beyond: f64 = self.beyond.iter().map(|block| block.entry(self.pattern.dim(), row, column)).sum();
        symmetric + beyond + self.skew.as_ref().map_or(0.0, |skew| skew::entry(&self.pattern, skew, row, column))
    }

    /// Entry `(r, c)` of the stored block of a number, or of its mirror image in the other triangle.
    pub(crate) fn block_entry(&self, block: usize, r: usize, c: usize, mirrored: bool) -> f64 {
        let dim = self.pattern.dim();
        let at = dim * dim * block + if mirrored { dim * r + c } else { dim * c + r };
        let skew = self.skew.as_ref().map_or(0.0, |skew| skew[at]);
        self.values[at] + if mirrored { -skew } else { skew }
    }

    /// `y = A x` on one thread, the same bits as [`multiply_on`](Self::multiply_on).
    pub fn multiply(&self, x: &[f64], y: &mut [f64]) {
        self.multiply_on(x, y, false);
    }

    /// `y = A x`, always summed in the same order; `parallel` uses all threads of the current rayon pool.
    pub fn multiply_on(&self, x: &[f64], y: &mut [f64], parallel: bool) {
        self.products(false).multiply(x, y, parallel);
    }

    /// `y = A^T x`.
    pub fn multiply_transposed(&self, x: &[f64], y: &mut [f64], parallel: bool) {
        self.products(true).multiply(x, y, parallel);
    }

    /// Products of A or `A^T` with several vectors: what is zero in the skew part is found once.
    pub(crate) fn products(&self, transposed: bool) -> EntryProducts<'_> {
        let skew = self.skew.as_ref().map(|skew| (SkewBlocks::of(&self.pattern, skew), &skew[..]));
        EntryProducts { matrix: self, skew, transposed }
    }

    fn multiply_symmetric(&self, x: &[f64], y: &mut [f64], parallel: bool) {
        match self.pattern.dim() {
            3 => self.multiply_blocks::<3>(x, y, parallel),
            2 => self.multiply_blocks::<2>(x, y, parallel),
            1 => self.multiply_blocks::<1>(x, y, parallel),
            _ => self.multiply_any(x, y),
        }
    }

    /// Parts of the columns, each into a vector of its own, since a column adds to many rows; then their sum.
    fn multiply_blocks<const D: usize>(&self, x: &[f64], y: &mut [f64], parallel: bool) {
        let old = self.pattern.ordering().new_to_old();
        let (x, _) = x.as_chunks::<D>();
        let x: Vec<[f64; D]> = old.iter().map(|&node| x[node as usize]).collect();
        let parts = self.parts();
        // Blocks stand below the diagonal: a part adds to no row above its columns.
        let product = |part: &Range<usize>| {
            let mut sums = vec![[0.0; D]; old.len() - part.start];
            self.add_columns(part.clone(), &x, &mut sums);
            sums
        };
        let sums: Vec<Vec<[f64; D]>> =
            if parallel { parts.par_iter().map(product).collect() } else { parts.iter().map(product).collect() };
        let (y, _) = y.as_chunks_mut::<D>();
        let new = self.pattern.ordering().old_to_new();
        let add = |(k, y): (usize, &mut [[f64; D]])| {
            for (y, &j) in y.iter_mut().zip(&new[ROWS_PER_TASK * k..]) {
                *y = [0.0; D];
                for (part, sums) in parts.iter().zip(&sums).take_while(|(part, _)| part.start <= j as usize) {
                    y.iter_mut().zip(&sums[j as usize - part.start]).for_each(|(s, v)| *s += v);
                }
            }
        };
        match parallel && y.len() > ROWS_PER_TASK {
            true => y.par_chunks_mut(ROWS_PER_TASK).enumerate().for_each(add),
            false => y.chunks_mut(ROWS_PER_TASK).enumerate().for_each(add),
        }
    }

    /// Ranges of columns with about as many blocks each. Their number depends on the matrix alone.
    fn parts(&self) -> Vec<Range<usize>> {
        let blocks = self.pattern.values() / self.pattern.dim().pow(2);
        let number = (blocks / MIN_PART_BLOCKS).clamp(1, MAX_PARTS);
        let mut parts = Vec::with_capacity(number);
        let mut start = 0;
        for part in 1..=number {
            let mut end = if part == number { self.pattern.nodes() } else { start };
            while end < self.pattern.nodes() && self.pattern.column(end).0 < part * blocks / number {
                end += 1;
            }
            parts.push(start..end);
            start = end;
        }
        parts
    }

    /// Adds what the columns have, and by symmetry their rows, to `sums`, whose first entry belongs to the first column.
    fn add_columns<const D: usize>(&self, columns: Range<usize>, x: &[[f64; D]], sums: &mut [[f64; D]]) {
        let (values, _) = self.values.as_chunks::<D>();
        let start = columns.start;
        for j in columns {
            let (first, rows) = self.pattern.column(j);
            let x_j = x[j];
            let mut y_j = sums[j - start];
            for (block, &i) in values[D * first..].chunks_exact(D).zip(rows) {
                if i as usize == j {
                    for c in 0..D {
                        for r in 0..D {
                            y_j[r] += block[c][r] * x_j[c];
                        }
                    }
                    continue;
                }
                let (y_i, x_i) = (&mut sums[i as usize - start], x[i as usize]);
                for c in 0..D {
                    for r in 0..D {
                        y_i[r] += block[c][r] * x_j[c];
                        y_j[c] += block[c][r] * x_i[r];
                    }
                }
            }
            sums[j - start] = y_j;
        }
    }

    fn multiply_any(&self, x: &[f64], y: &mut [f64]) {
        y.fill(0.0);
        self.for_each_entry(|row, column, value| {
            y[row] += value * x[column];
            if row / self.pattern.dim() != column / self.pattern.dim() {
                y[column] += value * x[row];
            }
        });
    }

    /// Calls with `(row, column, value)` for every stored entry of the symmetric part: off-diagonal blocks once, diagonal blocks in full.
    fn for_each_entry(&self, mut visit: impl FnMut(usize, usize, f64)) {
        let dim = self.pattern.dim();
        let old = self.pattern.ordering().new_to_old();
        for (j, &column_node) in old.iter().enumerate() {
            let (first, rows) = self.pattern.column(j);
            for (k, &i) in rows.iter().enumerate() {
                let block = &self.values[dim * dim * (first + k)..][..dim * dim];
                for (at, &value) in block.iter().enumerate() {
                    let row = dim * old[i as usize] as usize + at % dim;
                    visit(row, dim * column_node as usize + at / dim, value);
                }
            }
        }
    }

    /// Replaces rows and columns of the dofs marked `fixed` by those of `diagonal` times the identity.
    ///
    /// To prescribe values other than zero, move `A x` to the right-hand side first.
    pub fn eliminate(&mut self, fixed: &[bool], diagonal: f64) {
        let dim = self.pattern.dim();
        self.beyond.iter_mut().chain(&mut self.aside).for_each(|block| block.eliminate(dim, fixed));
        let pattern = Arc::clone(&self.pattern);
        let old = pattern.ordering().new_to_old();
        let is_fixed: Vec<&[bool]> = old.iter().map(|&node| &fixed[dim * node as usize..][..dim]).collect();
        let any: Vec<bool> = is_fixed.iter().map(|node| node.contains(&true)).collect();
        for j in 0..pattern.nodes() {
            let (first, rows) = pattern.column(j);
            for (k, &i) in rows.iter().enumerate() {
                if !any[j] && !any[i as usize] {
                    continue;
                }
                for at in 0..dim * dim {
                    let (r, c) = (at % dim, at / dim);
                    if is_fixed[i as usize][r] || is_fixed[j][c] {
                        let entry = dim * dim * (first + k) + at;
                        self.values[entry] = if i as usize == j && r == c { diagonal } else { 0.0 };
                        if let Some(skew) = &mut self.skew {
                            skew[entry] = 0.0;
                        }
                    }
                }
            }
        }
    }

    /// The diagonal, by dof.
    pub fn diagonal(&self) -> Vec<f64> {
        let dim = self.pattern.dim();
        let mut diagonal = vec![0.0; self.pattern.dofs()];
        for (j, &node) in self.pattern.ordering().new_to_old().iter().enumerate() {
            let (first, _) = self.pattern.column(j);
            for c in 0..dim {
                diagonal[dim * node as usize + c] = self.values[dim * dim * first + (dim + 1) * c];
            }
        }
        self.beyond.iter().for_each(|block| {
            block.each(dim, |i, j, value| {
                if i == j {
                    diagonal[i] += value
                }
            })
        });
        diagonal
    }

    /// `A += factor B` for a symmetric B. Fast where both share one pattern.
    ///
    /// # Errors
    /// [`NotCoupled`] where this pattern lacks a coupling at which B is not zero; A is then of no use.
    pub fn add_scaled(&mut self, factor: f64, other: &SparseMatrix) -> Result<(), NotCoupled> {
        let (dim, own) = (self.pattern.dim(), self.seen());
        self.beyond.extend(other.beyond.iter().map(|block| block.map(|entry| factor * entry).widened(dim, &own)));
        if Arc::ptr_eq(&self.pattern, &other.pattern) {
            self.values.iter_mut().zip(&other.values).for_each(|(a, b)| *a += factor * b);
            return Ok(());
        }
        let mut lacking = None;
        let place = |dof: usize| dim * (dof / own.len()) + own[dof % own.len()];
        other.for_each_entry(|row, column, value| match self.pattern.value_index(place(row), place(column)) {
            Some(at) => self.values[at] += factor * value,
            None if value == 0.0 => {}
            None => {
                lacking = lacking.or(Some(NotCoupled { a: (row / own.len()) as u32, b: (column / own.len()) as u32 }))
            }
        });
        lacking.map_or(Ok(()), Err)
    }

    /// Adds `shift` times the identity.
    pub fn add_to_diagonal(&mut self, shift: f64) {
        let (dim, own) = (self.pattern.dim(), self.seen());
        for j in 0..self.pattern.nodes() {
            let (first, _) = self.pattern.column(j);
            own.iter().for_each(|c| self.values[dim * dim * first + (dim + 1) * c] += shift);
        }
    }

    /// Adds a diagonal matrix, entries by dof.
    pub fn add_diagonal(&mut self, entries: &[f64]) {
        let (dim, own) = (self.pattern.dim(), self.seen());
        for (j, &node) in self.pattern.ordering().new_to_old().iter().enumerate() {
            let (first, _) = self.pattern.column(j);
            for (k, c) in own.iter().enumerate() {
                self.values[dim * dim * first + (dim + 1) * c] += entries[own.len() * node as usize + k];
            }
        }
    }

    /// The largest row sum of absolute values of the symmetric part, `|S|_inf = |S|_1`; a bound of it where there are blocks beyond the
    /// pattern.
    pub fn norm(&self) -> f64 {
        let mut sums = vec![0.0; self.pattern.dofs()];
        let dim = self.pattern.dim();
        self.for_each_entry(|row, column, value| {
            sums[row] += value.abs();
            if row / dim != column / dim {
                sums[column] += value.abs();
            }
        });
        for block in self.beyond.iter().map(ElementBlock::symmetric_part) {
            block.each(dim, |row, _, value| sums[row] += value.abs());
        }
        sums.into_iter().fold(0.0, f64::max)
    }

    /// Refuses NaN and infinities.
    ///
    /// # Errors
    /// [`FactorError::NotFinite`] with the first offender in mesh numbering.
    pub fn check_finite(&self) -> Result<(), FactorError> {
        // A sum is NaN or infinite as soon as one addend is; it overflows only for numbers that are useless anyway.
        let skew = self.skew.iter().flatten().chain(self.beyond.iter().flat_map(|block| &block.entries)).sum::<f64>();
        if self.values.iter().sum::<f64>().is_finite() && skew.is_finite() {
            return Ok(());
        }
        let dim = self.pattern.dim();
        let mut first: Option<(usize, f64)> = None;
        self.for_each_entry(|_, column, value| {
            if !value.is_finite() && first.is_none_or(|(at, _)| column < at) {
                first = Some((column, value));
            }
        });
        if first.is_none() && !skew.is_finite() {
            return Err(FactorError::NotFinite { node: 0, component: 0, value: skew });
        }
        match first {
            Some((dof, value)) => Err(FactorError::NotFinite { node: dof / dim, component: dof % dim, value }),
            None => Ok(()),
        }
    }
}
