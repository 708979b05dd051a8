//! [`Displaced`]: a displacement with what is known of its kinematics.

use nastic_tensor::Mat3;

/// A displacement u, and `1 + grad u` at all points of the body where it was found before.
#[derive(Clone, Copy)]
pub struct Displaced<'a> {
    /// u, flat.
    pub u: &'a [f64],
    /// `1 + grad u`, by point.
    pub known: Option<&'a [Mat3]>,
}

impl<'a> Displaced<'a> {
    /// One of which nothing is known.
    pub fn by(u: &'a [f64]) -> Self {
        Displaced { u, known: None }
    }
}
