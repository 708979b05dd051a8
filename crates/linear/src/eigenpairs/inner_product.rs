//! [`InnerProduct`]: `x . M y` of an eigenproblem.

use super::MassMatrix;
use crate::pattern::matrix::SparseMatrix;
use crate::sums::{self, dot};

/// Relative error of the entries of A: sums of some tens of products.
pub(super) const ENTRY_ROUNDING: f64 = 16.0 * f64::EPSILON;

/// Share of a vector after orthogonalisation below which it lies in the span of the others.
pub(super) const DEPENDENCE_TOLERANCE: f64 = 1e-12;

/// The inner product of M, on the unknowns that are not fixed.
#[derive(Clone, Copy)]
pub(super) struct InnerProduct<'a> {
    pub mass: MassMatrix<'a>,
    /// By unknown: whether it is fixed.
    pub fixed: &'a [bool],
    /// Whether to use all threads; the bits are the same.
    pub parallel: bool,
}

impl InnerProduct<'_> {
    /// `M x`.
    pub fn times_mass(&self, x: &[f64]) -> Vec<f64> {
        match self.mass {
            MassMatrix::Diagonal(mass) => {
                let entry = |((x, m), &fixed): ((&f64, &f64), &bool)| if fixed { 0.0 } else { x * m };
                x.iter().zip(mass).zip(self.fixed).map(entry).collect()
            }
            MassMatrix::Sparse(mass) => {
                let mut product = vec![0.0; x.len()];
                mass.multiply_on(x, &mut product, self.parallel);
                product
            }
        }
    }

    /// `x . M x`.
    pub fn square(&self, x: &[f64]) -> f64 {
        dot(x, &self.times_mass(x), self.parallel)
    }

    /// Makes x orthogonal to these (twice is enough: Kahan, Parlett) and returns its coefficients by them and what is
    /// left of its norm.
    pub fn orthogonalize<'v>(
        &self,
        x: &mut [f64],
        basis: impl Iterator<Item = &'v Vec<f64>> + Clone,
    ) -> (Vec<f64>, f64) {
        let mut sums = Vec::new();
        for _ in 0..2 {
            let mx = self.times_mass(x);
            let own: Vec<f64> = basis.clone().map(|q| dot(q, &mx, self.parallel)).collect();
            for (q, h) in basis.clone().zip(&own) {
                sums::zipped(x, q, self.parallel, |x, q| *x -= h * q);
            }
            sums.resize(own.len(), 0.0);
            sums.iter_mut().zip(&own).for_each(|(sum, h)| *sum += h);
        }
        (sums, self.square(x).sqrt())
    }
}

/// `16 eps |x| . |A| |x|` of each of these vectors, by the magnitudes of the entries of A.
pub(super) fn rounding(magnitudes: &SparseMatrix, vectors: &[Vec<f64>], parallel: bool) -> Vec<f64> {
    let of = |x: &Vec<f64>| {
        let (x, mut product) = (x.iter().map(|x| x.abs()).collect::<Vec<_>>(), vec![0.0; x.len()]);
        magnitudes.multiply_on(&x, &mut product, parallel);
        ENTRY_ROUNDING * dot(&x, &product, parallel)
    };
    vectors.iter().map(of).collect()
}
