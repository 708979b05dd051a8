//! [`Aim`]: a place of the body and where a cost wants it.

/// The position of a cost's point, or the mean of its points, and its target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aim {
    /// x.
    pub position: [f64; 3],
    /// The target of x; components without one are free.
    pub target: [Option<f64>; 3],
}
