//! [`Ties`]: nodes whose unknowns follow those of others.

use super::element_block::ElementBlock;
use super::graph::Graph;
use super::matrix::SparseMatrix;
use std::collections::BTreeSet;
use std::ops::Range;

/// Linear constraints `u_s = sum_m w_sm u_m`, component by component: nodes s that follow nodes m (their masters), which follow none, in all components of a node's block or in some.
/// With `u = C v`, v the unknowns that follow none, a system `K u = f` becomes `C^T K C v = C^T f`.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Ties {
    /// By node what components of it follow; nothing of one that is free. Empty without ties.
    follows: Vec<Vec<Tie>>,
    nodes: Vec<u32>,
    /// Nodes whose unknowns are mixed.
    mixed: Vec<Vec<u32>>,
}

/// Components of a node, and those of which nodes they follow, with weights.
#[derive(Debug, Clone, PartialEq)]
struct Tie {
    components: Range<usize>,
    masters: Vec<(u32, f64)>,
}

impl Ties {
    /// Mixes the unknowns of some nodes with each other ([`SparseMatrix::mix`]).
    #[must_use]
    pub fn mixing(mut self, nodes: Vec<u32>) -> Self {
        self.mixed.push(nodes);
        self
    }

    /// Lets these components of nodes of a mesh of so many follow those of others, each node with its masters and their weights. `None` where a node follows itself, one that is
    /// tied, or is tied twice, and where there is no such node.
    #[must_use]
    pub fn with(mut self, count: usize, components: Range<usize>, tied: Vec<(u32, Vec<(u32, f64)>)>) -> Option<Self> {
        let meets = |tie: &Tie| tie.components.start < components.end && components.start < tie.components.end;
        self.follows.resize(count.max(self.follows.len()), Vec::new());
        for (node, masters) in tied {
            let own = self.follows.get_mut(node as usize)?;
            if masters.is_empty() || own.iter().any(meets) {
                return None;
            }
            own.push(Tie { components: components.clone(), masters });
            own.sort_unstable_by_key(|tie| tie.components.start);
            self.nodes.push(node);
        }
        self.nodes.sort_unstable();
        self.nodes.dedup();
        let is_free =
            |(master, _): &(u32, f64)| self.follows.get(*master as usize).is_some_and(|own| !own.iter().any(meets));
        let mut ties = self.nodes.iter().flat_map(|&node| &self.follows[node as usize]);
        let sound = ties.all(|tie| !meets(tie) || tie.masters.iter().all(is_free));
        sound.then_some(self)
    }

