//! Elimination trees on the node graph: parents, postorder, column counts, fronts.
//!
//! Everything here counts nodes, not dofs: a node's dofs are eliminated together, so the scalar structure is the node
//! structure with every entry replaced by a dense block. Liu, "The role of elimination trees in sparse factorization",
//! SIAM J. Matrix Anal. Appl. 11 (1990).

use super::graph::Graph;

/// Marks a root of the elimination forest.
pub(crate) const ROOT: u32 = u32::MAX;

/// Parents in the elimination tree of the graph eliminated in the order `new_to_old` (numbers are new ones).
pub(super) fn parents(graph: &Graph, new_to_old: &[u32], old_to_new: &[u32]) -> Vec<u32> {
    let mut parent = vec![ROOT; new_to_old.len()];
    let mut ancestor = parent.clone();
    for (j, &old) in new_to_old.iter().enumerate() {
        for &neighbour in graph.neighbours(old as usize) {
            let mut i = old_to_new[neighbour as usize] as usize;
            while i < j {
                let next = std::mem::replace(&mut ancestor[i], j as u32);
                if next == ROOT {
                    parent[i] = j as u32;
                }
                if next == j as u32 || next == ROOT {
                    break;
                }
                i = next as usize;
            }
        }
    }
    parent
}

/// Depth-first postorder of a forest, children in ascending order: `post[k]` is the k-th vertex.
pub(super) fn postorder(parent: &[u32]) -> Vec<u32> {
    let n = parent.len();
    let (mut first_child, mut next_sibling) = (vec![ROOT; n], vec![ROOT; n]);
    let mut roots = Vec::new();
    for j in (0..n).rev() {
        if parent[j] == ROOT {
            roots.push(j as u32);
        } else {
            next_sibling[j] = std::mem::replace(&mut first_child[parent[j] as usize], j as u32);
        }
    }
    let mut post = Vec::with_capacity(n);
    let mut stack = Vec::new();
    while let Some(root) = roots.pop() {
        stack.push(root);
        while let Some(&j) = stack.last() {
            let child = std::mem::replace(&mut first_child[j as usize], ROOT);
            if child == ROOT {
                post.push(j);
                stack.pop();
                if next_sibling[j as usize] != ROOT && !stack.is_empty() {
                    stack.push(next_sibling[j as usize]);
                }
            } else {
                stack.push(child);
            }
        }
    }
    post
}

/// Number of nodes in each column of the factor, the diagonal included, by walking the row subtrees.
pub(super) fn column_counts(graph: &Graph, new_to_old: &[u32], old_to_new: &[u32], parent: &[u32]) -> Vec<u32> {
    let n = new_to_old.len();
    let mut counts = vec![1; n];
    let mut seen_by = vec![ROOT; n];
    for i in 0..n {
        seen_by[i] = i as u32;
        for &neighbour in graph.neighbours(new_to_old[i] as usize) {
            let mut j = old_to_new[neighbour as usize] as usize;
            while j < i && seen_by[j] != i as u32 {
                seen_by[j] = i as u32;
                counts[j] += 1;
                j = parent[j] as usize;
            }
        }
    }
    counts
}

/// A partition of the columns into fronts: sets of columns that are eliminated together as one dense block.
pub(super) struct Fronts {
    /// Elimination order of the columns that makes every front contiguous: `order[k]` is a column of the input.
    pub order: Vec<u32>,
    /// First column of each front in that order, and the number of columns at the end.
    pub starts: Vec<u32>,
    /// Rows of each front, its own columns among them.
    pub heights: Vec<u32>,
}

/// Fundamental fronts, merged with their parents while the explicit zeros that this stores stay few.
///
/// `parent` and `counts` must be postordered. A front of `w` columns with `h` rows merged into a parent of `W` columns
/// and `H` rows has `w + W` columns and `w + H` rows. Small fronts are merged generously: dense kernels only pay on wide ones.
pub(super) fn fronts(parent: &[u32], counts: &[u32]) -> Fronts {
    let mut merging = Merging::fundamental(parent, counts);
    merging.merge_children();
    merging.finish()
}

struct Merging {
    /// First and one-past-last column of each fundamental front.
    columns: Vec<(u32, u32)>,
    parent: Vec<u32>,
    /// Columns and rows of each (merged) front, and the zeros it stores in its trapezoid.
    width: Vec<u64>,
    height: Vec<u64>,
    zeros: Vec<u64>,
    /// Front that swallowed this one, if any.
    into: Vec<u32>,
}

