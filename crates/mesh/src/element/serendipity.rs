//! Quadratic serendipity shapes on [-1,1]^d, read off the reference nodes c:
//! corners 2^-d prod_d (1 + c_d x_d) (sum_d c_d x_d - (d - 1)), midside nodes 2^(1-d) (1 - x_e^2) prod_{d != e} (1 + c_d x_d).

pub(super) fn shapes<const DIM: usize>(nodes: &[[f64; 3]], xi: &[f64; 3], out: &mut [f64]) {
    let half = 1.0 / f64::from(1u32 << DIM);
    for (c, n) in nodes.iter().zip(out) {
        let sides: [f64; DIM] = std::array::from_fn(|d| 1.0 + c[d] * xi[d]);
        let product: f64 = sides.iter().product();
        *n = match middle_axis::<DIM>(c) {
            Some(e) => 2.0 * half * (1.0 - xi[e] * xi[e]) * product,
            None => half * product * bracket::<DIM>(c, xi),
        };
    }
}

pub(super) fn gradients<const DIM: usize>(nodes: &[[f64; 3]], xi: &[f64; 3], out: &mut [[f64; 3]]) {
    let half = 1.0 / f64::from(1u32 << DIM);
    for (c, g) in nodes.iter().zip(out) {
        *g = [0.0; 3];
        let but = |k: usize| -> f64 { (0..DIM).filter(|&d| d != k).map(|d| 1.0 + c[d] * xi[d]).product() };
        for (k, entry) in g.iter_mut().enumerate().take(DIM) {
            *entry = match middle_axis::<DIM>(c) {
                Some(e) if e == k => -4.0 * half * xi[e] * but(k),
                Some(e) => 2.0 * half * (1.0 - xi[e] * xi[e]) * c[k] * but(k),
                None => half * c[k] * but(k) * (bracket::<DIM>(c, xi) + 1.0 + c[k] * xi[k]),
            };
        }
    }
}

/// The axis along which a midside node sits at 0; the factor 1 + 0 x of that axis is 1 in the products above.
fn middle_axis<const DIM: usize>(c: &[f64; 3]) -> Option<usize> {
    (0..DIM).find(|&d| c[d] == 0.0)
}

fn bracket<const DIM: usize>(c: &[f64; 3], xi: &[f64; 3]) -> f64 {
    (0..DIM).map(|d| c[d] * xi[d]).sum::<f64>() - (DIM as f64 - 1.0)
}
