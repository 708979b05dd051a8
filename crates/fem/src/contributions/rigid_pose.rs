//! [`RigidPose`]: where something rigid beside the body is.

use super::rotation::rotation;
use nastic_tensor::{Mat3, Vec3};

/// A rigid motion `x = c + tau + R(theta) (X - c)` of what touches the body, with its name.
#[derive(Debug, Clone, PartialEq)]
pub struct RigidPose {
    /// What is moved.
    pub name: String,
    centre: Vec3,
    translation: Vec3,
    rotation: Mat3,
}

impl RigidPose {
    /// By a translation (m) and a rotation vector (radians) about a centre.
    pub fn new(name: &str, centre: [f64; 3], translation: [f64; 3], theta: [f64; 3]) -> Self {
        let [centre, translation, theta] = [centre, translation, theta].map(Vec3::from);
        RigidPose { name: name.to_owned(), centre, translation, rotation: rotation(&theta) }
    }

    /// Where a point goes.
    pub fn apply(&self, x: [f64; 3]) -> [f64; 3] {
        (self.centre + self.translation + self.rotation * (Vec3::from(x) - self.centre)).into()
    }
}
