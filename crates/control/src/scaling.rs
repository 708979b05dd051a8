//! [`Scaling`]: a vector is given a length.

use nastic_numeric::vector::{dot, norm};

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
