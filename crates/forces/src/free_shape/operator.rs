//! [`Operator`]: a symmetric positive definite operator of scalar nodal fields, with zero at some nodes.

use nastic_body::error::FemError;
use nastic_linear::{Factor, Graph, Ordering, Pattern, Pivots, SparseMatrix, Symbolic};
use std::sync::Arc;

/// Nodes and the dense symmetric matrix of them, row by row.
pub(super) type Piece = (Vec<u32>, Vec<f64>);

/// `A` among the nodes that are free, factorised, and the entries that lead from these to others.
#[derive(Debug)]
pub(super) struct Operator {
    /// The free nodes, ascending.
    pub free: Vec<u32>,
    /// `None` where there is none.
    factor: Option<Factor>,
    /// Free node (by place), other node (of the mesh), entry.
    beyond: Vec<(u32, u32, f64)>,
}

impl Operator {
    /// The sum of pieces.
    ///
    /// # Errors
    /// A part without a node that is held; one that is too large.
    pub fn new(what: &str, free: Vec<u32>, pieces: &[Piece], points: &[[f64; 3]]) -> Result<Self, FemError> {
        let place = |node: &u32| free.binary_search(node).ok().map(|place| place as u32);
        if free.is_empty() {
            return Ok(Operator { free, factor: None, beyond: Vec::new() });
        }
        let own = |nodes: &[u32]| -> Vec<u32> { nodes.iter().filter_map(place).collect() };
        let cliques: Vec<Vec<u32>> =
            (0..free.len() as u32).map(|i| vec![i]).chain(pieces.iter().map(|(nodes, _)| own(nodes))).collect();
        let graph = Graph::from_cliques(free.len(), cliques.iter().map(Vec::as_slice))?;
        let places: Vec<[f64; 3]> = free.iter().map(|node| points[*node as usize]).collect();
        let pattern = Arc::new(Pattern::new(&graph, 1, Ordering::best(&graph, &places)?)?);
        let (mut matrix, mut beyond) = (SparseMatrix::zeros(pattern.clone()), Vec::new());
        for (nodes, local) in pieces {
            let places: Vec<Option<u32>> = nodes.iter().map(place).collect();
            for (a, row) in places.iter().enumerate().filter_map(|(a, row)| Some((a, (*row)?))) {
                for (b, column) in places.iter().enumerate() {
                    let entry = local[a * nodes.len() + b];
                    match column {
                        None => beyond.push((row, nodes[b], entry)),
                        Some(column) if *column <= row => {
                            let at = pattern.value_index(row as usize, *column as usize);
                            at.into_iter().for_each(|at| matrix.values[at] += entry);
                        }
                        Some(_) => {}
                    }
                }
            }
        }
        let symbolic = Arc::new(Symbolic::new(&pattern));
        let factor = symbolic.factorize(&matrix, Pivots::Positive, true).map_err(|error| FemError::Meaningless {
            what: format!(
                "{what} is not determined, as some part of it touches neither the skin nor what stays: {error}"
            ),
        })?;
        Ok(Operator { free, factor: Some(factor), beyond })
    }

    /// `x = A^-1 x` among the free nodes, in their order.
    pub fn solve(&self, x: &mut [f64]) {
        if let Some(factor) = &self.factor {
            factor.solve(x, 1);
        }
    }

    /// `-A_fb x_b` from a field of all nodes.
    pub fn minus_beyond(&self, at_node: impl Fn(u32) -> f64) -> Vec<f64> {
        let mut out = vec![0.0; self.free.len()];
        self.beyond.iter().for_each(|(row, node, entry)| out[*row as usize] -= entry * at_node(*node));
        out
    }

    /// The transpose: calls with other nodes and `-A_bf y`, entry by entry.
    pub fn each_beyond(&self, y: &[f64], mut add: impl FnMut(u32, f64)) {
        self.beyond.iter().for_each(|(row, node, entry)| add(*node, -entry * y[*row as usize]));
    }
}
