//! The ball per point: |m_p| <= radius at every point p.

use super::sphere::add_curvature;
use super::{Admissible, Face, Intervals, NotBounds, Outside, SetError, check_radius};
use nastic_numeric::vector::{add, dot, norm};

/// Vectors of `dim` components, one per point and stored point by point, each no longer than a given radius: an applied
/// field.
#[derive(Clone, Debug, PartialEq)]
pub struct Ball {
    dim: usize,
    radius: f64,
}

impl Ball {
    /// A vector this close to the radius (relatively) is on the boundary.
    const BOUNDARY_TOLERANCE: f64 = 1e-13;

    /// Vectors of `dim` (1, 2 or 3) components no longer than `radius`.
    ///
    /// # Errors
    /// Another dimension, or a radius that is not positive.
    pub fn new(dim: usize, radius: f64) -> Result<Self, SetError> {
        check_radius(dim, radius)?;
        Ok(Self { dim, radius })
    }

    /// Number of components of each vector.
    pub fn dim(&self) -> usize {
        self.dim
    }

    /// The radius.
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// Where a step has led one vector; a step tangential at the boundary stays in the tangent plane of its beginning.
    fn boundary_point(&self, m: &[f64], d: &[f64]) -> Vec<f64> {
        let tangential = dot(m, d).abs() <= Self::BOUNDARY_TOLERANCE * norm(m) * norm(d);
        if tangential && norm(m) >= self.radius * (1.0 - Self::BOUNDARY_TOLERANCE) { m.to_vec() } else { add(m, d) }
    }

    /// Shortens one vector to the radius, never past it by rounding.
    fn shorten(&self, v: &mut [f64]) {
        let size = norm(v);
        if size > self.radius {
            v.iter_mut().for_each(|x| *x *= self.radius / size);
            while norm(v) > self.radius {
                v.iter_mut().for_each(|x| *x *= 1.0 - f64::EPSILON);
            }
        }
    }
}

impl Admissible for Ball {
    fn check(&self, m: &[f64]) -> Result<(), Outside> {
        let ragged = !m.len().is_multiple_of(self.dim);
        for (p, v) in m.chunks(self.dim).enumerate() {
            let value = norm(v);
            let inside = value <= self.radius;
            if ragged || !inside {
                let allowed = format!("vectors of {} components no longer than {:e}", self.dim, self.radius);
                return Err(Outside { index: p * self.dim, value, allowed });
            }
        }
        Ok(())
    }

    fn project(&self, m: &mut [f64]) {
        m.chunks_mut(self.dim).for_each(|v| self.shorten(v));
    }

    fn restrict(&self, m: &[f64], d: &mut [f64]) {
        for (m, d) in m.chunks(self.dim).zip(d.chunks_mut(self.dim)) {
            let mut x = add(m, d);
            // To the bit what it was where nothing holds it.
            if norm(&x) > self.radius {
                self.shorten(&mut x);
                d.iter_mut().zip(x.iter().zip(m)).for_each(|(d, (x, m))| *d = x - m);
            }
        }
    }

    /// Where the first vector that is not at the radius yet gets there.
    fn reach(&self, m: &[f64], d: &[f64], s: &[f64]) -> f64 {
        let mut reach = 1.0f64;
        for at in (0..m.len()).step_by(self.dim) {
            let x = self.boundary_point(&m[at..at + self.dim], &d[at..at + self.dim]);
            let s = &s[at..at + self.dim];
            if norm(&x) < self.radius * (1.0 - Self::BOUNDARY_TOLERANCE) && norm(&add(&x, s)) > self.radius {
                let (ss, xs, room) = (dot(s, s), dot(&x, s), self.radius * self.radius - dot(&x, &x));
                reach = reach.min(((xs * xs + ss * room).sqrt() - xs) / ss);
            }
        }
        reach.max(0.0)
    }

    fn tangent(&self, _m: &[f64], _v: &mut [f64]) {}

    fn retract(&self, m: &[f64], d: &[f64], t: f64, out: &mut [f64]) {
        for (out, (m, d)) in out.iter_mut().zip(m.iter().zip(d)) {
            *out = m + t * d;
        }
        self.project(out);
    }

    fn face(&self, m: &[f64], d: &[f64], derivative: &[f64]) -> Face {
        let mut face = Face::free(m.len());
        for at in (0..m.len()).step_by(self.dim) {
            let block = at..at + self.dim;
            let x = self.boundary_point(&m[block.clone()], &d[block.clone()]);
            let outward = -dot(&derivative[block], &x);
            if norm(&x) >= self.radius * (1.0 - Self::BOUNDARY_TOLERANCE) && outward > 0.0 {
                face.bar(at, &x, true);
            }
        }
        face
    }

    /// That of the sphere, where the vector is held at the boundary.
    fn add_curvature(&self, m: &[f64], derivative: &[f64], v: &[f64], out: &mut [f64]) {
        for (p, m) in m.chunks(self.dim).enumerate() {
            let at = p * self.dim..(p + 1) * self.dim;
            let outward = -dot(&derivative[at.clone()], m);
            if norm(m) >= self.radius * (1.0 - Self::BOUNDARY_TOLERANCE) && outward > 0.0 {
                add_curvature(m, &derivative[at.clone()], &v[at.clone()], self.radius, &mut out[at]);
            }
        }
    }

    fn inward(&self, m: &[f64], d: &mut [f64]) {
        for (m, d) in m.chunks(self.dim).zip(d.chunks_mut(self.dim)) {
            // A chord of the ball is admissible all along.
            if norm(&add(m, d)) > self.radius {
                d.iter_mut().for_each(|d| *d = -*d);
            }
        }
        self.restrict(m, d);
    }

    fn intervals(&self, _len: usize) -> Result<Intervals, NotBounds> {
        Err(NotBounds {
            index: 0,
            what: format!("vectors of {} components no longer than {:e}", self.dim, self.radius),
        })
    }

    fn extent(&self, m: &[f64]) -> Vec<f64> {
        vec![2.0 * self.radius; m.len()]
    }
}