    /// Whether no node follows another, and none are mixed.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty() && self.mixed.is_empty()
    }

    /// The nodes that follow others, ascending.
    #[must_use]
    pub fn nodes(&self) -> &[u32] {
        &self.nodes
    }

    /// What a component of a node follows, with weights; nothing of one that is free.
    #[must_use]
    pub fn masters(&self, node: u32, component: usize) -> &[(u32, f64)] {
        let own = self.of(node).iter().find(|tie| tie.components.contains(&component));
        own.map_or(&[], |tie| &tie.masters)
    }

    fn of(&self, node: u32) -> &[Tie] {
        self.follows.get(node as usize).map_or(&[], Vec::as_slice)
    }

    /// Calls with the unknowns of nodes of so many components that follow, and those that they follow, with weights.
    fn each(&self, dim: usize, mut call: impl FnMut(usize, &mut dyn Iterator<Item = (usize, f64)>)) {
        for &node in &self.nodes {
            for tie in self.of(node) {
                for c in tie.components.clone() {
                    call(dim * node as usize + c, &mut tie.masters.iter().map(|(m, w)| (dim * *m as usize + c, *w)));
                }
            }
        }
    }

    /// `C^T f`, forces at nodes: those on nodes that follow act on their masters, and become zero. Nothing of an empty vector.
    pub fn restrict(&self, dim: usize, forces: &mut [f64]) {
        if forces.is_empty() {
            return;
        }
        self.each(dim, |dof, masters| {
            let force = std::mem::take(&mut forces[dof]);
            masters.for_each(|(m, w)| forces[m] += w * force);
        });
    }

    /// `C v`: nodes that follow are where their masters lead them. Nothing of an empty vector.
    pub fn extend(&self, dim: usize, u: &mut [f64]) {
        if u.is_empty() {
            return;
        }
        self.each(dim, |dof, masters| u[dof] = masters.map(|(m, w)| w * u[m]).sum());
    }

    /// Sets of nodes that `C^T K C`, mixed, couples beyond a graph, that of K, which has so many components per node.
    #[must_use]
    pub fn couplings(&self, graph: &Graph, dim: usize) -> Vec<Vec<u32>> {
        let mut sets = BTreeSet::new();
        let led = |node: u32| {
            let own = (0..dim).any(|c| self.masters(node, c).is_empty()).then_some(node);
            own.into_iter().chain(self.of(node).iter().flat_map(|tie| &tie.masters).map(|(m, _)| *m))
        };
        for &node in &self.nodes {
            for &other in graph.neighbours(node as usize) {
                let set: BTreeSet<u32> = led(node).chain(led(other)).collect();
                sets.insert(set.into_iter().collect::<Vec<u32>>());
            }
        }
        for group in &self.mixed {
            for &other in group.iter().flat_map(|&node| graph.neighbours(node as usize)) {
                let set: BTreeSet<u32> = group.iter().copied().chain(led(other)).collect();
                sets.insert(set.into_iter().collect());
            }
        }
        sets.into_iter().filter(|set| graph.check_coupled(set).is_err()).collect()
    }

    /// The components of a node in groups, each with the node by itself and its weight 1, or with what it follows.
    fn expansions(&self, node: u32, dim: usize) -> Vec<Tie> {
        let mut all = Vec::new();
        let mut next = 0;
        let end = Tie { components: dim..dim, masters: Vec::new() };
        for tie in self.of(node).iter().chain([&end]) {
            if next < tie.components.start {
                all.push(Tie { components: next..tie.components.start, masters: vec![(node, 1.0)] });
            }
            next = tie.components.end;
            if !tie.masters.is_empty() {
                all.push(tie.clone());
            }
        }
        all
    }

    fn is_tied(&self, node: u32) -> bool {
        !self.of(node).is_empty()
    }
}

/// A block of a matrix that is moved.
struct Moved {
    row: u32,
    column: u32,
    /// The symmetric and the skew part, rows one after the other.
    parts: Vec<Vec<f64>>,
}

impl SparseMatrix {
    /// `C^T A C`, with a multiple of the identity at nodes that follow others. Pairs of nodes that the pattern lacks become blocks
    /// [beyond](Self::add_beyond) it.
    pub fn tie(&mut self, ties: &Ties, diagonal: f64) {
        if ties.is_empty() {
            return;
        }
        let dim = self.pattern().dim();
        let moved = self.take_tied(ties, diagonal);
        let beyond = self.beyond().iter().map(|block| tied(block, ties, dim)).collect();
        self.set_beyond(beyond);
        self.aside_mut().iter_mut().for_each(|block| *block = tied(block, ties, dim));
        for Moved { row, column, parts } in moved {
            let (rows, columns) = (ties.expansions(row, dim), ties.expansions(column, dim));
            for (k, part) in parts.into_iter().enumerate() {
                for (r, c) in rows.iter().flat_map(|r| columns.iter().map(move |c| (r, c))) {
                    let is_there = |at: usize| r.components.contains(&(at / dim)) && c.components.contains(&(at % dim));
                    let own: Vec<f64> = (0..dim * dim).map(|at| if is_there(at) { part[at] } else { 0.0 }).collect();
                    self.add_moved((row, column), [&r.masters, &c.masters], k, &own);
                }
            }
        }
    }

