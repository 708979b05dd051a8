//! Blocks of numbers, one for each node (or grid) that has any.

/// Numbers by node; a block comes into being, as zeros, when first asked for.
#[derive(Debug)]
pub(super) struct Blocks {
    /// Per node: where its block starts, plus one.
    start: Vec<u32>,
    data: Vec<f64>,
}

impl Blocks {
    pub fn new(nodes: usize) -> Self {
        Self { start: vec![0; nodes], data: Vec::new() }
    }

    pub fn get_mut(&mut self, node: u32, len: usize) -> &mut [f64] {
        let start = &mut self.start[node as usize];
        if *start == 0 {
            *start = self.data.len() as u32 + 1;
            self.data.resize(self.data.len() + len, 0.0);
        }
        &mut self.data[*start as usize - 1..][..len]
    }

    /// Adds a node's block, or the beginning of it, to `sum`.
    pub fn add_to(&self, node: u32, sum: &mut [f64]) {
        let start = self.start[node as usize] as usize;
        if start > 0 {
            sum.iter_mut().zip(&self.data[start - 1..]).for_each(|(sum, block)| *sum += block);
        }
    }
}
