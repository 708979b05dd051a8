//! Fields by node: smoothed averages of quantities at quadrature points.

use crate::discretization::Discretization;

impl Discretization {
    /// Nodal values of a quantity at the quadrature points, smoothed: at a corner `a`
    ///
    /// ```text
    /// v_a = sum_q w_q N_a(q) v_q / sum_q w_q N_a(q)
    /// ```
    ///
    /// over the points q of all cells around it, with reference volumes w and the shape functions N of the corners alone (the lumped
    /// L2 projection on functions that are linear between corners); between corners their interpolation. Zero at nodes without a cell;
    /// shape `[nodes][components]`.
    pub fn nodal_average(&self, at_points: &[f64], components: usize) -> Vec<f64> {
        let nodes = self.mesh.points().len();
        let (mut out, mut weight) = (vec![0.0; nodes * components], vec![0.0; nodes]);
        for (id, (first, count)) in self.points_of_cells().into_iter().enumerate() {
            let cell = self.mesh.cell(id);
            let corners = cell.kind.corners();
            let mut shapes = vec![0.0; corners];
            for (q, (at, _)) in cell.kind.rule().iter().enumerate().take(count) {
                cell.kind.corner_kind().shapes(at, &mut shapes);
                let (w, values) = (self.points.weights()[first + q], &at_points[(first + q) * components..]);
                for (&node, shape) in cell.nodes.iter().zip(&shapes) {
                    let node = node as usize;
                    weight[node] += w * shape;
                    out[node * components..][..components]
                        .iter_mut()
                        .zip(values)
                        .for_each(|(v, x)| *v += w * shape * x);
                }
            }
        }
        for (values, weight) in out.chunks_exact_mut(components).zip(&weight).filter(|(_, weight)| **weight > 0.0) {
            values.iter_mut().for_each(|value| *value /= weight);
        }
        self.interpolate_from_corners(&mut out, components);
        out
    }

    /// Nodes between corners get what the corners' shape functions give there.
    fn interpolate_from_corners(&self, nodal: &mut [f64], components: usize) {
        for id in 0..self.mesh.cells() {
            let cell = self.mesh.cell(id);
            let corners = cell.kind.corners();
            let mut shapes = vec![0.0; corners];
            for (a, &node) in cell.nodes.iter().enumerate().skip(corners) {
                cell.kind.corner_kind().shapes(&cell.kind.reference_nodes()[a], &mut shapes);
                for c in 0..components {
                    let at = |(&corner, shape): (&u32, &f64)| shape * nodal[corner as usize * components + c];
                    nodal[node as usize * components + c] = cell.nodes.iter().zip(&shapes).map(at).sum();
                }
            }
        }
    }
}
