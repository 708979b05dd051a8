//! Matrices whose unknowns at some nodes are mixed by an orthogonal matrix, and [`RowsOfNodes`].

use super::element_block::ElementBlock;
use super::matrix::SparseMatrix;
use nalgebra::DMatrix;
use std::collections::{BTreeMap, BTreeSet};

/// Rows and columns of the unknowns of some nodes.
#[derive(Debug, Clone)]
pub struct RowsOfNodes {
    /// The nodes that they are coupled with, their own among them.
    pub nodes: Vec<u32>,
    /// `A_ij`, i an unknown of theirs, j an unknown of these nodes one after the other.
    pub rows: DMatrix<f64>,
    /// `A_ji`, in the same places.
    pub columns: DMatrix<f64>,
}

impl SparseMatrix {
    /// `A <- Q^T A Q`, Q orthogonal over the unknowns of some nodes and one elsewhere. Pairs of nodes that the pattern lacks become blocks
    /// [beyond](Self::add_beyond) it.
    pub fn mix(&mut self, nodes: &[u32], q: &DMatrix<f64>) {
        let (dim, n) = (self.pattern().dim(), q.nrows());
        // before pairs that the pattern lacks come to them
        self.set_beyond(mixed(self.beyond().to_vec(), dim, nodes, q));
        *self.aside_mut() = mixed(std::mem::take(self.aside_mut()), dim, nodes, q);
        for part in 0..if self.is_symmetric() { 1 } else { 2 } {
            let mut taken = BTreeMap::new();
            let mut blocks = Vec::new();
            self.each_stored_at(nodes, |block| blocks.push(*block));
            for block in &blocks {
                let entries = self.take_block(block.number, part);
                block.add(dim, n, &entries, [1.0, -1.0][part], &mut taken);
            }
            let within = nodes.iter().map(|node| taken.remove(node).unwrap_or_else(|| DMatrix::zeros(n, dim)));
            let columns: Vec<DMatrix<f64>> = within.collect();
            let within = DMatrix::from_fn(n, n, |i, j| columns[j / dim][(i, j % dim)]) * q;
            let place = |(k, &node): (usize, &u32)| (node, within.columns(dim * k, dim).into_owned());
            let all: Vec<(u32, DMatrix<f64>)> = nodes.iter().enumerate().map(place).chain(taken).collect();
            for (other, rows) in all {
                let rows = q.transpose() * rows;
                for (k, &node) in nodes.iter().enumerate() {
                    // of a pair within one of both is stored
                    if !nodes[k + 1..].contains(&other) {
                        let block = rows.rows(dim * k, dim);
                        let by_rows: Vec<f64> = (0..dim * dim).map(|at| block[(at / dim, at % dim)]).collect();
                        self.add_part(node, other, part, &by_rows);
                    }
                }
            }
        }
    }

    /// Rows and columns of the unknowns of some nodes.
    #[must_use]
    pub fn rows_of(&self, nodes: &[u32]) -> RowsOfNodes {
        let (dim, n) = (self.pattern().dim(), self.pattern().dim() * nodes.len());
        let mut sides = [BTreeMap::new(), BTreeMap::new()];
        for part in 0..if self.is_symmetric() { 1 } else { 2 } {
            for (side, into) in sides.iter_mut().enumerate() {
                let sign = [1.0, -1.0][part];
                self.each_stored_at(nodes, |block| {
                    let entries = self.block(block.number, part);
                    // of the skew part the columns have the opposite sign
                    let entries: Vec<f64> =
                        if side == 0 { entries } else { entries.iter().map(|e| sign * e).collect() };
                    block.add(dim, n, &entries, sign, into);
                });
            }
        }
        for block in self.beyond() {
            block.each(dim, |i, j, entry| {
                for (side, (own, other)) in [(i, j), (j, i)].into_iter().enumerate() {
                    let node = (own / dim) as u32;
                    for k in (0..nodes.len()).filter(|&k| nodes[k] == node) {
                        let into = sides[side].entry((other / dim) as u32);
                        into.or_insert_with(|| DMatrix::zeros(n, dim))[(dim * k + own % dim, other % dim)] += entry;
                    }
                }
            });
        }
        let [rows, columns] = sides;
        let all: BTreeSet<u32> = rows.keys().chain(columns.keys()).copied().collect();
        let nodes: Vec<u32> = all.into_iter().collect();
        let side = |of: &BTreeMap<u32, DMatrix<f64>>| {
            let entry = |i: usize, j: usize| of.get(&nodes[j / dim]).map_or(0.0, |rows| rows[(i, j % dim)]);
            DMatrix::from_fn(n, dim * nodes.len(), entry)
        };
        RowsOfNodes { rows: side(&rows), columns: side(&columns), nodes }
    }

