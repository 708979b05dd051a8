//! Regular subdivision of the triangle or segment of a facet.

use super::V;
use super::boundary::{Boundary, Facet};
use super::interpolation_error::InterpolationError;
use super::patch::{sag, widths};

impl Boundary {
    /// A facet over these parameters of a face.
    pub fn facet(&self, face: u32, param: [[f64; 2]; 3]) -> Facet {
        let patch = self.patch(face);
        let domain = param.map(|u| [u[0], u[1], 0.0]);
        let corners = domain.map(|u| patch.value(&u));
        let sag = match patch.space.simplex {
            true => InterpolationError::of(&patch, &domain).bound(),
            false => sag(&self.second_bounds[face as usize], &widths(&domain)),
        };
        let [a, b, c] = corners;
        let edge = b - a;
        let normal = if self.plane { V::new(edge.y, -edge.x, 0.0) } else { edge.cross(&(c - a)) };
        let normal = normal.try_normalize(0.0).filter(|n| n.iter().all(|v| v.is_finite())).unwrap_or_default();
        Facet { corners, normal, param, face, sag }
    }

    /// Four triangles, or two segments, over the same parameters; `visit` returns true to stop.
    pub fn split(&self, facet: &Facet, mut visit: impl FnMut(&Facet) -> bool) {
        let p = &facet.param;
        let mid = |i: usize, j: usize| [0.5 * (p[i][0] + p[j][0]), 0.5 * (p[i][1] + p[j][1])];
        if self.plane {
            let m = mid(0, 1);
            for param in [[p[0], m, m], [m, p[1], p[1]]] {
                if visit(&self.facet(facet.face, param)) {
                    return;
                }
            }
            return;
        }
        let (m01, m12, m20) = (mid(0, 1), mid(1, 2), mid(2, 0));
        for param in [[p[0], m01, m20], [m01, p[1], m12], [m20, m12, p[2]], [m01, m12, m20]] {
            if visit(&self.facet(facet.face, param)) {
                return;
            }
        }
    }
}
