//! The skew part of a matrix, on the pattern of the symmetric one.
//!
//! Blocks `W_ij`, `i >= j` in elimination order, are stored as those of the symmetric part are; `W_ji = -W_ij^T`.

use super::pattern::Pattern;

/// An element matrix, entry `(i, j)` at `n i + j`, as its symmetric and its skew part.
pub(super) fn split(element: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let n = element.len().isqrt();
    let part = |sign: f64| (0..n * n).map(|at| 0.5 * (element[at] + sign * element[n * (at % n) + at / n])).collect();
    (part(1.0), part(-1.0))
}

/// Adds a skew element matrix to the blocks; `map` is that of [`Pattern::scatter_map`].
pub(super) fn scatter(dim: usize, map: &[u32], element: &[f64], values: &mut [f64]) {
    let n = element.len().isqrt();
    let (mut a, mut b) = (0, 0);
    for &code in map {
        let block = &mut values[dim * dim * (code >> 1) as usize..][..dim * dim];
        for r in 0..dim {
            for c in 0..dim {
                let value = element[n * (dim * a + r) + dim * b + c];
                if code & 1 == 0 {
                    block[dim * c + r] += value;
                } else {
                    block[dim * r + c] -= value;
                }
            }
        }
        (a, b) = if a == b { (a + 1, 0) } else { (a, b + 1) };
    }
}

/// Entry `(row, column)`, dofs by mesh node.
pub(super) fn entry(pattern: &Pattern, values: &[f64], row: usize, column: usize) -> f64 {
    let Some(at) = pattern.value_index(row, column) else { return 0.0 };
    let dim = pattern.dim();
    let old_to_new = pattern.ordering().old_to_new();
    let above = old_to_new[row / dim] < old_to_new[column / dim];
    if above { -values[at] } else { values[at] }
}

/// `y += sign W x`.
pub(super) fn add_product(pattern: &Pattern, values: &[f64], sign: f64, x: &[f64], y: &mut [f64]) {
    let dim = pattern.dim();
    let old = pattern.ordering().new_to_old();
    for (j, &column) in old.iter().enumerate() {
        let (first, rows) = pattern.column(j);
        for (k, &i) in rows.iter().enumerate() {
            let block = &values[dim * dim * (first + k)..][..dim * dim];
            let (row, column) = (dim * old[i as usize] as usize, dim * column as usize);
            for (at, value) in block.iter().enumerate() {
                let (r, c) = (at % dim, at / dim);
                y[row + r] += sign * value * x[column + c];
                if i as usize != j {
                    y[column + c] -= sign * value * x[row + r];
                }
            }
        }
    }
}
