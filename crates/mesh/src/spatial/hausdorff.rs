use super::directed::directed;
use super::{Shape, SpatialError};

/// Error of the distance, relative to the larger diagonal.
const TOLERANCE: f64 = 1e-4;

/// The Hausdorff distance of two solids, with its proof: the true value lies in [`distance`, `distance + gap`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hausdorff {
    /// max(`a_to_b`, `b_to_a`): no point of either solid is farther than `distance + gap` from the other, and one is at
    /// least this far (m).
    pub distance: f64,
    /// What the search has left open (m).
    pub gap: f64,
    /// The point, of whichever solid, that is farthest from the other.
    pub from: [f64; 3],
    /// Its nearest point on the other solid.
    pub to: [f64; 3],
    /// sup over the points of a of their distance to b, 0 if b holds a (m; within `gap` from below).
    pub a_to_b: f64,
    /// sup over the points of b of their distance to a (m; within `gap` from below).
    pub b_to_a: f64,
}

/// The Hausdorff distance of two solids to 1e-4 of the larger diagonal: max of sup_{x in a} d(x, b) and sup_{y in b}
/// d(y, a), where a point in the other solid has distance zero.
///
/// # Errors
/// Solids of different dimensions.
pub fn hausdorff(a: &Shape, b: &Shape) -> Result<Hausdorff, SpatialError> {
    hausdorff_within(a, b, TOLERANCE * a.diagonal().max(b.diagonal()))
}

/// [`hausdorff`] to a tolerance of your own (m). The work is bounded: what a small tolerance leaves open shows in the
/// gap.
///
/// # Errors
/// Solids of different dimensions.
pub fn hausdorff_within(a: &Shape, b: &Shape, tolerance: f64) -> Result<Hausdorff, SpatialError> {
    if a.dim() != b.dim() {
        return Err(SpatialError::Dimension { a: a.dim(), b: b.dim() });
    }
    let there = directed(a, b, tolerance.max(0.0));
    let back = directed(b, a, tolerance.max(0.0));
    let far = if there.lower >= back.lower { &there } else { &back };
    let gap = [&there, &back].iter().map(|d| d.upper - d.lower).fold(there.upper.max(back.upper) - far.lower, f64::max);
    Ok(Hausdorff {
        distance: far.lower,
        gap,
        from: far.from.into(),
        to: far.to.into(),
        a_to_b: there.lower,
        b_to_a: back.lower,
    })
}
