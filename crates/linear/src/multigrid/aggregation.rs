//! Aggregates: groups of strongly coupled nodes that become one node of the next level.

use super::block_matrix::BlockMatrix;
use super::chunks;
use super::couplings::{BlockRows, Couplings};

/// A coupling is strong where `|A_ij|^2 > STRENGTH_THRESHOLD^2 |A_ii| |A_jj|` (Frobenius norms of the blocks).
const STRENGTH_THRESHOLD: f64 = 0.02;
/// Marks a node that belongs to no aggregate: nothing couples it to others, the smoother is enough for it.
pub(super) const NO_AGGREGATE: u32 = u32::MAX;

/// The aggregates of the nodes of a level.
#[derive(Debug)]
pub(super) struct Aggregates {
    /// By node.
    pub of_node: Vec<u32>,
    /// The nodes of every aggregate, ascending.
    pub members: BlockRows,
}

impl Aggregates {
    /// Whole neighbourhoods first, in the order of the nodes; what is left over joins the aggregate it is coupled with most
    /// strongly, and makes up aggregates of its own at last. Vanek, Mandel, Brezina, Computing 56 (1996), algorithm 5.1.
    pub fn new(matrix: &BlockMatrix, strength: &Strength) -> Self {
        let couplings = &*matrix.couplings;
        let (nodes, strong) = (couplings.rows.rows(), |i: usize| strength.strong(couplings, i));
        let mut of_node = vec![NO_AGGREGATE; nodes];
        let mut count = 0u32;
        for i in 0..nodes {
            let free = |j: u32| of_node[j as usize] == NO_AGGREGATE;
            if free(i as u32) && strong(i).next().is_some() && strong(i).all(|(j, _)| free(j)) {
                of_node[i] = count;
                strong(i).for_each(|(j, _)| of_node[j as usize] = count);
                count += 1;
            }
        }
        let whole = of_node.clone();
        let scale = |i: usize| couplings.rows.position(i, i as u32).map_or(0.0, |at| matrix.square(at).sqrt());
        for i in (0..nodes).filter(|&i| whole[i] == NO_AGGREGATE) {
            let own = scale(i);
            let joined = strong(i).filter(|&(j, _)| whole[j as usize] != NO_AGGREGATE);
            let weighed = joined.map(|(j, at)| (j, matrix.square(at) / (own * scale(j as usize))));
            if let Some((j, _)) = weighed.reduce(|best, next| if next.1 > best.1 { next } else { best }) {
                of_node[i] = whole[j as usize];
            }
        }
        let coupled = |i: usize| {
            let mut row = couplings.rows.row(i);
            row.any(|at| couplings.rows.columns[at] as usize != i && matrix.square(at) > 0.0)
        };
        for i in 0..nodes {
            if of_node[i] == NO_AGGREGATE && coupled(i) {
                of_node[i] = count;
                for (j, _) in strong(i) {
                    if of_node[j as usize] == NO_AGGREGATE {
                        of_node[j as usize] = count;
                    }
                }
                count += 1;
            }
        }
        let members = members(&of_node, count as usize);
        Aggregates { of_node, members }
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.members.rows()
    }
}

fn members(of_node: &[u32], count: usize) -> BlockRows {
    let mut starts = vec![0; count + 1];
    let grouped = || of_node.iter().enumerate().filter(|&(_, &aggregate)| aggregate != NO_AGGREGATE);
    grouped().for_each(|(_, &aggregate)| starts[aggregate as usize + 1] += 1);
    (0..count).for_each(|a| starts[a + 1] += starts[a]);
    let (mut next, mut columns) = (starts.clone(), vec![0; starts[count]]);
    for (node, &aggregate) in grouped() {
        let at = &mut next[aggregate as usize];
        columns[*at] = node as u32;
        *at += 1;
    }
    BlockRows { block_columns: of_node.len(), starts, columns }
}

/// Which couplings of a matrix are strong.
#[derive(Debug)]
pub(super) struct Strength {
    pub strong: Vec<bool>,
}

impl Strength {
    pub fn of(matrix: &BlockMatrix, parallel: bool) -> Self {
        let (rows, scales) = (&matrix.couplings.rows, scales(matrix, parallel));
        let mut strong = vec![false; rows.columns.len()];
        chunks::each(rows.cut(&mut strong, 1), parallel, |k, part| {
            let mut marks = part.iter_mut();
            for i in chunks::CHUNK * k..(chunks::CHUNK * (k + 1)).min(rows.rows()) {
                rows.row(i).zip(&mut marks).for_each(|(at, mark)| *mark = is_strong(matrix, &scales, i, at));
            }
        });
        Strength { strong }
    }

    /// The share of couplings that are weak now and were strong, or the reverse.
    pub fn changed(&self, now: &BlockMatrix, parallel: bool) -> f64 {
        let (rows, scales) = (&now.couplings.rows, scales(now, parallel));
        let of_row = |i: usize| rows.row(i).filter(|&at| is_strong(now, &scales, i, at) != self.strong[at]).count();
        let changed: usize = chunks::map(rows.rows(), parallel, |range| range.map(of_row).sum::<usize>()).iter().sum();
        changed as f64 / rows.columns.len().max(1) as f64
    }

    /// The nodes strongly coupled with node `i`, and the number of the block.
    fn strong<'a>(&'a self, couplings: &'a Couplings, i: usize) -> impl Iterator<Item = (u32, usize)> + 'a {
        let strong = couplings.rows.row(i).filter(|&at| self.strong[at]);
        strong.map(|at| (couplings.rows.columns[at], at))
    }
}

fn is_strong(matrix: &BlockMatrix, scales: &[f64], i: usize, at: usize) -> bool {
    let j = matrix.couplings.rows.columns[at] as usize;
    j != i && matrix.square(at) > STRENGTH_THRESHOLD * STRENGTH_THRESHOLD * scales[i] * scales[j]
}

/// `|A_ii|` of every node.
fn scales(matrix: &BlockMatrix, parallel: bool) -> Vec<f64> {
    let rows = &matrix.couplings.rows;
    let scale = |i: usize| rows.position(i, i as u32).map_or(0.0, |at| matrix.square(at).sqrt());
    chunks::map(rows.rows(), parallel, |range| range.map(scale).collect::<Vec<f64>>()).concat()
}
