//! The free directions at a control: a linear subspace.

use crate::conjugate_gradient::conjugate_gradient;
use crate::inner_product::InnerProduct;
use nastic_numeric::vector::dot;

/// A subspace of control vectors: some components fixed, at some points one direction barred. Its Euclidean-orthogonal
/// projector P is used on directions and derivatives alike.
#[derive(Clone, Debug, PartialEq)]
pub struct Face {
    fixed: Vec<bool>,
    normals: Vec<Normal>,
}

/// One barred direction at the point whose components begin at `at`.
#[derive(Clone, Debug, PartialEq)]
struct Normal {
    at: usize,
    dim: usize,
    n: [f64; 3],
    /// Whether it counts as an active bound (a ball's does, a sphere's is always there).
    bound: bool,
}

impl Face {
    /// All directions free.
    pub fn free(len: usize) -> Self {
        Self { fixed: vec![false; len], normals: Vec::new() }
    }

    /// Fixes one component.
    pub fn fix(&mut self, component: usize) {
        self.fixed[component] = true;
    }

    /// Bars the direction of `radial` (one to three components, not zero) at the point that begins at `at`; `bound` says
    /// whether that is an active bound.
    pub fn bar(&mut self, at: usize, radial: &[f64], bound: bool) {
        let size = dot(radial, radial).sqrt();
        let mut n = [0.0; 3];
        for (n, x) in n.iter_mut().zip(radial) {
            *n = x / size;
        }
        self.normals.push(Normal { at, dim: radial.len(), n, bound });
    }

    /// Puts the face of a block in its place.
    pub fn insert(&mut self, offset: usize, block: &Face) {
        self.fixed[offset..offset + block.fixed.len()].copy_from_slice(&block.fixed);
        self.normals.extend(block.normals.iter().map(|n| Normal { at: n.at + offset, ..n.clone() }));
    }

    /// Bars what another face bars too.
    pub fn join(&mut self, other: &Face) {
        self.fixed.iter_mut().zip(&other.fixed).for_each(|(own, other)| *own |= other);
        let known = |normal: &&Normal| !self.normals.iter().any(|own| own.at == normal.at);
        let new: Vec<Normal> = other.normals.iter().filter(known).cloned().collect();
        self.normals.extend(new);
    }

    /// Puts the vectors of points held at a curved boundary back into a step that was bent there.
    pub fn keep_tangential(&self, unbent: &[f64], d: &mut [f64]) {
        for normal in self.normals.iter().filter(|normal| normal.bound) {
            let at = normal.at..normal.at + normal.dim;
            d[at.clone()].copy_from_slice(&unbent[at]);
        }
    }

    /// Number of active bounds: fixed components and points held at a ball's boundary.
    pub fn active(&self) -> usize {
        self.fixed.iter().filter(|f| **f).count() + self.normals.iter().filter(|n| n.bound).count()
    }

    /// Number of independent free directions.
    pub fn dimension(&self) -> usize {
        let barred =
            self.normals.iter().filter(|normal| !self.fixed[normal.at..normal.at + normal.dim].contains(&true));
        self.fixed.iter().filter(|fixed| !**fixed).count() - barred.count()
    }

    /// v <- P v.
    pub fn project(&self, v: &mut [f64]) {
        for (v, fixed) in v.iter_mut().zip(&self.fixed) {
            if *fixed {
                *v = 0.0;
            }
        }
        for normal in &self.normals {
            let v = &mut v[normal.at..normal.at + normal.dim];
            let along: f64 = v.iter().zip(&normal.n).map(|(v, n)| v * n).sum();
            for (v, n) in v.iter_mut().zip(&normal.n) {
                *v -= along * n;
            }
        }
    }

    /// P v.
    pub fn projected(&self, v: &[f64]) -> Vec<f64> {
        let mut v = v.to_vec();
        self.project(&mut v);
        v
    }

    /// The gradient within the face: v = P v with P G v = P derivative.
    pub fn gradient(&self, metric: &dyn InnerProduct, derivative: &[f64]) -> Vec<f64> {
        let rhs = self.projected(derivative);
        match metric.lumped() {
            Some(weights) if self.commutes(weights) => rhs.iter().zip(weights).map(|(d, w)| d / w).collect(),
            _ => {
                let apply = |v: &[f64]| self.projected(&metric.apply(v));
                let precondition = |r: &[f64]| self.projected(&metric.riesz(r));
                conjugate_gradient(apply, precondition, &rhs, 1e-12, 500)
            }
        }
    }

    /// Whether diag(weights) and P commute: equal weights over the components of every barred point.
    fn commutes(&self, weights: &[f64]) -> bool {
        self.normals.iter().all(|n| weights[n.at..n.at + n.dim].iter().all(|w| *w == weights[n.at]))
    }
}
