//! Aggregates: groups of strongly coupled nodes that become one node of the next level.

use super::block_matrix::BlockMatrix;

/// A coupling is strong where `|A_ij|^2 > STRONG^2 |A_ii| |A_jj|` (Frobenius norms of the blocks).
const STRONG: f64 = 0.02;
/// Marks a node that belongs to no aggregate: nothing couples it to others, the smoother is enough for it.
pub(super) const ALONE: u32 = u32::MAX;

/// The aggregate of every node, and their number.
///
/// Whole neighbourhoods first, in the order of the nodes; what is left over joins the aggregate it is coupled with most
/// strongly, and makes up aggregates of its own at last. Vanek, Mandel, Brezina, Computing 56 (1996), algorithm 5.1.
pub(super) fn aggregates(matrix: &BlockMatrix<f64>) -> (Vec<u32>, usize) {
    let strength = Strength::new(matrix);
    let mut of_node = vec![ALONE; matrix.rows()];
    let mut count = 0u32;
    for i in 0..matrix.rows() {
        let free = |j: u32| of_node[j as usize] == ALONE;
        if free(i as u32) && strength.strong(i).next().is_some() && strength.strong(i).all(|(j, _)| free(j)) {
            of_node[i] = count;
            strength.strong(i).for_each(|(j, _)| of_node[j as usize] = count);
            count += 1;
        }
    }
    let whole = of_node.clone();
    for i in (0..matrix.rows()).filter(|&i| whole[i] == ALONE) {
        let joined = strength.strong(i).filter(|&(j, _)| whole[j as usize] != ALONE);
        if let Some((j, _)) = joined.reduce(|best, next| if next.1 > best.1 { next } else { best }) {
            of_node[i] = whole[j as usize];
        }
    }
    for i in 0..matrix.rows() {
        if of_node[i] == ALONE && strength.coupled(i) {
            of_node[i] = count;
            for (j, _) in strength.strong(i) {
                if of_node[j as usize] == ALONE {
                    of_node[j as usize] = count;
                }
            }
            count += 1;
        }
    }
    (of_node, count as usize)
}

struct Strength<'a> {
    matrix: &'a BlockMatrix<f64>,
    /// `|A_ij|^2` of every block.
    squares: Vec<f64>,
    diagonal: Vec<f64>,
}

impl<'a> Strength<'a> {
    fn new(matrix: &'a BlockMatrix<f64>) -> Self {
        let square = |k: usize| matrix.block(k).iter().map(|value| value * value).sum::<f64>();
        let squares = (0..matrix.columns.len()).map(square).collect();
        let diagonal = |i| matrix.diagonal_block(i).map_or(0.0, |d| d.iter().map(|v| v * v).sum::<f64>().sqrt());
        Strength { matrix, squares, diagonal: (0..matrix.rows()).map(diagonal).collect() }
    }

    /// The nodes strongly coupled with node `i`, and how strongly.
    fn strong(&self, i: usize) -> impl Iterator<Item = (u32, f64)> {
        self.matrix.row(i).filter_map(move |k| {
            let j = self.matrix.columns[k];
            let scale = self.diagonal[i] * self.diagonal[j as usize];
            let strong = j as usize != i && self.squares[k] > STRONG * STRONG * scale;
            strong.then(|| (j, self.squares[k] / scale))
        })
    }

    fn coupled(&self, i: usize) -> bool {
        self.matrix.row(i).any(|k| self.matrix.columns[k] as usize != i && self.squares[k] > 0.0)
    }
}
