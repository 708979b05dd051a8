//! [`HarmonicExtension`]: a field inside a body from its values on the skin.

use super::operator::{Operator, Piece};
use nastic_body::discretization::quadrature_points::QuadraturePoints;
use nastic_body::error::FemError;
use nastic_mesh::Mesh;

/// `laplace x = 0` by finite elements: `x_f = -K_ff^-1 K_fb x_b`, with the field given at the nodes b and natural elsewhere.
#[derive(Debug)]
pub(super) struct HarmonicExtension(Operator);

/// `int grad N_a . grad N_b dX` of every cell of some.
///
/// # Errors
/// A cell that is inverted.
pub(super) fn stiffness(mesh: &Mesh, cells: &[u32]) -> Result<Vec<Piece>, FemError> {
    let sampling =
        QuadraturePoints::of_cells(mesh, cells.iter().copied(), |kind| kind.rule_of_points(kind.order() + 1))?;
    let (dim, mut pieces) = (mesh.dim(), Vec::with_capacity(cells.len()));
    for part in &sampling.parts {
        let (n, table) = (part.table.nodes, &part.table);
        for c in 0..part.cells.len() {
            let mut local = vec![0.0; n * n];
            for q in 0..table.points {
                let inverse = &part.inverse[c * table.points + q];
                let weight = sampling.weights()[part.first_point(c) + q];
                // dN_a/dX_J = dN_a/dxi_K dxi_K/dX_J
                let gradient = |a: usize| -> [f64; 3] {
                    let along = |k: usize| table.gradients[(q * dim + k) * table.width + a];
                    std::array::from_fn(|j| (0..dim).map(|k| along(k) * inverse[3 * k + j]).sum())
                };
                let gradients: Vec<[f64; 3]> = (0..n).map(gradient).collect();
                for (a, b) in (0..n).flat_map(|a| (0..n).map(move |b| (a, b))) {
                    local[a * n + b] += weight * (0..dim).map(|j| gradients[a][j] * gradients[b][j]).sum::<f64>();
                }
            }
            pieces.push((part.nodes_of(c).to_vec(), local));
        }
    }
    Ok(pieces)
}

impl HarmonicExtension {
    /// To these nodes, ascending.
    ///
    /// # Errors
    /// A part of them that nothing determines.
    pub fn new(free: Vec<u32>, stiffness: &[Piece], points: &[[f64; 3]]) -> Result<Self, FemError> {
        Operator::new("how the inside follows the skin", free, stiffness, points).map(HarmonicExtension)
    }

    /// The nodes that it is to.
    pub fn free(&self) -> &[u32] {
        &self.0.free
    }

    /// Fills in the component c of a field of `dim` components, given at all other nodes.
    pub fn extend(&self, field: &mut [f64], dim: usize, c: usize) {
        let mut x = self.0.minus_beyond(|node| field[dim * node as usize + c]);
        self.0.solve(&mut x);
        self.0.free.iter().zip(x).for_each(|(node, x)| field[dim * *node as usize + c] = x);
    }

    /// The transpose: adds what hangs on the nodes that were filled in to those that were given, and leaves zero there.
    pub fn gather(&self, field: &mut [f64], dim: usize, c: usize) {
        let at = |node: u32| dim * node as usize + c;
        let mut y: Vec<f64> = self.0.free.iter().map(|node| std::mem::take(&mut field[at(*node)])).collect();
        self.0.solve(&mut y);
        self.0.each_beyond(&y, |node, value| field[at(node)] += value);
    }
}
