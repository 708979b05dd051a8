//! Which pairs of leaves are summed; the others are too small to count.
//!
//! Why no sum S at a point, A_t or B_q, errs by more than tol S. Let L <= S be a lower bound of the sums at the points of both
//! nodes (`LowerBounds`), and recall that the weights of either set add up to one. A pair of points is left out where
//! E <= tol L, by the least distance of the boxes of two nodes. What is left out of a sum is then at most
//! sum w tol L <= tol S. The derivative's functions are E times at most the slope S' of log E, with errors in the same
//! proportion to S' L; divided by the sums and summed over the points this is half of the bound on `Summation`, the other
//! half of it being the error of the sums themselves.

use super::kernel::Kernel;
use super::lower_bounds::BoundedSet;

/// The leaves of `columns` that the points of a leaf of `rows` are summed with, in order.
pub(super) fn columns_of(
    kernel: &Kernel,
    log2_tolerance: f64,
    rows: &BoundedSet,
    row: u32,
    columns: &BoundedSet,
) -> Vec<u32> {
    let (here, lower) = (&rows.points.boxes[row as usize], rows.bounds.lower[row as usize]);
    let (mut found, mut stack) = (Vec::new(), vec![0u32]);
    while let Some(node) = stack.pop() {
        let highest = kernel.at(here.gap(&columns.points.boxes[node as usize]));
        if highest < lower.min(columns.bounds.lower[node as usize]) + log2_tolerance {
            continue;
        }
        if columns.points.node(node).is_leaf() {
            found.push(node);
        } else {
            let [left, right] = columns.points.tree().children(node);
            stack.extend([right, left]);
        }
    }
    found
}
