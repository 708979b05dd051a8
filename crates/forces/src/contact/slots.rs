//! Vectors of the slots of a [`Stencil`].

use super::stencil::Stencil;
use nastic_tensor::Vec3;

/// Slots of zero.
pub(super) fn zero<S: Stencil>(stencil: &S) -> S::Slots {
    stencil.slots(|_| 0.0, &[Vec3::zeros(); 2])
}

pub(super) fn scaled<S: AsMut<[Vec3]>>(mut slots: S, factor: f64) -> S {
    slots.as_mut().iter_mut().for_each(|value| *value *= factor);
    slots
}

pub(super) fn dot<S: AsRef<[Vec3]>>(a: &S, b: &S) -> f64 {
    a.as_ref().iter().zip(b.as_ref()).map(|(a, b)| a.dot(b)).sum()
}

pub(super) fn add_scaled<S: AsRef<[Vec3]> + AsMut<[Vec3]>>(to: &mut S, values: &S, factor: f64) {
    to.as_mut().iter_mut().zip(values.as_ref()).for_each(|(to, value)| *to += factor * value);
}
