//! Where the entries of a symmetric matrix with dense node blocks are stored.

use super::graph::Graph;
use super::multigrid_work::multigrid_flops;
use super::ordering::Ordering;
use crate::error::{NotCoupled, StructureError};
use std::sync::Arc;

/// Operations of a geometric order over those of multigrid, up to which no other order is tried.
const MAX_FLOPS_RATIO: f64 = 2.0;

/// The lower triangle, by node blocks, of a matrix whose nodes are numbered in elimination order.
///
/// Dofs are `dim * node + component` with mesh node numbers everywhere outside; the elimination order stays inside.
/// Block columns follow the elimination order. In column `j` stand the blocks `(i, j)`, `i >= j`, ascending in `i`, the
/// diagonal block first. A block has `dim * dim` consecutive values, column by column:
/// entry `(r, c)` of block `k` is value `dim * dim * k + dim * c + r`. Diagonal blocks are stored in full, both triangles.
#[derive(Clone, Debug)]
pub struct Pattern {
    dim: usize,
    ordering: Ordering,
    // shared by the patterns of other numbers of dofs
    starts: Arc<Vec<u32>>,
    rows: Arc<Vec<u32>>,
}

impl Pattern {
    /// The pattern of a mesh: one clique of nodes per element, `dim` dofs per node, the best of the known orderings.
    ///
    /// # Errors
    /// [`StructureError`].
    pub fn of_elements<'a>(
        points: &[[f64; 3]],
        dim: usize,
        elements: impl IntoIterator<Item = &'a [u32]>,
    ) -> Result<Self, StructureError> {
        Ok(Self::of_graph(&Graph::from_cliques(points.len(), elements)?, points, dim))
    }

    /// The pattern of a node graph with `dim` dofs per node, in the best of the known orderings; `points` are the nodes' positions
    /// (without one per node the graph alone decides). Where a factor in the geometric order takes twice the operations from which
    /// on [multigrid is taken](crate::Solver::cheaper), no better order is computed: multigrid needs none.
    pub fn of_graph(graph: &Graph, points: &[[f64; 3]], dim: usize) -> Self {
        let ordering = match Ordering::geometric(graph, points) {
            Err(_) => Ordering::multilevel(graph),
            Ok(geometric) => {
                let blocks = (graph.nodes() + graph.edges()) as f64;
                let most = MAX_FLOPS_RATIO * multigrid_flops(2.0 * blocks * (dim * dim) as f64);
                if geometric.work() * (dim * dim * dim) as f64 > most {
                    geometric
                } else {
                    geometric.or_multilevel(graph)
                }
            }
        };
        Self::laid_out(graph, dim, ordering)
    }

    /// The pattern of a node graph with `dim` dofs per node.
    ///
    /// # Errors
    /// [`StructureError::Length`] when graph and ordering differ in size.
    pub fn new(graph: &Graph, dim: usize, ordering: Ordering) -> Result<Self, StructureError> {
        let nodes = graph.nodes();
        if ordering.nodes() != nodes {
            return Err(StructureError::Length { what: "ordering", expected: nodes, found: ordering.nodes() });
        }
        Ok(Self::laid_out(graph, dim, ordering))
    }

    fn laid_out(graph: &Graph, dim: usize, ordering: Ordering) -> Self {
        let nodes = graph.nodes();
        let mut rows = Vec::with_capacity(nodes + graph.edges());
        let mut starts = Vec::with_capacity(nodes + 1);
        starts.push(0);
        for (j, &node) in ordering.new_to_old().iter().enumerate() {
            let first = rows.len();
            rows.push(j as u32);
            let neighbours = graph.neighbours(node as usize).iter();
            rows.extend(neighbours.map(|&other| ordering.old_to_new()[other as usize]).filter(|&i| i as usize > j));
            rows[first..].sort_unstable();
            starts.push(rows.len() as u32);
        }
        Self { dim, ordering, starts: Arc::new(starts), rows: Arc::new(rows) }
    }

    /// The same nodes in the same order, with another number of dofs each.
    #[must_use]
    pub fn with_dim(&self, dim: usize) -> Self {
        Self { dim, ..self.clone() }
    }

    /// Every coupled pair of nodes, once, by their numbers in the mesh; every node with itself first.
    pub fn pairs(&self) -> Vec<[u32; 2]> {
        let old = self.ordering.new_to_old();
        let of_column = |j: usize| self.column(j).1.iter().map(move |&i| [old[j], old[i as usize]]);
        (0..self.nodes()).flat_map(of_column).collect()
    }

    /// Dofs per node.
    pub fn dim(&self) -> usize {
        self.dim
    }

    /// Number of nodes.
    pub fn nodes(&self) -> usize {
        self.ordering.nodes()
    }

    /// Number of rows: `dim` per node.
    pub fn dofs(&self) -> usize {
        self.dim * self.nodes()
    }

    /// Number of stored values.
    pub fn values(&self) -> usize {
        self.dim * self.dim * self.rows.len()
    }

    /// The elimination order.
    pub fn ordering(&self) -> &Ordering {
        &self.ordering
    }

    /// Blocks of block column `j` (in elimination order): the number of the first one, and the row of each.
    pub fn column(&self, j: usize) -> (usize, &[u32]) {
        let (first, last) = (self.starts[j] as usize, self.starts[j + 1] as usize);
        (first, &self.rows[first..last])
    }

    /// Where the node blocks of an element matrix go.
    ///
    /// One code for every pair `a >= b` of the element's nodes, at `a * (a + 1) / 2 + b`: twice the number of the block,
    /// plus 1 if the block is stored transposed, that is, if the stored block is `K_ba` and not `K_ab`.
    ///
    /// # Errors
    /// [`NotCoupled`] when two of the nodes share no element of the pattern.
    pub fn scatter_map(&self, nodes: &[u32]) -> Result<Vec<u32>, NotCoupled> {
        let mut map = Vec::with_capacity(nodes.len() * (nodes.len() + 1) / 2);
        for (a, &node) in nodes.iter().enumerate() {
            for &other in &nodes[..=a] {
                map.push(self.block_code(node, other)?);
            }
        }
        Ok(map)
    }

    pub(crate) fn block_code(&self, a: u32, b: u32) -> Result<u32, NotCoupled> {
        let new = |node: u32| self.ordering.old_to_new().get(node as usize).copied();
        let (Some(row), Some(column)) = (new(a), new(b)) else { return Err(NotCoupled { a, b }) };
        let transposed = row < column;
        let (row, column) = (row.max(column), row.min(column));
        let (first, rows) = self.column(column as usize);
        let at = rows.binary_search(&row).map_err(|_| NotCoupled { a, b })?;
        Ok(2 * (first + at) as u32 + u32::from(transposed))
    }

    /// Adds an element matrix to the values of a matrix.
    ///
    /// `map` is the element's [`Pattern::scatter_map`]. `element` is its symmetric matrix of `n = dim * nodes` dofs
    /// (`dim * local node + component`), entry `(i, j)` at `n * i + j`; entries whose column node comes after their row
    /// node are not read, diagonal node blocks are read in full.
    pub fn scatter(&self, map: &[u32], element: &[f64], values: &mut [f64]) {
        match self.dim {
            3 => scatter_blocks::<3>(map, element, values),
            2 => scatter_blocks::<2>(map, element, values),
            1 => scatter_blocks::<1>(map, element, values),
            dim => scatter_among(dim, &(0..dim).collect::<Vec<_>>(), map, element, values, 1.0),
        }
    }

    /// Position of entry `(row, column)` among the values, dofs by mesh node, either triangle; nothing outside the pattern.
    pub fn value_index(&self, row: usize, column: usize) -> Option<usize> {
        let code = self.block_code((row / self.dim) as u32, (column / self.dim) as u32).ok()?;
        let (r, c) = (row % self.dim, column % self.dim);
        let (r, c) = if code & 1 == 1 { (c, r) } else { (r, c) };
        Some(self.dim * self.dim * (code >> 1) as usize + self.dim * c + r)
    }
}

