//! The camera: direction of view and orthographic projection.

use super::picture::View;
use super::vector::{V3, add, cross, dot, scale, sub, unit};

/// An orthographic camera: an orthonormal triad seen from the eye.
#[derive(Clone, Copy, Debug)]
pub(super) struct Camera {
    pub right: V3,
    pub up: V3,
    /// From the bodies to the eye.
    pub eye: V3,
}

impl Camera {
    /// `positions` of everything in the picture; `plane` if all of it lies in z = 0.
    pub fn new(view: View, plane: bool, positions: &[V3]) -> Result<Self, String> {
        match view {
            View::From(direction) => match unit(direction) {
                Some(eye) => Ok(Self::looking(eye)),
                None => Err("the direction of the view is zero or not finite".to_owned()),
            },
            View::Auto if plane => Ok(Self { right: [1.0, 0.0, 0.0], up: [0.0, 1.0, 0.0], eye: [0.0, 0.0, 1.0] }),
            View::Auto => Ok(Self::looking(across(positions))),
        }
    }

    /// z up, unless the eye looks along it.
    fn looking(eye: V3) -> Self {
        let up = if eye[2].abs() > 0.99 { [0.0, 1.0, 0.0] } else { [0.0, 0.0, 1.0] };
        // Neither is parallel to the eye.
        let right = unit(cross(up, eye)).unwrap_or([1.0, 0.0, 0.0]);
        Self { right, up: cross(eye, right), eye }
    }

    /// A point as (right, up, towards the eye).
    pub fn see(&self, p: V3) -> V3 {
        [dot(p, self.right), dot(p, self.up), dot(p, self.eye)]
    }
}

/// The direction across the plane in which the bodies extend, turned a little so that depth shows.
fn across(positions: &[V3]) -> V3 {
    let [longest, _, thinnest] = principal_axes(positions);
    if thinnest[2].abs() > 0.8 {
        // A flat thing on the ground: from the front, well above.
        return unit([0.45, -0.8, 0.75]).unwrap_or([0.0, -1.0, 0.0]);
    }
    // From the side that faces -y, or +x if the thing bends in the y-z plane.
    let towards = if thinnest[1].abs() > thinnest[0].abs() { -thinnest[1].signum() } else { thinnest[0].signum() };
    let front = scale(thinnest, towards);
    let along = scale(longest, if dot(longest, [1.0, 1.0, 0.0]) >= 0.0 { 1.0 } else { -1.0 });
    let tilted = add(add(front, scale(along, 0.28)), [0.0, 0.0, 0.38]);
    unit(tilted).unwrap_or([0.0, -1.0, 0.0])
}

/// Unit axes of the scatter of points, from the longest to the shortest (Jacobi's method).
fn principal_axes(positions: &[V3]) -> [V3; 3] {
    let count = positions.len().max(1) as f64;
    let centre = scale(positions.iter().fold([0.0; 3], |sum, p| add(sum, *p)), 1.0 / count);
    let mut a = [[0.0; 3]; 3];
    for p in positions {
        let d = sub(*p, centre);
        for i in 0..3 {
            for j in 0..3 {
                a[i][j] += d[i] * d[j] / count;
            }
        }
    }
    // Columns become the axes.
    let mut v = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for _ in 0..30 {
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            if a[p][q].abs() <= 1e-14 * (a[0][0] + a[1][1] + a[2][2]) {
                continue;
            }
            let theta = 0.5 * (a[q][q] - a[p][p]) / a[p][q];
            let t = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
            let c = 1.0 / (t * t + 1.0).sqrt();
            let s = t * c;
            for row in &mut a {
                (row[p], row[q]) = (c * row[p] - s * row[q], s * row[p] + c * row[q]);
            }
            let (row_p, row_q) = (a[p], a[q]);
            for k in 0..3 {
                a[p][k] = c * row_p[k] - s * row_q[k];
                a[q][k] = s * row_p[k] + c * row_q[k];
            }
            for row in &mut v {
                (row[p], row[q]) = (c * row[p] - s * row[q], s * row[p] + c * row[q]);
            }
        }
    }
    let mut order = [0, 1, 2];
    order.sort_by(|i, j| a[*j][*j].total_cmp(&a[*i][*i]));
    order.map(|k| [v[0][k], v[1][k], v[2][k]])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vector::length;

    #[test]
    fn the_plane_of_bending_is_seen_from_the_side() {
        // An arc in the x-z plane, turned about z by an angle: the eye turns with it.
        for turn in [0.0_f64, 0.4, 1.2] {
            let positions: Vec<V3> = (0..100)
                .map(|k| {
                    let s = f64::from(k) / 99.0;
                    let x = (1.2 * s).sin() / 1.2;
                    [x * turn.cos(), x * turn.sin(), (1.0 - (1.2 * s).cos()) / 1.2]
                })
                .collect();
            let camera = Camera::new(View::Auto, false, &positions).unwrap();
            let normal = [-turn.sin(), turn.cos(), 0.0];
            assert!(dot(camera.eye, normal).abs() > 0.8, "{turn}: {:?}", camera.eye);
            assert!(camera.eye[2] > 0.1 && camera.up[2] > 0.8);
            assert!((length(camera.up) - 1.0).abs() < 1e-12 && dot(camera.up, camera.right).abs() < 1e-12);
        }
    }

    #[test]
    fn the_view_may_be_given() {
        let camera = Camera::new(View::From([0.0, 0.0, 5.0]), false, &[]).unwrap();
        assert_eq!((camera.right, camera.up, camera.eye), ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]));
        assert!(Camera::new(View::From([0.0; 3]), false, &[]).is_err());
    }
}
