//! [`Length`]: vectors are given one length.

use super::ControlMap;
use nastic_numeric::vector::{dot, norm};

/// `y = L x/|x|` at every point, for vectors of several components; where `x = 0` it stays zero. Linear interpolation between nodes on a
/// sphere falls short of it, so a nodal field of unit vectors needs this; elsewhere it changes rounding alone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Length {
    /// L
    pub length: f64,
    /// Number of components of a vector.
    pub components: usize,
}

impl Length {
    /// `each` of the scaling at every point and the vectors there, one after the other.
    fn by_point(&self, x: &[f64], each: impl Fn(&Scaling, usize) -> Vec<f64>) -> Vec<f64> {
        let points = x.chunks_exact(self.components).enumerate();
        points.flat_map(|(q, x)| each(&Scaling::new(self.length, x), q * self.components)).collect()
    }
}

impl ControlMap for Length {
    fn describe(&self) -> String {
        format!("vectors of length {}", self.length)
    }

    fn values(&self, x: &[f64]) -> Vec<f64> {
        self.by_point(x, |scaling, _| scaling.value())
    }

    fn change(&self, x: &[f64], v: &[f64]) -> Vec<f64> {
        self.by_point(x, |scaling, at| scaling.derivative(&v[at..at + self.components]))
    }

    /// Symmetric at every point.
    fn vjp(&self, x: &[f64], g: &[f64]) -> Vec<f64> {
        self.change(x, g)
    }

    fn second_vjp(&self, x: &[f64], v: &[f64], g: &[f64]) -> Option<Vec<f64>> {
        Some(self.by_point(x, |scaling, at| {
            let own = at..at + self.components;
            scaling.second_derivative(&v[own.clone()], &g[own])
        }))
    }

    fn is_affine(&self) -> bool {
        false
    }

    fn length(&self) -> Option<f64> {
        Some(self.length)
    }
}

/// `s(v) = L v/|v|` at a vector v; where v = 0, the identity.
pub(crate) struct Scaling<'v> {
    v: &'v [f64],
    /// `L/|v|`, and `|v|`.
    sizes: Option<(f64, f64)>,
}

impl<'v> Scaling<'v> {
    pub fn new(length: f64, v: &'v [f64]) -> Self {
        let size = norm(v);
        Scaling { v, sizes: (size > 0.0).then(|| (length / size, size)) }
    }

    /// `s(v)`.
    fn value(&self) -> Vec<f64> {
        let factor = self.sizes.map_or(1.0, |(factor, _)| factor);
        self.v.iter().map(|v| v * factor).collect()
    }

    /// The part of a vector across v.
    fn across(&self, size: f64, d: &[f64]) -> Vec<f64> {
        let along = dot(self.v, d) / (size * size);
        d.iter().zip(self.v).map(|(d, v)| d - along * v).collect()
    }

    /// `s'(v) g = (L/|v|) (I - n n) g`, symmetric, `n = v/|v|`.
    pub fn derivative(&self, g: &[f64]) -> Vec<f64> {
        let Some((factor, size)) = self.sizes else { return g.to_vec() };
        self.across(size, g).into_iter().map(|g| factor * g).collect()
    }

    /// The change of `s'(v) g` along a change d of v: `-(L/|v|^2) ((n.d) g' + (n.g) d' + (d'.g) n)`, the dash for the part across n.
    pub fn second_derivative(&self, d: &[f64], g: &[f64]) -> Vec<f64> {
        let Some((factor, size)) = self.sizes else { return vec![0.0; g.len()] };
        let (d_across, g_across) = (self.across(size, d), self.across(size, g));
        let (along_d, along_g) = (dot(self.v, d) / size, dot(self.v, g) / size);
        let both = dot(&d_across, g) / size;
        let entry = |i: usize| along_d * g_across[i] + along_g * d_across[i] + both * self.v[i];
        (0..g.len()).map(|i| -factor / size * entry(i)).collect()
    }
}