    /// Adds a block of two nodes, or of the diagonal, to those that they follow.
    fn add_moved(&mut self, (row, column): (u32, u32), [rows, columns]: [&[(u32, f64)]; 2], k: usize, part: &[f64]) {
        let (dim, sign) = (self.pattern().dim(), [1.0, -1.0][k]);
        for &(a, weight) in rows {
            for &(b, other) in columns {
                let factor = weight * other;
                let block: Vec<f64> = part.iter().map(|entry| factor * entry).collect();
                // of a pair that meets in one node its mirror image too
                let both = row != column && a == b;
                let twice = |at: usize| block[at] + sign * block[dim * (at % dim) + at / dim];
                let block = if both { (0..dim * dim).map(twice).collect() } else { block };
                // of a diagonal block (a, b) and (b, a) come each by itself, and one of both is stored
                if row != column || a >= b {
                    self.add_part(a, b, k, &block);
                }
            }
        }
    }

    /// Takes the blocks with a tied node out.
    fn take_tied(&mut self, ties: &Ties, diagonal: f64) -> Vec<Moved> {
        let pattern = self.pattern().clone();
        let (dim, old) = (pattern.dim(), pattern.ordering().new_to_old());
        let mut moved = Vec::new();
        for (j, &column) in old.iter().enumerate() {
            let (first, rows) = pattern.column(j);
            for (k, &i) in rows.iter().enumerate() {
                let row = old[i as usize];
                if !ties.is_tied(row) && !ties.is_tied(column) {
                    continue;
                }
                let parts = (0..if self.is_symmetric() { 1 } else { 2 }).map(|part| self.take_block(first + k, part));
                let parts = parts.collect();
                if row == column {
                    let led = (0..dim).filter(|c| !ties.masters(row, *c).is_empty());
                    led.for_each(|c| self.values[dim * dim * (first + k) + (dim + 1) * c] = diagonal);
                }
                moved.push(Moved { row, column, parts });
            }
        }
        moved
    }

    /// Takes a stored block, by rows, out of the symmetric (0) or the skew (1) part.
    pub(crate) fn take_block(&mut self, block: usize, part: usize) -> Vec<f64> {
        let (taken, size) = (self.block(block, part), self.pattern().dim().pow(2));
        let values = if part == 0 { Some(&mut self.values) } else { self.skew_mut() };
        values.into_iter().for_each(|values| values[size * block..][..size].fill(0.0));
        taken
    }

    /// A stored block, by rows, of the symmetric (0) or the skew (1) part.
    pub(crate) fn block(&self, block: usize, part: usize) -> Vec<f64> {
        let dim = self.pattern().dim();
        let values = if part == 0 { Some(&self.values) } else { self.skew() };
        let entry = |values: &Vec<f64>, at: usize| values[dim * dim * block + dim * (at % dim) + at / dim];
        (0..dim * dim).map(|at| values.map_or(0.0, |values| entry(values, at))).collect()
    }

    /// Adds a block `A_ab`, given by rows, to the symmetric (0) or the skew (1) part, and so its mirror image.
    pub(crate) fn add_part(&mut self, a: u32, b: u32, part: usize, block: &[f64]) {
        let pattern = self.pattern().clone();
        let (dim, sign) = (pattern.dim(), [1.0, -1.0][part]);
        let Ok(code) = pattern.block_code(a, b) else {
            return self.add_beyond(&[a, b], beyond_block(dim, block, sign));
        };
        let values = if part == 0 { Some(&mut self.values) } else { self.skew_mut() };
        let Some(values) = values else { return };
        let into = &mut values[dim * dim * (code >> 1) as usize..][..dim * dim];
        for (at, entry) in block.iter().enumerate() {
            let (r, c) = (at / dim, at % dim);
            match code & 1 {
                0 => into[dim * c + r] += entry,
                _ => into[dim * r + c] += sign * entry,
            }
        }
    }
}

