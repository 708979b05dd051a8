//! [`PointPeak`]: the largest value of what an actuation is judged by at every point.

use nastic_energy::PointQuantity;

/// The largest value of a [`PointQuantity`] over the quadrature points of an actuation.
#[derive(Debug, Clone, PartialEq)]
pub struct PointPeak {
    /// The actuation.
    pub actuation: String,
    /// What is measured.
    pub quantity: PointQuantity,
    /// Its largest value.
    pub value: f64,
    /// The cell where it is.
    pub cell: u32,
    /// The largest share of the limit that is reached at a point, with the limit there; `None` where no point has a limit.
    pub share: Option<(f64, f64)>,
    /// Cells with a point beyond its limit.
    pub beyond: usize,
}
