//! [`Polyline`]: what is shown beside the cells of a body.

/// A line through points of space, in the displaced body: a tendon or a spring, say.
#[derive(Clone, Debug, PartialEq)]
pub struct Polyline {
    /// What it is called.
    pub name: String,
    /// Its corners.
    pub points: Vec<[f64; 3]>,
    /// Numbers that hold for the whole of it, by name.
    pub quantities: Vec<(String, f64)>,
}