    /// Calls with every stored block that has one of some nodes.
    fn each_stored_at(&self, nodes: &[u32], mut call: impl FnMut(&StoredBlock)) {
        let (pattern, places) = (self.pattern(), nodes.iter().enumerate().map(|(k, &node)| (node, k)));
        let (places, old): (BTreeMap<u32, usize>, _) = (places.collect(), pattern.ordering().new_to_old());
        for (j, &column) in old.iter().enumerate() {
            let (first, rows) = pattern.column(j);
            let to = places.get(&column).copied();
            for (k, &i) in rows.iter().enumerate() {
                let row = old[i as usize];
                let from = places.get(&row).copied();
                if from.is_some() || to.is_some() {
                    call(&StoredBlock { number: first + k, row, column, from, to });
                }
            }
        }
    }
}

/// Blocks over some nodes, those of which that have one of the mixed nodes over all of these.
fn mixed(mut all: Vec<ElementBlock>, dim: usize, nodes: &[u32], q: &DMatrix<f64>) -> Vec<ElementBlock> {
    let n = q.nrows();
    for block in all.iter_mut().filter(|block| block.nodes.iter().any(|node| nodes.contains(node))) {
        let others = block.nodes.iter().copied().filter(|node| !nodes.contains(node));
        let together: Vec<u32> = nodes.iter().copied().chain(others).collect();
        let size = dim * together.len();
        let mut seen = 0;
        let place_of = |node: &u32| {
            nodes.iter().position(|known| known == node).unwrap_or_else(|| {
                seen += 1;
                nodes.len() + seen - 1
            })
        };
        let places: Vec<usize> = block.nodes.iter().map(place_of).collect();
        let (mut whole, own) = (DMatrix::zeros(size, size), dim * block.nodes.len());
        for (at, entry) in block.entries.iter().enumerate() {
            let place = |i: usize| dim * places[i / dim] + i % dim;
            whole[(place(at / own), place(at % own))] += entry;
        }
        let mut turn = DMatrix::identity(size, size);
        turn.view_mut((0, 0), (n, n)).copy_from(q);
        let mixed = turn.transpose() * whole * turn;
        let entries = (0..size * size).map(|at| mixed[(at / size, at % size)]).collect();
        *block = ElementBlock { nodes: together, entries };
    }
    all
}

/// A stored block, and the places of its nodes among some.
#[derive(Clone, Copy)]
struct StoredBlock {
    number: usize,
    row: u32,
    column: u32,
    from: Option<usize>,
    to: Option<usize>,
}

impl StoredBlock {
    /// Adds its entries, given by rows, to the rows of some nodes, by the other node; `sign` is that of its mirror image.
    fn add(&self, dim: usize, n: usize, entries: &[f64], sign: f64, into: &mut BTreeMap<u32, DMatrix<f64>>) {
        let mut rows_of = |other: u32, k: usize, entry: &dyn Fn(usize, usize) -> f64| {
            let rows = into.entry(other).or_insert_with(|| DMatrix::zeros(n, dim));
            (0..dim * dim).for_each(|at| rows[(dim * k + at / dim, at % dim)] += entry(at / dim, at % dim));
        };
        if let Some(k) = self.from {
            rows_of(self.column, k, &|r, c| entries[dim * r + c]);
        }
        if let Some(k) = self.to.filter(|_| self.row != self.column) {
            rows_of(self.row, k, &|r, c| sign * entries[dim * c + r]);
        }
    }
}
