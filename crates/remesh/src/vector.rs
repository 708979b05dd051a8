//! Vectors, and distances of points from segments and triangles.

pub(crate) fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|k| a[k] - b[k])
}

pub(crate) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub(crate) fn length(a: [f64; 3]) -> f64 {
    dot(a, a).sqrt()
}

pub(crate) fn mean(points: &[[f64; 3]]) -> [f64; 3] {
    let sum = points.iter().fold([0.0; 3], |sum, x| [0, 1, 2].map(|k| sum[k] + x[k]));
    sum.map(|x| x / points.len() as f64)
}

/// Of a point from a segment or a triangle. The nearest point of a triangle lies on an edge, or is the foot of the perpendicular where that is inside.
pub(crate) fn distance(p: [f64; 3], simplex: &[[f64; 3]]) -> f64 {
    match *simplex {
        [a, b] => {
            let (along, to) = (minus(b, a), minus(p, a));
            let square = dot(along, along);
            let share = if square > 0.0 { (dot(along, to) / square).clamp(0.0, 1.0) } else { 0.0 };
            length([0, 1, 2].map(|k| to[k] - share * along[k]))
        }
        [a, b, c] => {
            let normal = cross(minus(b, a), minus(c, a));
            let is_left = |s: [f64; 3], t: [f64; 3]| dot(cross(minus(t, s), minus(p, s)), normal) >= 0.0;
            if length(normal) > 0.0 && is_left(a, b) && is_left(b, c) && is_left(c, a) {
                return (dot(minus(p, a), normal) / length(normal)).abs();
            }
            [[a, b], [b, c], [c, a]].iter().map(|edge| distance(p, edge)).fold(f64::INFINITY, f64::min)
        }
        _ => f64::INFINITY,
    }
}
