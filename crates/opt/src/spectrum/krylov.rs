//! [`Krylov`]: the space that Lanczos' method builds on a face, from several start vectors; [`Ritz`]: its eigenpairs.

use crate::admissible::Face;
use crate::inner_product::InnerProduct;
use nalgebra::{DMatrix, SymmetricEigen};
use nastic_numeric::Random;
use nastic_numeric::vector::{axpy, dot, scale};

/// Start vectors: as many copies of a multiple eigenvalue are found.
const START_VECTORS: usize = 4;
/// Share of a vector after orthogonalisation below which it lies in the span of the others.
const DEPENDENCE_TOLERANCE: f64 = 1e-12;
/// Least number of steps between two computations of the Ritz pairs.
const MIN_STEPS: usize = 4;
/// Steps made over those between two computations of the Ritz pairs, whose cost is cubic in the steps.
const STEP_DIVISOR: usize = 10;

/// An orthonormal basis in the inner product, and the coefficients by it of the images of its first vectors under `B = (P G P)^-1 P H`.
pub(super) struct Krylov<'a> {
    face: &'a Face,
    metric: &'a dyn InnerProduct,
    dimension: usize,
    random: Random,
    basis: Vec<Vec<f64>>,
    images: Vec<Vec<f64>>,
    look: usize,
}

impl<'a> Krylov<'a> {
    /// The space of the start vectors; `dimension` is that of the face.
    pub fn new(face: &'a Face, metric: &'a dyn InnerProduct, dimension: usize) -> Self {
        let random = Random::new(0);
        let mut out = Self { face, metric, dimension, random, basis: vec![], images: vec![], look: MIN_STEPS };
        (0..START_VECTORS).for_each(|_| out.start());
        out
    }

    /// Adds a random vector, unless the space is the whole face.
    fn start(&mut self) {
        let mut v: Vec<f64> = (0..self.metric.len()).map(|_| self.random.symmetric()).collect();
        self.face.project(&mut v);
        let size = self.metric.norm(&v);
        let (_, left) = self.orthogonalize(&mut v);
        self.push(v, left, DEPENDENCE_TOLERANCE * size);
    }

    fn push(&mut self, mut v: Vec<f64>, left: f64, spanned: f64) {
        if left > spanned && self.basis.len() < self.dimension {
            scale(1.0 / left, &mut v);
            self.basis.push(v);
        }
    }

    /// The vector whose image is wanted; `None` when the space is the whole face. A space that its images do not leave is extended by a
    /// random vector.
    pub fn next(&mut self) -> Option<Vec<f64>> {
        if self.images.len() == self.basis.len() {
            self.start();
        }
        self.basis.get(self.images.len()).cloned()
    }

    /// Takes the image of the [next](Self::next) vector; the number of images.
    pub fn add(&mut self, mut image: Vec<f64>) -> usize {
        let (mut coefficients, left) = self.orthogonalize(&mut image);
        let largest = self.images.iter().flatten().chain(&coefficients).fold(0.0, |most: f64, h| most.max(h.abs()));
        let before = self.basis.len();
        self.push(image, left, DEPENDENCE_TOLERANCE * largest);
        if self.basis.len() > before {
            coefficients.push(left);
        }
        self.images.push(coefficients);
        self.images.len()
    }

    /// Whether the Ritz pairs are due.
    pub fn is_due(&mut self) -> bool {
        let steps = self.images.len();
        if steps < self.look && steps < self.dimension {
            return false;
        }
        self.look = steps + MIN_STEPS.max(steps / STEP_DIVISOR);
        true
    }

    /// Makes v orthogonal to the basis (twice is enough: Kahan, Parlett): its coefficients, and what is left of its norm.
    fn orthogonalize(&self, v: &mut [f64]) -> (Vec<f64>, f64) {
        let mut sums = vec![0.0; self.basis.len()];
        for _ in 0..2 {
            let gv = self.metric.apply(v);
            let own: Vec<f64> = self.basis.iter().map(|q| dot(q, &gv)).collect();
            self.basis.iter().zip(&own).for_each(|(q, h)| axpy(-h, q, v));
            sums.iter_mut().zip(&own).for_each(|(sum, h)| *sum += h);
        }
        (sums, self.metric.norm(v))
    }

    /// Eigenpairs of `q_i . H q_k` over the vectors whose images are known.
    pub fn ritz(&self) -> Ritz {
        let n = self.images.len();
        let entry = |i: usize, k: usize| self.images[k].get(i).copied().unwrap_or(0.0);
        let matrix = DMatrix::from_fn(n, n, |i, k| 0.5 * (entry(i, k) + entry(k, i)));
        let SymmetricEigen { eigenvalues, eigenvectors } = matrix.symmetric_eigen();
        let mut order: Vec<usize> = (0..n).collect();
        order.sort_by(|&a, &b| eigenvalues[b].total_cmp(&eigenvalues[a]));
        let values = order.iter().map(|&k| eigenvalues[k]).collect();
        let vectors: Vec<Vec<f64>> = order.iter().map(|&k| eigenvectors.column(k).iter().copied().collect()).collect();
        let outside = |y: &Vec<f64>| {
            let component = |i: usize| (0..n).map(|k| entry(i, k) * y[k]).sum::<f64>();
            (n..self.basis.len()).map(|i| component(i).powi(2)).sum::<f64>().sqrt()
        };
        let residuals = vectors.iter().map(outside).collect();
        Ritz { values, vectors, residuals }
    }

    /// The control vector of a Ritz vector.
    pub fn combined(&self, ritz: &Ritz, k: usize) -> Vec<f64> {
        let mut out = vec![0.0; self.metric.len()];
        self.basis.iter().zip(&ritz.vectors[k]).for_each(|(q, y)| axpy(*y, q, &mut out));
        out
    }
}

/// Ritz pairs, the largest first.
pub(super) struct Ritz {
    values: Vec<f64>,
    vectors: Vec<Vec<f64>>,
    /// `|B v - theta v|` in the norm of the inner product.
    residuals: Vec<f64>,
}

impl Ritz {
    /// The largest absolute value.
    pub fn scale(&self) -> f64 {
        self.values.iter().fold(0.0, |most: f64, value| most.max(value.abs()))
    }

    /// How many of the largest, without a gap, have residuals below this share of the scale.
    pub fn converged(&self, tolerance: f64) -> usize {
        let limit = tolerance * self.scale();
        self.residuals.iter().take_while(|residual| **residual <= limit).count()
    }

    /// The smallest value; 0 without any.
    pub fn lowest(&self) -> f64 {
        self.values.last().copied().unwrap_or(0.0)
    }

    /// How many values are below this.
    pub fn below(&self, limit: f64) -> usize {
        self.values.iter().filter(|value| **value < limit).count()
    }
}
