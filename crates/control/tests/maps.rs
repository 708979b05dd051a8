//! The contract of every kind of control map.

use nastic_control::MAPS;
use nastic_fem::Discretization;
use nastic_mesh::{CellKind, box_mesh};
use std::sync::Arc;

type Outcome<T = ()> = Result<T, Box<dyn std::error::Error>>;

fn vector(len: usize, seed: f64) -> Vec<f64> {
    (0..len).map(|i| (seed + 2.1 * i as f64).cos()).collect()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// The derivative at 0 of a curve, of fourth order.
fn slope(curve: impl Fn(f64) -> Vec<f64>) -> Vec<f64> {
    let h = 1e-3;
    let at = [-2.0, -1.0, 1.0, 2.0].map(|k| curve(k * h));
    (0..at[0].len()).map(|i| (at[0][i] - 8.0 * at[1][i] + 8.0 * at[2][i] - at[3][i]) / (12.0 * h)).collect()
}

fn near(found: &[f64], expected: &[f64], what: &str) {
    assert_eq!(found.len(), expected.len(), "{what}");
    let size = expected.iter().chain(found).fold(1e-3f64, |size, x| size.max(x.abs()));
    for (found, expected) in found.iter().zip(expected) {
        assert!((found - expected).abs() < 1e-8 * size, "{what}: {found:e}, expected {expected:e}");
    }
}

#[test]
fn every_map_keeps_its_contract() -> Outcome {
    let disc = Discretization::new(Arc::new(box_mesh([1.0, 0.2, 0.2], [2, 1, 1], CellKind::Hex8)?))?;
    for row in MAPS {
        let (map, x) = (row.example)(&disc)?;
        let y = map.values(&x);
        assert_eq!(y, map.values(&x), "{}", row.name);
        assert!(!map.describe().is_empty() && !row.about.is_empty());
        let (v, g) = (vector(x.len(), 0.4), vector(y.len(), 1.9));
        let along = |t: f64| x.iter().zip(&v).map(|(x, v)| x + t * v).collect::<Vec<_>>();
        let change = map.change(&x, &v);
        near(&change, &slope(|t| map.values(&along(t))), &format!("{}: change", row.name));
        let back = map.vjp(&x, &g);
        let (left, right) = (dot(&change, &g), dot(&back, &v));
        assert!((left - right).abs() < 1e-12 * left.abs().max(1.0), "{}: {left:e} and {right:e}", row.name);
        let second = map.second_vjp(&x, &v, &g);
        assert_eq!(second.is_none(), map.is_affine(), "{}", row.name);
        let second = second.unwrap_or_else(|| vec![0.0; x.len()]);
        near(&second, &slope(|t| map.vjp(&along(t), &g)), &format!("{}: second vjp", row.name));
        if let Some(length) = map.length() {
            let size = |v: &[f64]| dot(v, v).sqrt();
            assert!(y.chunks(3).all(|v| (size(v) - length).abs() < 1e-14), "{}", row.name);
        }
    }
    Ok(())
}
