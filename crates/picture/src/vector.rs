//! Vectors of three components.

pub(super) type V3 = [f64; 3];

pub(super) fn add(a: V3, b: V3) -> V3 {
    std::array::from_fn(|i| a[i] + b[i])
}

pub(super) fn sub(a: V3, b: V3) -> V3 {
    std::array::from_fn(|i| a[i] - b[i])
}

pub(super) fn scale(a: V3, s: f64) -> V3 {
    a.map(|x| x * s)
}

pub(super) fn dot(a: V3, b: V3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(super) fn cross(a: V3, b: V3) -> V3 {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub(super) fn length(a: V3) -> f64 {
    dot(a, a).sqrt()
}

/// The direction of a vector; `None` for zero and for what is not finite.
pub(super) fn unit(a: V3) -> Option<V3> {
    let size = a.iter().fold(0.0_f64, |size, x| size.max(x.abs()));
    if size == 0.0 || !size.is_finite() {
        return None;
    }
    let a = scale(a, 1.0 / size);
    Some(scale(a, 1.0 / length(a)))
}
