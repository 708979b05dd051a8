//! The skew part of a matrix, on the pattern of the symmetric one.
//!
//! Blocks `W_ij`, `i >= j` in elimination order, are stored as those of the symmetric part are; `W_ji = -W_ij^T`.

use super::entries::Pattern;

/// An element matrix, entry `(i, j)` at `n i + j`, as its symmetric and its skew part.
pub(super) fn split(element: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let n = element.len().isqrt();
    let part = |sign: f64| (0..n * n).map(|at| 0.5 * (element[at] + sign * element[n * (at % n) + at / n])).collect();
    (part(1.0), part(-1.0))
}

/// Entry `(row, column)`, dofs by mesh node.
pub(super) fn entry(pattern: &Pattern, values: &[f64], row: usize, column: usize) -> f64 {
    let Some(at) = pattern.value_index(row, column) else { return 0.0 };
    let dim = pattern.dim();
    let old_to_new = pattern.ordering().old_to_new();
    let above = old_to_new[row / dim] < old_to_new[column / dim];
    if above { -values[at] } else { values[at] }
}

/// `y += sign W x`. Most of W is zero: what is not symmetric acts at few nodes.
pub(super) fn add_product(pattern: &Pattern, values: &[f64], sign: f64, x: &[f64], y: &mut [f64]) {
    match pattern.dim() {
        3 => add_product_of::<3, 9>(pattern, values, sign, x, y),
        2 => add_product_of::<2, 4>(pattern, values, sign, x, y),
        _ => {
            let dim = pattern.dim();
            let blocks = values.chunks_exact(dim * dim);
            each_block(
                pattern,
                blocks,
                |block| block.iter().all(|value| *value == 0.0),
                |block, row, column| {
                    for (at, value) in block.iter().enumerate() {
                        let (r, c) = (dim * row + at % dim, dim * column + at / dim);
                        y[r] += sign * value * x[c];
                        if row != column {
                            y[c] -= sign * value * x[r];
                        }
                    }
                },
            );
        }
    }
}

/// The same of D unknowns per node, `S = D^2`.
fn add_product_of<const D: usize, const S: usize>(
    pattern: &Pattern,
    values: &[f64],
    sign: f64,
    x: &[f64],
    y: &mut [f64],
) {
    let ((blocks, _), (x, _), (y, _)) = (values.as_chunks::<S>(), x.as_chunks::<D>(), y.as_chunks_mut::<D>());
    each_block(
        pattern,
        blocks.iter(),
        |block| *block == &[0.0; S],
        |block, row, column| {
            for c in 0..D {
                for r in 0..D {
                    let value = sign * block[D * c + r];
                    y[row][r] += value * x[column][c];
                    if row != column {
                        y[column][c] -= value * x[row][r];
                    }
                }
            }
        },
    );
}

/// Calls with every block that is not zero and its row and column, nodes of the mesh.
fn each_block<B>(
    pattern: &Pattern,
    mut blocks: impl Iterator<Item = B>,
    is_zero: impl Fn(&B) -> bool,
    mut call: impl FnMut(B, usize, usize),
) {
    let old = pattern.ordering().new_to_old();
    for (j, &column) in old.iter().enumerate() {
        for (&i, block) in pattern.column(j).1.iter().zip(blocks.by_ref()) {
            if !is_zero(&block) {
                call(block, old[i as usize] as usize, column as usize);
            }
        }
    }
}