impl Merging {
    fn fundamental(parent: &[u32], counts: &[u32]) -> Self {
        let n = parent.len();
        let mut children = vec![0u32; n];
        for &p in parent.iter().filter(|&&p| p != ROOT) {
            children[p as usize] += 1;
        }
        let mut columns: Vec<(u32, u32)> = Vec::new();
        let mut front_of = vec![0; n];
        for j in 0..n {
            let chained = j > 0 && parent[j - 1] == j as u32 && children[j] == 1 && counts[j - 1] == counts[j] + 1;
            match columns.last_mut() {
                Some(last) if chained => last.1 += 1,
                _ => columns.push((j as u32, j as u32 + 1)),
            }
            front_of[j] = columns.len() as u32 - 1;
        }
        let parents = columns.iter().map(|c| parent[c.1 as usize - 1]);
        Self {
            parent: parents.map(|p| if p == ROOT { ROOT } else { front_of[p as usize] }).collect(),
            width: columns.iter().map(|c| u64::from(c.1 - c.0)).collect(),
            height: columns.iter().map(|c| u64::from(counts[c.0 as usize])).collect(),
            zeros: vec![0; columns.len()],
            into: vec![ROOT; columns.len()],
            columns,
        }
    }

    fn merge_children(&mut self) {
        let n = self.columns.len();
        let mut children = vec![Vec::new(); n];
        for (f, &p) in self.parent.iter().enumerate() {
            if p != ROOT {
                children[p as usize].push(f as u32);
            }
        }
        for (p, mut candidates) in children.into_iter().enumerate() {
            // The child that adds the fewest zeros first; a merged child's own children are not tried again.
            while let Some(best) = self.cheapest(p, &candidates) {
                let child = candidates.swap_remove(best) as usize;
                self.zeros[p] = self.merged_zeros(p, child);
                self.width[p] += self.width[child];
                self.height[p] += self.width[child];
                self.into[child] = p as u32;
            }
        }
    }

    fn cheapest(&self, p: usize, candidates: &[u32]) -> Option<usize> {
        let allowed = candidates.iter().enumerate().filter(|&(_, &c)| self.worth_merging(p, c as usize));
        allowed.min_by_key(|&(_, &c)| (self.merged_zeros(p, c as usize), c)).map(|(at, _)| at)
    }

    fn merged_zeros(&self, p: usize, c: usize) -> u64 {
        let union = self.width[c] + self.height[p];
        self.zeros[p] + self.zeros[c] + self.width[c] * (union - self.height[c])
    }

    fn worth_merging(&self, p: usize, c: usize) -> bool {
        let (width, height) = (self.width[p] + self.width[c], self.width[c] + self.height[p]);
        let stored = width * height - width * (width - 1) / 2;
        let share = self.merged_zeros(p, c) as f64 / stored as f64;
        share == 0.0 || RELAXATION.iter().any(|&(columns, limit)| width <= columns && share <= limit)
    }

    fn finish(self) -> Fronts {
        let n = self.columns.len();
        let mut members = vec![Vec::new(); n];
        for f in 0..n {
            let mut target = f;
            while self.into[target] != ROOT {
                target = self.into[target] as usize;
            }
            members[target].push(f);
        }
        let mut tree = vec![ROOT; n];
        for f in (0..n).filter(|&f| self.into[f] == ROOT) {
            let mut p = self.parent[f];
            while p != ROOT && self.into[p as usize] != ROOT {
                p = self.into[p as usize];
            }
            tree[f] = p;
        }
        let mut fronts = Fronts { order: Vec::new(), starts: vec![0], heights: Vec::new() };
        for f in postorder(&tree) {
            for &member in &members[f as usize] {
                fronts.order.extend(self.columns[member].0..self.columns[member].1);
            }
            if fronts.order.len() as u32 > fronts.starts[fronts.starts.len() - 1] {
                fronts.starts.push(fronts.order.len() as u32);
                fronts.heights.push(self.height[f as usize] as u32);
            }
        }
        fronts
    }
}

/// Share of explicit zeros that a merged front may store, by its largest number of node columns.
const RELAXATION: [(u64, f64); 4] = [(2, 1.0), (6, 0.6), (16, 0.2), (u64::MAX, 0.05)];
