//! [`Aim`]: a place of the body and where a cost wants it.

/// Where the point is that a cost looks at, or the mean of the points, and where it should be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aim {
    /// x.
    pub position: [f64; 3],
    /// The target of x; components without one are free.
    pub target: [Option<f64>; 3],
}
