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

/// The blocks of W that are not zero: few, since what is not symmetric acts at few nodes.
pub(super) struct SkewBlocks {
    /// Number of the block, with its row and column, nodes of the mesh.
    blocks: Vec<[u32; 3]>,
}

impl SkewBlocks {
    pub fn of(pattern: &Pattern, values: &[f64]) -> Self {
        let (old, size) = (pattern.ordering().new_to_old(), pattern.dim() * pattern.dim());
        let columns = old
            .iter()
            .enumerate()
            .flat_map(|(j, &column)| pattern.column(j).1.iter().map(move |&i| [old[i as usize], column]));
        let stored = values.chunks_exact(size).zip(columns).zip(0..);
        let is_zero = |block: &[f64]| block.iter().all(|value| *value == 0.0);
        let blocks = stored.filter(|((block, _), _)| !is_zero(block)).map(|((_, [i, j]), at)| [at, i, j]).collect();
        SkewBlocks { blocks }
    }

    /// `y += sign W x`
    pub fn add_product(&self, dim: usize, values: &[f64], sign: f64, x: &[f64], y: &mut [f64]) {
        match dim {
            3 => self.add_product_of::<3, 9>(values, sign, x, y),
            2 => self.add_product_of::<2, 4>(values, sign, x, y),
            _ => self.add_product_of_any(dim, values, sign, x, y),
        }
    }

    /// The same of D unknowns per node, `S = D^2`.
    fn add_product_of<const D: usize, const S: usize>(&self, values: &[f64], sign: f64, x: &[f64], y: &mut [f64]) {
        let ((values, _), (x, _), (y, _)) = (values.as_chunks::<S>(), x.as_chunks::<D>(), y.as_chunks_mut::<D>());
        for [at, row, column] in self.blocks.iter().map(|block| block.map(|number| number as usize)) {
            let block = &values[at];
            for c in 0..D {
                for r in 0..D {
                    let value = sign * block[D * c + r];
                    y[row][r] += value * x[column][c];
                    if row != column {
                        y[column][c] -= value * x[row][r];
                    }
                }
            }
        }
    }

    fn add_product_of_any(&self, dim: usize, values: &[f64], sign: f64, x: &[f64], y: &mut [f64]) {
        for [at, row, column] in self.blocks.iter().map(|block| block.map(|number| number as usize)) {
            for (at, value) in values[dim * dim * at..][..dim * dim].iter().enumerate() {
                let (r, c) = (dim * row + at % dim, dim * column + at / dim);
                y[r] += sign * value * x[c];
                if row != column {
                    y[c] -= sign * value * x[r];
                }
            }
        }
    }
}
