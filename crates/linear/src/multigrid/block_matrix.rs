//! The matrix of a level in single precision, both triangles by rows or by the products of cells: what a cycle smooths with.

use std::ops::Range;
use std::sync::{Arc, Mutex};

use super::cell_products::CellProducts;
use super::chunks::{self, CHUNK};
use super::couplings::{Couplings, Symmetric};
use crate::locks::lock;

/// Calls a function generic over the size of blocks; the sizes that occur are the components of a displacement and the
/// numbers of rigid motions in one to three dimensions.
macro_rules! with_size {
    ($size:expr, $($call:ident).+ ( $($argument:expr),* )) => {
        match $size {
            1 => $($call).+::<1>($($argument),*),
            2 => $($call).+::<2>($($argument),*),
            3 => $($call).+::<3>($($argument),*),
            _ => $($call).+::<6>($($argument),*),
        }
    };
}
pub(super) use with_size;

/// A symmetric matrix by rows of blocks, each stored column by column. Rounding to single precision changes the
/// preconditioner and not the answer, and a cycle is bound by memory.
#[derive(Debug)]
pub(super) struct BlockMatrix {
    pub couplings: Arc<Couplings>,
    /// Nothing where there are products.
    values: Vec<f32>,
    products: Option<Arc<dyn CellProducts>>,
    /// Rooms for what cells make of a vector.
    rooms: Mutex<Vec<Vec<f32>>>,
}

/// A vector on its way through a matrix.
pub(super) struct Multiplied<'a, const N: usize> {
    matrix: &'a BlockMatrix,
    x: &'a [[f64; N]],
    /// What the cells make of it, where they make the products.
    of_cells: Vec<f32>,
}

impl BlockMatrix {
    /// One without values yet.
    pub fn new(couplings: Arc<Couplings>) -> Self {
        BlockMatrix { couplings, values: Vec::new(), products: None, rooms: Mutex::default() }
    }

    /// Becomes a matrix with its couplings, from its stored values or its products.
    pub fn fill(&mut self, values: &[f64], products: Option<&Arc<dyn CellProducts>>, parallel: bool) {
        self.products = products.cloned();
        if self.products.is_some() {
            self.values = Vec::new();
            return;
        }
        lock(&self.rooms).clear();
        let couplings = self.couplings.clone();
        let of = Symmetric { couplings: &couplings, values };
        with_size!(couplings.size, self.fill_blocks(&of, parallel));
    }

    /// Lets go of the products, without which it is of no use.
    pub fn release_products(&mut self) {
        self.products = None;
        lock(&self.rooms).clear();
    }

    fn fill_blocks<const N: usize>(&mut self, of: &Symmetric, parallel: bool) {
        let couplings = &*self.couplings;
        self.values.resize(N * N * couplings.codes.len(), 0.0);
        chunks::each(couplings.rows.cut(&mut self.values, N * N), parallel, |k, values| {
            let first = couplings.rows.starts[CHUNK * k];
            for (block, &code) in values.as_chunks_mut::<N>().0.chunks_exact_mut(N).zip(&couplings.codes[first..]) {
                let from = of.block::<N>(code);
                for (c, column) in block.iter_mut().enumerate() {
                    (0..N).for_each(|r| column[r] = from[r][c] as f32);
                }
            }
        });
    }

    /// The k-th block, column by column.
    #[inline(always)]
    pub fn block<const N: usize>(&self, k: usize) -> &[[f32; N]] {
        &self.values.as_chunks::<N>().0[N * k..N * (k + 1)]
    }

    /// The sum of squares of the k-th block.
    pub fn square(&self, k: usize) -> f64 {
        let size = self.couplings.size.pow(2);
        self.values[size * k..size * (k + 1)].iter().map(|&value| f64::from(value).powi(2)).sum()
    }

    /// `y = A x`.
    pub fn multiply(&self, x: &[f64], y: &mut [f64], parallel: bool) {
        with_size!(self.couplings.size, self.multiply_blocks(x, y, parallel));
    }

    fn multiply_blocks<const N: usize>(&self, x: &[f64], y: &mut [f64], parallel: bool) {
        let of_x = self.times::<N>(x, parallel);
        let parts = chunks::rows(y.as_chunks_mut::<N>().0, 1).collect();
        chunks::each(parts, parallel, |k, y: &mut [[f64; N]]| {
            of_x.rows(CHUNK * k..CHUNK * k + y.len(), |i, product| y[i] = product);
        });
    }

    /// `y -= A x`.
    pub fn subtract(&self, x: &[f64], y: &mut [f64], parallel: bool) {
        with_size!(self.couplings.size, self.subtract_blocks(x, y, parallel));
    }

    fn subtract_blocks<const N: usize>(&self, x: &[f64], y: &mut [f64], parallel: bool) {
        let of_x = self.times::<N>(x, parallel);
        let parts = chunks::rows(y.as_chunks_mut::<N>().0, 1).collect();
        chunks::each(parts, parallel, |k, y: &mut [[f64; N]]| {
            let rows = CHUNK * k..CHUNK * k + y.len();
            of_x.rows(rows, |i, product| (0..N).for_each(|r| y[i][r] -= product[r]));
        });
    }

    /// `A x`, of which rows can be asked for.
    pub fn times<'a, const N: usize>(&'a self, x: &'a [f64], parallel: bool) -> Multiplied<'a, N> {
        let mut of_cells = Vec::new();
        if let Some(products) = &self.products {
            of_cells = lock(&self.rooms).pop().unwrap_or_default();
            products.of_cells(x, &mut of_cells, parallel);
        }
        Multiplied { matrix: self, x: x.as_chunks::<N>().0, of_cells }
    }

    /// Numbers that a product passes.
    pub fn numbers(&self) -> usize {
        self.values.len() + self.products.as_ref().map_or(0, |products| products.numbers())
    }

    /// Memory of the values or products, in bytes.
    pub fn bytes_of_values(&self) -> usize {
        let rooms = lock(&self.rooms).iter().map(|room| size_of_val(&room[..])).sum::<usize>();
        size_of_val(&self.values[..]) + self.products.as_ref().map_or(0, |products| products.bytes()) + rooms
    }
}

impl<const N: usize> Multiplied<'_, N> {
    /// Calls with the number of every row among some, and its product.
    #[inline(always)]
    pub fn rows(&self, rows: Range<usize>, mut put: impl FnMut(usize, [f64; N])) {
        if let Some(products) = &self.matrix.products {
            for (at, node) in rows.enumerate() {
                let sum = products.at_node(node, &self.of_cells);
                put(at, std::array::from_fn(|c| sum.get(c).copied().unwrap_or(0.0)));
            }
            return;
        }
        let (columns, _) = self.matrix.values.as_chunks::<N>();
        let all = &self.matrix.couplings.rows;
        for (at, i) in rows.enumerate() {
            let row = all.row(i);
            let mut sum = [0.0; N];
            let blocks = columns[N * row.start..N * row.end].chunks_exact(N);
            for (block, &j) in blocks.zip(&all.columns[row]) {
                let x = &self.x[j as usize];
                for c in 0..N {
                    for r in 0..N {
                        sum[r] += f64::from(block[c][r]) * x[c];
                    }
                }
            }
            put(at, sum);
        }
    }
}

impl<const N: usize> Drop for Multiplied<'_, N> {
    fn drop(&mut self) {
        if self.matrix.products.is_some() {
            lock(&self.matrix.rooms).push(std::mem::take(&mut self.of_cells));
        }
    }
}
