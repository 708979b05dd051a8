//! [`Line`]: what contributions show of themselves beside the body.

/// A polyline in the displaced body.
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    /// Name of its contribution.
    pub name: String,
    /// Its corners.
    pub points: Vec<[f64; 3]>,
    /// Numbers that hold for the whole of it.
    pub quantities: Vec<(&'static str, f64)>,
}
