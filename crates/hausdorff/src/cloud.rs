//! A weighted cloud of points: what quadrature makes of a body.

use std::sync::Arc;

use rayon::prelude::*;

use super::bounding_box::{BoundingBox, norm};
use super::error::HausdorffError;
use super::tree::Tree;

/// Points (metres; z = 0 in two dimensions) with positive weights (their share of the volume or area, deformed
/// measure), checked once and sorted into a tree of boxes. Clones share them.
#[derive(Clone, Debug)]
pub struct Cloud {
    inner: Arc<Inner>,
}

#[derive(Debug)]
struct Inner {
    points: Vec<[f64; 3]>,
    weights: Vec<f64>,
    measure: f64,
    tree: Tree,
}

impl Cloud {
    /// Errors: no points, unequal lengths, a coordinate that is not finite, a weight that is not positive and finite.
    pub fn new(points: Vec<[f64; 3]>, weights: Vec<f64>) -> Result<Self, HausdorffError> {
        if points.is_empty() {
            return Err(HausdorffError::Empty);
        }
        if points.len() != weights.len() {
            let (found, points) = (weights.len(), points.len());
            return Err(HausdorffError::Length { what: "weights", found, points });
        }
        if let Some(index) = points.iter().position(|x| !x.iter().all(|c| c.is_finite())) {
            return Err(HausdorffError::Point { index, point: points[index] });
        }
        if let Some(index) = weights.iter().position(|&w| !(w > 0.0 && w.is_finite())) {
            return Err(HausdorffError::Weight { index, weight: weights[index] });
        }
        let measure: f64 = weights.iter().sum();
        if !measure.is_finite() {
            return Err(HausdorffError::Overflow { what: "sum of weights", value: measure });
        }
        let tree = Tree::new(&points);
        Ok(Self { inner: Arc::new(Inner { points, weights, measure, tree }) })
    }

    /// Number of points.
    pub fn len(&self) -> usize {
        self.inner.points.len()
    }

    /// Never: a cloud has points.
    pub fn is_empty(&self) -> bool {
        false
    }

    /// The points, as given.
    pub fn points(&self) -> &[[f64; 3]] {
        &self.inner.points
    }

    /// The weights, as given.
    pub fn weights(&self) -> &[f64] {
        &self.inner.weights
    }

    /// Sum of the weights: |Omega| or |T|.
    pub fn measure(&self) -> f64 {
        self.inner.measure
    }

    /// Length of the diagonal of the bounding box.
    pub fn diagonal(&self) -> f64 {
        let all = bounds(self.points());
        all.reach(&all)
    }

    pub(super) fn centre(&self) -> [f64; 3] {
        bounds(self.points()).centre()
    }

    /// Mean distance of a point to its nearest neighbour; zero for a single point.
    ///
    /// When `Smoothing::resolution` is below it the smoothed distance sees separate points, not the body.
    pub fn spacing(&self) -> f64 {
        if self.len() == 1 {
            return 0.0;
        }
        let boxes = node_bounds(self.tree(), self.points());
        let nearest: Vec<f64> = (0..self.len()).into_par_iter().map(|i| self.nearest_other(&boxes, i)).collect();
        nearest.iter().sum::<f64>() / self.len() as f64
    }

    pub(super) fn tree(&self) -> &Tree {
        &self.inner.tree
    }

    fn nearest_other(&self, boxes: &[BoundingBox], index: usize) -> f64 {
        let tree = self.tree();
        let x = self.points()[index];
        let here = BoundingBox::point(x);
        let mut best = f64::INFINITY;
        let mut stack = vec![(0.0, 0u32)];
        while let Some((gap, node)) = stack.pop() {
            let it = &tree.nodes[node as usize];
            if gap >= best {
                continue;
            }
            if it.is_leaf() {
                for &other in &tree.order[it.range()] {
                    if other as usize != index {
                        let y = self.points()[other as usize];
                        best = best.min(norm(std::array::from_fn(|d| x[d] - y[d])));
                    }
                }
            } else {
                let mut next = tree.children(node).map(|child| (here.gap(&boxes[child as usize]), child));
                if next[0].0 < next[1].0 {
                    next.swap(0, 1);
                }
                stack.extend(next);
            }
        }
        best
    }
}

fn bounds(points: &[[f64; 3]]) -> BoundingBox {
    points.iter().fold(BoundingBox::EMPTY, |all, &x| all.join(&BoundingBox::point(x)))
}

/// The box of every node of `tree` around `points` (in the cloud's numbering).
fn node_bounds(tree: &Tree, points: &[[f64; 3]]) -> Vec<BoundingBox> {
    fit(tree, |k| points[tree.order[k] as usize])
}

/// The box of every node of `tree`, from the points in tree order.
pub(super) fn fit(tree: &Tree, point: impl Fn(usize) -> [f64; 3]) -> Vec<BoundingBox> {
    let mut boxes = vec![BoundingBox::EMPTY; tree.nodes.len()];
    // Preorder: children come after their parent, so backwards they come first.
    for node in (0..tree.nodes.len()).rev() {
        let it = &tree.nodes[node];
        boxes[node] = if it.is_leaf() {
            it.range().fold(BoundingBox::EMPTY, |all, k| all.join(&BoundingBox::point(point(k))))
        } else {
            let [left, right] = tree.children(node as u32);
            boxes[left as usize].join(&boxes[right as usize])
        };
    }
    boxes
}
