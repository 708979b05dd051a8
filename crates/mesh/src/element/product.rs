//! Tensor-product Lagrange shapes on [-1,1]^d. A node at -1, 0, 1 reads entry 0, 1, 2 of a one-dimensional basis.

type Basis = fn(f64) -> ([f64; 3], [f64; 3]);

/// Values and slopes of (1 - x)/2 and (1 + x)/2; there is no node at 0.
pub(super) fn linear(x: f64) -> ([f64; 3], [f64; 3]) {
    ([0.5 * (1.0 - x), 0.0, 0.5 * (1.0 + x)], [-0.5, 0.0, 0.5])
}

/// Values and slopes of the Lagrange polynomials on -1, 0, 1.
pub(super) fn quadratic(x: f64) -> ([f64; 3], [f64; 3]) {
    ([0.5 * x * (x - 1.0), 1.0 - x * x, 0.5 * x * (x + 1.0)], [x - 0.5, -2.0 * x, x + 0.5])
}

/// N_a = prod_d l_{a,d}(xi_d).
pub(super) fn shapes<const DIM: usize>(nodes: &[[f64; 3]], basis: Basis, xi: &[f64; 3], out: &mut [f64]) {
    let axes: [_; DIM] = std::array::from_fn(|d| basis(xi[d]).0);
    for (node, n) in nodes.iter().zip(out) {
        *n = (0..DIM).map(|d| axes[d][entry(node[d])]).product();
    }
}

/// dN_a/dxi_k = l'_{a,k}(xi_k) prod_{d != k} l_{a,d}(xi_d).
pub(super) fn gradients<const DIM: usize>(nodes: &[[f64; 3]], basis: Basis, xi: &[f64; 3], out: &mut [[f64; 3]]) {
    let axes: [_; DIM] = std::array::from_fn(|d| basis(xi[d]));
    for (node, g) in nodes.iter().zip(out) {
        *g = [0.0; 3];
        for (k, slope) in g.iter_mut().enumerate().take(DIM) {
            *slope =
                (0..DIM).map(|d| if d == k { axes[d].1[entry(node[d])] } else { axes[d].0[entry(node[d])] }).product();
        }
    }
}

fn entry(node: f64) -> usize {
    (node + 1.0) as usize
}
