//! [`ElementBlock`]: a dense matrix over the unknowns of some nodes.

/// A dense matrix over the unknowns of some nodes, which need not be coupled in a pattern.
#[derive(Clone, Debug, PartialEq)]
pub struct ElementBlock {
    /// The nodes, each once.
    pub nodes: Vec<u32>,
    /// Its `n = dim * nodes` rows one after the other; unknown `dim * local node + component`.
    pub entries: Vec<f64>,
}

impl ElementBlock {
    /// Of nodes each of which may be there more than once: what belongs to one node is added up.
    pub(crate) fn merged(nodes: &[u32], entries: Vec<f64>) -> Self {
        let mut unique: Vec<u32> = Vec::with_capacity(nodes.len());
        let place = |node: &u32| {
            unique.iter().position(|known| known == node).unwrap_or_else(|| {
                unique.push(*node);
                unique.len() - 1
            })
        };
        let places: Vec<usize> = nodes.iter().map(place).collect();
        if unique.len() == nodes.len() {
            return ElementBlock { nodes: unique, entries };
        }
        let own = entries.len().isqrt();
        let dim = own / nodes.len();
        let (n, at) = (dim * unique.len(), |i: usize| dim * places[i / dim] + i % dim);
        let mut sums = vec![0.0; n * n];
        for (k, entry) in entries.iter().enumerate() {
            sums[n * at(k / own) + at(k % own)] += entry;
        }
        ElementBlock { nodes: unique, entries: sums }
    }

    /// With a function of every entry.
    pub(crate) fn map(&self, of: impl Fn(f64) -> f64) -> Self {
        ElementBlock { nodes: self.nodes.clone(), entries: self.entries.iter().map(|entry| of(*entry)).collect() }
    }

    /// `(E + E^T) / 2`.
    pub(crate) fn symmetric_part(&self) -> Self {
        let n = self.entries.len().isqrt();
        let mean = |at: usize| 0.5 * (self.entries[at] + self.entries[n * (at % n) + at / n]);
        ElementBlock { nodes: self.nodes.clone(), entries: (0..n * n).map(mean).collect() }
    }

    /// Calls with `(row, column, entry)` of every entry, dofs by mesh node.
    pub(crate) fn each(&self, dim: usize, mut call: impl FnMut(usize, usize, f64)) {
        let n = dim * self.nodes.len();
        let dof = |local: usize| dim * self.nodes[local / dim] as usize + local % dim;
        for (at, entry) in self.entries.iter().enumerate() {
            call(dof(at / n), dof(at % n), *entry);
        }
    }

    /// Its entry at a row and column; zero where it has none.
    pub(crate) fn entry(&self, dim: usize, row: usize, column: usize) -> f64 {
        let mut sum = 0.0;
        self.each(dim, |i, j, value| {
            if (i, j) == (row, column) {
                sum += value;
            }
        });
        sum
    }

    /// `y += E x`, or `y += E^T x`.
    pub(crate) fn add_product(&self, dim: usize, x: &[f64], y: &mut [f64], transposed: bool) {
        match transposed {
            false => self.each(dim, |i, j, value| y[i] += value * x[j]),
            true => self.each(dim, |i, j, value| y[j] += value * x[i]),
        }
    }

    /// Makes rows and columns of fixed dofs zero.
    pub(crate) fn eliminate(&mut self, dim: usize, fixed: &[bool]) {
        let n = dim * self.nodes.len();
        let dof = |local: usize| dim * self.nodes[local / dim] as usize + local % dim;
        for (at, entry) in self.entries.iter_mut().enumerate() {
            if fixed[dof(at / n)] || fixed[dof(at % n)] {
                *entry = 0.0;
            }
        }
    }

    /// The same block over all `dim` components of its nodes, whose own ones stand at the given places.
    pub(crate) fn widened(&self, dim: usize, components: &[usize]) -> Self {
        let (own, n) = (components.len() * self.nodes.len(), dim * self.nodes.len());
        let place = |i: usize| dim * (i / components.len()) + components[i % components.len()];
        let mut entries = vec![0.0; n * n];
        for (at, entry) in self.entries.iter().enumerate() {
            entries[n * place(at / own) + place(at % own)] = *entry;
        }
        ElementBlock { nodes: self.nodes.clone(), entries }
    }
}
