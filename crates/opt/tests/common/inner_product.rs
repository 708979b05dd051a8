//! The contract of every inner product.

use nastic_opt::InnerProduct;

/// Vectors of all signs and sizes, different for every seed.
pub fn vector(len: usize, seed: u64) -> Vec<f64> {
    let mut random = nastic_numeric::Random::new(seed);
    (0..len).map(|_| random.symmetric()).collect()
}

/// (a, b) is bilinear, symmetric and positive; `riesz` is the inverse of `apply`; norms and dual norms belong to it.
pub fn keeps_its_contract(product: &dyn InnerProduct, what: &str) {
    let len = product.len();
    assert!(len > 1 && !product.is_empty(), "{what}");
    for seed in 1..6 {
        let (a, b) = (vector(len, seed), vector(len, seed + 100));
        let close = |x: f64, y: f64, name: &str| {
            let size = product.norm(&a) * product.norm(&b);
            assert!((x - y).abs() <= 1e-12 * size.max(x.abs()).max(y.abs()), "{what}: {name}: {x:e} and {y:e}");
        };
        let dual: f64 = product.apply(&a).iter().zip(&b).map(|(x, y)| x * y).sum();
        close(product.inner(&a, &b), dual, "(a, b) = a . G b");
        close(product.inner(&a, &b), product.inner(&b, &a), "symmetric");
        let sum: Vec<f64> = a.iter().zip(&b).map(|(a, b)| a - 2.0 * b).collect();
        close(product.inner(&sum, &b), product.inner(&a, &b) - 2.0 * product.inner(&b, &b), "linear");
        assert!(product.inner(&a, &a) > 0.0, "{what}: positive");
        close(product.norm(&a).powi(2), product.inner(&a, &a), "norm");
        let derivative = product.apply(&a);
        let back = product.riesz(&derivative);
        let off = a.iter().zip(&back).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(off < 1e-11, "{what}: riesz is not the inverse of apply: {off:e}");
        close(product.dual_norm(&derivative), product.norm(&a), "dual norm");
        if let Some(weights) = product.lumped() {
            let own: Vec<f64> = a.iter().zip(weights).map(|(a, w)| a * w).collect();
            assert_eq!(own, derivative, "{what}: lumped");
        }
    }
}