/// A block `A_ab` and its mirror image in a matrix over both nodes.
fn beyond_block(dim: usize, block: &[f64], sign: f64) -> Vec<f64> {
    let n = 2 * dim;
    let mut entries = vec![0.0; n * n];
    for (at, entry) in block.iter().enumerate() {
        let (r, c) = (at / dim, at % dim);
        entries[n * r + dim + c] += entry;
        entries[n * (dim + c) + r] += sign * entry;
    }
    entries
}

/// A block over the masters of its tied nodes.
fn tied(block: &ElementBlock, ties: &Ties, dim: usize) -> ElementBlock {
    if !block.nodes.iter().any(|&node| ties.is_tied(node)) {
        return block.clone();
    }
    let itself: Vec<[(u32, f64); 1]> = block.nodes.iter().map(|&node| [(node, 1.0)]).collect();
    // by unknown of the block
    let expansion = |at: usize| match ties.masters(block.nodes[at / dim], at % dim) {
        [] => &itself[at / dim],
        masters => masters,
    };
    let nodes: BTreeSet<u32> = (0..dim * block.nodes.len()).flat_map(expansion).map(|(node, _)| *node).collect();
    let nodes: Vec<u32> = nodes.into_iter().collect();
    let (own, n) = (dim * block.nodes.len(), dim * nodes.len());
    let place = |node: u32| dim * nodes.binary_search(&node).unwrap_or_default();
    let mut entries = vec![0.0; n * n];
    for (at, entry) in block.entries.iter().enumerate().filter(|(_, entry)| **entry != 0.0) {
        let (row, column) = (at / own, at % own);
        for (a, weight) in expansion(row) {
            for (b, other) in expansion(column) {
                entries[n * (place(*a) + row % dim) + place(*b) + column % dim] += weight * other * entry;
            }
        }
    }
    ElementBlock { nodes, entries }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pattern::entries::Pattern;
    use crate::pattern::matrix::Symmetry;
    use nalgebra::DMatrix;
    use std::sync::Arc;

    const CELLS: [[u32; 2]; 4] = [[0, 1], [1, 2], [2, 3], [3, 4]];

    fn entry(at: usize, k: usize) -> f64 {
        ((31 * at + 17 * k) % 23) as f64 - 11.0
    }

    /// The graph of a chain of five nodes, and that with what ties couple.
    fn graphs(ties: &Ties) -> (Graph, Graph) {
        let cells = || CELLS.iter().map(|cell| &cell[..]);
        let graph = Graph::from_cliques(5, cells()).unwrap();
        let more = ties.couplings(&graph, 2);
        let full = Graph::from_cliques(5, cells().chain(more.iter().map(Vec::as_slice))).unwrap();
        (graph, full)
    }

    /// A matrix on the chain, with a block beyond it.
    fn chain(graph: &Graph, symmetry: Symmetry) -> SparseMatrix {
        let mut matrix = SparseMatrix::with_symmetry(Arc::new(Pattern::of_graph(graph, &[], 2)), symmetry);
        let element = |k: usize| -> Vec<f64> {
            let mirrored = |at: usize| 4 * (at % 4) + at / 4;
            let of = |at: usize| match symmetry {
                Symmetry::General => entry(at, k),
                Symmetry::Symmetric => entry(at, k) + entry(mirrored(at), k),
            };
            (0..16).map(of).collect()
        };
        CELLS.iter().enumerate().for_each(|(k, cell)| matrix.add_pairs(cell, &element(k)).unwrap());
        matrix.add_beyond(&[0, 3], element(7));
        matrix
    }

    fn dense(matrix: &SparseMatrix) -> DMatrix<f64> {
        DMatrix::from_fn(10, 10, |i, j| matrix.get(i, j))
    }

    /// `C^T A C` of a chain of five nodes, of which the third follows the first and the fifth, the fourth the fifth alone, by dense products.
    #[test]
    fn tied_matrices_are_the_products() {
        let dim = 2;
        let wholly =
            Ties::default().with(5, 0..dim, vec![(2, vec![(0, 0.25), (4, 0.75)]), (3, vec![(4, -1.5)])]).unwrap();
        // a node whose components follow others each, one that follows and leads
        let partly = Ties::default().with(5, 1..2, vec![(2, vec![(0, 0.25), (3, 0.75)]), (1, vec![(0, 1.0)])]).unwrap();
        let partly = partly.with(5, 0..1, vec![(2, vec![(4, 0.5)]), (3, vec![(4, 1.0)])]).unwrap();
        let cases = [(false, Symmetry::General), (false, Symmetry::Symmetric), (true, Symmetry::General)];
        for (ties, (lacks, symmetry)) in [&wholly, &partly].into_iter().flat_map(|ties| cases.map(|case| (ties, case)))
        {
            let (graph, full) = graphs(ties);
            let mut matrix = chain(if lacks { &graph } else { &full }, symmetry);
            let before = dense(&matrix);
            let c = DMatrix::from_fn(10, 10, |i, j| {
                let (node, other) = ((i / dim) as u32, (j / dim) as u32);
                let itself = if node == other { 1.0 } else { 0.0 };
                let weight = match ties.masters(node, i % dim) {
                    [] => itself,
                    masters => masters.iter().find(|(m, _)| *m == other).map_or(0.0, |(_, w)| *w),
                };
                if i % dim == j % dim { weight } else { 0.0 }
            });
            matrix.tie(ties, 3.0);
            let mut expected = c.transpose() * before * &c;
            let led = (0..10).filter(|i| !ties.masters((i / dim) as u32, i % dim).is_empty());
            led.for_each(|i| expected[(i, i)] += 3.0);
            assert!((dense(&matrix) - expected).abs().max() < 1e-12);
        }
    }

    /// `Q^T A Q` and its rows and columns, of a chain of five nodes with a block beyond it.
    #[test]
    fn mixed_matrices_are_the_products() {
        let group = [3_u32, 1];
        let (graph, full) = graphs(&Ties::default().mixing(group.to_vec()));
        for (graph, symmetry) in [(&full, Symmetry::Symmetric), (&full, Symmetry::General), (&graph, Symmetry::General)]
        {
            let mut matrix = chain(graph, symmetry);
            let before = dense(&matrix);
            let q = DMatrix::from_fn(4, 4, |i, j| entry(4 * i + j, 3)).qr().q();
            let dofs = [6, 7, 2, 3];
            let mut turn = DMatrix::<f64>::identity(10, 10);
            (0..16).for_each(|at| turn[(dofs[at / 4], dofs[at % 4])] = q[(at / 4, at % 4)]);
            let expected = turn.transpose() * before * turn;
            matrix.mix(&group, &q);
            assert!((dense(&matrix) - &expected).abs().max() < 1e-12);
            let found = matrix.rows_of(&group);
            let other = |j: usize| 2 * found.nodes[j / 2] as usize + j % 2;
            assert_eq!(found.rows.ncols(), 10);
            let rows = DMatrix::from_fn(4, 10, |i, j| expected[(dofs[i], other(j))]);
            let columns = DMatrix::from_fn(4, 10, |i, j| expected[(other(j), dofs[i])]);
            assert!((found.rows - rows).abs().max() < 1e-12 && (found.columns - columns).abs().max() < 1e-12);
        }
    }

    #[test]
    fn chains_of_ties_are_refused() {
        let with = |tied| Ties::default().with(3, 0..2, tied);
        assert!(with(vec![(0, vec![(1, 1.0)]), (1, vec![(2, 1.0)])]).is_none());
        assert!(with(vec![(0, vec![(0, 1.0)])]).is_none());
        assert!(with(vec![(0, vec![(7, 1.0)])]).is_none());
        let tied = with(vec![(0, vec![(1, 1.0)])]).unwrap();
        assert!(tied.clone().with(3, 1..3, vec![(0, vec![(2, 1.0)])]).is_none());
        assert!(tied.with(3, 2..3, vec![(1, vec![(2, 1.0)])]).is_some());
    }
}
