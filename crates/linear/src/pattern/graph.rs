//! The graph whose vertices are mesh nodes and whose edges join nodes that share an element.

use crate::error::{NotCoupled, StructureError};

/// Adjacency of mesh nodes: symmetric, without loops, neighbours ascending.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Graph {
    starts: Vec<usize>,
    neighbours: Vec<u32>,
}

impl Graph {
    /// The union of one clique per element: every node of an element is coupled with every other one.
    ///
    /// # Errors
    /// [`StructureError::NodeOutOfRange`] when an element names a node `>= nodes`, [`StructureError::TooLarge`] for more pairs than 32
    /// bits can number.
    pub fn from_cliques<'a>(
        nodes: usize,
        cliques: impl IntoIterator<Item = &'a [u32]>,
    ) -> Result<Self, StructureError> {
        if nodes > i32::MAX as usize {
            return Err(StructureError::TooLarge { what: "nodes", count: nodes as u64 });
        }
        let (element_starts, element_nodes) = checked_elements(nodes, cliques)?;
        let (incident_starts, incident) = transpose(nodes, &element_starts, &element_nodes);
        let mut graph = Self { starts: Vec::with_capacity(nodes + 1), neighbours: Vec::new() };
        graph.starts.push(0);
        let mut seen_by = vec![u32::MAX; nodes];
        for node in 0..nodes {
            seen_by[node] = node as u32;
            let first = graph.neighbours.len();
            for &e in &incident[incident_starts[node]..incident_starts[node + 1]] {
                for &other in &element_nodes[element_starts[e as usize]..element_starts[e as usize + 1]] {
                    if seen_by[other as usize] != node as u32 {
                        seen_by[other as usize] = node as u32;
                        graph.neighbours.push(other);
                    }
                }
            }
            graph.neighbours[first..].sort_unstable();
            graph.starts.push(graph.neighbours.len());
        }
        graph.neighbours.shrink_to_fit();
        let blocks = nodes + graph.edges();
        if blocks > (u32::MAX / 2) as usize {
            return Err(StructureError::TooLarge { what: "matrix blocks", count: blocks as u64 });
        }
        Ok(graph)
    }

    /// Number of nodes.
    pub fn nodes(&self) -> usize {
        self.starts.len() - 1
    }

    /// Number of edges, each counted once.
    pub fn edges(&self) -> usize {
        self.neighbours.len() / 2
    }

    /// Whether all of some nodes are coupled with each other.
    ///
    /// # Errors
    /// [`NotCoupled`] names two that are not.
    pub fn check_coupled(&self, nodes: &[u32]) -> Result<(), NotCoupled> {
        let known = |node: u32| (node as usize) < self.nodes();
        let pair = |a: u32, b: u32| a == b || self.neighbours(a as usize).binary_search(&b).is_ok();
        for (k, &a) in nodes.iter().enumerate() {
            if let Some(&b) = nodes[..=k].iter().find(|&&b| !(known(a) && known(b) && pair(a, b))) {
                return Err(NotCoupled { a, b });
            }
        }
        Ok(())
    }

    /// The nodes coupled with `node`, ascending, without `node` itself.
    pub fn neighbours(&self, node: usize) -> &[u32] {
        &self.neighbours[self.starts[node]..self.starts[node + 1]]
    }
}

fn checked_elements<'a>(
    nodes: usize,
    cliques: impl IntoIterator<Item = &'a [u32]>,
) -> Result<(Vec<usize>, Vec<u32>), StructureError> {
    let (mut starts, mut flat) = (vec![0], Vec::new());
    for (element, clique) in cliques.into_iter().enumerate() {
        if let Some(&node) = clique.iter().find(|&&node| node as usize >= nodes) {
            return Err(StructureError::NodeOutOfRange { element, node, nodes });
        }
        flat.extend_from_slice(clique);
        starts.push(flat.len());
    }
    Ok((starts, flat))
}

/// Elements at each node, ascending.
fn transpose(nodes: usize, element_starts: &[usize], element_nodes: &[u32]) -> (Vec<usize>, Vec<u32>) {
    let mut starts = vec![0; nodes + 1];
    for &node in element_nodes {
        starts[node as usize + 1] += 1;
    }
    for node in 0..nodes {
        starts[node + 1] += starts[node];
    }
    let mut next = starts.clone();
    let mut incident = vec![0; element_nodes.len()];
    for (element, range) in element_starts.windows(2).enumerate() {
        for &node in &element_nodes[range[0]..range[1]] {
            incident[next[node as usize]] = element as u32;
            next[node as usize] += 1;
        }
    }
    (starts, incident)
}
