//! Jacobians of many cells of one kind at fixed reference points: shape gradients are evaluated once.

use crate::CellKind;
use crate::geometry::{MAX_NODES, determinant, tangents};

/// Shape gradients of one kind at some points.
pub(crate) struct Tabulated {
    kind: CellKind,
    gradients: Vec<[[f64; 3]; MAX_NODES]>,
}

impl Tabulated {
    pub(crate) fn new<'a>(kind: CellKind, points: impl IntoIterator<Item = &'a [f64; 3]>) -> Tabulated {
        let at = |xi: &[f64; 3]| {
            let mut gradients = [[0.0; 3]; MAX_NODES];
            kind.gradients(xi, &mut gradients[..kind.nodes()]);
            gradients
        };
        Tabulated { kind, gradients: points.into_iter().map(at).collect() }
    }

    /// det dx/dxi at every point, in order, for a cell with these node positions.
    pub(crate) fn jacobians(&self, positions: &[[f64; 3]]) -> impl Iterator<Item = f64> {
        let n = self.kind.nodes();
        let dim = self.kind.dim();
        self.gradients.iter().map(move |gradients| determinant(dim, &tangents(&gradients[..n], positions)))
    }
}

/// Room for the node positions of one cell.
pub(crate) struct Gathered([[f64; 3]; MAX_NODES]);

impl Gathered {
    pub(crate) fn new() -> Gathered {
        Gathered([[0.0; 3]; MAX_NODES])
    }

    /// The positions of these nodes.
    pub(crate) fn of(&mut self, nodes: &[u32], points: &[[f64; 3]]) -> &[[f64; 3]] {
        for (x, &node) in self.0.iter_mut().zip(nodes) {
            *x = points[node as usize];
        }
        &self.0[..nodes.len()]
    }
}
