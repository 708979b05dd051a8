//! The nearest point of a segment or triangle, and the distance from it with derivatives.

use nastic_tensor::Scalar;
use nastic_tensor::Vec3;

/// The corners of a segment or triangle between which its nearest point to x is: one of a corner, two of an edge, three of the inside.
pub(super) fn feature(x: &Vec3, corners: &[Vec3]) -> Vec<usize> {
    match corners {
        [a, b] => on_edge(x, 0, a, 1, b),
        [a, b, c] => on_triangle(x, [a, b, c]),
        _ => vec![0],
    }
}

fn on_edge(x: &Vec3, i: usize, a: &Vec3, j: usize, b: &Vec3) -> Vec<usize> {
    let along = (x - a).dot(&(b - a));
    if along <= 0.0 {
        vec![i]
    } else if along >= (b - a).norm_squared() {
        vec![j]
    } else {
        vec![i, j]
    }
}

/// By the regions of the triangle's corners and edges.
fn on_triangle(x: &Vec3, corners: [&Vec3; 3]) -> Vec<usize> {
    let [a, b, c] = corners;
    let normal = (b - a).cross(&(c - a));
    // outside of which edges
    let outside = |i: usize| {
        let (p, q) = (corners[i], corners[(i + 1) % 3]);
        normal.dot(&(q - p).cross(&(x - p))) <= 0.0
    };
    let edges: Vec<usize> = (0..3).filter(|&i| outside(i)).collect();
    if edges.is_empty() {
        return vec![0, 1, 2];
    }
    let found = edges.into_iter().map(|i| on_edge(x, i, corners[i], (i + 1) % 3, corners[(i + 1) % 3]));
    let distance = |feature: &Vec<usize>| {
        let corners: Vec<[f64; 3]> = feature.iter().map(|&i| (*corners[i]).into()).collect();
        nearest((*x).into(), &corners).distance
    };
    // where an obtuse corner has x outside of two edges, the nearer one counts
    found.min_by(|one, two| distance(one).total_cmp(&distance(two))).unwrap_or_default()
}

/// A point and its nearest one on the affine hull of some corners.
#[derive(Debug, Clone, Copy)]
pub(super) struct Nearest<T> {
    pub distance: T,
    /// From the nearest point to x, of length 1.
    pub normal: [T; 3],
    /// Barycentric coordinates of the nearest point.
    pub shares: [T; 3],
}

/// `|x - y|`, `y = sum_i b_i q_i` with `(x - y) . (q_i - q_0) = 0`, `sum_i b_i = 1`.
pub(super) fn nearest<T: Scalar>(x: [T; 3], corners: &[[T; 3]]) -> Nearest<T> {
    let (zero, one) = (T::of(0.0), T::of(1.0));
    let from = minus(x, corners[0]);
    let edges: Vec<[T; 3]> = corners[1..].iter().map(|corner| minus(*corner, corners[0])).collect();
    let shares = match edges[..] {
        [] => [one, zero, zero],
        [e] => {
            let t = dot(from, e) / dot(e, e);
            [one - t, t, zero]
        }
        _ => {
            let (e, f) = (edges[0], edges[1]);
            let (ee, ef, ff) = (dot(e, e), dot(e, f), dot(f, f));
            let (xe, xf) = (dot(from, e), dot(from, f));
            let determinant = ee * ff - ef * ef;
            let (s, t) = ((ff * xe - ef * xf) / determinant, (ee * xf - ef * xe) / determinant);
            [one - s - t, s, t]
        }
    };
    let along = edges.iter().zip(&shares[1..]).fold(from, |sum, (edge, share)| minus(sum, edge.map(|e| e * *share)));
    let distance = dot(along, along).root(2);
    Nearest { distance, normal: along.map(|a| a / distance), shares }
}

fn dot<T: Scalar>(a: [T; 3], b: [T; 3]) -> T {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn minus<T: Scalar>(a: [T; 3], b: [T; 3]) -> [T; 3] {
    std::array::from_fn(|i| a[i] - b[i])
}

/// The distance of a point from a segment or triangle.
pub(super) fn distance(x: &Vec3, corners: &[Vec3]) -> f64 {
    let between: Vec<[f64; 3]> = feature(x, corners).into_iter().map(|i| corners[i].into()).collect();
    nearest((*x).into(), &between).distance
}

#[cfg(test)]
mod tests {
    use super::*;
    use nastic_numeric::Random;

    /// No point of a fine grid on the triangle is nearer.
    #[test]
    fn nothing_of_a_triangle_is_nearer() {
        let mut random = Random::new(3);
        let mut draw = || Vec3::from_fn(|_, _| random.symmetric());
        for _ in 0..300 {
            let (x, corners) = (2.0 * draw(), [draw(), draw(), draw()]);
            let found = distance(&x, &corners);
            let n = 60;
            let on_grid = |i: usize, j: usize| {
                let (s, t) = (i as f64 / n as f64, j as f64 / n as f64);
                (corners[0] * (1.0 - s - t) + corners[1] * s + corners[2] * t - x).norm()
            };
            let all = (0..=n).flat_map(|i| (0..=n - i).map(move |j| on_grid(i, j)));
            let least = all.fold(f64::INFINITY, f64::min);
            assert!(found <= least + 1e-12 && least < found + 0.05, "{found} and {least}");
        }
    }
}
