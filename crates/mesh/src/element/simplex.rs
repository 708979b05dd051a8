//! Shapes on the unit simplex through barycentric coordinates L_0 = 1 - sum xi, L_k = xi_{k-1}.

fn barycentric(dim: usize, xi: &[f64; 3]) -> [f64; 4] {
    let mut l = [0.0; 4];
    l[0] = 1.0 - xi[..dim].iter().sum::<f64>();
    l[1..=dim].copy_from_slice(&xi[..dim]);
    l
}

/// dL_a/dxi_k.
fn slope(a: usize, k: usize) -> f64 {
    match a {
        0 => -1.0,
        _ if a == k + 1 => 1.0,
        _ => 0.0,
    }
}

pub(super) fn linear_shapes(dim: usize, xi: &[f64; 3], out: &mut [f64]) {
    for (n, l) in out.iter_mut().zip(&barycentric(dim, xi)[..=dim]) {
        *n = *l;
    }
}

pub(super) fn linear_gradients(dim: usize, out: &mut [[f64; 3]]) {
    for (a, g) in out.iter_mut().enumerate().take(dim + 1) {
        *g = std::array::from_fn(|k| if k < dim { slope(a, k) } else { 0.0 });
    }
}

/// Corners L(2L - 1), midside nodes 4 L_i L_j.
pub(super) fn quadratic_shapes(dim: usize, edges: &[[usize; 2]], xi: &[f64; 3], out: &mut [f64]) {
    let l = barycentric(dim, xi);
    let corners = l[..=dim].iter().map(|l| l * (2.0 * l - 1.0));
    let middles = edges.iter().map(|&[i, j]| 4.0 * l[i] * l[j]);
    for (n, value) in out.iter_mut().zip(corners.chain(middles)) {
        *n = value;
    }
}

pub(super) fn quadratic_gradients(dim: usize, edges: &[[usize; 2]], xi: &[f64; 3], out: &mut [[f64; 3]]) {
    let l = barycentric(dim, xi);
    let corner = |a: usize, k: usize| (4.0 * l[a] - 1.0) * slope(a, k);
    let middle = |[i, j]: [usize; 2], k: usize| 4.0 * (l[i] * slope(j, k) + l[j] * slope(i, k));
    for (a, g) in out.iter_mut().enumerate() {
        *g = [0.0; 3];
        for (k, entry) in g.iter_mut().enumerate().take(dim) {
            *entry = if a <= dim { corner(a, k) } else { middle(edges[a - dim - 1], k) };
        }
    }
}
