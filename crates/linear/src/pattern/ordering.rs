//! The order in which nodes are eliminated, and the fronts in which this happens.

use super::dissection;
use super::elimination;
use super::graph::Graph;
use crate::error::StructureError;

/// A fill-reducing elimination order of the nodes, grouped into fronts.
///
/// Numbers called *new* are positions in the elimination order, *old* ones are mesh nodes.
#[derive(Clone, Debug, PartialEq)]
pub struct Ordering {
    new_to_old: Vec<u32>,
    old_to_new: Vec<u32>,
    fronts: Vec<u32>,
    heights: Vec<u32>,
    method: OrderingMethod,
    nonzeros: f64,
    work: f64,
}

/// Where an order came from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OrderingMethod {
    /// Planes through the nodes' positions, separators from the graph.
    Geometric,
    /// Multilevel nested dissection of the graph alone.
    Multilevel,
    /// Handed in.
    Given,
}

impl Ordering {
    /// The better of [`Ordering::geometric`] and [`Ordering::multilevel`] by the entries of the factor.
    ///
    /// # Errors
    /// [`StructureError::Length`] when there is not one point per node.
    pub fn best(graph: &Graph, points: &[[f64; 3]]) -> Result<Self, StructureError> {
        Ok(Self::geometric(graph, points)?.or_multilevel(graph))
    }

    /// The better of itself and [`Ordering::multilevel`] by the entries of the factor.
    #[must_use]
    pub fn or_multilevel(self, graph: &Graph) -> Self {
        let multilevel = Self::multilevel(graph);
        if multilevel.nonzeros < self.nonzeros { multilevel } else { self }
    }

    /// Geometric nested dissection; `points` are the nodes' positions (z = 0 in two dimensions).
    ///
    /// # Errors
    /// [`StructureError::Length`] when there is not one point per node.
    pub fn geometric(graph: &Graph, points: &[[f64; 3]]) -> Result<Self, StructureError> {
        if points.len() != graph.nodes() {
            let (expected, found) = (graph.nodes(), points.len());
            return Err(StructureError::Length { what: "node positions", expected, found });
        }
        Ok(Self::refined(graph, dissection::nested_dissection(graph, points), OrderingMethod::Geometric))
    }

    /// Multilevel nested dissection of the graph.
    pub fn multilevel(graph: &Graph) -> Self {
        let (starts, rows) = compressed(graph);
        let natural = || (0..graph.nodes() as u32).collect();
        let order = dissection::multilevel(&starts, &rows, graph.nodes()).unwrap_or_else(natural);
        Self::refined(graph, order, OrderingMethod::Multilevel)
    }

    /// A given elimination order: `new_to_old[k]` is the k-th node to go. Nodes are renumbered within what leaves the
    /// fill unchanged (postorder, fronts).
    ///
    /// # Errors
    /// [`StructureError::NotAPermutation`].
    pub fn given(graph: &Graph, new_to_old: &[u32]) -> Result<Self, StructureError> {
        let nodes = graph.nodes();
        let refuse = |problem: String| Err(StructureError::NotAPermutation { nodes, problem });
        if new_to_old.len() != nodes {
            return refuse(format!("it holds {} entries", new_to_old.len()));
        }
        let mut seen = vec![false; nodes];
        for &node in new_to_old {
            match seen.get_mut(node as usize) {
                None => return refuse(format!("node {node} does not exist")),
                Some(true) => return refuse(format!("node {node} occurs twice")),
                Some(first) => *first = true,
            }
        }
        Ok(Self::refined(graph, new_to_old.to_vec(), OrderingMethod::Given))
    }

    fn refined(graph: &Graph, order: Vec<u32>, method: OrderingMethod) -> Self {
        let inverse = inverted(&order);
        let tree = elimination::parents(graph, &order, &inverse);
        let order = composed(&order, &elimination::postorder(&tree));
        let inverse = inverted(&order);
        let tree = elimination::parents(graph, &order, &inverse);
        let counts = elimination::column_counts(graph, &order, &inverse, &tree);
        let fronts = elimination::fronts(&tree, &counts);
        let new_to_old = composed(&order, &fronts.order);
        Self {
            old_to_new: inverted(&new_to_old),
            new_to_old,
            fronts: fronts.starts,
            heights: fronts.heights,
            method,
            nonzeros: counts.iter().map(|&c| f64::from(c)).sum(),
            work: counts.iter().map(|&c| f64::from(c) * f64::from(c)).sum(),
        }
    }

    /// Number of nodes.
    pub fn nodes(&self) -> usize {
        self.new_to_old.len()
    }

    /// The k-th node to be eliminated, for every k.
    pub fn new_to_old(&self) -> &[u32] {
        &self.new_to_old
    }

    /// The position of every node in the elimination order.
    pub fn old_to_new(&self) -> &[u32] {
        &self.old_to_new
    }

    /// First position of each front, and the number of nodes at the end.
    pub fn fronts(&self) -> &[u32] {
        &self.fronts
    }

    /// Rows of each front in the factor, its own nodes among them.
    pub fn heights(&self) -> &[u32] {
        &self.heights
    }

    /// Where the order came from.
    pub fn method(&self) -> OrderingMethod {
        self.method
    }

    /// Node blocks in the lower triangle of the factor, diagonal included, without the zeros that merged fronts store.
    pub fn nonzeros(&self) -> f64 {
        self.nonzeros
    }

    /// Multiply-adds of the factorisation with one dof per node: the sum of the squared column counts.
    pub fn work(&self) -> f64 {
        self.work
    }
}

/// The neighbours of every node one after the other, and where each node's begin.
fn compressed(graph: &Graph) -> (Vec<i32>, Vec<i32>) {
    let mut starts = vec![0i32];
    let mut rows = Vec::with_capacity(2 * graph.edges());
    for node in 0..graph.nodes() {
        rows.extend(graph.neighbours(node).iter().map(|&other| other as i32));
        starts.push(rows.len() as i32);
    }
    (starts, rows)
}

fn inverted(order: &[u32]) -> Vec<u32> {
    let mut inverse = vec![0; order.len()];
    for (new, &old) in order.iter().enumerate() {
        inverse[old as usize] = new as u32;
    }
    inverse
}

fn composed(order: &[u32], then: &[u32]) -> Vec<u32> {
    then.iter().map(|&k| order[k as usize]).collect()
}