fn scatter_blocks<const D: usize>(map: &[u32], element: &[f64], values: &mut [f64]) {
    let (blocks, _) = values.as_chunks_mut::<D>();
    let (mut a, mut b) = (0, 0);
    let n = D * element_nodes(map);
    for &code in map {
        let first = D * (code >> 1) as usize;
        let block = &mut blocks[first..first + D];
        for r in 0..D {
            let row = &element[n * (D * a + r) + D * b..][..D];
            for c in 0..D {
                if code & 1 == 0 {
                    block[c][r] += row[c];
                } else {
                    block[r][c] += row[c];
                }
            }
        }
        (a, b) = if a == b { (a + 1, 0) } else { (a, b + 1) };
    }
}

/// Of an element matrix over some components of every node, whose places in a node's block of `dim` are given; blocks of the other triangle come with a sign.
pub(super) fn scatter_among(
    dim: usize,
    components: &[usize],
    map: &[u32],
    element: &[f64],
    values: &mut [f64],
    mirrored: f64,
) {
    let (mut a, mut b) = (0, 0);
    let own = components.len();
    let n = own * element_nodes(map);
    for &code in map {
        let block = &mut values[dim * dim * (code >> 1) as usize..][..dim * dim];
        for (r, row) in components.iter().enumerate() {
            for (c, column) in components.iter().enumerate() {
                let value = element[n * (own * a + r) + own * b + c];
                match code & 1 {
                    0 => block[dim * column + row] += value,
                    _ => block[dim * row + column] += mirrored * value,
                }
            }
        }
        (a, b) = if a == b { (a + 1, 0) } else { (a, b + 1) };
    }
}

/// Inverse of `nodes * (nodes + 1) / 2`.
fn element_nodes(map: &[u32]) -> usize {
    ((2.0 * map.len() as f64 + 0.25).sqrt() - 0.5).round() as usize
}
