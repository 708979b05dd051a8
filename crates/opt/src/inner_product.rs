//! Inner products of the control space: what turns a derivative into a gradient.

use nastic_numeric::vector::dot;
use std::fmt::Debug;
use std::sync::Arc;
use thiserror::Error;

/// A symmetric positive definite product (a, b) = a . G b on control vectors, with Gram matrix G.
pub trait InnerProduct: Debug + Send + Sync {
    /// Number of control components.
    fn len(&self) -> usize;

    /// Whether there is no component at all.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// G v: a dual vector.
    fn apply(&self, v: &[f64]) -> Vec<f64>;

    /// The Riesz image G^-1 d of a dual vector: the gradient that belongs to a derivative.
    fn riesz(&self, d: &[f64]) -> Vec<f64>;

    /// The diagonal of G if G is diagonal. Then clamping *is* the projection onto a box.
    fn lumped(&self) -> Option<&[f64]> {
        None
    }

    /// (a, b) = a . G b.
    fn inner(&self, a: &[f64], b: &[f64]) -> f64 {
        dot(&self.apply(a), b)
    }

    /// |v| = sqrt((v, v)).
    fn norm(&self, v: &[f64]) -> f64 {
        self.inner(v, v).max(0.0).sqrt()
    }

    /// sqrt(d . G^-1 d): the norm of a dual vector, equal to the norm of its Riesz image.
    fn dual_norm(&self, d: &[f64]) -> f64 {
        dot(&self.riesz(d), d).max(0.0).sqrt()
    }
}

/// A row of the catalogue of inner products.
#[derive(Clone, Copy, Debug)]
pub struct InnerProductRow {
    /// The product's name.
    pub name: &'static str,
    /// What it is, in a few words.
    pub about: &'static str,
    /// An example by the number of components.
    pub make: fn(usize) -> Result<Arc<dyn InnerProduct>, InnerProductError>,
}

/// Every inner product of this crate; those of control fields are in `nastic-control`.
pub const INNER_PRODUCTS: &[InnerProductRow] = &[
    InnerProductRow { name: "euclidean", about: "sum_i a_i b_i", make: |len| Ok(Arc::new(Euclidean::new(len))) },
    InnerProductRow {
        name: "diagonal",
        about: "sum_i w_i a_i b_i",
        make: |len| Ok(Arc::new(Diagonal::new((0..len).map(|i| 0.3 + (i % 4) as f64).collect())?)),
    },
];

/// Why an inner product was refused.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum InnerProductError {
    /// A weight that is not positive and finite.
    #[error(
        "weight {index} of the inner product is {value:e}; weights must be positive and finite (an element of zero volume?)"
    )]
    Weight {
        /// Which component.
        index: usize,
        /// Its weight.
        value: f64,
    },
}

/// A lumped product: G = diag(w), (a, b) = sum_i w_i a_i b_i.
#[derive(Clone, Debug)]
pub struct Diagonal {
    weights: Vec<f64>,
}

impl Diagonal {
    /// One positive weight per component (the measure of a cell, the lumped mass of a node).
    ///
    /// # Errors
    /// A weight that is zero, negative or not finite.
    pub fn new(weights: Vec<f64>) -> Result<Self, InnerProductError> {
        match weights.iter().position(|w| !(w.is_finite() && *w > 0.0)) {
            Some(index) => Err(InnerProductError::Weight { index, value: weights[index] }),
            None => Ok(Self { weights }),
        }
    }
}

impl InnerProduct for Diagonal {
    fn len(&self) -> usize {
        self.weights.len()
    }

    fn apply(&self, v: &[f64]) -> Vec<f64> {
        v.iter().zip(&self.weights).map(|(v, w)| v * w).collect()
    }

    fn riesz(&self, d: &[f64]) -> Vec<f64> {
        d.iter().zip(&self.weights).map(|(d, w)| d / w).collect()
    }

    fn lumped(&self) -> Option<&[f64]> {
        Some(&self.weights)
    }
}

/// The Euclidean product: G = I.
#[derive(Clone, Debug)]
pub struct Euclidean {
    ones: Vec<f64>,
}

impl Euclidean {
    /// The product of `len` components.
    pub fn new(len: usize) -> Self {
        Self { ones: vec![1.0; len] }
    }
}

impl InnerProduct for Euclidean {
    fn len(&self) -> usize {
        self.ones.len()
    }

    fn apply(&self, v: &[f64]) -> Vec<f64> {
        v.to_vec()
    }

    fn riesz(&self, d: &[f64]) -> Vec<f64> {
        d.to_vec()
    }

    fn lumped(&self) -> Option<&[f64]> {
        Some(&self.ones)
    }
}
