//! The sphere per point: |m_p| = radius at every point p.

use super::{Admissible, Face, Intervals, NotBounds, Outside, SetError, check_radius};
use nastic_numeric::Random;
use nastic_numeric::vector::{dot, norm};

/// Vectors of `dim` components, one per point and stored point by point, each of the same given length: a magnetisation.
/// The retraction is (m + t d) radius/|m + t d|, the transport the projection onto the new tangent plane.
#[derive(Clone, Debug, PartialEq)]
pub struct Sphere {
    dim: usize,
    radius: f64,
}

impl Sphere {
    /// Relative tolerance of |m_p| = radius.
    const TOLERANCE: f64 = 1e-12;

    /// Vectors of `dim` (1, 2 or 3) components of length `radius`.
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

    /// Vectors at `points` points in directions drawn independently and evenly from a seed: a start where nothing is
    /// known. The same on every machine.
    pub fn random(&self, points: usize, seed: u64) -> Vec<f64> {
        let mut random = Random::new(seed);
        let mut out = Vec::with_capacity(points * self.dim);
        while out.len() < points * self.dim {
            // Evenly in the ball, hence evenly in direction.
            let mut v: Vec<f64> = (0..self.dim).map(|_| random.symmetric()).collect();
            if (0.1..=1.0).contains(&norm(&v)) {
                self.normalise(&mut v);
                out.extend(v);
            }
        }
        out
    }

    /// Scales one vector to the sphere; one without a direction gets the first axis.
    fn normalise(&self, v: &mut [f64]) {
        let size = norm(v);
        if size > 0.0 && size.is_finite() {
            v.iter_mut().for_each(|x| *x *= self.radius / size);
        } else {
            v.fill(0.0);
            v[0] = self.radius;
        }
    }
}

/// `-(derivative . m / radius^2) v` of one vector: `(m + t v) radius/|m + t v|` bends by `-t^2 |v|^2 m / (2 radius^2)`.
pub(super) fn add_curvature(m: &[f64], derivative: &[f64], v: &[f64], radius: f64, out: &mut [f64]) {
    let factor = -dot(derivative, m) / (radius * radius);
    out.iter_mut().zip(v).for_each(|(out, v)| *out += factor * v);
}

impl Admissible for Sphere {
    fn check(&self, m: &[f64]) -> Result<(), Outside> {
        let ragged = !m.len().is_multiple_of(self.dim);
        for (p, v) in m.chunks(self.dim).enumerate() {
            let value = norm(v);
            let on_sphere = (value - self.radius).abs() <= Self::TOLERANCE * self.radius;
            if ragged || !on_sphere {
                let allowed = format!("vectors of {} components and length {:e}", self.dim, self.radius);
                return Err(Outside { index: p * self.dim, value, allowed });
            }
        }
        Ok(())
    }

    fn project(&self, m: &mut [f64]) {
        m.chunks_mut(self.dim).for_each(|v| self.normalise(v));
    }

    fn restrict(&self, m: &[f64], d: &mut [f64]) {
        self.tangent(m, d);
    }

    fn tangent(&self, m: &[f64], v: &mut [f64]) {
        for (m, v) in m.chunks(self.dim).zip(v.chunks_mut(self.dim)) {
            let along = m.iter().zip(v.iter()).map(|(m, v)| m * v).sum::<f64>() / (self.radius * self.radius);
            for (m, v) in m.iter().zip(v) {
                *v -= along * m;
            }
        }
    }

    fn retract(&self, m: &[f64], d: &[f64], t: f64, out: &mut [f64]) {
        let points = out.chunks_mut(self.dim).zip(m.chunks(self.dim)).zip(d.chunks(self.dim));
        for ((out, m), d) in points {
            if d.iter().all(|d| *d == 0.0) {
                out.copy_from_slice(m);
                continue;
            }
            for (out, (m, d)) in out.iter_mut().zip(m.iter().zip(d)) {
                *out = m + t * d;
            }
            self.normalise(out);
        }
    }

    fn face(&self, m: &[f64], _d: &[f64], _derivative: &[f64]) -> Face {
        let mut face = Face::free(m.len());
        for (p, v) in m.chunks(self.dim).enumerate() {
            face.bar(p * self.dim, v, false);
        }
        face
    }

    /// `-(derivative . m / radius^2) v` at every point.
    fn add_curvature(&self, m: &[f64], derivative: &[f64], v: &[f64], out: &mut [f64]) {
        for (p, m) in m.chunks(self.dim).enumerate() {
            let at = p * self.dim..(p + 1) * self.dim;
            add_curvature(m, &derivative[at.clone()], &v[at.clone()], self.radius, &mut out[at]);
        }
    }

    fn inward(&self, m: &[f64], d: &mut [f64]) {
        self.tangent(m, d);
    }

    fn intervals(&self, _len: usize) -> Result<Intervals, NotBounds> {
        Err(NotBounds { index: 0, what: format!("vectors of {} components and length {:e}", self.dim, self.radius) })
    }

    fn extent(&self, m: &[f64]) -> Vec<f64> {
        vec![self.radius; m.len()]
    }
}
